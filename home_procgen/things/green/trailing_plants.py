"""Hanging and trailing plants."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, move
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.green.pots import GOLDEN_ANGLE, pot


def hanging(kind: str = "round") -> Iterator[Solid]:
    """Build trailing vines in a pot on cords, for a ceiling."""
    for piece in pot(kind, 0.14, 0.2):
        yield move(piece, (0.0, 0.62, 0.0))
    for i in range(4):
        a = 2 * np.pi * i / 4
        yield rod("cream", (0.13 * np.cos(a), 0.78, 0.13 * np.sin(a)), (0.0, 1.3, 0.0), 0.004, sides=5)
    for i in range(9):
        a = GOLDEN_ANGLE * i
        c, s = np.cos(a), np.sin(a)
        drop = 0.62 - 0.06 * (i % 5)
        path = spline(
            [
                (0.08 * c, 0.8, 0.08 * s),
                (0.17 * c, 0.82, 0.17 * s),
                (0.2 * c, 0.6, 0.2 * s),
                (0.19 * c, 0.8 - drop, 0.19 * s),
            ],
            3,
        )
        yield tube("leaf", path, 0.004, 4)
        for k, at in enumerate(path[1:]):
            yield leaf(
                "leaf", 0.075, 0.05, (float(at[0]), float(at[1]), float(at[2])), a + 1.4 * (-1) ** k, 0.1, 1.3, 0.8, 2
            )


def trailing(kind: str = "cylinder") -> Iterator[Solid]:
    """Build vines that hang over the rim of a pot on a stand."""
    yield revolve("wood", [(0.14, 0.0), (0.03, 0.03), (0.025, 0.5), (0.13, 0.53), (0.13, 0.55)], sides=18, steps=1)
    for piece in pot(kind, 0.12, 0.18):
        yield move(piece, (0.0, 0.55, 0.0))
    for i in range(10):
        a = GOLDEN_ANGLE * i
        c, s = np.cos(a), np.sin(a)
        path = spline(
            [
                (0.06 * c, 0.7, 0.06 * s),
                (0.15 * c, 0.76, 0.15 * s),
                (0.19 * c, 0.55, 0.19 * s),
                (0.19 * c, 0.25 + 0.04 * (i % 4), 0.19 * s),
            ],
            3,
        )
        for k, at in enumerate(path):
            yield leaf(
                "leaf", 0.09, 0.055, (float(at[0]), float(at[1]), float(at[2])), a + 1.2 * (-1) ** k, 0.2, 1.2, 0.8, 2
            )
