"""Placed instances of models: the generator's own record of an object."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.suncg.formats.variants import variant_key
from home_mjx.schema.house import Material, Mesh, ObjectNode
from home_procgen.model_store import model_at_detail
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel, Shape
from home_procgen.primitives.solids import Vector

Box = Float[np.ndarray, "2 3"]
Boxes = Float[np.ndarray, "_ 2 3"]

MAX_CACHED_SHAPES = 64  # maximum number of cached shapes per model
FRONT_DIRECTIONS = ((0, 1), (1, 0), (0, -1), (-1, 0))  # (x, z) direction of the front after 0..3 quarter turns


@dataclass(frozen=True)
class PlacedModel:
    """An instance of a library model."""

    model: FurnitureModel
    position: Vector  # [m], of the model's origin
    quarter: int = 0  # quarter turns about the vertical axis; `FRONT_DIRECTIONS` lists the directions of the front
    scale: Vector = (1.0, 1.0, 1.0)  # along the model's own axes
    mirrored: bool = False  # left and right swapped
    closed: bool = False  # the closed variant of a door
    materials: tuple[Material, ...] = ()  # one per slot

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Linear part of the transform: rotation times scale and mirror."""
        return self._shape[0]

    @cached_property
    def size(self) -> Float[np.ndarray, " 3"]:
        """Extents along the model's own axes [m]."""
        return self.model.size * np.asarray(self.scale)

    def moved_to(self, x: float, y: float, z: float, quarter: int = 0) -> "PlacedModel":
        """Return the same object at a position [m], with `quarter` quarter turns instead of its own."""
        # `dataclasses.replace` takes ten times as long, and rooms try many places.
        moved = object.__new__(type(self))
        own = moved.__dict__
        own.update(self.__dict__)
        for name in ("parts", "box") if quarter % 4 == self.quarter else ("parts", "box", "linear", "_shape"):
            own.pop(name, None)
        own["position"], own["quarter"] = (round(x, 4), round(y, 4), round(z, 4)), quarter % 4
        return moved

    def local_point(self, right: float, front: float) -> tuple[float, float]:
        """Return the point (x, z), `right` and `front` metres from the origin in the object's unmirrored directions."""
        x, z = FRONT_DIRECTIONS[self.quarter]
        return self.position[0] + z * right + x * front, self.position[2] - x * right + z * front

    @cached_property
    def parts(self) -> Boxes:
        """Boxes of the model's solids in the scene [m]; exact, since turns are by quarters."""
        return self._shape[1] + self.position

    @cached_property
    def box(self) -> Box:
        """Lower and upper corner of the bounding box in the scene [m]."""
        return self._shape[2] + self.position

    @cached_property
    def _shape(self) -> Shape:
        """Linear transform, boxes of the parts, and bounding box, all with the object at the origin."""
        turn = self.quarter, self.scale, self.mirrored
        if turn not in self.model.shapes:
            if len(self.model.shapes) >= MAX_CACHED_SHAPES:
                self.model.shapes.clear()
            self.model.shapes[turn] = _transform_shape(self.model, *turn)
        return self.model.shapes[turn]


@dataclass(frozen=True)
class RotatedObject(PlacedModel):
    """An instance turned by an arbitrary angle; boxes are axis-aligned ones around it. Subclasses define `linear`."""

    @cached_property
    def parts(self) -> Boxes:
        """Boxes around the model's solids in the scene [m]."""
        return self._around(self.model.corners)

    @cached_property
    def box(self) -> Box:
        """Box around the model's box in the scene [m]."""
        return self._around(self.model.box_corners)

    def _around(self, corners: Float[np.ndarray, "8 *n 3"]) -> Float[np.ndarray, "*n 2 3"]:
        moved = corners @ self.linear.T + self.position
        found = np.empty((*corners.shape[1:-1], 2, 3))
        moved.min(axis=0, out=found[..., 0, :])
        moved.max(axis=0, out=found[..., 1, :])
        return found


