"""Flowering plants, cacti and succulents."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import spline
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import rod, sweep, tube
from home_procgen.things.green.pots import GOLDEN_ANGLE, pot


def cactus(kind: str = "clay", arms: int = 2) -> Iterator[Solid]:
    """Build a ribbed cactus, as a ball or as a column with arms and a flower."""
    yield from pot(kind, 0.09, 0.14)
    angle = 2 * np.pi * np.arange(24) / 24
    section = np.stack([np.cos(angle), np.sin(angle)], -1) * (1 + 0.13 * (np.arange(24) % 2 * 2 - 1))[:, None]
    if arms:
        yield sweep(
            "leaf",
            [(0.0, y, 0.0) for y in (0.11, 0.2, 0.4, 0.5, 0.54, 0.56)],
            section * 0.055,
            [0.9, 1.0, 1.0, 0.85, 0.5, 0.12],
        )
        for s in (-1, 1)[:arms]:
            path = spline(
                [
                    (s * 0.03, 0.24 + 0.04 * s, 0.0),
                    (s * 0.11, 0.26 + 0.04 * s, 0.0),
                    (s * 0.13, 0.36, 0.0),
                    (s * 0.13, 0.43, 0.0),
                ],
                3,
            )
            yield tube("leaf", path, [0.03] * (len(path) - 2) + [0.024, 0.008], 10)
    else:
        yield sweep(
            "leaf", [(0.0, y, 0.0) for y in (0.11, 0.14, 0.19, 0.23, 0.25)], section * 0.09, [0.6, 0.95, 1.0, 0.6, 0.1]
        )
    for i in range(6):
        yield leaf("petal", 0.035, 0.02, (0.0, 0.555 if arms else 0.245, 0.0), i * np.pi / 3, 1.0, 0.8, pieces=2)


def succulents() -> Iterator[Solid]:
    """Build three succulent rosettes in a long trough."""
    yield rounded_box("concrete", (0.34, 0.09, 0.12), (0.0, 0.0, 0.0), 0.012, 2)
    yield box("soil", (0.3, 0.006, 0.09), (0.0, 0.088, 0.0))
    for k in range(3):
        for i in range(18):
            yield leaf(
                f"leaf_{k}",
                0.06 - 0.0018 * i,
                0.024,
                ((k - 1) * 0.1, 0.09 + 0.001 * i, 0.0),
                GOLDEN_ANGLE * i,
                0.3 + 0.065 * i,
                0.3,
                1.4,
                2,
            )


def orchid(kind: str = "cylinder", stems: int = 2) -> Iterator[Solid]:
    """Build an orchid with bent stems and flowers above broad leaves."""
    yield from pot(kind, 0.07, 0.12)
    for i in range(6):
        yield leaf("leaf", 0.2, 0.06, (0.0, 0.1, 0.0), GOLDEN_ANGLE * i, 0.6, 1.0, 1.2, 4)
    for k in range(stems):
        s = (-1) ** k
        path = spline([(0.0, 0.1, 0.0), (0.02 * s, 0.36, 0.02), (0.08 * s, 0.48, 0.05), (0.2 * s, 0.46, 0.1)], 4)
        yield tube("leaf", path, 0.004, 5)
        for j in range(5):
            at = path[-1 - j]
            for p in range(5):
                yield leaf(
                    "petal",
                    0.035,
                    0.028,
                    (float(at[0]), float(at[1]), float(at[2]) + 0.004),
                    2 * np.pi * p / 5,
                    0.25,
                    0.2,
                    1.1,
                    2,
                )
            yield ball("yellow", 0.007, (float(at[0]), float(at[1]) + 0.008, float(at[2]) + 0.004), 8, 4)


def flowers(kind: str = "round", count: int = 14) -> Iterator[Solid]:
    """Build a bush of flowers in a pot."""
    yield from pot(kind, 0.11, 0.17)
    for i in range(count):
        a, r = GOLDEN_ANGLE * i, 0.035 * np.sqrt(i)
        x, z, y = r * np.cos(a), r * np.sin(a), 0.34 - 0.5 * r
        yield rod("leaf", (0.3 * x, 0.14, 0.3 * z), (x, y, z), 0.003, sides=4)
        yield leaf("leaf", 0.11, 0.05, (0.4 * x, 0.18, 0.4 * z), a + 0.7, 0.8, 0.9, pieces=3)
        for p in range(6):
            yield leaf("petal", 0.038, 0.024, (x, y, z), 2 * np.pi * p / 6, 0.5, 0.4, 1.2, 2)
        yield ball("yellow", 0.01, (x, y + 0.008, z), 8, 4)
