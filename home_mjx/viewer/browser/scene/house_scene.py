"""One house of a bank as groups of equal instances, for a browser's scene (host only)."""

from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.scene.types import DynamicInstances
from home_mjx.schema.categories import fine_index
from home_mjx.schema.compiled import ARCHITECTURE
from home_mjx.schema.semantic import Semantic
from home_mjx.viewer.browser.scene.models import ModelLibrary
from home_mjx.viewer.browser.scene.poses import is_plain_scale, split_poses

STATIC, MOVING, CEILING, OUTDOORS = "static", "moving", "ceiling", "outdoors"  # layers of a level
NO_LEVEL = -1  # level of agents, and of objects outside of all levels


class _Key(NamedTuple):
    """Equal instances: one model with one look on one level; a stretch that is not a plain scale is part of it."""

    level: int
    layer: str
    model: int
    material: int
    stretch: bytes


@dataclass(frozen=True)
class InstanceGroup:
    """Instances of one mesh on one level.

    Attributes:
        level: Level of the house; -1 none.
        layer: `STATIC`, `MOVING`, `CEILING`, or `OUTDOORS`: roofs, and static objects in no room.
        glbs: The mesh as binary glTF, in the model's frame; one file per material if there are several instances.
        entries: Instances of the house; of layer `moving` indices into `Scene.moving` instead.
        objects: Object ids; -1 for the architecture.
        semantic: Rows in the bank's semantic table.
        scale: Scale along the model's axes.
        pos: Positions [m].
        quat: Rotations, wxyz.
    """

    level: int
    layer: str
    glbs: tuple[bytes, ...]
    entries: Int[np.ndarray, " n"]
    objects: Int[np.ndarray, " n"]
    semantic: Int[np.ndarray, " n"]
    scale: Float[np.ndarray, "n 3"]
    pos: Float[np.ndarray, "n 3"]
    quat: Float[np.ndarray, "n 4"]

    def with_poses(self, pos: Float[np.ndarray, "m 3"], quat: Float[np.ndarray, "m 4"]) -> "InstanceGroup":
        """Return the group of layer `MOVING` at the poses of all m dynamic instances, see `split_poses`."""
        return InstanceGroup(**{**self.__dict__, "pos": pos[self.entries], "quat": quat[self.entries]})


