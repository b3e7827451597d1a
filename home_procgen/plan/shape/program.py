"""Random room program of a home, and the requirements of each type of room.

A program is the number of storeys, the number of rooms, and the types of the rooms of each storey. A requirement is a
size, a shape and a role in the plan.

Frequencies follow SUNCG's: 76.6, 18.6 and 4.9 % of its houses have one, two and three floors, and a floor has 8.1 rooms
on average. Weights of the types follow its room labels, within the limits of doors, halls and one kitchen per home.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from home_mjx.errors import ConfigError

STOREY_PROBABILITIES = (0.766, 0.186, 0.048)  # probabilities of 1, 2 and 3 storeys
# Number of rooms on a floor -> weight.
ROOM_COUNT_WEIGHTS = {3: 3, 4: 7, 5: 10, 6: 12, 7: 14, 8: 14, 9: 13, 10: 10, 11: 7, 12: 5, 13: 3, 14: 2}
MAX_ROOMS, MIN_ROOMS = 14, 3
MIN_ROOMS_WITH_STAIRS = 5  # minimum number of rooms on a floor with stairs
NUM_COUNTS_WITH_STAIRS = 5  # room counts, from `MIN_ROOMS_WITH_STAIRS` on, that replace counts too small for stairs

# Optional rooms of one-storey homes and their weights; a type listed twice may be drawn twice.
OPTIONAL_TYPES = (
    ("Bedroom", 1.4),
    ("Bedroom", 1.0),
    ("Bedroom", 0.3),
    ("Toilet", 3.0),
    ("Toilet", 1.2),
    ("Bathroom", 1.2),
    ("Office", 0.8),
    ("Office", 0.2),
    ("Dining_Room", 1.2),
    ("Garage", 0.8),
    ("Child_Room", 0.2),
    ("Gym", 0.2),
    ("Wardrobe", 0.14),
    ("Storage", 0.12),
    ("Guest_Room", 0.1),
    ("Boiler_room", 0.05),
    ("Entryway", 0.08),
)
GROUND_TYPES = ("Kitchen", "Living_Room", "Toilet")
OPTIONAL_GROUND_TYPES = (
    ("Dining_Room", 1.6),
    ("Garage", 1.4),
    ("Bathroom", 0.7),
    ("Office", 0.6),
    ("Bedroom", 0.6),
    ("Guest_Room", 0.3),
    ("Storage", 0.4),
    ("Boiler_room", 0.15),
    ("Gym", 0.2),
    ("Toilet", 0.5),
    ("Bedroom", 0.3),
    ("Entryway", 0.2),
    ("Wardrobe", 0.15),
)
UPPER_TYPES = ("Bedroom", "Bathroom", "Bedroom")
OPTIONAL_UPPER_TYPES = (
    ("Bedroom", 1.3),
    ("Toilet", 1.6),
    ("Child_Room", 0.4),
    ("Bathroom", 0.7),
    ("Office", 0.5),
    ("Bedroom", 0.7),
    ("Wardrobe", 0.3),
    ("Guest_Room", 0.2),
    ("Gym", 0.25),
    ("Storage", 0.15),
    ("Child_Room", 0.15),
    ("Office", 0.2),
    ("Bedroom", 0.4),
    ("Living_Room", 0.12),
)

SMALL_TYPES = ("Toilet", "Storage", "Wardrobe", "Boiler_room")  # may have a nook of their neighbour behind them
ROOMY_TYPES = ("Living_Room", "Kitchen", "Bedroom", "Child_Room", "Guest_Room", "Office", "Dining_Room", "Gym")
OUTDOOR_TYPES = ("Balcony", "Loggia", "Terrace")
WET_TYPES = ("Bathroom", "Toilet")
WINDOWLESS_TYPES = ("Storage", "Wardrobe", "Boiler_room", *OUTDOOR_TYPES)
# Types that other rooms can be reached through, in order of preference; all others are leaves of the door graph.
CONNECTING_TYPES = ("Hallway", "Hall", "Lobby", "Entryway", "Living_Room", "Dining_Room", "Kitchen")
PRIVATE_ACCESS_TYPES = CONNECTING_TYPES[:6]  # a kitchen has no door to a private room


class RoomRequirements(NamedTuple):
    """Size and shape that a type of room requires."""

    min_area: float  # [m^2], range of the area
    max_area: float
    min_side: float  # [m], minimum length of the shorter side
    max_aspect: float  # maximum ratio of the longer to the shorter side
    zone: float  # 0: guest area, 1: sleeping area; neighbouring rooms have similar zones


ROOM_REQUIREMENTS = {
    "Living_Room": RoomRequirements(18, 32, 3.5, 2.0, 0.0),
    "Kitchen": RoomRequirements(8.5, 15, 2.4, 2.2, 0.15),
    "Dining_Room": RoomRequirements(10.5, 17, 2.9, 1.9, 0.08),
    "Bedroom": RoomRequirements(11, 18, 2.8, 1.8, 0.9),
    "Child_Room": RoomRequirements(9.5, 14, 2.6, 1.8, 0.95),
    "Guest_Room": RoomRequirements(10, 14, 2.6, 1.8, 0.7),
    "Office": RoomRequirements(7.5, 13, 2.4, 1.9, 0.5),
    "Bathroom": RoomRequirements(5, 8.5, 1.9, 2.3, 0.75),
    "Toilet": RoomRequirements(2.1, 3.6, 1.3, 2.5, 0.4),
    "Storage": RoomRequirements(2.6, 6, 1.4, 2.5, 0.45),
    "Wardrobe": RoomRequirements(3.5, 6.5, 1.6, 2.4, 0.85),
    "Garage": RoomRequirements(17, 34, 3.1, 2.6, -0.1),
    "Gym": RoomRequirements(11, 19, 2.8, 1.9, 0.6),
    "Boiler_room": RoomRequirements(3.2, 6.5, 1.6, 2.4, 0.35),
    "Entryway": RoomRequirements(3.6, 7, 1.7, 2.4, 0.3),
}


@dataclass(frozen=True)
class RoomProgram:
    """Rooms to build.

    Attributes:
        ground_types: Types of the rooms of the ground floor, without the hall.
        num_storeys: Number of storeys.
    """

    ground_types: tuple[str, ...]
    num_storeys: int


def draw_program(rng: np.random.Generator, room_counts: Mapping[int, float] | None = None) -> RoomProgram:
    """Draw a random program: number of storeys, and types of the ground floor's rooms.

    Args:
        rng: Source of randomness.
        room_counts: Number of rooms of homes of one storey -> weight; None: homes of any size.

    Example:
        >>> program = draw_program(np.random.default_rng(3))
        >>> "Kitchen" in program.ground_types
        True
    """
    storeys = 1 + int(rng.choice(3, p=STOREY_PROBABILITIES)) if room_counts is None else 1
    options = ROOM_COUNT_WEIGHTS if room_counts is None else room_counts
    weights = np.array(list(options.values()), float)
    count = int(rng.choice(list(options), p=weights / weights.sum()))
    if storeys > 1 and count < MIN_ROOMS_WITH_STAIRS:
        # A range, so that fewer homes are alike.
        count = MIN_ROOMS_WITH_STAIRS + int(rng.integers(NUM_COUNTS_WITH_STAIRS))
    return RoomProgram(draw_ground_types(rng, count, storeys), storeys)


def draw_ground_types(rng: np.random.Generator, count: int, storeys: int = 1) -> tuple[str, ...]:
    """Draw the types of the rooms of a ground floor, without the hall.

    Args:
        rng: Source of randomness.
        count: Number of rooms, with the hall.
        storeys: Number of storeys of the home.

    Raises:
        ConfigError: The number of rooms is out of range for the number of storeys.
    """
    if not MIN_ROOMS <= count <= MAX_ROOMS or (storeys > 1 and count < MIN_ROOMS_WITH_STAIRS):
        hint = f"A floor has {MIN_ROOMS} to {MAX_ROOMS} rooms, one with stairs at least {MIN_ROOMS_WITH_STAIRS}."
        raise ConfigError(f"a home of {storeys} storeys cannot have {count} rooms on its ground floor", hint=hint)
    if storeys > 1:
        return (*GROUND_TYPES, *draw_types(rng, OPTIONAL_GROUND_TYPES, count - 1 - len(GROUND_TYPES)))
    if count == 3:  # the living room is the hall
        return ("Bathroom", str(rng.choice(["Kitchen", "Kitchen", "Bedroom", "Office"])))
    core = ("Kitchen", "Bathroom", "Bedroom")
    if count <= 6:
        return (
            *core,
            *draw_types(
                rng, _exclude_types(OPTIONAL_TYPES, ("Garage", "Entryway", "Boiler_room")), count - 1 - len(core)
            ),
        )
    core = ("Living_Room", *core)
    return (*core, *draw_types(rng, OPTIONAL_TYPES, count - 1 - len(core)))


def draw_types(rng: np.random.Generator, options: Sequence[tuple[str, float]], count: int) -> list[str]:
    """Draw `count` types, or all if there are fewer, without replacement by weight."""
    weight = np.array([w for _, w in options])
    picks = rng.choice(len(options), size=min(count, len(options)), replace=False, p=weight / weight.sum())
    return [options[int(i)][0] for i in picks]


def _exclude_types(options: Sequence[tuple[str, float]], types: Sequence[str]) -> list[tuple[str, float]]:
    return [option for option in options if option[0] not in types]
