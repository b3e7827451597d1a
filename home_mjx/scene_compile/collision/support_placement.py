"""Placement of movable objects on their supports, with boxes shrunk to clear all obstacles."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.boxes import BoxSet, concat_boxes, footprint, make_boxes, penetration_depth
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.collision.movables import MIN_BODY_HALF, MovableCandidate, MovableOptions
from home_mjx.scene_compile.objects.placed_objects import PlacedObject

MIN_LOAD_RISE = 0.03  # [m], an object with a lower underside above that of another object is beside it, not on it
MAX_LEVEL_DIFFERENCE = 0.002  # [m], maximum height difference of upper sides that support an object together
SUPPORT_REGION = 0.3  # fraction of a box's half extents; the support must cover this central region
ROUNDING = 1e-9  # [m], more than the rounding errors of distances
MIN_VERTICAL_OVERLAP = 2e-4  # [m], boxes with a smaller vertical overlap only touch


def find_loads(objects: Sequence[PlacedObject], reach: float) -> dict[int, list[int]]:
    """Return the ids of the objects on or in each object, by its id, from bounding boxes; no entry without such loads.

    The centre of a load is over the object in the plan. Its underside is more than `MIN_LOAD_RISE` above that of the
    object, and less than `reach` [m] above its top. So a load may have several carriers, such as a box and its table.
    """
    boxes = np.array([o.limits for o in objects]).reshape(-1, 2, 3)
    loads: dict[int, list[int]] = {}
    for item, (low, high) in zip(objects, boxes, strict=True):
        middle = (low + high)[:2] / 2
        over = ((boxes[:, 0, :2] < middle) & (boxes[:, 1, :2] > middle)).all(axis=1)
        on = over & (low[2] > boxes[:, 0, 2] + MIN_LOAD_RISE) & (low[2] < boxes[:, 1, 2] + reach)
        for row in np.flatnonzero(on).tolist():
            loads.setdefault(objects[row].object_id, []).append(item.object_id)
    return loads


def sort_carriers_first(
    candidates: Sequence[MovableCandidate], loads: Mapping[int, Sequence[int]]
) -> list[MovableCandidate]:
    """Sort the candidates, stably, by the longest chain of objects below each, so that each follows its carriers.

    Args:
        candidates: Objects to sort.
        loads: Ids of the objects on or in each object, by object id, see `find_loads`. Two inside each other are in
            either order.
    """
    carriers = {load: {i for i, on in loads.items() if load in on} for load in {j for on in loads.values() for j in on}}
    depth: dict[int, int] = {}

    def depth_of(object_id: int) -> int:
        """Return the length of the longest chain of objects below an object; 0 if nothing carries it."""
        if object_id not in depth:
            depth[object_id] = 0  # ends the recursion for two objects inside each other
            depth[object_id] = 1 + max((depth_of(i) for i in carriers.get(object_id, ())), default=-1)
        return depth[object_id]

    return sorted(candidates, key=lambda c: depth_of(c.item.object_id))


def place_on_supports(
    candidates: Sequence[MovableCandidate],
    loads: Mapping[int, Sequence[int]],
    static: Mapping[int, BoxSet],
    fixed: BoxSet,
    options: MovableOptions,
) -> list[MovableCandidate]:
    """Return the candidates that rest without touching anything else, with adjusted boxes; the others stay fixed.

    The order is that of `sort_carriers_first`.

    Args:
        candidates: Objects that may become bodies, by precedence: later boxes shrink to clear earlier ones.
        loads: Ids of the objects on or in each object.
        static: Boxes of each object while it is fixed, by object id.
        fixed: Boxes that never move.
        options: Limits.
    """
    height = {c.item.object_id: float(c.item.box.bottom[0]) for c in candidates}
    moving = sort_carriers_first(
        [c for c in candidates if _has_loads_on_top(c, loads, height, options.max_support_gap)], loads
    )
    while True:
        ids = {c.item.object_id for c in moving}
        around = concat_boxes([fixed, *(boxes for i, boxes in static.items() if i not in ids)])
        standing, failed = _stand(moving, loads, around, options)
        if not failed:
            return standing
        # Those that failed are obstacles now, so the others are tested again.
        moving = [c for c in moving if c.item.object_id not in failed]


def _has_loads_on_top(
    carrier: MovableCandidate, loads: Mapping[int, Sequence[int]], height: Mapping[int, float], reach: float
) -> bool:
    """Return whether all loads of an object are candidates, the keys of `height`, and within `reach` of its top [m].

    `height` has their undersides [m]. True for an object without loads.
    """
    top = float(carrier.item.box.top[0])
    return all(abs(height.get(i, np.inf) - top) <= reach for i in loads.get(carrier.item.object_id, ()))


def _stand(
    moving: Sequence[MovableCandidate], loads: Mapping[int, Sequence[int]], around: BoxSet, options: MovableOptions
) -> tuple[list[MovableCandidate], set[int]]:
    """Return the candidates that rest, and ids of those that fail; loads of failed ones are in neither.

    One fails without support, if its box cannot shrink enough, or if one of its loads is not `moving`.
    """
    ids = {c.item.object_id for c in moving}
    standing: list[MovableCandidate] = []
    failed: set[int] = set()
    for c in moving:
        if any(c.item.object_id in loads.get(i, ()) for i in failed):
            continue
        obstacles = concat_boxes([around, *(s.box for s in standing)])
        base = c.floor if c.floor is not None else find_support(c.item.box, obstacles, options.max_support_gap)
        box = None if base is None else _shrink(_put(c.item.box, base, c.floor is not None), obstacles, options)
        if box is None or not ids.issuperset(loads.get(c.item.object_id, ())):
            failed.add(c.item.object_id)
        else:
            standing.append(MovableCandidate(c.item, box, c.mass, c.floor))
    return standing, failed


def _put(box: BoxSet, base: float, stretch: bool) -> BoxSet:
    """Return the box with its underside at `base` [m]: moved, or with `stretch` extended so that its top stays."""
    top = float(box.top[0]) if stretch else base + 2 * float(box.half[0, 2])
    return make_boxes([*box.center[0, :2], (base + top) / 2], [*box.half[0, :2], (top - base) / 2], box.yaw)


def find_support(box: BoxSet, obstacles: BoxSet, reach: float) -> float | None:
    """Return the height of the highest upper side, within `reach` [m] of a box's bottom, at its central region.

    Return None if there is none, or if upper sides at this height do not cover the region's centre and corners.
    """
    points = box.center[0, :2] + (
        SUPPORT_REGION * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, 0]]) * box.half[0, :2]
    ) @ (yaw_matrix(box.yaw[0])[:2, :2].T)
    near = obstacles[abs(obstacles.top - box.bottom[0]) <= reach]
    below = _over(near, points)
    if not below.any():
        return None
    height = float(near.top[below.any(axis=1)].max())
    return height if below[near.top > height - MAX_LEVEL_DIFFERENCE].any(axis=0).all() else None


def _over(boxes: BoxSet, points: Float[np.ndarray, "p 2"]) -> Bool[np.ndarray, "n p"]:
    """Return whether each point is in or on the edge of the footprint of each box."""
    away = points - boxes.center[:, None, :2]
    c, s = np.cos(boxes.yaw)[:, None], np.sin(boxes.yaw)[:, None]
    along, across = c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0]
    return (abs(along) <= boxes.half[:, :1]) & (abs(across) <= boxes.half[:, 1:2])


def _shrink(box: BoxSet, obstacles: BoxSet, options: MovableOptions, gap: float = 1e-3) -> BoxSet | None:
    """Return the part of the box that is `gap` [m] away from every obstacle; None if the limits do not allow it.

    Its top is lowered, to at least `min_lowered_height`, else a side is moved inwards; its underside stays. A side
    moves by at most `max_shrink`, and at least half of each edge in the plan remains.
    """
    low, high = -box.half[0].copy(), box.half[0].copy()
    near = _near(box, obstacles)
    # A part of the box is at least as far away as the whole.
    for i in near[penetration_depth(box, obstacles[near])[0] > -gap - ROUNDING].tolist():
        now = _cut(box, low, high)
        if penetration_depth(now, obstacles[i : i + 1])[0, 0] <= -gap or obstacles.bottom[i] >= now.top[0]:
            continue
        below = obstacles.bottom[i] - gap - box.center[0, 2]
        if below - low[2] >= options.min_lowered_height:
            high[2] = below
        else:
            _shrink_side(box, obstacles, i, low, high, gap)
    drawn = np.maximum(box.half[0] - high, low + box.half[0])[:2]
    if (high - low < 2 * MIN_BODY_HALF).any():  # also of an object that is sunk into the floor
        return None
    if (drawn > options.max_shrink).any() or (high - low < 0.5 * 2 * box.half[0])[:2].any():
        return None
    return _cut(box, low, high)


def _shrink_side(
    box: BoxSet, obstacles: BoxSet, index: int, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"], gap: float
) -> None:
    """Clear obstacle `index` by moving an upright side of the box the shortest way; change `low` or `high` in place."""
    corners = (footprint(obstacles, index) - box.center[0, :2]) @ yaw_matrix(box.yaw[0])[:2, :2]
    ways = np.array([high[:2] - corners.min(axis=0), corners.max(axis=0) - low[:2]])
    side, axis = divmod(int(ways.argmin()), 2)
    if side == 0:
        high[axis] -= ways[0, axis] + gap
    else:
        low[axis] += ways[1, axis] + gap


def _cut(box: BoxSet, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> BoxSet:
    """Return the part of a box between two corners in its own frame, which has its centre as origin [m]."""
    center = box.center[0] + yaw_matrix(box.yaw[0]) @ ((low + high) / 2)
    return make_boxes(center, (high - low) / 2, box.yaw[0])


def _near(box: BoxSet, obstacles: BoxSet) -> Int[np.ndarray, " r"]:
    """Return the rows of the obstacles whose bounding circles and heights overlap those of a box."""
    apart = np.linalg.norm(obstacles.center[:, :2] - box.center[0, :2], axis=1)
    reach = np.linalg.norm(obstacles.half[:, :2], axis=1) + np.linalg.norm(box.half[0, :2])
    level = (obstacles.bottom < box.top[0] - MIN_VERTICAL_OVERLAP) & (
        obstacles.top > box.bottom[0] + MIN_VERTICAL_OVERLAP
    )
    return np.flatnonzero((apart < reach) & level)