class HouseScene:
    """A house for a browser: its architecture per level, static instances, and dynamic instances.

    Args:
        bank: The houses.
        house: Index of the house.
        moving: Dynamic instances of an environment in this house.
        library: Models of the bank; None: a new one.

    Attributes:
        groups: All groups of instances, dynamic ones last.
        levels: Levels of the house, lowest first.
        box: Bounds of the house's goals, which are in its rooms [m], (2, 3).
    """

    def __init__(
        self, bank: HouseBank, house: int, moving: DynamicInstances, library: ModelLibrary | None = None
    ) -> None:
        self.bank, self.house, self.library = bank, house, library or ModelLibrary(bank)
        self._semantics = np.asarray(bank.semantics)
        self.groups = [*self._architecture(), *self._static(moving), *self._moving(moving)]
        self.levels = sorted({group.level for group in self.groups} - {NO_LEVEL})
        goals = np.asarray(bank.navigation.goal[house])
        self.box = np.stack([goals.min(axis=0), goals.max(axis=0)])

    def _architecture(self) -> list[InstanceGroup]:
        """Return walls and floors of each level, and its ceilings apart; triangles of no level join the lowest."""
        geometry = self.bank.geometry
        model, material, first = (
            int(x[self.house, ARCHITECTURE])
            for x in (geometry.instance_model, geometry.instance_material, geometry.instance_semantic)
        )
        triangle = self.library.triangles(model)
        rows = self._semantics[first + self.library.part(triangle)]
        level, is_ceiling = np.maximum(rows[:, Semantic.LEVEL], 0), rows[:, Semantic.FINE] == fine_index(CEILING)
        still = {
            "entries": np.zeros(1, np.int32), "objects": np.full(1, -1), "semantic": np.full(1, first),
            "scale": np.ones((1, 3)), "pos": np.zeros((1, 3)), "quat": np.eye(1, 4),
        }  # fmt: skip
        parts = [
            (int(number), layer, triangle[(level == number) & mask])
            for number in np.unique(level)
            for layer, mask in ((STATIC, ~is_ceiling), (CEILING, is_ceiling))
        ]
        return [
            InstanceGroup(number, layer, (self.library.to_glb(chosen, material),), **still)
            for number, layer, chosen in parts
            if len(chosen)
        ]

    def _static(self, moving: DynamicInstances) -> list[InstanceGroup]:
        """Return groups of the instances that are not in `moving`, without the architecture."""
        geometry, house = self.bank.geometry, self.house
        model = np.asarray(geometry.instance_model[house])
        is_static = (model >= 0) & (np.arange(len(model)) > ARCHITECTURE)
        dynamic = np.asarray(moving.instance)
        is_static[dynamic[(dynamic >= 0) & (dynamic < len(model))]] = False
        names = ("model", "pose", "object", "material", "semantic")
        arrays = {name: np.asarray(getattr(geometry, f"instance_{name}")[house]) for name in names}
        return self._group(STATIC, np.flatnonzero(is_static), arrays)

    def _moving(self, moving: DynamicInstances) -> list[InstanceGroup]:
        """Return groups of the dynamic instances."""
        arrays = {name: np.asarray(getattr(moving, name)) for name in ("model", "pose", "material", "semantic")}
        arrays["object"] = np.asarray(moving.object_id)
        return self._group(MOVING, np.flatnonzero(np.asarray(moving.instance) >= 0), arrays)

    def _group(self, layer: str, entries: Int[np.ndarray, " n"], arrays: dict[str, np.ndarray]) -> list[InstanceGroup]:
        """Return groups of the entries of arrays by name: model, pose, object, material, semantic."""
        split, found = split_poses(arrays["pose"]), defaultdict(list)
        for entry in entries.tolist():
            found[self._key(layer, entry, arrays, split.stretch[entry])].append(entry)
        groups = []
        for key, members in found.items():
            rows, stretch = np.array(members), np.frombuffer(key.stretch).reshape(-1, 3) if key.stretch else None
            scale = np.diagonal(split.stretch[rows], axis1=1, axis2=2) if stretch is None else np.ones((len(rows), 3))
            glbs = self._meshes(self.library.triangles(key.model), key.material, stretch, len(rows))
            known = {"objects": arrays["object"][rows], "semantic": arrays["semantic"][rows], "scale": scale}
            groups.append(
                InstanceGroup(key.level, key.layer, glbs, rows, pos=split.pos[rows], quat=split.quat[rows], **known)
            )
        return groups

    def _meshes(
        self, triangle: Int[np.ndarray, " t"], material: int, stretch: Float[np.ndarray, "3 3"] | None, count: int
    ) -> tuple[bytes, ...]:
        """Return a mesh for a number of instances: viser draws several only if the file has one material."""
        looks = self.library.split_by_look(triangle, material)
        parts = [triangle] if count == 1 else [part for _, part in looks]
        return tuple(self.library.to_glb(part, material, stretch) for part in parts)

    def _key(self, layer: str, entry: int, arrays: dict[str, np.ndarray], stretch: Float[np.ndarray, "3 3"]) -> _Key:
        """Return the group of one entry."""
        row = self._semantics[arrays["semantic"][entry]]
        level = int(row[Semantic.LEVEL])
        layer = OUTDOORS if layer == STATIC and row[Semantic.ROOM] < 0 else layer
        baked = b"" if is_plain_scale(stretch) else stretch.round(5).tobytes()
        return _Key(level, layer, int(arrays["model"][entry]), int(arrays["material"][entry]), baked)
