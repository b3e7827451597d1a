"""Furniture families; each variant is a library model."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Joint, Light, Mesh
from home_procgen.primitives.palette import FINISHES
from home_procgen.primitives.solids import Solid, Vector, move, to_mesh


@dataclass(frozen=True)
class Bulb:
    """A light source of a model."""

    position: Vector  # [m]
    power: float  # [W]


_PICKS, _AXES = np.array([[(i >> k) & 1 for k in range(3)] for i in range(8)]), np.arange(3)  # corners of a box
# Rotation times scale and mirror, boxes of the parts, and bounding box, with the object at the origin [m].
Shape = tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "p 2 3"], Float[np.ndarray, "2 3"]]


class Meshes(NamedTuple):
    """Meshes of a model."""

    mesh: Mesh
    closed: Mesh | None = None  # the `_0` variant of a door, whose own mesh is open


@dataclass(frozen=True, eq=False)
class FurnitureModel:
    """A library model: origin at the bottom centre, front towards +z, Y up, in metres."""

    id: str
    family: str
    fine: str  # fine class, a key of CATEGORIES
    slots: Mapping[str, str]  # slot name -> finish, in the order of the MTL
    parts: Float[np.ndarray, "p 2 3"]  # boxes of the solids [m]
    load_meshes: Callable[[], Meshes]  # called once, when a mesh is needed
    lights: tuple[Light, ...] = ()
    joints: tuple[Joint, ...] = ()

    @cached_property
    def meshes(self) -> Meshes:
        """Meshes of all states."""
        return self.load_meshes()

    @property
    def mesh(self) -> Mesh:
        """Mesh of the model; of a door, in its open state."""
        return self.meshes.mesh

    @property
    def closed(self) -> Mesh | None:
        """Mesh of a closed door; None for other models."""
        return self.meshes.closed

    @cached_property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Lower and upper corner of the bounding box [m]."""
        return np.stack([self.parts[:, 0].min(0), self.parts[:, 1].max(0)])

    @cached_property
    def size(self) -> Float[np.ndarray, " 3"]:
        """Extents along x, y, z [m]."""
        return self.box[1] - self.box[0]

    @cached_property
    def corners(self) -> Float[np.ndarray, "8 p 3"]:
        """The eight corners of each part's box [m]."""
        return np.ascontiguousarray(np.moveaxis(self.parts[..., _PICKS, _AXES], -2, 0))

    @cached_property
    def box_corners(self) -> Float[np.ndarray, "8 3"]:
        """The eight corners of the bounding box [m]."""
        return self.box[_PICKS, _AXES]

    @cached_property
    def shapes(self) -> dict[tuple[int, Vector, bool], Shape]:
        """Cache of shapes by quarter turns, scale and mirror; placement tries the same few at many places."""
        return {}


@dataclass(frozen=True)
class VariantFamily:
    """A parametric design and the parameters of its library models.

    Args:
        name: Family name; the models are `gen_<name>_<k>`.
        fine: Fine class.
        build: Returns the solids (and bulbs) for one set of parameters.
        slots: Slot name -> finish.
        variants: Parameter sets.
        closed: Parameters of the closed state of a variant, for doors.
        centred: Move the middle of the box to x = z = 0; openings stay on their wall's centre-line.
    """

    name: str
    fine: str
    build: Callable[..., Iterable[Solid | Bulb]]
    slots: Mapping[str, str]
    variants: tuple[Mapping[str, Any], ...]
    closed: Mapping[str, Any] | None = None
    centred: bool = True

    def models(self) -> Iterator[FurnitureModel]:
        """Generate the library models of the family."""
        for number, variant in enumerate(self.variants, 1):
            yield self._model(f"gen_{self.name}_{number}", number, variant)

    def _model(self, model_id: str, number: int, variant: Mapping[str, Any]) -> FurnitureModel:
        solids, lights = self._built(variant)
        used = {solid.material for solid in solids}
        slots = {name: finish for name, finish in self.slots.items() if name in used}
        materials = tuple(
            replace(FINISHES[finish][(number + i) % len(FINISHES[finish])], name=f"material_{i}")
            for i, finish in enumerate(slots.values())
        )
        folder = Path("object") / model_id
        mesh = to_mesh(folder / f"{model_id}.obj", solids, list(slots), materials)
        closed = None
        if self.closed is not None:
            shut = self._built({**variant, **self.closed})[0]
            closed = to_mesh(folder / f"{model_id}_0.obj", shut, list(slots), materials)
        parts = np.stack([solid.box for solid in solids])
        meshes = Meshes(mesh, closed)
        return FurnitureModel(model_id, self.name, self.fine, slots, parts, lambda: meshes, lights)

    def _built(self, variant: Mapping[str, Any]) -> tuple[list[Solid], tuple[Light, ...]]:
        built = list(self.build(**variant))
        solids = [piece for piece in built if isinstance(piece, Solid)]
        low, high = np.min([s.box[0] for s in solids], 0), np.max([s.box[1] for s in solids], 0)
        shift = -(low + high) / 2 * (1, 0, 1) * self.centred
        solids = [move(solid, shift) for solid in solids]
        return solids, tuple(_light(piece, shift) for piece in built if isinstance(piece, Bulb))


def make_variant(**parameters: Any) -> Mapping[str, Any]:
    """Return the keyword arguments as one set of parameters of a design."""
    return parameters


def _light(bulb: Bulb, shift: Float[np.ndarray, " 3"]) -> Light:
    x, y, z = np.round(np.asarray(bulb.position) + shift, 6).tolist()
    return Light("point", bulb.power, (1.0, 1.0, 1.0), (x, y, z))


def make_slots(*names: str, **finishes: str) -> Mapping[str, str]:
    """Return slot names with their finishes; a name's finish is the name without a trailing number.

    Example:
        >>> make_slots("wood", "wood_1", color_1="glass")
        {'wood': 'wood', 'wood_1': 'wood', 'color_1': 'glass'}
    """
    return {name: name.rstrip("_0123456789") for name in names} | finishes
