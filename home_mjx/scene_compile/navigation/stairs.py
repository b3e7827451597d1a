"""Ways from level to level: the cells over a slope at which one grid goes on in the next."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.scene_compile.navigation.geodesic import Link
from home_mjx.scene_compile.objects.stairs import Flight

NOTHING = 1e-4  # [m], length of a link from a cell to itself, as far as a graph can have it


def stair_links(
    flights: Sequence[Flight],
    standable: Bool[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[list[Link]]:
    """Of each flight the cells that are free in the grids of both its levels.

    Args:
        flights: Stairs of the house.
        standable: Where an agent's axis may be.
        centres: x and y of the cells [m].
    """
    points = np.stack(np.meshgrid(*centres), axis=-1)
    found = []
    for flight in flights:
        both = flight.contains(points) & standable[flight.lower] & standable[flight.upper]
        cells = np.argwhere(both).tolist()
        found.append([Link((flight.lower, y, x), (flight.upper, y, x), NOTHING) for y, x in cells])
    return found
