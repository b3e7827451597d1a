"""Passability of rooms with open doors, whose leaves are obstacles."""

from collections.abc import Sequence
from functools import lru_cache

from home_procgen.floor_plan.bounds import wall_box
from home_procgen.floor_plan.openings import PlanOpening
from home_procgen.floor_plan.placed import Box
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.walking import WalkingGrid
from home_procgen.plan.openings.bounds import cut_corner_boxes, landing_points, stairwell_box
from home_procgen.plan.shape.storeys import Stairwell

BOX_HEIGHT = 2.5  # [m], of boxes of walls and stairs: taller than an agent, and at most the wall height


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
    return WalkingGrid(
        room, [*boundary_boxes(room, BOX_HEIGHT, stairs), *parts], [*ways, *(landing_points(stairs) if stairs else ())]
    )


@lru_cache(maxsize=64)
def boundary_boxes(room: RoomPlan, height: float, stairs: Stairwell | None) -> tuple[Box, ...]:
    """Return boxes of a room's walls, its stairwell and its cut-off corners, up to a height [m]."""
    steps = [stairwell_box(stairs, 0.0, height)] if stairs else []
    return (*(wall_box(wall, height) for wall in room.walls), *steps, *cut_corner_boxes(room, height))