@dataclass(frozen=True)
class YawedObject(RotatedObject):
    """An object turned by an arbitrary angle, in addition to its quarter turns.

    Attributes:
        angle: Angle about the vertical axis, from z towards x [rad].
    """

    angle: float = 0.0

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Linear part of the transform: rotation times scale and mirror."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]) @ self._shape[0]


def _transform_shape(model: FurnitureModel, quarter: int, scale: Vector, mirrored: bool) -> Shape:
    x, z = FRONT_DIRECTIONS[quarter]
    turn = np.array([[z, 0, x], [0, 1, 0], [-x, 0, z]], float)
    linear = turn * np.asarray(scale) * (-1 if mirrored else 1, 1, 1)
    return linear, np.sort(model.parts @ linear.T, axis=-2), np.sort(model.box @ linear.T, axis=-2)


def quarter_towards(x: float, z: float) -> int:
    """Return the quarter turns that point a model's front along a unit direction (x, z) of an axis.

    Example:
        >>> quarter_towards(1.0, 0.0)
        1
    """
    return FRONT_DIRECTIONS.index((round(float(x)), round(float(z))))  # NumPy's own rounding is slow


def overlap_mask(
    box: Float[np.ndarray, "*b 2 3"], others: Float[np.ndarray, "*n 2 3"], tolerance: float = 0.012
) -> Bool[np.ndarray, "*k"]:
    """Return a mask of the boxes that intersect a box by more than `tolerance` [m] on every axis.

    The default tolerance exceeds the thickness of a rug.
    """
    depth = np.minimum(box[..., 1, :], others[..., 1, :]) - np.maximum(box[..., 0, :], others[..., 0, :])
    return depth.min(-1) > tolerance


def stack_boxes(boxes: Sequence[Box]) -> Boxes:
    """Stack boxes into one array; an empty sequence becomes shape (0, 2, 3)."""
    return np.array(boxes, float).reshape(-1, 2, 3)


def furniture_object(placed: PlacedModel, index: int) -> ObjectNode:
    """Return the node of an object on the lowest level, as the node number `index`."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = placed.linear, placed.position
    return ObjectNode(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=placed.model.id,
        model_key=variant_key(placed.model.id, int(placed.closed)),
        transform=transform,
        materials=placed.materials,
    )


def used_models(objects: Sequence[PlacedModel], detail: str = DETAILS[0]) -> Mapping[str, Mesh]:
    """Return the meshes by model key: the base mesh of each model, and the closed variants in use.

    Args:
        objects: The objects.
        detail: Level of detail of the meshes.
    """
    models = {placed.model.id: model_at_detail(placed.model, detail) for placed in objects}
    meshes = {key: model.mesh for key, model in models.items()}
    shut = {placed.model.id for placed in objects if placed.closed}
    closed = {variant_key(key, 1): mesh for key in shut if (mesh := models[key].closed) is not None}
    return meshes | closed


def yaw_to(item: PlacedModel, x: float, y: float, z: float, angle: float) -> YawedObject:
    """Return an object at a place [m] whose front points to (sin angle, cos angle) in (x, z)."""
    at = (round(x, 4), round(y, 4), round(z, 4))
    made = object.__new__(YawedObject)  # the constructor takes several times as long: see `PlacedModel.moved_to`
    own = made.__dict__
    own.update((name, getattr(item, name)) for name in ("model", "scale", "mirrored", "closed", "materials"))
    own["position"], own["quarter"], own["angle"] = at, 0, round(angle, 4)
    return made


def yaw_by(item: PlacedModel, angle: float) -> PlacedModel:
    """Return the same object, turned at its place by a further angle from z towards x [rad]."""
    if isinstance(item, YawedObject):
        return replace(item, angle=round(item.angle + angle, 4))
    return yaw_to(item, *item.position, item.quarter * np.pi / 2 + angle)
