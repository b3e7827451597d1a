"""Baskets and chests with their contents."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet, loop, star
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, join_loops, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bow_handle, corners, disc


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
    yield revolve("cane", [(0.225, 0.6), (0.22, 0.63), (0.08, 0.67), (0.02, 0.675)], sides=26, steps=2)
    yield bow_handle("leather", 0.05, (0.66, 0.71), 0.0, 0.02, 0.008, 6)


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
    yield rounded_box("bright", (0.7, 0.36, 0.4), (0.0, 0.02, 0.0), 0.02, 2)
    yield rotate(rounded_box("bright_1", (0.72, 0.03, 0.42), (0.0, 0.37, 0.0), 0.012, 1), 0, -1.1, (0.0, 0.38, -0.2))
    for i in range(5):
        yield ball(f"bright_{i}", 0.075, (-0.24 + 0.12 * i, 0.4, 0.05 * (-1) ** i), 12, 8)
    yield ball("fur_coat", 0.08, (0.1, 0.44, -0.06), 14, 8)
    for i in range(2):
        yield prism("yellow", star(0.06, 0.025, 5), 0.01, (-0.18 + 0.36 * i, 0.2, 0.2))


def _crate() -> Iterator[Solid]:
    """Build a slatted crate with rolled blankets."""
    for x, z in corners(0.46, 0.3):
        yield box("wood", (0.03, 0.28, 0.03), (x, 0.0, z))
    for y in (0.02, 0.1, 0.18):
        for s in (-1, 1):
            yield box("wood", (0.52, 0.06, 0.012), (0.0, y, s * 0.172))
            yield box("wood", (0.012, 0.06, 0.332), (s * 0.254, y, 0.0))
    yield box("wood", (0.5, 0.012, 0.33), (0.0, 0.01, 0.0))
    for i in range(3):
        roll = revolve(f"textile_{i}", [(0.06, 0.0), (0.07, 0.02), (0.07, 0.24), (0.06, 0.26)], sides=14, steps=1)
        yield move(rotate(roll, 0, np.pi / 2), ((i - 1) * 0.145, 0.2 + 0.015 * (i % 2), -0.13))


def _wires() -> Iterator[Solid]:
    """Build a wire basket with wooden grips."""
    for y, half in ((0.01, 0.15), (0.11, 0.165), (0.21, 0.18), (0.31, 0.195)):
        outline = fillet([(-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)], 0.05, 3, True)
        yield tube("iron", outline, 0.005, 6, closed=True)
    for i in range(24):
        a = 2 * np.pi * i / 24
        low, high = (np.array([np.cos(a), np.sin(a)]) / max(abs(np.cos(a)), abs(np.sin(a))) * h for h in (0.14, 0.185))
        yield rod("iron", (float(low[0]), 0.01, float(low[1])), (float(high[0]), 0.31, float(high[1])), 0.003, sides=5)
    yield rounded_box("iron", (0.28, 0.008, 0.28), (0.0, 0.0, 0.0), 0.003, 1)
    for s in (-1, 1):
        yield rod("wood", (s * 0.21, 0.34, -0.07), (s * 0.21, 0.34, 0.07), 0.014)
        for z in (-0.06, 0.06):
            yield rod("iron", (s * 0.195, 0.31, z), (s * 0.21, 0.34, z), 0.004)


def _belly() -> Iterator[Solid]:
    """Build a bellied grass basket with two loops and a turned-down rim."""
    shape = [(0.13, 0.0), (0.2, 0.1), (0.21, 0.18), (0.17, 0.3), (0.18, 0.36)]
    yield vessel("cane", shape, 0.01, sides=26, steps=3)
    for y, r in ((0.06, 0.178), (0.14, 0.208), (0.22, 0.206), (0.36, 0.18)):
        yield ring("cane_1", r, 0.014, (0.0, y, 0.0), 1, 30)
    for s in (-1, 1):
        yield tube(
            "cane_1", fillet([(s * 0.18, 0.34, -0.06), (s * 0.2, 0.44, 0.0), (s * 0.18, 0.34, 0.06)], 0.04), 0.009, 8
        )


def _sack() -> Iterator[Solid]:
    """Build a cloth sack in a frame of crossed poles."""
    for z in (-0.17, 0.17):
        for s in (-1, 1):
            yield rod("wood", (-s * 0.2, 0.0, z + 0.012 * s), (s * 0.2, 0.62, z + 0.012 * s), 0.013, sides=8)
        yield disc("brass", 0.012, 0.01, (0.0, 0.31, z - 0.005), 12)
    for s in (-1, 1):
        yield rod("wood", (s * 0.2, 0.62, -0.19), (s * 0.2, 0.62, 0.19), 0.013, sides=8)
    loops = []
    for y, x, z in ((0.12, 0.06, 0.11), (0.15, 0.1, 0.14), (0.3, 0.12, 0.155), (0.5, 0.17, 0.15), (0.62, 0.19, 0.15)):
        loops.append(np.insert(loop(2 * x, 2 * z, 24, 4.0), 1, y, axis=1))
    yield join_loops("linen", loops)
    for i in range(3):
        yield ball(f"textile_{i}", (0.1, 0.05, 0.08), (0.06 * (i - 1), 0.63 + 0.012 * i, 0.05 * (-1) ** i), 12, 6)


_BASKET_KINDS = {
    "laundry": _laundry, "hamper": _hamper, "logs": _logs, "umbrellas": _umbrellas, "chest": _chest,
    "crate": _crate, "wires": _wires, "belly": _belly, "sack": _sack,
}  # fmt: skip


def basket(kind: str = "laundry") -> Iterator[Solid]:
    """Build a basket: laundry, hamper, logs, umbrella stand, toy chest, crate, wire, grass or sack."""
    yield from _BASKET_KINDS[kind]()


KINDS = ("laundry", "hamper", "logs", "umbrellas", "crate", "wires", "belly", "sack")

FAMILIES = (FurnitureFamily("basket", "household_appliance", design_kinds(basket, *KINDS)),)
