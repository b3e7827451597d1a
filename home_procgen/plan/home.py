"""Random plan of a home: storeys with their rooms, doors and windows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from home_mjx.errors import ConfigError
from home_procgen.floor_plan.openings import LevelPlan, PlanOpening
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.structure import structure_models
from home_procgen.model_store import get_model
from home_procgen.plan.openings.doors import OpeningModels, draw_doors, draw_entrance, draw_garage_doors
from home_procgen.plan.openings.passage import is_passable
from home_procgen.plan.openings.windows import draw_windows
from home_procgen.plan.outdoors import add_outdoors
from home_procgen.plan.quality import meets_quality_limits
from home_procgen.plan.shape.program import RoomProgram, draw_program
from home_procgen.plan.shape.storeys import Stairwell, Storey, draw_storeys
from home_procgen.plan.slants import add_slants
from home_procgen.primitives.palette import choose_random

MAX_STOREY_ATTEMPTS = 6000  # maximum attempts to draw storeys; a few dozen are typical
ATTEMPTS_PER_PROGRAM = 1500  # attempts before another program is drawn; only if the caller passed none
# [m], wall heights of one-storey homes
WALL_HEIGHTS, WALL_HEIGHT_PROBABILITIES = (2.5, 2.6, 2.7, 2.8, 3.0), (0.15, 0.15, 0.45, 0.15, 0.1)
HALL_ENTRANCE_PROBABILITY = 0.9  # that the entrance must lead into the hall, if any, and not into the living room
NUM_OPENING_ATTEMPTS = 5  # attempts to place doors and windows in the same rooms
SOLID_DOOR_NUMBERS, GLAZED_DOOR_NUMBERS = (1, 2, 4, 5, 7, 8, 9, 10, 11, 13), (3, 6, 12)  # model numbers of doors
STOREY_HEIGHTS = (2.7, 2.8, 2.9)  # [m], floor-to-floor heights of homes of several storeys


@dataclass(frozen=True)
class HomePlan:
    """Plan of a home, storeys from bottom to top.

    Attributes:
        storeys: Rooms, with the places of stairs.
        levels: The same rooms with their openings.
        height: Height from floor to floor, and of walls [m].
    """

    storeys: tuple[Storey, ...]
    levels: tuple[LevelPlan, ...]
    height: float

    def stairwell(self, level: int) -> Stairwell | None:
        """Return the place of stairs on a level, from stairs up or down; None if the level has none."""
        return self.storeys[level].stairs_up or self.storeys[level].stairs_down


def draw_home(rng: np.random.Generator, program: RoomProgram | None = None, is_plain: bool = False) -> HomePlan:
    """Draw a random home plan.

    Args:
        rng: Source of randomness.
        program: Room program to build; None draws a program as well.
        is_plain: Leave out balconies, loggias and terraces, and more than one window per room.

    Raises:
        ConfigError: No plan was found for the program.

    Example:
        >>> home = draw_home(np.random.default_rng(0))
        >>> len(home.levels) == len(home.storeys)
        True
    """
    wanted = draw_program(rng) if program is None else program
    solid, glazed = (
        get_model("door", choose_random(numbers, rng)) for numbers in (SOLID_DOOR_NUMBERS, GLAZED_DOOR_NUMBERS)
    )
    entry, double = (get_model(kind, choose_random(range(1, 4), rng)) for kind in ("entry_door", "double_door"))
    models = OpeningModels(solid, glazed, choose_random(structure_models()["garage_door"], rng), entry, double)
    for attempt in range(MAX_STOREY_ATTEMPTS):
        storeys = draw_storeys(rng, wanted)
        if storeys is not None and meets_quality_limits(storeys):
            slanted, strict = add_slants(rng, storeys), bool(rng.random() < HALL_ENTRANCE_PROBABILITY)
            ways = (_add_openings(rng, slanted, models, strict, is_plain) for _ in range(NUM_OPENING_ATTEMPTS))
            if home := next((home for home in ways if home is not None), None):
                return home
        if program is None and attempt % ATTEMPTS_PER_PROGRAM == ATTEMPTS_PER_PROGRAM - 1:
            wanted = draw_program(rng)
    hint = "Ask for other rooms, or fewer storeys."
    raise ConfigError(f"no plan was found for {wanted.num_storeys} storeys with {wanted.ground_types}", hint=hint)


def _bypasses_hall(rooms: Sequence[RoomPlan], entrance: PlanOpening) -> bool:
    return rooms[0].type != "Living_Room" and rooms[entrance.rooms[0]].type == "Living_Room"


def _add_openings(
    rng: np.random.Generator, storeys: Sequence[Storey], models: OpeningModels, into_hall: bool, is_plain: bool
) -> HomePlan | None:
    """Add outdoor rooms, unless `is_plain` is set, doors and windows to all storeys.

    Return None if a room cannot be reached or crossed, or if `into_hall` is set and the entrance bypasses the hall.
    """
    height = float(
        rng.choice(WALL_HEIGHTS, p=WALL_HEIGHT_PROBABILITIES) if len(storeys) == 1 else rng.choice(STOREY_HEIGHTS)
    )
    found, levels = [], []
    for number, plain in enumerate(storeys):
        below = [room for storey in found for room in storey.rooms]
        rooms = plain.rooms if is_plain else add_outdoors(rng, plain.rooms, number == 0, below)
        storey = replace(plain, rooms=rooms)
        doors = draw_doors(rng, storey, models)
        if doors is None:
            return None
        if number == 0:
            entrance = draw_entrance(rng, storey, models, doors)
            if entrance is None or (into_hall and _bypasses_hall(storey.rooms, entrance)):
                return None
            doors.append(entrance)
        openings: list[PlanOpening] = [*doors, *draw_garage_doors(rng, storey.rooms, models, doors)]
        place = storey.stairs_up or storey.stairs_down
        windows = draw_windows(rng, storey.rooms, openings, place.rect if place else None, is_plain)
        level = LevelPlan(storey.rooms, (*openings, *windows), height)
        if not all(is_passable(r, level.openings_of(i), None if i else place) for i, r in enumerate(level.rooms)):
            return None
        levels.append(level)
        found.append(storey)
    return HomePlan(tuple(found), tuple(levels), height)
