"""Links between levels: cells over stairs at which one grid continues in the next."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.geodesic import GridLink
from home_mjx.scene_compile.objects.stairs import Staircase

LINK_LENGTH = 1e-4  # [m], length of a link between copies of a cell; sparse graphs cannot store zero


def stair_links(
    stairs: Sequence[Staircase],
    standable: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[list[GridLink]]:
    """Return for each of the stairs links at the cells that are free in the grids of both levels.

    Args:
        stairs: Stairs of the house.
        standable: Cells where agents can stand.
        height: Height of the cells [m]; where stairs are above one another, the grids may differ.
        centres: x and y of the cells [m].
    """
    points = np.stack(np.meshgrid(*centres), axis=-1)
    found = []
    for one in stairs:
        both = one.contains(points) & standable[one.lower] & standable[one.upper]
        both &= np.isclose(height[one.lower], height[one.upper])
        cells = np.argwhere(both).tolist()
        found.append([GridLink((one.lower, y, x), (one.upper, y, x), LINK_LENGTH) for y, x in cells])
    return found
