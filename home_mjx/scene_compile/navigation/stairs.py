"""Ways from level to level: the cells over a slope at which one grid goes on in the next."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.geodesic import Link
from home_mjx.scene_compile.objects.stairs import Stairs

NOTHING = 1e-4  # [m], length of a link from a cell to itself, as far as a graph can have it


def stair_links(
    stairs: Sequence[Stairs],
    standable: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[list[Link]]:
    """Of each of the stairs the cells that are free in the grids of both its levels.

    Args:
        stairs: Of the house.
        standable: Where an agent's axis may be.
        height: Of the cells [m]: over stairs that are above one another, the grids may have different ones.
        centres: x and y of the cells [m].
    """
    points = np.stack(np.meshgrid(*centres), axis=-1)
    found = []
    for one in stairs:
        both = one.contains(points) & standable[one.lower] & standable[one.upper]
        both &= np.isclose(height[one.lower], height[one.upper])
        cells = np.argwhere(both).tolist()
        found.append([Link((one.lower, y, x), (one.upper, y, x), NOTHING) for y, x in cells])
    return found
