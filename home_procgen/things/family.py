"""Families of library models: each model has a construction of its own."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Light, Mesh
from home_procgen.primitives.family import Bulb, FurnitureModel
from home_procgen.primitives.solids import Solid, move, to_mesh
from home_procgen.shapes.normals import corner_normals
from home_procgen.things.finishes import FINISHES
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

    def model(self, number: int) -> FurnitureModel:
        """Build one of the library models.

        Args:
            number: Number of the model, from 1.
        """
        model_id, made = f"home_{self.name}_{number}", self.designs[number - 1]
        solids, bulbs, parts = _build_solids(made, {}, self.centred)
        names = list(dict.fromkeys(str(solid.material) for solid in solids))
        slots = {name: self.finishes.get(name, name.rstrip("_0123456789")) for name in names}
        materials = tuple(
            replace(FINISHES[finish][(number + i * (finish != "wood")) % len(FINISHES[finish])], name=f"material_{i}")
            for i, finish in enumerate(slots.values())
        )
        folder = Path("object") / model_id
        mesh = _add_normals(to_mesh(folder / f"{model_id}.obj", solids, names, materials))
        closed = None
        if self.closed is not None:
            shut = _build_solids(made, self.closed, self.centred)[0]
            closed = _add_normals(to_mesh(folder / f"{model_id}_0.obj", shut, names, materials))
        joints, lights = make_joints(model_id, solids, mesh), tuple(map(_make_light, bulbs))
        return FurnitureModel(model_id, self.name, self.fine, slots, mesh, parts, lights, closed, joints)


def _build_solids(
    made: FurnitureDesign, change: Mapping[str, Any], centred: bool
) -> tuple[list[Solid], list[Bulb], Float[np.ndarray, "_ 2 3"]]:
    """Build the solids and bulbs of a design with its lowest point at height 0, and the solids' bounding boxes."""
    pieces = list(made.build(**{**made.parameters, **change}))
    solids = [piece for piece in pieces if isinstance(piece, Solid)]
    boxes = np.stack([solid.box for solid in solids])
    shift = _origin_shift(boxes, centred)
    bulbs = [_move_bulb(piece, shift) for piece in pieces if isinstance(piece, Bulb)]
    return [move(solid, shift) for solid in solids], bulbs, boxes + shift


def _origin_shift(boxes: Float[np.ndarray, "_ 2 3"], centred: bool) -> Float[np.ndarray, " 3"]:
    low, high = boxes[:, 0].min(0), boxes[:, 1].max(0)
    middle = (low + high) / 2 if centred else np.zeros(3)
    return -np.array([middle[0], low[1] if centred else 0.0, middle[2]])


def _move_bulb(bulb: Bulb, shift: Float[np.ndarray, " 3"]) -> Bulb:
    x, y, z = (np.asarray(bulb.position) + shift).tolist()
    return Bulb((x, y, z), bulb.power)


def _add_normals(mesh: Mesh) -> Mesh:
    """Add vertex normals and drop unused vertices, which OBJ files do not store."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    faces = faces.reshape(mesh.faces.shape).astype(mesh.faces.dtype)
    return replace(mesh, vertices=mesh.vertices[used], faces=faces, normal=corner_normals(mesh.vertices[used], faces))


def _make_light(bulb: Bulb) -> Light:
    x, y, z = np.round(bulb.position, 6).tolist()
    return Light("point", bulb.power, (1.0, 1.0, 1.0), (x, y, z))
