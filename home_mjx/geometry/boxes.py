"""Sets of upright boxes, the shapes of colliders and movable bodies."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.rotations import yaw_matrix, yaw_quat
from home_mjx.schema.compiled import Colliders

MIN_HALF_EXTENT = 1e-4  # [m], minimum half extent of a collider; MuJoCo rejects boxes without thickness


def box_inertia(mass: Float[np.ndarray, "*b"], size: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 3"]:
    """Return moments of inertia of uniform solid boxes about their x, y and z axes through the centre [kg m^2].

    About x it is m/3 (b^2 + c^2); `mass` is in kg, and `size` has the half extents a, b, c [m].
    """
    square = size**2
    return mass[..., None] / 3 * (square.sum(axis=-1, keepdims=True) - square)


@dataclass(frozen=True)
class BoxSet:
    """Boxes rotated about the vertical axis only; sets may share arrays, so do not modify these in place."""

    center: Float[np.ndarray, "n 3"]  # [m]
    half: Float[np.ndarray, "n 3"]  # [m], half extents
    yaw: Float[np.ndarray, " n"]  # [rad] about +z

    @property
    def bottom(self) -> Float[np.ndarray, " n"]:
        """Minimum height of each box [m]."""
        return self.center[:, 2] - self.half[:, 2]

    @property
    def top(self) -> Float[np.ndarray, " n"]:
        """Maximum height of each box [m]."""
        return self.center[:, 2] + self.half[:, 2]

    def __len__(self) -> int:
        """Return the number of boxes."""
        return len(self.yaw)

    def __getitem__(self, rows: np.ndarray | slice | list[int]) -> "BoxSet":
        """Return the set of the boxes of a mask, a slice or row numbers, in that order; not of one number."""
        return BoxSet(self.center[rows], self.half[rows], self.yaw[rows])

    def colliders(self, object_id: Int[np.ndarray, " n"]) -> Colliders:
        """Convert the boxes to colliders with the object id of each; half extents become at least `MIN_HALF_EXTENT`."""
        size = np.maximum(self.half, MIN_HALF_EXTENT)
        return Colliders(pos=self.center, quat=yaw_quat(self.yaw), size=size, object_id=object_id)


def make_boxes(center: object, half: object, yaw: object = 0.0) -> BoxSet:
    """Create boxes from one centre, of shape (3,), or several, (n, 3) [m]; values are not checked.

    Half extents [m], a scalar, (3,) or (n, 3), and yaws [rad] about +z, a scalar or (n,), are broadcast to them.
    """
    center = np.atleast_2d(np.asarray(center, float))
    half = np.broadcast_to(np.asarray(half, float), center.shape)
    return BoxSet(center, half.copy(), np.broadcast_to(np.asarray(yaw, float), len(center)).copy())


def empty_boxes() -> BoxSet:
    """Return a set of no boxes."""
    return BoxSet(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))


def concat_boxes(sets: Iterable[BoxSet]) -> BoxSet:
    """Concatenate sets of boxes, in order; an empty set if there are none."""
    sets = [empty_boxes(), *sets]
    return BoxSet(*(np.concatenate([getattr(s, name) for s in sets]) for name in ("center", "half", "yaw")))


def unique_boxes(boxes: BoxSet) -> BoxSet:
    """Return the boxes without later exact duplicates (centre, half extents and yaw), in their order.

    Yaws that differ by whole turns are not equal. Without duplicates, the result is `boxes` itself.
    """
    first: dict[tuple[float, ...], int] = {}
    for row, values in enumerate(np.c_[boxes.center, boxes.half, boxes.yaw].tolist()):
        first.setdefault(tuple(values), row)
    return boxes[list(first.values())] if len(first) < len(boxes) else boxes


def bounding_box(points: Float[np.ndarray, "n 3"], yaw: float = 0.0) -> BoxSet:
    """Return a set of one box, the smallest around at least one point [m] with this yaw about +z [rad].

    Half extents may be 0.
    """
    turn = yaw_matrix(yaw)
    local = points @ turn
    columns = np.ascontiguousarray(local.T)
    low, high = columns.min(axis=1), columns.max(axis=1)
    return make_boxes(turn @ ((low + high) / 2), (high - low) / 2, yaw)


def thicken_boxes(boxes: BoxSet, half: float) -> BoxSet:
    """Return boxes with half extents of at least `half` [m] along x, y and z, around the same centres."""
    return BoxSet(boxes.center, np.maximum(boxes.half, half), boxes.yaw)


def rotate_boxes(boxes: BoxSet, angle: float, pivot: Float[np.ndarray, "2"]) -> BoxSet:
    """Return boxes rotated by `angle` [rad], counter-clockwise from above, about the vertical line through `pivot`.

    `pivot` is (x, y) [m]. Yaws increase by `angle` and are not wrapped.
    """
    arm = boxes.center - [*pivot, 0.0]
    return BoxSet(arm @ yaw_matrix(angle).T + [*pivot, 0.0], boxes.half, boxes.yaw + angle)


def penetration_depth(boxes: BoxSet, others: BoxSet) -> Float[np.ndarray, "m n"]:
    """Return the depth in plan of each box (rows) in each of the others [m], whatever their heights; negative if apart.

    By separating axes (Gottschalk et al., 1996): exact for the depth, and minus a lower bound of the distance if apart.
    It is 0 if boxes touch. Boxes above each other overlap in plan; callers compare heights themselves.
    """
    yaws = boxes.yaw[:, None], others.yaw
    halves = boxes.half.T[:2, :, None], others.half.T[:2]
    turn = yaws[1] - yaws[0]
    mixed = abs(np.cos(turn)), abs(np.sin(turn))  # |axis i of one . axis j of the other|: equal or unequal i and j
    dx, dy = (others.center[:, i] - boxes.center[:, i, None] for i in (0, 1))
    depth = np.full(turn.shape, np.inf)
    for yaw, own, other in zip(yaws, halves, halves[::-1], strict=True):
        c, s = np.cos(yaw), np.sin(yaw)
        for i, away in enumerate((c * dx + s * dy, c * dy - s * dx)):
            reach = own[i] + (other[0] * mixed[i] + other[1] * mixed[1 - i])
            depth = np.minimum(depth, reach - abs(away))
    return depth


def footprint_distance(boxes: BoxSet, points: Float[np.ndarray, "#n *p 2"]) -> Float[np.ndarray, "n *p"]:
    """Return the distances in plan [m] from points (x, y) to each box, whatever its height; 0 inside.

    The first axis of `points` has the points of each box, or length 1 for all boxes.
    """
    shape = (-1, *(1,) * (points.ndim - 2))
    (x, y), (a, b) = (values[:, :2].T.reshape(2, *shape) for values in (boxes.center, boxes.half))
    c, s = np.cos(boxes.yaw).reshape(shape), np.sin(boxes.yaw).reshape(shape)
    dx, dy = points[..., 0] - x, points[..., 1] - y
    return np.hypot(np.maximum(abs(c * dx + s * dy) - a, 0), np.maximum(abs(c * dy - s * dx) - b, 0))


def footprint(boxes: BoxSet, index: int) -> Float[np.ndarray, "4 2"]:
    """Return world x and y of the corners of box `index` [m], counter-clockwise from above.

    The first is the minimum corner in the box's own frame. The box may have no extent.
    """
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * boxes.half[index, :2]
    return corners @ yaw_matrix(boxes.yaw[index])[:2, :2].T + boxes.center[index, :2]
