"""Knives, chopping boards, utensils."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds


def knives(kind: str = "block") -> Iterator[Solid]:
    """Build knives in a block, on a magnet bar or in a holder."""
    if kind == "bar":
        yield rounded_box("wood", (0.42, 0.05, 0.02), (0.0, 0.2, -0.02), 0.005, 1)
        for i in range(5):
            x, long = -0.16 + 0.08 * i, 0.2 - 0.025 * i
            yield prism(
                "steel",
                [(x - 0.018, 0.25), (x + 0.014, 0.25), (x + 0.012, 0.25 - 0.6 * long), (x - 0.016, 0.25 - long)],
                0.003,
                (0.0, 0.0, -0.008),
            )
            yield rounded_box("black", (0.024, 0.11, 0.016), (x, 0.25, -0.008), 0.006, 2)
        return
    if kind == "block":
        yield prism(
            "wood", [(-0.1, 0.0), (0.1, 0.0), (0.1, 0.05), (-0.02, 0.23), (-0.1, 0.18)], 0.11, (0.0, 0.0, 0.0), "side"
        )
    else:
        yield rounded_box("bright", (0.16, 0.2, 0.09), (0.0, 0.0, 0.0), 0.02, 3)
    for row in range(2):
        for i in range(3):
            x, z, y = (i - 1) * 0.034, 0.02 - 0.055 * row, 0.19 - 0.03 * row
            grip = [
                rounded_box("black", (0.018, 0.12, 0.024), (x, y, z), 0.007, 2),
                box("steel", (0.02, 0.02, 0.026), (x, y - 0.01, z)),
            ]
            yield from (rotate(p, 0, 0.72 if kind == "block" else 0.0, (x, 0.1, 0.0)) for p in grip)


def board(kind: str = "plain") -> Iterator[Solid]:
    """Build a chopping board with bread or with vegetables, or boards on edge in a stand."""
    if kind == "stand":
        for i in range(3):
            piece = rounded_box(
                ("wood", "bright", "white")[i],
                (0.32 - 0.03 * i, 0.24 - 0.02 * i, 0.016),
                (0.0, 0.012, -0.04 + 0.035 * i),
                0.007,
                2,
            )
            yield rotate(piece, 0, -0.12, (0.0, 0.012, -0.04 + 0.035 * i))
        yield rounded_box("black", (0.2, 0.014, 0.14), (0.0, 0.0, -0.01), 0.005, 1)
        return
    yield rounded_box("wood", (0.38, 0.022, 0.25), (0.0, 0.0, 0.0), 0.009, 2)
    if kind == "plain":
        yield ring("black", 0.022, 0.008, (0.16, 0.022, 0.0), 1, 16)
        yield padded_block("crust", (0.22, 0.1, 0.11), (-0.06, 0.022, 0.0), 2.6, 6)
        for i in range(2):
            yield rotate(
                padded_block("cream", (0.016, 0.09, 0.1), (0.07 + 0.025 * i, 0.024, 0.0), 3.0, 4),
                2,
                -0.3 - 0.5 * i,
                (0.07 + 0.025 * i, 0.024, 0.0),
            )
    else:
        yield tube(
            "orange", [(-0.14, 0.036, -0.06), (-0.06, 0.036, -0.05), (0.0, 0.036, -0.045)], [0.004, 0.012, 0.014], 10
        )
        for i in range(4):
            yield cylinder("red", 0.028, 0.008, (0.02 + 0.03 * i, 0.022 + 0.004 * (i % 2), 0.04), sides=16)
        yield ball("green", (0.035, 0.03, 0.035), (-0.1, 0.05, 0.05), 12, 8)
        yield prism(
            "steel", [(0.0, -0.1), (0.15, -0.1), (0.15, -0.07), (0.02, -0.075)], 0.003, (0.0, 0.022, 0.0), "top"
        )
        yield rounded_box("black", (0.11, 0.016, 0.024), (0.2, 0.018, -0.085), 0.007, 2)


def utensils(kind: str = "jar") -> Iterator[Solid]:
    """Build spoons, a whisk and a spatula, in a jar or on a rail."""
    base = 0.16 if kind == "jar" else 0.02
    if kind == "jar":
        yield vessel("glaze", [(0.05, 0.0), (0.058, 0.02), (0.055, 0.1), (0.06, 0.15)], 0.005, sides=20, steps=2)
    else:
        yield rod("chrome", (-0.22, 0.3, -0.03), (0.22, 0.3, -0.03), 0.007)
        for s in (-1, 1):
            yield rounded_box("chrome", (0.03, 0.03, 0.02), (s * 0.2, 0.285, -0.045), 0.006, 1)
    for i in range(5):
        if kind == "jar":
            a = 2 * np.pi * i / 5
            foot, tip = (0.01 * np.cos(a), 0.02, 0.01 * np.sin(a)), (0.06 * np.cos(a), base + 0.1, 0.06 * np.sin(a))
        else:
            x = -0.16 + 0.08 * i
            foot, tip = (x, 0.3, -0.02), (x, base + 0.09, -0.02)
        yield rod(("wood", "steel", "black", "wood", "steel")[i], foot, tip, 0.005)
        x, y, z = tip
        if i == 0:
            yield ball("wood", (0.022, 0.032, 0.009), (x, y + 0.02, z), 12, 6)
        elif i == 1:
            for k in range(3):
                c, s = np.cos(k * np.pi / 3), np.sin(k * np.pi / 3)
                yield tube(
                    "steel",
                    [
                        (x, y - 0.02, z),
                        (x + 0.02 * c, y + 0.03, z + 0.02 * s),
                        (x, y + 0.06, z),
                        (x - 0.02 * c, y + 0.03, z - 0.02 * s),
                        (x, y - 0.02, z + 1e-4),
                    ],
                    0.002,
                    5,
                )
        elif i == 2:
            yield rounded_box("black", (0.06, 0.07, 0.006), (x, y - 0.01, z), 0.003, 1)
        elif i == 3:
            yield rounded_box("wood", (0.045, 0.075, 0.008), (x, y - 0.01, z), 0.004, 2)
        else:
            yield vessel("steel", [(0.012, 0.0), (0.03, 0.01), (0.034, 0.03)], 0.003, (x, y - 0.01, z), 16, 2)


def cutlery_stand() -> Iterator[Solid]:
    """Build spoons and forks that hang around a small stand."""
    yield cylinder("wood", 0.075, 0.014, sides=26)
    yield rod("chrome", (0.0, 0.012, 0.0), (0.0, 0.34, 0.0), 0.006)
    yield ring("chrome", 0.05, 0.008, (0.0, 0.3, 0.0), 1, 22)
    yield ball("wood", 0.014, (0.0, 0.345, 0.0), 12, 8)
    for i in range(5):
        a = 2 * np.pi * i / 5
        x, z = 0.055 * np.cos(a), 0.055 * np.sin(a)
        slot = ("wood", "steel", "black", "steel", "wood")[i]
        yield rod(slot, (x, 0.3, z), (x, 0.11, z), 0.005)
        yield ball(slot, (0.022, 0.035, 0.012), (x, 0.085, z), 12, 8)


FAMILIES = (
    FurnitureFamily("knife_rack", "knife_rack", design_kinds(knives, "block", "holder", "bar")),
    FurnitureFamily("cutting_board", "cutting_board", design_kinds(board, "plain", "vegetables", "stand")),
    FurnitureFamily(
        "utensil_holder", "utensil_holder", (*design_kinds(utensils, "jar", "rail"), design(cutlery_stand))
    ),
)
