"""Bowls of any outline."""

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import loop
from home_procgen.shapes.rounded import between_loops


def tub(
    slot: str, levels: list[tuple[float, float, float, float]], wall: float = 0.035, power: float = 4.0, sides: int = 36
) -> Solid:
    """An open hollow of oval plan.

    Args:
        slot: Slot name.
        levels: Height, width (x), depth (z), shift along x of the outside, from the bottom up [m].
        wall: Thickness [m].
        power: Squareness of the plan, 2 is an ellipse.
        sides: Facets around.
    """
    outer = [np.insert(loop(w, d, sides, power) + np.array([x, 0.0]), 1, y, axis=1) for y, w, d, x in levels]
    inner = [
        np.insert(
            loop(w - 2 * wall, d - 2 * wall, sides, power) + np.array([x, 0.0]), 1, max(y, levels[0][0] + wall), axis=1
        )
        for y, w, d, x in levels
    ]
    return between_loops(slot, [*outer, *inner[::-1]])
