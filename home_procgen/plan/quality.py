"""Quality limits of plans: size of halls, compactness of outlines, distance from kitchens to tables."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.rooms import RoomPlan, outer_spans, shared_span
from home_procgen.plan.shape.storeys import Storey

MAX_HALL_SHARE, HALL_ALLOWANCE = 0.165, 3.5  # maximum hall area: a share of the floor area, plus a constant [m^2]
# Maximum perimeter relative to a square of the same area; the second value is for flats around their living room.
MAX_PERIMETER_RATIO, MAX_FLAT_PERIMETER_RATIO = 1.36, 1.28
MAX_ASPECT = 2.3  # maximum ratio of length to width
HALL_TYPES = ("Hallway", "Hall", "Lobby")
TABLE_ROOM_TYPES = ("Dining_Room", "Living_Room")


def meets_quality_limits(storeys: Sequence[Storey]) -> bool:
    """Return whether the storeys meet all quality limits."""
    return all(_has_fair_hall(s) and _is_compact(s.rooms) for s in storeys) and _has_near_tables(storeys[0].rooms)


def _has_fair_hall(storey: Storey) -> bool:
    stairs = storey.stairs_up or storey.stairs_down
    halls = sum(room.area for room in storey.rooms if room.type in HALL_TYPES) - (stairs.area if stairs else 0.0)
    return halls <= HALL_ALLOWANCE + MAX_HALL_SHARE * sum(room.area for room in storey.rooms)


def _is_compact(rooms: Sequence[RoomPlan]) -> bool:
    outside = sum(
        b - a
        for i, room in enumerate(rooms)
        for wall in room.walls
        for a, b in outer_spans(wall, [w for k, other in enumerate(rooms) if k != i for w in other.walls])
    )
    corners = np.concatenate([room.polygon for room in rooms])
    short, long = np.sort(np.ptp(corners, axis=0))
    most = MAX_FLAT_PERIMETER_RATIO if rooms[0].type == "Living_Room" else MAX_PERIMETER_RATIO
    return bool(long <= MAX_ASPECT * short and outside <= most * 4 * np.sqrt(sum(room.area for room in rooms)))


def _has_near_tables(rooms: Sequence[RoomPlan]) -> bool:
    """Return whether each kitchen adjoins a dining or living room, or their centres are less than 5.5 m apart."""
    tables = [room for room in rooms if room.type in TABLE_ROOM_TYPES]
    kitchens = [room for room in rooms if room.type == "Kitchen"]
    return all(
        any(_are_adjacent(kitchen, table) or _are_near(kitchen, table) for table in tables) for kitchen in kitchens
    )


def _are_adjacent(one: RoomPlan, other: RoomPlan) -> bool:
    return any(shared_span(a, b) for a in one.walls for b in other.walls)


def _are_near(one: RoomPlan, other: RoomPlan) -> bool:
    middles = [np.mean(room.polygon, axis=0) for room in (one, other)]
    return float(np.linalg.norm(middles[0] - middles[1])) < 5.5
