"""U-shaped stairs: two parallel flights with a landing between them."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, move, rotate

# [m], dimensions of the model; instances are stretched to the storey height and the stairwell.
RISE, RUN, WIDTH, LANDING = 2.8, 0.26, 2.06, 1.0
RISERS_PER_FLIGHT = 8  # risers per flight, including those to the landing and to the upper floor
FLIGHT_GAP = 0.08  # [m], between the flights
LENGTH = (RISERS_PER_FLIGHT - 1) * RUN + LANDING  # [m], from the front edge to the back of the landing
FLIGHT_WIDTH = (WIDTH - FLIGHT_GAP) / 2  # [m], width of a flight


def u_stairs(closed: bool, left: bool = False) -> Iterator[Solid]:
    """Generate stairs that go up towards -z at +x and return to the front at -x. The front edge is at z = 0.

    Args:
        closed: Add riser boards between the treads.
        left: Mirror the stairs: up at -x, back at +x.
    """
    rise = RISE / (2 * RISERS_PER_FLIGHT)
    yield box("wood", (WIDTH, 0.06, LANDING), (0.0, RISERS_PER_FLIGHT * rise - 0.06, -LENGTH + LANDING / 2))
    for side, first in ((1, 0), (-1, RISERS_PER_FLIGHT)):
        x = (-side if left else side) * (WIDTH - FLIGHT_WIDTH) / 2
        for i in range(1, RISERS_PER_FLIGHT):
            z = -(i - 0.5) * RUN if side > 0 else -(RISERS_PER_FLIGHT - 1 - i + 0.5) * RUN
            yield box("wood", (FLIGHT_WIDTH - 0.06, 0.04, RUN + 0.02), (x, (first + i) * rise - 0.04, z))
        for i in range(1, RISERS_PER_FLIGHT + 1) if closed else ():
            z = -(i - 1) * RUN - 0.02 if side > 0 else -(RISERS_PER_FLIGHT - i) * RUN + 0.02
            yield box("wood_1", (FLIGHT_WIDTH - 0.06, rise - 0.04, 0.015), (x, (first + i - 1) * rise, z))
        yield from _stringers(x, first * rise, side)


def _stringers(x: float, bottom: float, side: int) -> Iterator[Solid]:
    """Generate the two boards that carry a flight."""
    rise = RISE / (2 * RISERS_PER_FLIGHT)
    run, climb = (RISERS_PER_FLIGHT - 1) * RUN, (RISERS_PER_FLIGHT - 1) * rise
    slope = float(np.arctan2(climb, run))
    for edge in (-1, 1):
        board = box("wood_1", (0.04, 0.2, float(np.hypot(run, climb))), (0.0, -0.21, 0.0))
        turned = rotate(board, 0, side * slope)
        yield move(turned, (x + edge * (FLIGHT_WIDTH / 2 - 0.02), bottom + rise + climb / 2, -run / 2))


FAMILIES = (
    VariantFamily(
        "stairs",
        "stairs",
        u_stairs,
        make_slots("wood", "wood_1"),
        tuple(make_variant(closed=closed, left=left) for left in (False, True) for closed in (True, False)),
        centred=False,
    ),
)
