"""Families of library models: each model has a construction of its own."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Light, Mesh
from home_procgen.model_codec import add_normals, round_positions, round_uv
from home_procgen.primitives.detail import DETAILS, build_coarsely
from home_procgen.primitives.family import Bulb, FurnitureModel, Meshes
from home_procgen.primitives.solids import Solid, move, to_mesh
from home_procgen.textures.finishes import default_materials
from home_procgen.textures.recipes import repeat_uv
from home_procgen.things.low_detail import reduce_solids, select_pieces
from home_procgen.things.movable_parts import make_joints


@dataclass(frozen=True)
class FurnitureDesign:
    """Construction function and its parameters."""

    build: Callable[..., Iterable[Solid | Bulb]]
    parameters: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Name of the construction function."""
        return self.build.__name__


def design(build: Callable[..., Iterable[Solid | Bulb]], **parameters: Any) -> FurnitureDesign:
    """Return a `FurnitureDesign` with these parameters."""
    return FurnitureDesign(build, parameters)


def design_kinds(build: Callable[..., Iterable[Solid | Bulb]], *kinds: str) -> tuple[FurnitureDesign, ...]:
    """Return one `FurnitureDesign` per kind, with default parameters otherwise."""
    return tuple(design(build, kind=kind) for kind in kinds)


@dataclass(frozen=True)
class FurnitureFamily:
    """Interchangeable library models of one kind of furniture.

    A slot's finish is its name without a trailing number, unless `finishes` overrides it. Slots are numbered in the
    order in which the solids first use them.

    Args:
        name: Name of the family; its models are `home_<name>_<k>`.
        fine: Fine class.
        designs: Designs, one per model.
        closed: Parameters for the closed state of a door; None if the family has no closed state.
        centred: Move the centre of the bounding box to x = z = 0; False keeps openings on their wall's centre line.
        finishes: Slot name -> finish; overrides the finish in the slot's name.
    """

    name: str
    fine: str
    designs: tuple[FurnitureDesign, ...]
    closed: Mapping[str, Any] | None = None
    centred: bool = True
    finishes: Mapping[str, str] = field(default_factory=dict)

    @property
    def numbers(self) -> range:
        """Numbers of the library models, from 1."""
        return range(1, len(self.designs) + 1)

    def models(self) -> Iterator[FurnitureModel]:
        """Yield the library models of the family."""
        yield from map(self.model, self.numbers)

    def model(self, number: int, detail: str = DETAILS[0]) -> FurnitureModel:
        """Build one of the library models.

        Args:
            number: Number of the model, from 1.
            detail: Level of detail of its meshes; boxes of its parts are those of full detail.
        """
        model_id, made = f"home_{self.name}_{number}", self.designs[number - 1]
        solids, bulbs, parts = _build_solids(made, {}, self.centred)
        names = list(dict.fromkeys(str(solid.material) for solid in solids))
        slots = {name: self.finishes.get(name, name.rstrip("_0123456789")) for name in names}
        shut = None if self.closed is None else _build_solids(made, self.closed, self.centred)[0]
        if detail != DETAILS[0]:
            solids, shut = self._coarse_solids(made, solids, shut)
        folder, materials = Path("object") / model_id, default_materials(slots, number)
        mesh = _finish(to_mesh(folder / f"{model_id}.obj", solids, names, materials), slots)
        closed = None if shut is None else _finish(to_mesh(folder / f"{model_id}_0.obj", shut, names, materials), slots)
        joints, lights = make_joints(model_id, solids, mesh), tuple(map(_make_light, bulbs))
        meshes = Meshes(mesh, closed)
        return FurnitureModel(model_id, self.name, self.fine, slots, parts, lambda: meshes, lights, joints)

    def _coarse_solids(
        self, made: FurnitureDesign, full: list[Solid], shut: list[Solid] | None
    ) -> tuple[list[Solid], list[Solid] | None]:
        """Return the solids at low detail, also those of the closed state."""
        coarseness, solids = reduce_solids(full, lambda: _build_solids(made, {}, self.centred)[0], shut is not None)
        kept = select_pieces(solids)
        if shut is not None and self.closed is not None:
            with build_coarsely(coarseness):
                coarse = _build_solids(made, self.closed, self.centred)[0]
            pairs = zip(coarse, shut, strict=True)
            shut = [a if len(a.faces) < len(b.faces) else b for a, b in pairs]
            shut = [_round_solid(shut[i]) for i in kept]
        return [_round_solid(solids[i]) for i in kept], shut


def _build_solids(
    made: FurnitureDesign, change: Mapping[str, Any], centred: bool
) -> tuple[list[Solid], list[Bulb], Float[np.ndarray, "_ 2 3"]]:
    """Build the solids and bulbs of a design with its lowest point at height 0, and the solids' bounding boxes."""
    pieces = list(made.build(**{**made.parameters, **change}))
    solids = [piece for piece in pieces if isinstance(piece, Solid)]
    boxes = np.stack([solid.box for solid in solids])
    shift = _origin_shift(boxes, centred)
    bulbs = [_move_bulb(piece, shift) for piece in pieces if isinstance(piece, Bulb)]
    moved = [_round_solid(move(solid, shift)) for solid in solids]
    return moved, bulbs, np.stack([solid.box for solid in moved])


def _round_solid(piece: Solid) -> Solid:
    """Return a solid on the grid of the shipped library."""
    return replace(piece, vertices=round_positions(piece.vertices), uv=round_uv(piece.uv))


def _origin_shift(boxes: Float[np.ndarray, "_ 2 3"], centred: bool) -> Float[np.ndarray, " 3"]:
    low, high = boxes[:, 0].min(0), boxes[:, 1].max(0)
    middle = (low + high) / 2 if centred else np.zeros(3)
    return -np.array([middle[0], low[1] if centred else 0.0, middle[2]])


def _move_bulb(bulb: Bulb, shift: Float[np.ndarray, " 3"]) -> Bulb:
    x, y, z = (np.asarray(bulb.position) + shift).tolist()
    return Bulb((x, y, z), bulb.power)


def _finish(mesh: Mesh, slots: Mapping[str, str]) -> Mesh:
    """Return a mesh with normals, UVs in repeats, and without unused vertices, which OBJ files do not store."""
    return add_normals(repeat_uv(mesh, slots.values()))


def _make_light(bulb: Bulb) -> Light:
    x, y, z = np.round(bulb.position, 6).tolist()
    return Light("point", bulb.power, (1.0, 1.0, 1.0), (x, y, z))
