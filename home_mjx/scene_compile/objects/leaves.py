"""Door leaves in the world: their range of motion, and their table."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import BoxSet, concat_boxes, footprint, footprint_distance, penetration_depth
from home_mjx.geometry.rotations import yaw_quat
from home_mjx.scene_compile.objects.doors import PlacedLeaf
from home_mjx.scene_compile.objects.trays import tray_columns
from home_mjx.schema.compiled import Doors

LEAF_AREAL_DENSITY = 8.0  # [kg/m^2], mass per leaf area: a hollow-core interior door of 0.8 x 2 m weighs 10 to 15 kg
LEAF_MASS_RANGE = (5.0, 60.0)  # [kg], minimum and maximum mass of a leaf
MIN_FRONT_MASS = 0.5  # [kg], minimum mass of a front of furniture
CLEARANCE = 0.01  # [m], minimum distance of a leaf from obstacles
TURN_STEP = np.deg2rad(1.0)  # angle increment of the range search; the free edge moves by 1.4 cm
SLIDE_STEP = 0.01  # [m], distance increment of the range search
RANGE_TOLERANCE = 1e-6  # [rad] or [m], tolerance of the maximum range
MAX_OPEN_ANGLE = np.pi  # [rad], maximum opening angle
MIN_OPEN_ANGLE = np.deg2rad(60.0)  # minimum opening angle of a leaf that leaves the way free
MIN_SLIDE_OPENING = 0.5  # [m], the same for a sliding leaf
MIN_DRAWER_OPENING = 0.1  # [m], minimum opening of a drawer that does not count as blocked


def make_doors(
    leaves: Sequence[PlacedLeaf],
    static: BoxSet,
    walls: BoxSet | None = None,
    movable: BoxSet | None = None,
    bodies: Mapping[int, BoxSet] | None = None,
) -> Doors:
    """Build the table of a house's leaves: closed and open poses, ranges by `find_motion_range`, boxes and masses.

    The open pose is the wide-open one, clipped to the range.

    Args:
        leaves: Leaves that turn or slide.
        static: Obstacles of all leaves.
        walls: Additional obstacles of turning leaves; sliding leaves may enter walls. None: no walls.
        movable: Boxes of movable objects in their initial pose; see `find_motion_range`. None: no movable objects.
        bodies: Boxes of the furniture that fronts belong to, by the front's instance. They do not stop it: its joint's
            range is that of its own body. None: no fronts.
    """
    if not leaves:
        return Doors.empty()
    bodies = bodies or {}
    around = (_without(static, bodies[leaf.instance]) if leaf.instance in bodies else static for leaf in leaves)
    ranges = [find_motion_range(leaf, own, walls, movable) for leaf, own in zip(leaves, around, strict=True)]
    low, high = np.array(ranges).T
    box = concat_boxes(leaf.box for leaf in leaves)
    area = np.array([_board_area(concat_boxes([leaf.box, leaf.tray])) for leaf in leaves])
    is_front = np.array([leaf.is_front for leaf in leaves])
    lightest = np.where(is_front, MIN_FRONT_MASS, LEAF_MASS_RANGE[0])
    return Doors(
        instance=np.array([leaf.instance for leaf in leaves], np.int32),
        pivot=np.array([leaf.pivot for leaf in leaves]),
        closed=np.array([leaf.closed for leaf in leaves]),
        fully_open=np.clip([leaf.wide_open for leaf in leaves], low, high),
        low=low,
        high=high,
        pos=box.center,
        quat=yaw_quat(box.yaw),
        size=box.half,
        mass=np.clip(area * LEAF_AREAL_DENSITY, lightest, LEAF_MASS_RANGE[1]),
        slide=np.array([leaf.slide for leaf in leaves]),
        is_front=is_front,
        **tray_columns(leaves),
    )


def _board_area(boxes: BoxSet) -> float:
    """Return the total area of boards [m^2]: of each box the largest face."""
    return float((4 * np.sort(boxes.half, axis=1)[:, 1:].prod(axis=1)).sum())


def _without(boxes: BoxSet, others: BoxSet) -> BoxSet:
    """Return the boxes that are not among others, compared exactly."""
    known = {row.tobytes() for row in np.c_[others.center, others.half, others.yaw]}
    kept = [row.tobytes() not in known for row in np.c_[boxes.center, boxes.half, boxes.yaw]]
    return boxes[np.array(kept, bool)]


def find_motion_range(
    leaf: PlacedLeaf, static: BoxSet, walls: BoxSet | None = None, movable: BoxSet | None = None
) -> tuple[float, float]:
    """Return the range of motion of a leaf, from closed to the first obstacle, in steps of `TURN_STEP` or `SLIDE_STEP`.

    When closed, a leaf has the frame and the wall beside it within its clearance. Compared to the closed pose, it may
    penetrate such boxes further by its own thickness, since turning about a hinge at its edge requires it; a drawer may
    not. If the leaf is free in its initial pose, the range includes that pose, regardless of obstacles in between. A
    sliding leaf moves at most as far as in its model's open variant. Neither walls nor boxes that it touches when
    closed, such as its frame, stop it, unless it is a drawer. Movable objects are pushed away until the leaf is wide
    open. Beyond that, the range ends at the first one, since it would stop the leaf. The range also must not depend on
    the selection of bodies. Fronts of furniture never open farther than their joints do, and by one step even if
    blocked: no joint of MuJoCo has no range.

    Args:
        leaf: The leaf; its initial pose is coordinate 0.
        static: Obstacles.
        walls: See `make_doors`.
        movable: See `make_doors`.

    Returns:
        Minimum and maximum angle [rad] or distance [m]; one of them is the closed pose.
    """
    is_rail = leaf.slides and not leaf.is_front
    around = static if is_rail or walls is None else concat_boxes([static, walls])
    near = around[_within_reach(leaf, around)]
    closed = penetration_depth(leaf.box_at(leaf.closed), near)[0]
    further = np.inf if is_rail else RANGE_TOLERANCE if leaf.slides else 2 * float(leaf.box.half[0, :2].min())
    allowed = np.where(closed > -CLEARANCE, np.maximum(closed, 0) + further, -CLEARANCE)

    def is_free(ways: Float[np.ndarray, " w"]) -> Bool[np.ndarray, " w"]:
        """Return for each coordinate whether the leaf stays within the allowed penetration of all boxes there."""
        return np.asarray((penetration_depth(leaf.boxes_at(ways), near) <= allowed).all(axis=1))

    opens, most = (
        np.sign(leaf.wide_open - leaf.closed),
        abs(leaf.wide_open - leaf.closed) if leaf.slides or leaf.is_front else MAX_OPEN_ANGLE,
    )
    step = SLIDE_STEP if leaf.slides else TURN_STEP
    start = 0.0 if is_free(np.zeros(1))[0] else leaf.closed
    ways = np.cumsum([start, *[float(opens) * step] * (int(2 * most / step) + 1)])
    ways = ways[: 1 + int((abs(ways[:-1] - leaf.closed) + step <= most + RANGE_TOLERANCE).argmin())]
    least = int(leaf.is_front and len(ways) > 1)
    end = float(ways[max(least, int(np.append(is_free(ways[1:]), False).argmin()))])
    if movable is not None and not leaf.slides:
        end = _clip_to_movables(leaf, end, movable)
    return min(leaf.closed, end), max(leaf.closed, end)


def _clip_to_movables(leaf: PlacedLeaf, end: float, movable: BoxSet) -> float:
    """Return `end` of the range, or the last end before a movable object is met beyond the wide-open pose."""
    beyond, opens = (
        abs(end - leaf.closed) - abs(leaf.wide_open - leaf.closed),
        float(np.sign(leaf.wide_open - leaf.closed)),
    )
    if beyond <= 0:
        return end
    near = movable[_within_reach(leaf, movable)]
    ways = np.array([0.0, *np.arange(TURN_STEP, beyond, TURN_STEP), beyond])
    met = (penetration_depth(leaf.boxes_at(leaf.wide_open + opens * ways[1:]), near) > -CLEARANCE).any(axis=1)
    return float(leaf.wide_open + opens * ways[met.argmax()]) if met.any() else end


def _within_reach(leaf: PlacedLeaf, static: BoxSet) -> Bool[np.ndarray, " n"]:
    """Return a mask of boxes at a leaf's heights, within `CLEARANCE` of the circle around its pivot that it reaches."""
    ends = [leaf.box_at(leaf.closed), leaf.box_at(leaf.wide_open)] if leaf.slides else [leaf.box]
    corners = np.concatenate([footprint(box, 0) for box in ends])
    reach = np.linalg.norm(corners - leaf.pivot, axis=1).max() + CLEARANCE
    away = footprint_distance(static, leaf.pivot[None])
    return (away <= reach) & (static.bottom < leaf.box.top[0]) & (static.top > leaf.box.bottom[0])


def find_blocking_leaves(leaves: Sequence[PlacedLeaf], static: BoxSet, walls: BoxSet | None = None) -> BoxSet:
    """Return the boxes, at their maximum opening, of leaves whose range is too small to leave the way free.

    Fronts of furniture are on no way, and are left out. Limits are `MIN_OPEN_ANGLE` and, for sliding leaves,
    `MIN_SLIDE_OPENING`. Arguments are those of `make_doors`.
    """
    found = []
    for leaf in (leaf for leaf in leaves if not leaf.is_front):
        low, high = find_motion_range(leaf, static, walls)
        if high - low < (MIN_SLIDE_OPENING if leaf.slides else MIN_OPEN_ANGLE):
            found.append(leaf.box_at(high if leaf.wide_open > leaf.closed else low))
    return concat_boxes(found)
