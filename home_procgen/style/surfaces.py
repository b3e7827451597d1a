"""Materials of floors, walls and ceilings of rooms."""

from collections.abc import Sequence

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.walls import Surfaces
from home_procgen.plan.needs.room_program import OUTDOORS, WET
from home_procgen.primitives.palette import CEILINGS, DRY_WALLS, WET_WALLS, choose, plain, textured


def _named(family: str, numbers: Sequence[int]) -> tuple[Material, ...]:
    return tuple(textured(f"{family}_{n}") for n in numbers)


PARQUETS = (*_named("prkt", range(1, 12)), *_named("laminate", range(1, 7)))
CARPETS = _named("carpet", (1, 2, 4, 5, 6, 7, 11, 12))
TILES = (*_named("tile", (1, 2, 3, 4, 14, 15, 16, 17, 18, 19, 20, 21, 22)), *_named("stone", (2, 3)))
HARD = (*_named("stone", (1, 2, 5)), *_named("concrete", (1, 2)), *_named("tile", (4, 20, 21)))
DECKS = (*_named("stone", (1, 2, 5)), *_named("tile", (4, 20)), textured("wood_2"), textured("wood_9"))
WET_PAPERS = (*WET_WALLS, *_named("tile", range(6, 14)), textured("marble_1"))
PAPERS = _named("wallp", range(5, 27))
BRIGHT_PAPERS = _named("wallp", (8, 10, 14, 17, 18, 19, 20))
_COLORS = ("#f2efe6", "#e4e8e4", "#d6dee4", "#e8ddd0", "#c9d4c8", "#dccfc4", "#b9c6cc", "#c8b6a6")
PAINTS = (*DRY_WALLS, *map(plain, _COLORS))
SOFT_ROOMS = ("Bedroom", "Child_Room", "Guest_Room", "Office", "Wardrobe", "Gym")
BOARDS = (
    *map(plain, ("#f4f2ec", "#f4f2ec", "#dcd6c8", "#3a3632")),
    *_named("wood", (1, 3, 4)),
)  # skirting boards
HARD_ROOMS = ("Garage", "Boiler_room", "Storage")


class Cladding:
    """Surface materials of a home's rooms: a few materials, shared by all of them.

    Args:
        rng: Source of randomness.
        facade: Material of the outer walls.
    """

    def __init__(self, rng: np.random.Generator, facade: Material) -> None:
        self._rng, self._facade = rng, facade
        self._ceiling = choose(CEILINGS, rng)
        self._board = choose(BOARDS, rng)
        self._parquet, self._tiles, self._paint = choose(PARQUETS, rng), choose(TILES, rng), choose(PAINTS, rng)

    def of(self, kind: str) -> Surfaces:
        """Return the surfaces of a room of a type."""
        board = None if kind in (*WET, *HARD_ROOMS) else self._board
        return Surfaces(self._floor(kind), self._ceiling, self._walls(kind), self._facade, board)

    def _floor(self, kind: str) -> Material:
        if kind in OUTDOORS:
            return choose(DECKS, self._rng)
        if kind in HARD_ROOMS:
            return choose(HARD, self._rng)
        if kind in WET:
            return self._tiles if self._rng.random() < 0.5 else choose(TILES, self._rng)
        if kind in ("Kitchen", "Entryway") and self._rng.random() < 0.7:
            return self._tiles
        return choose(CARPETS, self._rng) if kind in SOFT_ROOMS and self._rng.random() < 0.3 else self._parquet

    def _walls(self, kind: str) -> Material:
        if kind in WET:
            return choose(WET_PAPERS, self._rng)
        if kind == "Child_Room" and self._rng.random() < 0.6:
            return choose(BRIGHT_PAPERS, self._rng)
        if kind in ("Living_Room", "Bedroom", "Dining_Room", "Guest_Room", "Hallway") and self._rng.random() < 0.35:
            return choose(PAPERS, self._rng)
        return self._paint if self._rng.random() < 0.5 else choose(PAINTS, self._rng)
