"""Compiled MuJoCo model of an MJCF scene, with the poses of its bodies and the geoms that are visible."""

import warnings
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.datasets.mjcf.files import MAX_HEIGHTS
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, printable
from home_mjx.errors import DatasetError
from home_mjx.geometry.meshes import Z_UP

MIN_INERTIA = 1e-6  # [kg], [kg m^2], of moving bodies whose mass the file leaves out
MAX_SHOWN_GROUP = 2  # groups above it are hidden by default in MuJoCo's viewer
HEIGHTS = 1  # `mujoco.mjtGeom.mjGEOM_HFIELD`
LEVEL_LINEAR = Z_UP.T  # house (Y up) from world (Z up)


@dataclass(frozen=True)
class MjcfScene:
    """An MJCF scene at its reference pose.

    Attributes:
        path: Its file.
        model: The compiled `mujoco.MjModel`.
        data: `mujoco.MjData` with the poses at `qpos0`.
        notes: Warnings of MuJoCo.
    """

    path: Path
    model: Any
    data: Any
    notes: tuple[str, ...] = ()

    @cached_property
    def shown(self) -> Bool[np.ndarray, " g"]:
        """Mask of the geoms that are visible.

        Below each body of the world these are the geoms without contacts, and those in the same groups, if there are
        any, else the geoms of groups up to `MAX_SHOWN_GROUP`. Transparent geoms are not visible.
        """
        model = self.model
        seen, pure = self.opacity > 0, (model.geom_contype == 0) & (model.geom_conaffinity == 0)
        tree, group = model.body_rootid[model.geom_bodyid], model.geom_group
        found = np.zeros(model.ngeom, bool)
        for root in np.unique(tree):
            mine = seen & (tree == root)
            groups = np.unique(group[mine & pure])
            found |= mine & (np.isin(group, groups) if len(groups) else group <= MAX_SHOWN_GROUP)
        return found

    @cached_property
    def opacity(self) -> Float[np.ndarray, " g"]:
        """Opacity of each geom, of its material unless the geom has a colour of its own."""
        return np.array([self.rgba(geom) for geom in range(self.model.ngeom)]).reshape(-1, 4)[:, 3]

    def rgba(self, geom: int) -> Float[np.ndarray, "4"]:
        """Return the colour of a geom: its own if it is not MuJoCo's default, else that of its material."""
        own, material = self.model.geom_rgba[geom], int(self.model.geom_matid[geom])
        is_default = np.array_equal(own, np.array([0.5, 0.5, 0.5, 1.0]))
        return self.model.mat_rgba[material] if is_default and material >= 0 else own

    @cached_property
    def children(self) -> dict[int, list[int]]:
        """Children of each body."""
        found = defaultdict(list)
        for body in range(1, self.model.nbody):
            found[int(self.model.body_parentid[body])].append(body)
        return found

    def subtree(self, body: int) -> list[int]:
        """Return a body and all below it, depth first."""
        found, stack = [], [body]
        while stack:
            found.append(stack.pop())
            stack += reversed(self.children[found[-1]])
        return found

    def geoms(self, bodies: list[int]) -> Int[np.ndarray, " n"]:
        """Return the visible geoms of bodies, in the order of the bodies."""
        owner = self.model.geom_bodyid
        return np.concatenate([np.flatnonzero(self.shown & (owner == body)) for body in bodies], dtype=int)

    def matrix(self, body: int) -> Float[np.ndarray, "4 4"]:
        """Return house from body, both Y up."""
        matrix = np.eye(4)
        matrix[:3, :3] = LEVEL_LINEAR @ self.data.xmat[body].reshape(3, 3) @ LEVEL_LINEAR.T
        matrix[:3, 3] = LEVEL_LINEAR @ self.data.xpos[body]
        return matrix


def compile_scene(path: Path) -> MjcfScene:
    """Compile an MJCF file whose files were checked, and compute the poses of its bodies.

    Masses of moving bodies that the file leaves out, and volumes of flat meshes, are no errors.

    Raises:
        DatasetError: MuJoCo refuses the file, or a pose or size is not finite or larger than all houses, or geoms
            have more than `MAX_HEIGHTS` heights together.
    """
    with warnings.catch_warnings(record=True) as found, _warnings_kept():
        warnings.simplefilter("always")
        try:
            model, data = _compile(path, is_tolerant=False)
        except DatasetError as error:
            model, data = _compile(path, is_tolerant=True)
            warnings.warn(f"compiled with tolerated masses: {error.message}", stacklevel=2)
    sizes = np.concatenate([model.geom_size, model.geom_rbound[:, None]], axis=1)
    for name, values in (("body", data.xpos), ("geom", data.geom_xpos), ("geom", data.geom_xmat), ("geom", sizes)):
        bad = np.flatnonzero(~(abs(values) < MAX_COORDINATE).all(axis=1))
        if len(bad):
            message = "pose or size is not finite, or beyond 1,000 km"
            raise DatasetError(message, file=path, element=f"{name}[{int(bad[0])}]", hint="Correct it.")
    _check_heights(path, model)
    return MjcfScene(path, model, data, tuple(dict.fromkeys(str(warning.message) for warning in found)))


def _check_heights(path: Path, model: Any) -> None:
    """Raise `DatasetError` if the geoms of height fields, also those read from images, have too many heights."""
    fields = model.geom_dataid[model.geom_type == HEIGHTS]
    count = int((model.hfield_nrow[fields].astype(int) * model.hfield_ncol[fields]).sum())
    if count > MAX_HEIGHTS:
        message = f"geoms show {count} heights of fields, at most {MAX_HEIGHTS} are read"
        raise DatasetError(message, file=path, element="hfield", hint="Use fewer rows, columns or geoms.")


def _mujoco() -> Any:
    """Return the module `mujoco`, loaded on first use."""
    import mujoco

    return mujoco


@contextmanager
def _warnings_kept() -> Iterator[None]:
    """Turn MuJoCo's own warnings into Python's while the block runs; else it prints them and writes a log file."""
    mujoco = _mujoco()
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: warnings.warn(text, stacklevel=2))
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def _compile(path: Path, is_tolerant: bool) -> tuple[Any, Any]:
    """Return the model and data of a file; if tolerant, bodies need no masses, and meshes no volumes."""
    mujoco = _mujoco()
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        _prepare(spec)
        if is_tolerant:
            _tolerate_masses(spec)
        model = spec.compile()
        data = mujoco.MjData(model)
        for step in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_camlight):
            step(model, data)
    except (ValueError, TypeError, RuntimeError, MemoryError, mujoco.FatalError) as error:
        message = " ".join(printable(str(error)).split())
        raise DatasetError(f"MuJoCo refuses the scene: {message}", file=path, hint="Correct it.") from None
    return model, data


def _prepare(spec: Any) -> None:
    """Let a spec keep all bodies and geoms, and ask for no memory but that of the scene."""
    spec.compiler.discardvisual = spec.compiler.fusestatic = False
    spec.memory = spec.nstack = spec.njmax = spec.nconmax = -1
    spec.nuserdata = spec.nkey = 0


def _tolerate_masses(spec: Any) -> None:
    """Bound masses and inertias of a spec, and take meshes as shells."""
    spec.compiler.balanceinertia = True
    spec.compiler.boundmass = max(spec.compiler.boundmass, MIN_INERTIA)
    spec.compiler.boundinertia = max(spec.compiler.boundinertia, MIN_INERTIA)
    for mesh in spec.meshes:
        mesh.inertia = _mujoco().mjtMeshInertia.mjMESH_INERTIA_SHELL
