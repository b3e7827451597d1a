"""Passability of rooms with open doors, whose leaves are obstacles."""

from collections.abc import Sequence
from functools import lru_cache

from home_procgen.floor_plan.bounds import wall_box
from home_procgen.floor_plan.openings import Opening
from home_procgen.floor_plan.placed import Box
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.walking import WalkingGrid
from home_procgen.plan.openings.bounds import column, cut_off, landings
from home_procgen.plan.shape.storeys import Stairwell

HEIGHT = 2.5  # [m], of boxes of walls and stairs: taller than an agent, and at most the wall height


def is_passable(room: RoomPlan, openings: Sequence[Opening], stairs: Stairwell | None = None) -> bool:
    """Return whether each door of an empty room is reachable from every other, and nearly all floor from the doors."""
    return floor_grid(room, openings, stairs).stays_connected([])


def floor_grid(room: RoomPlan, openings: Sequence[Opening], stairs: Stairwell | None = None) -> WalkingGrid:
    """Return the walking grid of an empty room.

    Args:
        room: The room.
        openings: Its doors and windows.
        stairs: The place of stairs in it; None if it has none.
    """
    parts = [part for opening in openings for part in opening.placed.parts]
    doors = [opening.placed for opening in openings if opening.is_door]
    ways = [door.beside(0.0, side * 0.5) for door in doors for side in (-1, 1)]
    return WalkingGrid(room, [*bounds(room, HEIGHT, stairs), *parts], [*ways, *(landings(stairs) if stairs else ())])


@lru_cache(maxsize=64)
def bounds(room: RoomPlan, height: float, stairs: Stairwell | None) -> tuple[Box, ...]:
    """Return boxes of a room's walls, its stairwell and its cut-off corners, up to a height [m]."""
    steps = [column(stairs, 0.0, height)] if stairs else []
    return (*(wall_box(wall, height) for wall in room.walls), *steps, *cut_off(room, height))
