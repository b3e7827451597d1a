"""Fruit in bowls."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball
from home_procgen.shapes.sweep import ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds


def fruit(kind: str = "bowl") -> Iterator[Solid]:
    """Build fruit in a bowl, in a basket, on a stand or in a wire bowl."""
    low = {"bowl": 0.02, "basket": 0.03, "stand": 0.17, "wire": 0.03}[kind]
    if kind == "bowl":
        yield vessel("glaze", [(0.06, 0.0), (0.065, 0.01), (0.12, 0.04), (0.15, 0.085)], 0.006, sides=28, steps=3)
    elif kind == "basket":
        yield vessel("cane", [(0.1, 0.0), (0.13, 0.04), (0.15, 0.09)], 0.01, sides=24, steps=2)
        yield tube(
            "cane", [(0.145 * np.cos(a), 0.08 + 0.16 * np.sin(a), 0.0) for a in np.linspace(0, np.pi, 13)], 0.008
        )
    elif kind == "stand":
        yield revolve("wood", [(0.09, 0.0), (0.03, 0.02), (0.02, 0.08), (0.04, 0.15)], sides=20, steps=3)
        yield vessel("wood", [(0.05, 0.145), (0.14, 0.16), (0.16, 0.19)], 0.008, sides=28, steps=2)
    else:
        for y, r in ((0.005, 0.07), (0.04, 0.12), (0.085, 0.15)):
            yield ring("iron", r, 0.008, (0.0, y, 0.0), 1, 24)
        for i in range(14):
            a = 2 * np.pi * i / 14
            c, s = np.cos(a), np.sin(a)
            yield tube("iron", [(r * c, y, r * s) for y, r in ((0.005, 0.07), (0.04, 0.12), (0.085, 0.15))], 0.003, 5)
        yield cylinder("iron", 0.07, 0.006, (0.0, 0.002, 0.0), sides=24)
    spots = (
        (0.0, 0.0, "red"),
        (0.075, 0.02, "orange"),
        (-0.07, 0.03, "orange"),
        (0.01, -0.075, "green"),
        (0.0, 0.08, "red"),
    )
    for i, (x, z, slot) in enumerate(spots):
        yield ball(slot, (0.04, 0.038, 0.04), (x, low + 0.042 + 0.5 * abs(x), z), 14, 8)
        yield rod(
            "brown", (x, low + 0.076 + 0.5 * abs(x), z), (x + 0.005, low + 0.092 + 0.5 * abs(x), z), 0.002, sides=5
        )
        if i < 2:
            yield ball(slot if i else "green", 0.037, (0.03 - 0.06 * i, low + 0.1, 0.03 - 0.05 * i), 14, 8)
    for i in range(3):
        path = [
            (0.1 * np.cos(a) - 0.03, low + 0.09 + 0.012 * i + 0.02 * np.sin(3 * a), 0.1 * np.sin(a) - 0.02 + 0.02 * i)
            for a in np.linspace(0.5, 2.2, 7)
        ]
        yield tube("yellow", path, [0.006, 0.015, 0.018, 0.018, 0.018, 0.014, 0.005], 8)


FAMILIES = (FurnitureFamily("fruit_bowl", "fruit_bowl", design_kinds(fruit, "bowl", "basket", "stand", "wire")),)
