"""Leaves of doors in the world: how far they can turn or slide, and the table of them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from home_mjx.geometry.boxes import BoxSet, footprint, footprint_distance, join, overlap
from home_mjx.geometry.rotations import yaw_quat
from home_mjx.scene_compile.objects.doors import Leaf
from home_mjx.schema.compiled import Doors

AREAL_DENSITY = 8.0  # [kg/m^2] of leaf: a hollow-core interior door of 0.8 x 2 m weighs 10 to 15 kg
LEAF_MASS = (5.0, 60.0)  # [kg]
CLEARANCE = 0.01  # [m], that a leaf keeps from what it could run into
STEP = np.deg2rad(1.0)  # in which a leaf is turned to find how far it can: its free edge moves by 1.4 cm
SLIDE_STEP = 0.01  # [m]
EXACT = 1e-6  # [rad] or [m], by which what is reached may be exceeded
MOST_OPEN = np.pi  # [rad], from closed
AJAR = np.deg2rad(60.0)  # from closed: a leaf that opens farther leaves the way free
SLIDE_AJAR = 0.5  # [m], of a leaf that slides


def make_doors(
    leaves: Sequence[Leaf], static: BoxSet, walls: BoxSet | None = None, movable: BoxSet | None = None
) -> Doors:
    """The table of a house's leaves.

    Args:
        leaves: Those that turn or slide.
        static: What they cannot run into.
        walls: What else stops those that turn; others slide into it. None by default.
        movable: What could move, as it stands; see `swing`. None by default.
    """
    if not leaves:
        return Doors.none()
    low, high = np.array([swing(leaf, static, walls, movable) for leaf in leaves]).T
    box = join(leaf.box for leaf in leaves)
    area = 4 * np.sort(box.half, axis=1)[:, 1:].prod(axis=1)
    return Doors(
        instance=np.array([leaf.instance for leaf in leaves], np.int32),
        pivot=np.array([leaf.pivot for leaf in leaves]),
        closed=np.array([leaf.closed for leaf in leaves]),
        wide=np.clip([leaf.wide for leaf in leaves], low, high),
        low=low,
        high=high,
        pos=box.center,
        quat=yaw_quat(box.yaw),
        size=box.half,
        mass=np.clip(area * AREAL_DENSITY, *LEAF_MASS),
        slide=np.array([leaf.slide for leaf in leaves]),
    )


def swing(
    leaf: Leaf, static: BoxSet, walls: BoxSet | None = None, movable: BoxSet | None = None
) -> tuple[float, float]:
    """The coordinates between which a leaf can move: from closed to where its box comes too near to another one.

    A leaf has the frame and the wall beside it within its clearance when it is closed. Into such boxes it may reach
    by its own thickness further than when closed, as much as turning about a hinge at its edge takes.
    If the leaf stands free as placed, the range reaches at least there, whatever is between.
    A sliding leaf goes as far as in its model's open variant at most. Walls do not stop it, nor does what it touches
    when it is closed, such as its frame.
    What could move is pushed out of the way until the leaf is wide open. Whatever stands there, beyond that the leaf
    turns no farther than up to it: it would be stopped by it, and how far it turns shall not depend on what is a body.

    Args:
        leaf: As it stands, at coordinate 0.
        static: What it cannot run into.
        walls: See `make_doors`.
        movable: See `make_doors`.

    Returns:
        Least and greatest angle [rad] or way [m]; one of them is the closed one.
    """
    around = static if leaf.slides or walls is None else join([static, walls])
    near = around[_within_reach(leaf, around)]
    closed = overlap(leaf.box_at(leaf.closed), near)
    further = np.inf if leaf.slides else 2 * float(leaf.box.half[0, :2].min())
    allowed = np.where(closed > -CLEARANCE, np.maximum(closed, 0) + further, -CLEARANCE)

    def is_free(way: float) -> bool:
        return bool((overlap(leaf.box_at(way), near) <= allowed).all())

    opens, most = np.sign(leaf.wide - leaf.closed), abs(leaf.wide - leaf.closed) if leaf.slides else MOST_OPEN
    step = SLIDE_STEP if leaf.slides else STEP
    end = 0.0 if is_free(0.0) else leaf.closed
    while abs(end - leaf.closed) + step <= most + EXACT and is_free(end + float(opens) * step):
        end += float(opens) * step
    if movable is not None and not leaf.slides:
        end = _up_to(leaf, end, movable)
    return min(leaf.closed, end), max(leaf.closed, end)


def _up_to(leaf: Leaf, end: float, movable: BoxSet) -> float:
    """How far a leaf that could turn to an angle does: from wide open until it comes near to what could move."""
    beyond, opens = abs(end - leaf.closed) - abs(leaf.wide - leaf.closed), float(np.sign(leaf.wide - leaf.closed))
    if beyond <= 0:
        return end
    near, way = movable[_within_reach(leaf, movable)], 0.0
    for farther in [*np.arange(STEP, beyond, STEP).tolist(), beyond]:
        if (overlap(leaf.box_at(leaf.wide + opens * farther), near) > -CLEARANCE).any():
            return leaf.wide + opens * way
        way = farther
    return end


def _within_reach(leaf: Leaf, static: BoxSet) -> Bool[np.ndarray, " n"]:
    """Which boxes a leaf can come near to wherever it is."""
    ends = [leaf.box_at(leaf.closed), leaf.box_at(leaf.wide)] if leaf.slides else [leaf.box]
    corners = np.concatenate([footprint(box, 0) for box in ends])
    reach = np.linalg.norm(corners - leaf.pivot, axis=1).max() + CLEARANCE
    away = np.array([footprint_distance(static, i, leaf.pivot[None])[0] for i in range(len(static))])
    return (away <= reach) & (static.bottom < leaf.box.top[0]) & (static.top > leaf.box.bottom[0])


def ajar_leaves(leaves: Sequence[Leaf], static: BoxSet, walls: BoxSet | None = None) -> BoxSet:
    """Boxes of the leaves that cannot be opened far enough to leave the way free, opened as far as they can be.

    Args:
        leaves: Those that turn or slide.
        static: What they cannot run into.
        walls: See `make_doors`.
    """
    found = []
    for leaf in leaves:
        low, high = swing(leaf, static, walls)
        if high - low < (SLIDE_AJAR if leaf.slides else AJAR):
            found.append(leaf.box_at(high if leaf.wide > leaf.closed else low))
    return join(found)
