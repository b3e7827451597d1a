"""A model that stands somewhere: the generator's own record of an object."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.procedural.primitives.family import Furniture
from home_mjx.datasets.procedural.primitives.solids import Vector
from home_mjx.schema.house import Material

Box = Float[np.ndarray, "2 3"]
Boxes = Float[np.ndarray, "_ 2 3"]

FACING = ((0, 1), (1, 0), (0, -1), (-1, 0))  # (x, z) that the front points to after 0..3 quarter turns


@dataclass(frozen=True)
class PlacedFurniture:
    """An instance of a library model."""

    model: Furniture
    position: Vector  # [m], of the model's origin
    quarter: int = 0  # quarter turns about the vertical axis; `FACING` tells where the front then is
    scale: Vector = (1.0, 1.0, 1.0)  # along the model's own axes
    mirrored: bool = False  # left and right swapped
    closed: bool = False  # shows the closed variant of a door
    materials: tuple[Material, ...] = ()  # one per slot

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Rotation times scale and mirror."""
        x, z = FACING[self.quarter]
        turn = np.array([[z, 0, x], [0, 1, 0], [-x, 0, z]], float)
        return turn * np.asarray(self.scale) * (-1 if self.mirrored else 1, 1, 1)

    @cached_property
    def size(self) -> Float[np.ndarray, " 3"]:
        """Extents along the model's own axes [m]."""
        return self.model.size * np.asarray(self.scale)

    def at(self, x: float, y: float, z: float, quarter: int = 0) -> "PlacedFurniture":
        """The same object somewhere else [m]."""
        return replace(self, position=(round(x, 4), round(y, 4), round(z, 4)), quarter=quarter % 4)

    def beside(self, right: float, front: float) -> tuple[float, float]:
        """(x, z) of the point `right` and `front` metres from the origin, as the object faces."""
        x, z = FACING[self.quarter]
        return self.position[0] + z * right + x * front, self.position[2] - x * right + z * front

    @cached_property
    def parts(self) -> Boxes:
        """Boxes of the model's solids in the scene [m]; exact, since turns are by quarters."""
        return self._moved(self.model.parts)

    @cached_property
    def box(self) -> Box:
        """Bounding box in the scene [m]."""
        return self._moved(self.model.box)

    def _moved(self, boxes: Float[np.ndarray, "*n 2 3"]) -> Float[np.ndarray, "*n 2 3"]:
        return np.sort(boxes @ self.linear.T + self.position, axis=-2)


def quarter_towards(x: float, z: float) -> int:
    """Quarter turns that point a model's front along the axis direction (x, z).

    Example:
        >>> quarter_towards(1.0, 0.0)
        1
    """
    return FACING.index((round(x), round(z)))


def overlaps(
    box: Float[np.ndarray, "*b 2 3"], others: Float[np.ndarray, "*n 2 3"], tolerance: float = 0.012
) -> Bool[np.ndarray, "*k"]:
    """Which boxes a box enters by more than `tolerance` [m] along every axis; a rug is thinner than that."""
    depth = np.minimum(box[..., 1, :], others[..., 1, :]) - np.maximum(box[..., 0, :], others[..., 0, :])
    return depth.min(-1) > tolerance


def stack(boxes: Sequence[Box]) -> Boxes:
    """Boxes as one array, also when there is none."""
    return np.array(boxes, float).reshape(-1, 2, 3)
