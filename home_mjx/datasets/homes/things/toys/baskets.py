"""Baskets, chests and what they hold."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, star
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, kinds_of
from home_mjx.datasets.homes.things.joinery import bow
from home_mjx.datasets.procedural.primitives.solids import Solid, rotate


def _laundry() -> Iterator[Solid]:
    yield vessel("white", [(0.2, 0.0), (0.25, 0.28)], 0.008, sides=26, steps=1, stretch=0.75)
    for y in (0.08, 0.16, 0.24):
        for i in range(16):
            a = 2 * np.pi * i / 16
            r = 0.205 + 0.05 * y / 0.28
            yield ball("gray", (0.02, 0.012, 0.012), (r * np.cos(a), y, 0.75 * r * np.sin(a)), 6, 4)
    for i in range(5):
        yield ball(
            f"textile_{i}",
            (0.1, 0.06, 0.08),
            (0.09 * np.cos(2.4 * i), 0.26 + 0.012 * i, 0.07 * np.sin(2.4 * i)),
            10,
            6,
        )


def _hamper() -> Iterator[Solid]:
    yield vessel("cane", [(0.2, 0.0), (0.23, 0.3), (0.21, 0.6)], 0.012, sides=26, steps=2)
    yield turned("cane", [(0.225, 0.6), (0.22, 0.63), (0.08, 0.67), (0.02, 0.675)], sides=26, steps=2)
    yield bow("leather", 0.05, (0.66, 0.71), 0.0, 0.02, 0.008, 6)


def _logs() -> Iterator[Solid]:
    yield tube(
        "iron", fillet([(-0.22, 0.4, 0.0), (-0.2, 0.03, 0.0), (0.2, 0.03, 0.0), (0.22, 0.4, 0.0)], 0.06), 0.012, 6
    )
    for z in (-0.12, 0.12):
        yield tube("iron", fillet([(-0.22, 0.4, z), (-0.2, 0.012, z), (0.2, 0.012, z), (0.22, 0.4, z)], 0.06), 0.012, 6)
    for row in range(3):
        for i in range(4 - row % 2):
            x = (i - (3 - row % 2) / 2) * 0.095
            yield rod("bark", (x, 0.085 + 0.085 * row, -0.2), (x, 0.085 + 0.085 * row, 0.2), 0.045, sides=9)
            yield rod("cream", (x, 0.085 + 0.085 * row, -0.202), (x, 0.085 + 0.085 * row, 0.202), 0.036, sides=9)


def _umbrellas() -> Iterator[Solid]:
    yield vessel("glaze", [(0.11, 0.0), (0.12, 0.05), (0.11, 0.45), (0.125, 0.5)], 0.008, sides=24, steps=2)
    for k, (x, z) in enumerate(((-0.04, 0.03), (0.05, 0.0), (0.0, -0.05))):
        yield tube(
            f"bright_{k}",
            [(0.3 * x, 0.03, 0.3 * z), (x, 0.3, z), (1.4 * x, 0.62, 1.4 * z)],
            [0.008, 0.035, 0.03],
            8,
        )
        yield tube(
            "wood",
            fillet(
                [
                    (1.4 * x, 0.6, 1.4 * z),
                    (1.7 * x, 0.84, 1.7 * z),
                    (1.7 * x + 0.07, 0.86, 1.7 * z),
                    (1.7 * x + 0.075, 0.78, 1.7 * z),
                ],
                0.04,
            ),
            0.009,
            8,
        )


def _chest() -> Iterator[Solid]:
    yield rounded("bright", (0.7, 0.36, 0.4), (0.0, 0.02, 0.0), 0.02, 2)
    yield rotate(rounded("bright_1", (0.72, 0.03, 0.42), (0.0, 0.37, 0.0), 0.012, 1), 0, -1.1, (0.0, 0.38, -0.2))
    for i in range(5):
        yield ball(f"bright_{i}", 0.075, (-0.24 + 0.12 * i, 0.4, 0.05 * (-1) ** i), 12, 8)
    yield ball("fur_coat", 0.08, (0.1, 0.44, -0.06), 14, 8)
    for i in range(2):
        yield prism("yellow", star(0.06, 0.025, 5), 0.01, (-0.18 + 0.36 * i, 0.2, 0.2))


_BASKET_KINDS = {
    "laundry": _laundry,
    "hamper": _hamper,
    "logs": _logs,
    "umbrellas": _umbrellas,
    "chest": _chest,
}


def basket(kind: str = "laundry") -> Iterator[Solid]:
    """A laundry basket full of clothes, a log basket, a toy chest, an umbrella stand, a box of papers."""
    yield from _BASKET_KINDS[kind]()


FAMILIES = (Family("basket", "household_appliance", kinds_of(basket, "laundry", "hamper", "logs", "umbrellas")),)
