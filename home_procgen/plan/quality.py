"""Quality limits of plans: size of halls, compactness of outlines, distance from kitchens to tables."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.rooms import RoomPlan, outer_spans, shared_span
from home_procgen.plan.shape.storeys import Storey

HALL_SHARE, HALL_ROOM = 0.165, 3.5  # maximum hall area: a share of the floor area, plus a constant [m^2]
# Maximum perimeter relative to a square of the same area; the second value is for flats around their living room.
SPRAWL, SPRAWL_SMALL = 1.36, 1.28
SLENDER = 2.3  # maximum ratio of length to width
HALLS = ("Hallway", "Hall", "Lobby")
TABLES = ("Dining_Room", "Living_Room")


def is_liveable(storeys: Sequence[Storey]) -> bool:
    """Return whether the storeys meet all quality limits."""
    return all(_fair_hall(s) and _compact(s.rooms) for s in storeys) and _short_ways(storeys[0].rooms)


def _fair_hall(storey: Storey) -> bool:
    stairs = storey.stairs or storey.well
    halls = sum(room.area for room in storey.rooms if room.type in HALLS) - (stairs.area if stairs else 0.0)
    return halls <= HALL_ROOM + HALL_SHARE * sum(room.area for room in storey.rooms)


def _compact(rooms: Sequence[RoomPlan]) -> bool:
    outside = sum(
        b - a
        for i, room in enumerate(rooms)
        for wall in room.walls
        for a, b in outer_spans(wall, [w for k, other in enumerate(rooms) if k != i for w in other.walls])
    )
    corners = np.concatenate([room.polygon for room in rooms])
    short, long = np.sort(np.ptp(corners, axis=0))
    most = SPRAWL_SMALL if rooms[0].type == "Living_Room" else SPRAWL
    return bool(long <= SLENDER * short and outside <= most * 4 * np.sqrt(sum(room.area for room in rooms)))


def _short_ways(rooms: Sequence[RoomPlan]) -> bool:
    """Return whether every kitchen is next to a room with a table, or at most 5.5 m from it."""
    tables = [room for room in rooms if room.type in TABLES]
    kitchens = [room for room in rooms if room.type == "Kitchen"]
    return all(any(_beside(kitchen, table) or _near(kitchen, table) for table in tables) for kitchen in kitchens)


def _beside(one: RoomPlan, other: RoomPlan) -> bool:
    return any(shared_span(a, b) for a in one.walls for b in other.walls)


def _near(one: RoomPlan, other: RoomPlan) -> bool:
    middles = [np.mean(room.polygon, axis=0) for room in (one, other)]
    return float(np.linalg.norm(middles[0] - middles[1])) < 5.5
