"""Materials of floors, walls and ceilings of rooms."""

from collections.abc import Sequence

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.walls import RoomSurfaces
from home_procgen.plan.shape.program import OUTDOOR_TYPES, WET_TYPES
from home_procgen.primitives.palette import CEILINGS, DRY_WALLS, WET_WALLS, choose_random, plain, textured


def _texture_family(family: str, numbers: Sequence[int]) -> tuple[Material, ...]:
    return tuple(textured(f"{family}_{n}") for n in numbers)


PARQUETS = (*_texture_family("prkt", range(1, 12)), *_texture_family("laminate", range(1, 7)))
CARPETS = _texture_family("carpet", (1, 2, 4, 5, 6, 7, 11, 12))
TILES = (*_texture_family("tile", (1, 2, 3, 4, 14, 15, 16, 17, 18, 19, 20, 21, 22)), *_texture_family("stone", (2, 3)))
HARD_FLOORS = (
    *_texture_family("stone", (1, 2, 5)),
    *_texture_family("concrete", (1, 2)),
    *_texture_family("tile", (4, 20, 21)),
)
OUTDOOR_FLOORS = (
    *_texture_family("stone", (1, 2, 5)),
    *_texture_family("tile", (4, 20)),
    textured("wood_2"),
    textured("wood_9"),
)
WET_WALLPAPERS = (*WET_WALLS, *_texture_family("tile", range(6, 14)), textured("marble_1"))
WALLPAPERS = _texture_family("wallp", range(5, 27))
BRIGHT_WALLPAPERS = _texture_family("wallp", (8, 10, 14, 17, 18, 19, 20))
_COLORS = ("#f2efe6", "#e4e8e4", "#d6dee4", "#e8ddd0", "#c9d4c8", "#dccfc4", "#b9c6cc", "#c8b6a6")
PAINTS = (*DRY_WALLS, *map(plain, _COLORS))
CARPETED_TYPES = ("Bedroom", "Child_Room", "Guest_Room", "Office", "Wardrobe", "Gym")
SKIRTING_BOARDS = (
    *map(plain, ("#f4f2ec", "#f4f2ec", "#dcd6c8", "#3a3632")),
    *_texture_family("wood", (1, 3, 4)),
)  # skirting boards
HARD_FLOOR_TYPES = ("Garage", "Boiler_room", "Storage")


class HomeSurfaces:
    """Surface materials of a home's rooms: a few materials, shared by all of them.

    Args:
        rng: Source of randomness.
        facade: Material of the outer walls.
    """

    def __init__(self, rng: np.random.Generator, facade: Material) -> None:
        self._rng, self._facade = rng, facade
        self._ceiling = choose_random(CEILINGS, rng)
        self._board = choose_random(SKIRTING_BOARDS, rng)
        self._parquet, self._tiles, self._paint = (
            choose_random(PARQUETS, rng),
            choose_random(TILES, rng),
            choose_random(PAINTS, rng),
        )

    def draw_room_surfaces(self, kind: str) -> RoomSurfaces:
        """Draw the surfaces of a room of a type, mostly materials that the home shares; wet rooms have no skirting."""
        board = None if kind in (*WET_TYPES, *HARD_FLOOR_TYPES) else self._board
        return RoomSurfaces(self._floor(kind), self._ceiling, self._walls(kind), self._facade, board)

    def _floor(self, kind: str) -> Material:
        if kind in OUTDOOR_TYPES:
            return choose_random(OUTDOOR_FLOORS, self._rng)
        if kind in HARD_FLOOR_TYPES:
            return choose_random(HARD_FLOORS, self._rng)
        if kind in WET_TYPES:
            return self._tiles if self._rng.random() < 0.5 else choose_random(TILES, self._rng)
        if kind in ("Kitchen", "Entryway") and self._rng.random() < 0.7:
            return self._tiles
        return (
            choose_random(CARPETS, self._rng) if kind in CARPETED_TYPES and self._rng.random() < 0.3 else self._parquet
        )

    def _walls(self, kind: str) -> Material:
        if kind in WET_TYPES:
            return choose_random(WET_WALLPAPERS, self._rng)
        if kind == "Child_Room" and self._rng.random() < 0.6:
            return choose_random(BRIGHT_WALLPAPERS, self._rng)
        if kind in ("Living_Room", "Bedroom", "Dining_Room", "Guest_Room", "Hallway") and self._rng.random() < 0.35:
            return choose_random(WALLPAPERS, self._rng)
        return self._paint if self._rng.random() < 0.5 else choose_random(PAINTS, self._rng)
