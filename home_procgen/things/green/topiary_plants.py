"""Topiary, bamboo, bonsai and herbs."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.green.pots import GOLDEN_ANGLE, pot


def topiary(kind: str = "square", balls: int = 2) -> Iterator[Solid]:
    """Build clipped balls of small leaves on a stem."""
    yield from pot(kind, 0.16, 0.3)
    yield rod("bark", (0.0, 0.25, 0.0), (0.0, 0.6 + 0.36 * balls, 0.0), 0.018)
    for k in range(balls):
        radius, y = 0.2 - 0.045 * k, 0.62 + 0.38 * k
        yield ball("leaf_1", 0.93 * radius, (0.0, y, 0.0), 14, 9)
        for i in range(90 - 25 * k):
            t = 1 - 2 * (i + 0.5) / (90 - 25 * k)
            r = np.sqrt(1 - t * t)
            a = GOLDEN_ANGLE * i
            yield leaf(
                "leaf",
                0.07,
                0.045,
                (0.88 * radius * r * np.sin(a), y + 0.88 * radius * t, 0.88 * radius * r * np.cos(a)),
                a,
                float(np.arcsin(t)),
                0.3,
                pieces=2,
            )


def bamboo(kind: str = "cylinder") -> Iterator[Solid]:
    """Build jointed bamboo canes in a pot of stones."""
    yield from pot(kind, 0.14, 0.3)
    for i in range(7):
        a, r = GOLDEN_ANGLE * i, 0.03 * np.sqrt(i)
        x, z, top = r * np.cos(a), r * np.sin(a), 1.5 - 0.12 * i
        yield rod("leaf_1", (x, 0.26, z), (1.5 * x, top, 1.5 * z), 0.012, 0.009)
        for k in range(4):
            y = 0.45 + 0.25 * k
            if y < top:
                yield cylinder(
                    "leaf_1",
                    0.015,
                    0.012,
                    (x * (1 + 0.5 * (y - 0.26) / (top - 0.26)), y, z * (1 + 0.5 * (y - 0.26) / (top - 0.26))),
                    sides=8,
                )
        for k in range(7):
            y = top - 0.09 * k
            yield leaf("leaf", 0.24, 0.035, (1.5 * x, y, 1.5 * z), GOLDEN_ANGLE * (i + 5 * k), 0.5, 1.0, 0.8, 3)


def herbs() -> Iterator[Solid]:
    """Build three small pots of herbs on a tray."""
    yield rounded_box("wood", (0.42, 0.02, 0.15), (0.0, 0.0, 0.0), 0.006, 1)
    for k in range(3):
        x = (k - 1) * 0.13
        yield revolve("terracotta", [(0.04, 0.02), (0.052, 0.1), (0.058, 0.1), (0.058, 0.115)], (x, 0.0, 0.0), 16, 1)
        for i in range(16):
            a, r = GOLDEN_ANGLE * i, 0.011 * np.sqrt(i)
            wide = (0.012, 0.035, 0.02)[k]
            yield leaf("leaf", 0.11 - 0.01 * k, wide, (x + r * np.cos(a), 0.11, r * np.sin(a)), a, 1.2, 0.8, pieces=3)


def bonsai() -> Iterator[Solid]:
    """Build a small bent tree with flat clouds of leaves in a dish."""
    yield rounded_box("glaze", (0.3, 0.06, 0.2), (0.0, 0.0, 0.0), 0.015, 2)
    yield rounded_box("soil", (0.26, 0.02, 0.16), (0.0, 0.05, 0.0), 0.01, 2)
    yield tube(
        "bark",
        spline([(-0.04, 0.06, 0.0), (0.02, 0.13, 0.0), (-0.04, 0.2, 0.02), (0.05, 0.28, 0.0)], 4),
        np.linspace(0.024, 0.008, 13),
        8,
    )
    for x, y, z, r in ((0.05, 0.31, 0.0, 0.085), (-0.11, 0.23, 0.02, 0.065), (0.12, 0.2, -0.02, 0.055)):
        yield rod("bark", (0.0, y - 0.05, 0.0), (x, y, z), 0.007)
        yield ball("leaf_1", (r, 0.4 * r, 0.8 * r), (x, y, z), 12, 6)
        for i in range(30):
            a, d = GOLDEN_ANGLE * i, r * np.sqrt(i / 30)
            yield leaf(
                "leaf",
                0.03,
                0.02,
                (x + d * np.cos(a), y + 0.35 * r * (1 - i / 40), z + 0.8 * d * np.sin(a)),
                a,
                0.7,
                0.4,
                pieces=2,
            )
