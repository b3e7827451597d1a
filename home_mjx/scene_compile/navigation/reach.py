"""Storeys that agents cannot reach."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.navigation.free_space import FreeSpace
from home_mjx.scene_compile.objects.stairs import Staircase

MIN_REACHED_SHARE = 0.1  # minimum share of a storey's free floor in the home region; the head of stairs has less


@dataclass(frozen=True)
class UnreachableStorey:
    """A storey with free floor that is not connected to the ground floor.

    Attributes:
        storey: Index of its grid, from 0 at the bottom.
        level: Index of its level in the house.
        area: Area where agents could stand [m^2].
        stairs: Object ids of the stairs that begin or end there.
    """

    storey: int
    level: int
    area: float
    stairs: tuple[int, ...]


def find_unreachable_storeys(
    spaces: Sequence[FreeSpace], region: Int[np.ndarray, "l ny nx"], stairs: Sequence[Staircase], cell: float
) -> tuple[UnreachableStorey, ...]:
    """Return the upper storeys of which less than `MIN_REACHED_SHARE` of the free floor is in the home region.

    Storeys without free floor are not returned, nor is the lowest. Ramps are no floor.

    `spaces` has the levels with rooms, lowest first, and `region` (0 home, -1 none) the cells of their grids, of size
    `cell` [m].
    """
    found = []
    for grid, space in enumerate(spaces[1:], 1):
        floor = (region[grid] >= 0) & ~space.on_ramp
        if np.sum(floor & (region[grid] == 0)) < MIN_REACHED_SHARE * floor.sum():
            near = tuple(one.object_id for one in stairs if grid in (one.lower, one.upper))
            found.append(UnreachableStorey(grid, int(space.level), float(floor.sum()) * cell**2, near))
    return tuple(found)
