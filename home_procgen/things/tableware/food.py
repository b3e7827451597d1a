"""Cakes, bread, meals; a mortar."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, rotate
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds


def cake(kind: str = "whole") -> Iterator[Solid]:
    """Build a cake or muffins on a stand, or a cake under a glass bell."""
    yield revolve(
        "crockery",
        [(0.06, 0.0), (0.02, 0.015), (0.018, 0.06), (0.04, 0.075), (0.14, 0.08), (0.145, 0.09)],
        sides=28,
        steps=1,
    )
    if kind == "muffins":
        for i in range(5):
            a = 2 * np.pi * i / 5
            x, z = 0.085 * np.cos(a), 0.085 * np.sin(a)
            yield revolve("paper", [(0.024, 0.09), (0.032, 0.125)], (x, 0.0, z), 12, 1)
            yield ball("crust", (0.036, 0.024, 0.036), (x, 0.128, z), 12, 6)
        return
    yield revolve("cream", [(0.11, 0.09), (0.11, 0.17), (0.1, 0.175)], sides=28, steps=1)
    yield revolve("brown", [(0.1112, 0.12), (0.1112, 0.135)], sides=28, steps=1)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield ball("red", 0.013, (0.085 * np.cos(a), 0.186, 0.085 * np.sin(a)), 10, 6)
    if kind == "bell":
        yield vessel("glass", [(0.13, 0.0), (0.13, 0.1), (0.07, 0.16), (0.012, 0.17)], 0.003, (0.0, 0.09, 0.0), 26, 2)
        yield ball("glass", 0.014, (0.0, 0.275, 0.0), 10, 6)


def bread(kind: str = "loaf") -> Iterator[Solid]:
    """Build a loaf, rolls in a basket, or a cut baguette on a cloth."""
    if kind == "baguette":
        yield rounded_box("linen", (0.4, 0.006, 0.16), (0.0, 0.0, 0.0), 0.002, 2)
        yield padded_block("crust", (0.3, 0.06, 0.075), (-0.04, 0.006, 0.0), 2.4, 7)
        for i in range(3):
            slice_ = padded_block("cream", (0.014, 0.055, 0.07), (0.13 + 0.022 * i, 0.006, 0.01 * i), 2.6, 5)
            yield rotate(slice_, 2, -0.25 - 0.3 * i, (0.13 + 0.022 * i, 0.006, 0.0))
        return
    if kind == "loaf":
        yield padded_block("crust", (0.28, 0.11, 0.13), (0.0, 0.0, 0.0), 2.8, 7)
        for i in range(4):
            yield rotate(
                padded_block("cream", (0.014, 0.008, 0.09), (-0.08 + 0.055 * i, 0.105, 0.0), 2.5, 3),
                1,
                0.5,
                (-0.08 + 0.055 * i, 0.1, 0.0),
            )
    else:
        yield vessel("cane", [(0.1, 0.0), (0.13, 0.03), (0.14, 0.08)], 0.008, sides=24, steps=2, stretch=0.7)
        for i in range(6):
            yield ball(
                "crust",
                (0.045, 0.035, 0.038),
                ((i % 3 - 1) * 0.07, 0.06 + 0.04 * (i // 4), (i // 3 - 0.5) * 0.06),
                12,
                8,
            )


def _pizza() -> Iterator[Solid]:
    yield cylinder("wood", 0.17, 0.012, sides=30)
    yield revolve("crust", [(0.15, 0.012), (0.155, 0.02), (0.145, 0.028), (0.13, 0.02)], sides=30, steps=2)
    yield cylinder("yellow", 0.132, 0.004, (0.0, 0.019, 0.0), sides=30)
    for i in range(9):
        a = 2.4 * i
        yield cylinder(
            "red", 0.018, 0.004, (0.038 * np.sqrt(i) * np.cos(a), 0.0225, 0.038 * np.sqrt(i) * np.sin(a)), sides=12
        )


def _salad() -> Iterator[Solid]:
    yield vessel("wood", [(0.06, 0.0), (0.11, 0.03), (0.13, 0.09)], 0.007, sides=26, steps=2)
    for i in range(22):
        yield leaf(
            "leaf",
            0.1,
            0.06,
            (0.05 * np.cos(2.4 * i), 0.05 + 0.0015 * i, 0.05 * np.sin(2.4 * i)),
            1.3 * i,
            0.7,
            1.2,
            pieces=3,
        )
    for i in range(5):
        yield ball("red", 0.016, (0.06 * np.cos(1.3 * i), 0.1, 0.06 * np.sin(1.3 * i)), 10, 6)


def _sushi() -> Iterator[Solid]:
    yield rounded_box("black", (0.3, 0.014, 0.16), (0.0, 0.0, 0.0), 0.006, 1)
    for i in range(6):
        x, z = -0.1 + 0.1 * (i % 3), -0.035 + 0.07 * (i // 3)
        yield padded_block("white", (0.06, 0.026, 0.032), (x, 0.014, z), 3.0, 4)
        yield padded_block(("orange", "red")[i % 2], (0.066, 0.012, 0.036), (x, 0.038, z), 3.0, 4)


_MEAL_KINDS = {
    "pizza": _pizza,
    "salad": _salad,
    "sushi": _sushi,
}


def meal(kind: str = "pizza") -> Iterator[Solid]:
    """Build a pizza, a salad or a tray of sushi."""
    yield from _MEAL_KINDS[kind]()


def mortar(slot: str = "stone", wide: float = 1.0) -> Iterator[Solid]:
    """Build a mortar with its pestle; `wide` is a factor on its width."""
    profile = [(0.05, 0.0), (0.055, 0.015), (0.045, 0.03), (0.07, 0.06), (0.075, 0.1)]
    yield vessel(slot, [(wide * r, y) for r, y in profile], 0.014 * wide, sides=24, steps=2)
    yield tube(slot, [(0.0, 0.045, 0.0), (0.03, 0.09, 0.01), (0.075, 0.15, 0.02)], [0.02, 0.013, 0.018], 10)


FAMILIES = (
    FurnitureFamily("cake", "cake", design_kinds(cake, "whole", "muffins", "bell")),
    FurnitureFamily("bread", "bread", design_kinds(bread, "loaf", "rolls", "baguette")),
    FurnitureFamily("food", "food", design_kinds(meal, "pizza", "salad", "sushi")),
    FurnitureFamily(
        "mortar",
        "mortar_and_pestle",
        (design(mortar), design(mortar, slot="wood", wide=0.8), design(mortar, slot="ceramic", wide=1.25)),
    ),
)
