"""Balls, rings, xylophones, robots, playpens."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import beam, ring, rod, tube
from home_procgen.things.joinery import disc


def _ball() -> Iterator[Solid]:
    yield ball("bright", 0.11, (0.0, 0.11, 0.0), 24, 14)
    for a in range(3):
        yield ring("white", 0.1095, 0.006, (0.0, 0.11, 0.0), a, 30)


def _rings() -> Iterator[Solid]:
    yield revolve("wood", [(0.09, 0.0), (0.09, 0.015), (0.02, 0.02)], sides=22, steps=1)
    yield rod("wood", (0.0, 0.01, 0.0), (0.0, 0.23, 0.0), 0.012)
    for i in range(5):
        yield ring(f"bright_{i}", 0.058 - 0.006 * i, 0.038, (0.0, 0.038 + 0.037 * i, 0.0), 1, 22)
    yield ball("bright", 0.022, (0.0, 0.235, 0.0), 12, 8)


def _xylophone() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (-0.17, 0.02, s * 0.07), (0.17, 0.02, s * 0.035), 0.02, 0.03)
    for i in range(8):
        yield rounded_box(f"bright_{i % 6}", (0.034, 0.012, 0.2 - 0.013 * i), (-0.15 + 0.043 * i, 0.036, 0.0), 0.004, 1)
    yield rod("wood", (-0.1, 0.056, 0.05), (0.1, 0.056, -0.01), 0.004, sides=6)
    yield ball("bright_2", 0.014, (0.1, 0.06, -0.01), 10, 6)


def _robot() -> Iterator[Solid]:
    yield rounded_box("bright", (0.14, 0.15, 0.09), (0.0, 0.1, 0.0), 0.015, 2)
    yield rounded_box("gray", (0.11, 0.09, 0.08), (0.0, 0.265, 0.0), 0.015, 2)
    for s in (-1, 1):
        yield rounded_box("gray", (0.045, 0.1, 0.06), (s * 0.035, 0.01, 0.0), 0.008, 1)
        yield rounded_box("black", (0.055, 0.025, 0.09), (s * 0.037, 0.0, 0.01), 0.008, 1)
        yield tube("gray", [(s * 0.075, 0.22, 0.0), (s * 0.11, 0.19, 0.0), (s * 0.11, 0.11, 0.03)], 0.016, 8)
        yield disc("yellow", 0.016, 0.012, (s * 0.024, 0.315, 0.036), 14)
    yield rod("chrome", (0.0, 0.355, 0.0), (0.0, 0.4, 0.0), 0.003, sides=5)
    yield ball("red", 0.012, (0.0, 0.405, 0.0), 10, 6)
    for i in range(3):
        yield disc(f"bright_{i}", 0.012, 0.008, (-0.035 + 0.035 * i, 0.15, 0.043), 12)


def _playpen() -> Iterator[Solid]:
    for i in range(8):
        a, b = 2 * np.pi * i / 8, 2 * np.pi * (i + 1) / 8
        p, q = ((0.62 * np.cos(t), 0.0, 0.62 * np.sin(t)) for t in (a, b))
        yield rod("wood", p, (p[0], 0.62, p[2]), 0.018)
        yield beam("wood", (p[0], 0.6, p[2]), (q[0], 0.6, q[2]), 0.03)
        yield beam("wood", (p[0], 0.05, p[2]), (q[0], 0.05, q[2]), 0.03)
        for k in range(1, 5):
            t = k / 5
            x, z = p[0] * (1 - t) + q[0] * t, p[2] * (1 - t) + q[2] * t
            yield rod("wood", (x, 0.06, z), (x, 0.59, z), 0.007, sides=6)
    yield cylinder("textile", 0.56, 0.04, sides=8)
    for i in range(16):
        r = 0.11 * np.sqrt(i)
        yield ball(f"bright_{i % 5}", 0.045, (r * np.cos(2.4 * i), 0.085, r * np.sin(2.4 * i)), 10, 6)


_BALL_PIT_KINDS = {
    "ball": _ball,
    "rings": _rings,
    "xylophone": _xylophone,
    "robot": _robot,
    "playpen": _playpen,
}


def ball_pit(kind: str = "ball") -> Iterator[Solid]:
    """Build a ball, stacking rings, a xylophone, a robot or a playpen full of balls."""
    yield from _BALL_PIT_KINDS[kind]()
