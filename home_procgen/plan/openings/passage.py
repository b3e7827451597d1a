"""Passability of rooms with open doors; leaves, walls, stairs and cut-off corners are obstacles."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from home_procgen.floor_plan.openings import PlanOpening
from home_procgen.floor_plan.placed_model import Box
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.walking_grid import WalkingGrid
from home_procgen.floor_plan.walls import PRISM_THICKNESS, wall_box
from home_procgen.plan.shape.cut_rooms import CutRoom, slanted_sides
from home_procgen.plan.shape.storeys import Stairwell

BOX_HEIGHT = 2.5  # [m], of boxes of walls and stairs: taller than an agent, and at most the wall height

STRIP_SHARE = 0.125  # width of each box that approximates a cut-off corner, as a share of the corner's side
MIN_WAY_WIDTH = 0.6  # [m], of the ways between the doors of a furnished room
LANDING_DISTANCE = 0.5  # [m], from the edge of stairs to the points that must be reachable


def cut_corner_boxes(room: RoomPlan, height: float) -> Iterator[Box]:
    """Generate boxes that cover the cut-off corners of a room and the slanted walls."""
    for (x0, z0), (x1, z1) in slanted_sides(room):
        # The corner is the intersection of the neighbouring walls: (x0, z1) or (x1, z0).
        cuts = room.cuts if isinstance(room, CutRoom) else ()
        corner = next((x, z) for x, z, _ in cuts if (x, z) in ((x0, z1), (x1, z0)))
        for share in np.arange(0, 1, STRIP_SHARE) + STRIP_SHARE:
            reach = 1 - share + STRIP_SHARE  # share of the triangle's other side at the start of the strip
            x = corner[0] + share * ((x1 if corner[0] == x0 else x0) - corner[0])
            z = corner[1] + reach * ((z1 if corner[1] == z0 else z0) - corner[1])
            low, high = np.sort([[corner[0], corner[1]], [x, z]], axis=0)
            yield np.array(
                [
                    [low[0] - PRISM_THICKNESS, 0.0, low[1] - PRISM_THICKNESS],
                    [high[0] + PRISM_THICKNESS, height, high[1] + PRISM_THICKNESS],
                ]
            )


def stairwell_box(stairs: Stairwell, before: float, height: float) -> Box:
    """Return the box of a stairwell from height 0 to `height`, extended towards the hall by `before` [m]."""
    x0, z0, x1, z1 = stairs.rect
    low, high = np.array([x0, 0.0, z0]), np.array([x1, height, z1])
    for axis, way in zip((0, 2), stairs.direction, strict=True):
        low[axis] -= before * (way > 0)
        high[axis] += before * (way < 0)
    return np.stack([low, high])


def landing_points(stairs: Stairwell) -> list[tuple[float, float]]:
    """Return the two points (x, z) in front of the foot and of the head of stairs, in either order [m]."""
    middle = np.array([(stairs.rect.x0 + stairs.rect.x1) / 2, (stairs.rect.z0 + stairs.rect.z1) / 2])
    size, way = np.array(stairs.rect.extents), np.array(stairs.direction, float)
    edge = middle - way * (size @ abs(way)) / 2
    aside = np.array([-way[1], way[0]]) * (size @ abs(way[::-1])) / 4
    points = [edge - LANDING_DISTANCE * way + side * aside for side in (-1, 1)]
    return [(float(x), float(z)) for x, z in points]


def is_passable(room: RoomPlan, openings: Sequence[PlanOpening], stairs: Stairwell | None = None) -> bool:
    """Return whether each door of an empty room is reachable from every other, and nearly all floor from the doors."""
    return build_floor_grid(room, openings, stairs).stays_connected([])


def build_floor_grid(room: RoomPlan, openings: Sequence[PlanOpening], stairs: Stairwell | None = None) -> WalkingGrid:
    """Return the walking grid of an empty room.

    Args:
        room: The room.
        openings: Its doors and windows.
        stairs: The place of stairs in it; None if it has none.
    """
    parts = [part for opening in openings for part in opening.object.parts]
    doors = [opening.object for opening in openings if opening.is_door]
    ways = [door.local_point(0.0, side * 0.5) for door in doors for side in (-1, 1)]
    starts = [*ways, *(landing_points(stairs) if stairs else ())]
    return WalkingGrid(room, [*boundary_boxes(room, BOX_HEIGHT, stairs), *parts], starts, MIN_WAY_WIDTH / 2)


@lru_cache(maxsize=64)
def boundary_boxes(room: RoomPlan, height: float, stairs: Stairwell | None) -> tuple[Box, ...]:
    """Return boxes of a room's walls, its stairwell and its cut-off corners, up to a height [m]."""
    steps = [stairwell_box(stairs, 0.0, height)] if stairs else []
    return (*(wall_box(wall, height) for wall in room.walls), *steps, *cut_corner_boxes(room, height))
