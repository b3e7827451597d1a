"""Leaves of doors in the world: how far they can turn, and the table of them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from home_mjx.scene_compile.geometry.boxes import BoxSet, footprint, footprint_distance, join, overlap
from home_mjx.scene_compile.geometry.rotations import yaw_quat
from home_mjx.scene_compile.objects.doors import Leaf
from home_mjx.schema.compiled import Doors

AREAL_DENSITY = 8.0  # [kg/m^2] of leaf: a hollow-core interior door of 0.8 x 2 m weighs 10 to 15 kg
LEAF_MASS = (5.0, 60.0)  # [kg]
CLEARANCE = 0.01  # [m], that a leaf keeps from what it could turn into
STEP = np.deg2rad(1.0)  # in which a leaf is turned to find how far it can: its free edge moves by 1.4 cm
MOST_OPEN = np.pi  # [rad], from closed
AJAR = np.deg2rad(60.0)  # from closed: a leaf that opens farther leaves the way free


def make_doors(leaves: Sequence[Leaf], static: BoxSet) -> Doors:
    """The table of a house's leaves.

    Args:
        leaves: Those that turn.
        static: What they cannot turn into.
    """
    if not leaves:
        return Doors.none()
    low, high = np.array([swing(leaf, static) for leaf in leaves]).T
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
    )


def swing(leaf: Leaf, static: BoxSet) -> tuple[float, float]:
    """The angles between which a leaf can turn: from closed to where its box would come too near to another one.

    A leaf has the frame and the wall beside it within its clearance when it is closed. Into such boxes it may reach
    by its own thickness further than when closed, as much as turning about a hinge at its edge takes.
    If the leaf stands free as placed, the range reaches at least there, whatever is between.

    Args:
        leaf: As it stands, at angle 0.
        static: What it cannot turn into.

    Returns:
        Least and greatest angle [rad]; one of them is the closed one.
    """
    near = static[_within_reach(leaf, static)]
    closed = overlap(leaf.box_at(leaf.closed), near)
    thickness = 2 * float(leaf.box.half[0, :2].min())
    allowed = np.where(closed > -CLEARANCE, np.maximum(closed, 0) + thickness, -CLEARANCE)

    def is_free(angle: float) -> bool:
        return bool((overlap(leaf.box_at(angle), near) <= allowed).all())

    opens = float(np.sign(leaf.wide - leaf.closed))
    end = 0.0 if is_free(0.0) else leaf.closed
    while abs(end - leaf.closed) + STEP <= MOST_OPEN and is_free(end + opens * STEP):
        end += opens * STEP
    return min(leaf.closed, end), max(leaf.closed, end)


def _within_reach(leaf: Leaf, static: BoxSet) -> Bool[np.ndarray, " n"]:
    """Which boxes a leaf can come near to at any angle."""
    corners = footprint(leaf.box, 0)
    reach = np.linalg.norm(corners - leaf.pivot, axis=1).max() + CLEARANCE
    away = np.array([footprint_distance(static, i, leaf.pivot[None])[0] for i in range(len(static))])
    return (away <= reach) & (static.bottom < leaf.box.top[0]) & (static.top > leaf.box.bottom[0])


def ajar_leaves(leaves: Sequence[Leaf], static: BoxSet) -> BoxSet:
    """Boxes of the leaves that cannot be opened far enough to leave the way free, opened as far as they can be.

    Args:
        leaves: Those that turn.
        static: What they cannot turn into.
    """
    ranges = [(leaf, swing(leaf, static)) for leaf in leaves]
    ends = [(leaf, high if leaf.wide > leaf.closed else low) for leaf, (low, high) in ranges if high - low < AJAR]
    return join(leaf.box_at(end) for leaf, end in ends)
