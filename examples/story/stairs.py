"""Models of stairs and railings, for houses of several storeys."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate

STEPS, RISE, RUN, WIDTH = 15, 2.8, 0.26, 1.0  # risers; [m] from floor to floor; [m] a tread; [m]
LENGTH = (STEPS - 1) * RUN  # [m], of the flight without its last tread, which is the upper floor
RAIL = 0.95  # [m], height of a railing


def flight(steps: int, rise: float, run: float, width: float) -> Iterator[Solid]:
    """Open treads between two stringers, up along +x.

    Args:
        steps: Number of risers; the last one leads onto the upper floor.
        rise: From floor to floor [m].
        run: Depth of a tread [m].
        width: [m].
    """
    step = rise / steps
    for i in range(1, steps):
        yield box("wood", (run + 0.03, 0.04, width - 0.06), ((i - 0.5) * run - 0.015, i * step - 0.04, 0.0))
    slope, middle = np.arctan2(step, run), ((steps - 1) * run / 2, steps * step / 2, 0.0)
    for side in (-1, 1):
        length = (steps - 1) * run / np.cos(slope)
        board = box("wood_1", (length, 0.2, 0.04), (0.0, -0.2, side * (width / 2 - 0.02)))
        yield move(rotate(board, 2, slope), middle)


def banister(steps: int, rise: float, run: float) -> Iterator[Solid]:
    """A handrail on posts beside a flight, up along +x."""
    step = rise / steps
    for i in range(1, steps, 2):
        yield cylinder("chrome", 0.012, RAIL + step / 2, ((i - 0.5) * run, (i - 0.5) * step, 0.0), sides=6)
    slope, length = np.arctan2(step, run), (steps - 1) * np.hypot(run, step)
    rail = rotate(box("wood", (length, 0.05, 0.05), (0.0, 0.0, 0.0)), 2, slope)
    yield move(rail, ((steps - 1) * run / 2, (steps - 1) * step / 2 + RAIL, 0.0))


def railing(length: float) -> Iterator[Solid]:
    """A straight railing of thin bars along x."""
    yield box("wood", (length, 0.05, 0.05), (0.0, RAIL - 0.05, 0.0))
    yield box("wood", (length, 0.12, 0.04), (0.0, -0.1, 0.0))
    count = round(length / 0.16)
    for i in range(count + 1):
        x = (i / count - 0.5) * (length - 0.04)
        yield cylinder("chrome", 0.008, RAIL - 0.06, (x, 0.01, 0.0), sides=6)


FAMILIES = (
    VariantFamily(
        "stairs",
        "stairs",
        flight,
        make_slots("wood", "wood_1"),
        (make_variant(steps=STEPS, rise=RISE, run=RUN, width=WIDTH),),
        centred=False,
    ),
    VariantFamily(
        "banister",
        "fence",
        banister,
        make_slots("wood", "chrome"),
        (make_variant(steps=STEPS, rise=RISE, run=RUN),),
        centred=False,
    ),
    VariantFamily(
        "railing", "fence", railing, make_slots("wood", "chrome"), (make_variant(length=4.7),), centred=False
    ),
)
