"""Bowls with superelliptic plans."""

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import loop
from home_procgen.shapes.rounded import join_loops


def tub(
    slot: str, levels: list[tuple[float, float, float, float]], wall: float = 0.035, power: float = 4.0, sides: int = 36
) -> Solid:
    """Build an open bowl with a superelliptic plan.

    Args:
        slot: Slot name.
        levels: Height, width (x), depth (z) and shift along x of the outer surface, from the bottom up [m].
        wall: Wall thickness [m].
        power: Exponent of the superellipse; 2 is an ellipse, higher is squarer.
        sides: Number of facets around.
    """
    outer = [np.insert(loop(w, d, sides, power) + np.array([x, 0.0]), 1, y, axis=1) for y, w, d, x in levels]
    inner = [
        np.insert(
            loop(w - 2 * wall, d - 2 * wall, sides, power) + np.array([x, 0.0]), 1, max(y, levels[0][0] + wall), axis=1
        )
        for y, w, d, x in levels
    ]
    return join_loops(slot, [*outer, *inner[::-1]])
