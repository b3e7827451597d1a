"""Gym equipment."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import corners
from home_procgen.things.leisure.machines import bike, cross, rower, treadmill


def _bench() -> Iterator[Solid]:
    yield rounded_box("black", (0.28, 0.07, 1.15), (0.0, 0.4, 0.05), 0.03, 2)
    for z in (-0.4, 0.5):
        yield beam("gray", (-0.25, 0.025, z), (0.25, 0.025, z), 0.05)
        yield beam("gray", (0.0, 0.02, z), (0.0, 0.41, z), 0.06)
    for s in (-1, 1):
        yield beam("gray", (s * 0.5, 0.02, -0.42), (s * 0.5, 1.0, -0.42), 0.06)
        yield beam("gray", (s * 0.5, 0.025, -0.7), (s * 0.5, 0.025, -0.15), 0.05)
        yield rounded_box("gray", (0.05, 0.05, 0.14), (s * 0.5, 0.97, -0.38), 0.01, 1)
        for k, r in enumerate((0.2, 0.16)):
            plate = rotate(revolve("iron", [(r, -0.02), (r, 0.02), (0.7 * r, 0.03)], sides=26, steps=1), 2, np.pi / 2)
            yield move(plate, (s * (0.72 + 0.06 * k), 1.04, -0.36))
    yield beam("gray", (-0.5, 0.2, -0.42), (0.5, 0.2, -0.42), 0.04)
    yield rod("chrome", (-0.95, 1.04, -0.36), (0.95, 1.04, -0.36), 0.014, sides=10)


def _dumbbells() -> Iterator[Solid]:
    for s in (-1, 1):
        yield prism(
            "gray",
            [(-0.25, 0.0), (0.25, 0.0), (0.2, 0.05), (-0.02, 0.85), (-0.12, 0.85), (-0.2, 0.05)],
            0.05,
            (s * 0.55, 0.0, 0.0),
            "side",
        )
    for row in range(3):
        y, z = 0.16 + 0.26 * row, 0.14 - 0.09 * row
        for dz in (-0.06, 0.06):
            yield beam("gray", (-0.54, y, z + dz), (0.54, y, z + dz), 0.04, 0.02)
        for i in range(5):
            x, r = (i - 2) * 0.2, 0.075 - 0.012 * row
            yield rod("chrome", (x, y + 0.05, z - 0.1), (x, y + 0.05, z + 0.1), 0.014)
            for dz in (-0.08, 0.08):
                yield rod(
                    "rubber",
                    (x, y + 0.02 + r * 0.6, z + dz - 0.035),
                    (x, y + 0.02 + r * 0.6, z + dz + 0.035),
                    r,
                    sides=6,
                )


def _mat() -> Iterator[Solid]:
    yield rounded_box("bright", (0.6, 0.012, 1.75), (0.0, 0.0, 0.0), 0.005, 2)
    yield tube("bright_1", [(0.5, 0.09, -0.3), (0.5, 0.09, 0.3)], 0.09, 18)
    yield ball("bright_2", 0.32, (-0.6, 0.32, -0.3), 26, 16)
    for z in (0.5, 0.66):
        yield rod("black", (0.4, 0.035, z), (0.62, 0.035, z), 0.012)
        for x in (0.4, 0.62):
            yield rod("rubber", (x - 0.03, 0.04, z), (x + 0.03, 0.04, z), 0.045, sides=6)


def _bag() -> Iterator[Solid]:
    yield beam("black", (-0.5, 0.03, -0.6), (0.5, 0.03, -0.6), 0.08, 0.06)
    yield beam("black", (0.0, 0.03, -0.7), (0.0, 0.03, 0.5), 0.08, 0.06)
    yield beam("black", (0.0, 0.03, -0.6), (0.0, 2.15, -0.6), 0.08)
    yield beam("black", (0.0, 2.12, -0.63), (0.0, 2.12, 0.1), 0.07)
    yield beam("black", (0.0, 1.75, -0.6), (0.0, 2.1, -0.25), 0.05)
    yield revolve("red", [(0.12, 0.62), (0.17, 0.66), (0.17, 1.68), (0.12, 1.72)], (0.0, 0.0, 0.06), 24, 1)
    for y in (0.75, 1.6):
        yield ring("black", 0.168, 0.02, (0.0, y, 0.06), 1, 24)
    for i in range(4):
        a = 2 * np.pi * i / 4
        yield rod("chrome", (0.13 * np.cos(a), 1.71, 0.06 + 0.13 * np.sin(a)), (0.0, 2.0, 0.06), 0.005, sides=5)
    yield rod("chrome", (0.0, 2.0, 0.06), (0.0, 2.1, 0.06), 0.008)


def _rack() -> Iterator[Solid]:
    for x, z in corners(1.1, 1.1):
        yield beam("iron", (x, 0.0, z), (x, 2.1, z), 0.06)
    for y in (0.04, 2.07):
        for s in (-1, 1):
            yield beam("iron", (s * 0.55, y, -0.55), (s * 0.55, y, 0.55), 0.055)
            yield beam("iron", (-0.55, y, -0.55 if y < 1 else s * 0.55), (0.55, y, -0.55 if y < 1 else s * 0.55), 0.05)
    yield rod("chrome", (-0.55, 1.95, 0.3), (0.55, 1.95, 0.3), 0.016)
    yield rod("chrome", (-1.05, 1.25, 0.6), (1.05, 1.25, 0.6), 0.014, sides=10)
    for s in (-1, 1):
        yield rounded_box("iron", (0.06, 0.08, 0.12), (s * 0.55, 1.19, 0.6), 0.01, 1)
        for k, r in enumerate((0.22, 0.22, 0.15)):
            yield move(
                rotate(revolve("rubber", [(r, -0.018), (r, 0.018), (0.6 * r, 0.026)], sides=26, steps=1), 2, np.pi / 2),
                (s * (0.8 + 0.05 * k), 1.25, 0.6),
            )


def _kettlebells() -> Iterator[Solid]:
    for i in range(4):
        x, r = (i - 1.5) * 0.28, 0.085 + 0.014 * i
        yield ball("iron", r, (x, r, 0.0), 18, 12)
        yield cylinder("iron", 0.7 * r, 0.012, (x, 0.0, 0.0), sides=16)
        yield tube(
            "iron",
            fillet(
                [
                    (x - 0.05, 1.7 * r, 0.0),
                    (x - 0.065, 1.9 * r + 0.08, 0.0),
                    (x + 0.065, 1.9 * r + 0.08, 0.0),
                    (x + 0.05, 1.7 * r, 0.0),
                ],
                0.04,
                4,
            ),
            0.014,
            8,
        )


_GYM_KINDS = {
    "treadmill": treadmill,
    "bench": _bench,
    "bike": bike,
    "rower": rower,
    "dumbbells": _dumbbells,
    "mat": _mat,
    "bag": _bag,
    "cross": cross,
    "rack": _rack,
    "kettlebells": _kettlebells,
}


def gym(kind: str = "treadmill") -> Iterator[Solid]:
    """Build gym equipment: a treadmill, bench, bike, rower, cross trainer, punch bag, mat, weights or a rack."""
    yield from _GYM_KINDS[kind]()


FAMILIES = (
    FurnitureFamily(
        "gym",
        "gym_equipment",
        design_kinds(
            gym, "treadmill", "bench", "bike", "rower", "dumbbells", "mat", "bag", "cross", "rack", "kettlebells"
        ),
    ),
)
