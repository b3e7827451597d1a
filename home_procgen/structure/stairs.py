"""U-shaped stairs: two parallel flights with a landing between them."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Family, slots, variant
from home_procgen.primitives.solids import Solid, box, move, rotate

# [m], dimensions of the model; instances are stretched to the storey height and the stairwell.
RISE, RUN, WIDTH, LANDING = 2.8, 0.26, 2.06, 1.0
STEPS = 8  # risers per flight, including those to the landing and to the upper floor
GAP = 0.08  # [m], between the flights
LENGTH = (STEPS - 1) * RUN + LANDING  # [m], from the front edge to the back of the landing
LANE = (WIDTH - GAP) / 2  # [m], width of a flight


def back_stairs(closed: bool, left: bool = False) -> Iterator[Solid]:
    """Generate stairs that go up towards -z at +x and return to the front at -x. The front edge is at z = 0.

    Args:
        closed: Add riser boards between the treads.
        left: Mirror the stairs: up at -x, back at +x.
    """
    rise = RISE / (2 * STEPS)
    yield box("wood", (WIDTH, 0.06, LANDING), (0.0, STEPS * rise - 0.06, -LENGTH + LANDING / 2))
    for side, first in ((1, 0), (-1, STEPS)):
        x = (-side if left else side) * (WIDTH - LANE) / 2
        for i in range(1, STEPS):
            z = -(i - 0.5) * RUN if side > 0 else -(STEPS - 1 - i + 0.5) * RUN
            yield box("wood", (LANE - 0.06, 0.04, RUN + 0.02), (x, (first + i) * rise - 0.04, z))
        for i in range(1, STEPS + 1) if closed else ():
            z = -(i - 1) * RUN - 0.02 if side > 0 else -(STEPS - i) * RUN + 0.02
            yield box("wood_1", (LANE - 0.06, rise - 0.04, 0.015), (x, (first + i - 1) * rise, z))
        yield from _stringers(x, first * rise, side)


def _stringers(x: float, bottom: float, side: int) -> Iterator[Solid]:
    """Generate the two boards that carry a flight."""
    rise = RISE / (2 * STEPS)
    run, climb = (STEPS - 1) * RUN, (STEPS - 1) * rise
    slope = float(np.arctan2(climb, run))
    for edge in (-1, 1):
        board = box("wood_1", (0.04, 0.2, float(np.hypot(run, climb))), (0.0, -0.21, 0.0))
        turned = rotate(board, 0, side * slope)
        yield move(turned, (x + edge * (LANE / 2 - 0.02), bottom + rise + climb / 2, -run / 2))


FAMILIES = (
    Family(
        "stairs",
        "stairs",
        back_stairs,
        slots("wood", "wood_1"),
        tuple(variant(closed=closed, left=left) for left in (False, True) for closed in (True, False)),
        centred=False,
    ),
)
