"""Sites of openings: stretches of wall between two rooms, or between a room and the outside."""

from collections.abc import Sequence

from home_procgen.floor_plan.openings import OpeningSite
from home_procgen.floor_plan.rooms import RoomPlan, outer_spans, shared_span

MIN_DOOR_WALL = 1.1  # [m], minimum length of wall for a door


def find_inner_sites(rooms: Sequence[RoomPlan]) -> list[OpeningSite]:
    """Return the stretches of wall that two rooms share and that are long enough for a door."""
    return [
        OpeningSite(wall, span, (a, b))
        for b in range(len(rooms))
        for a in range(b)
        for wall in rooms[a].walls
        for other in rooms[b].walls
        if (span := shared_span(wall, other)) and span[1] - span[0] >= MIN_DOOR_WALL
    ]


def find_outer_sites(rooms: Sequence[RoomPlan], room: int) -> list[OpeningSite]:
    """Return the stretches of a room's walls that no other room shares."""
    others = [wall for i, other in enumerate(rooms) if i != room for wall in other.walls]
    return [OpeningSite(wall, span, (room,)) for wall in rooms[room].walls for span in outer_spans(wall, others)]
