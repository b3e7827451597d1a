"""Trolleys and safes."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import corners, disc, roller
from home_procgen.things.movable_parts import panel


def _trolley(slot: str, board: str, wide: float, deep: float, levels: tuple[float, ...]) -> Iterator[Solid]:
    for x, z in corners(wide, deep):
        yield rod(slot, (x, 0.05, z), (x, levels[-1] + 0.08, z), 0.013)
        yield roller("rubber", 0.03, 0.02, (x, 0.03, z), 12)
    for y in levels:
        yield rounded_box(board, (wide, 0.015, deep), (0.0, y, 0.0), 0.004, 1)
        for s in (-1, 1):
            yield rod(slot, (-wide / 2, y + 0.06, s * deep / 2), (wide / 2, y + 0.06, s * deep / 2), 0.007, sides=6)
            yield rod(slot, (s * wide / 2, y + 0.06, -deep / 2), (s * wide / 2, y + 0.06, deep / 2), 0.007, sides=6)
    yield tube(
        slot,
        fillet(
            [
                (-wide / 2, levels[-1] + 0.07, -deep / 2),
                (-wide / 2 - 0.1, levels[-1] + 0.1, -deep / 2),
                (-wide / 2 - 0.1, levels[-1] + 0.1, deep / 2),
                (-wide / 2, levels[-1] + 0.07, deep / 2),
            ],
            0.04,
        ),
        0.01,
    )


def bar_trolley() -> Iterator[Solid]:
    """Build a serving trolley with bottles and glasses."""
    yield from _trolley("brass", "glass", 0.7, 0.42, (0.2, 0.72))
    top = 0.72 + 0.015
    for i in range(4):
        yield revolve(
            ("green", "tint", "brown", "tint_1")[i],
            [(0.035, 0.0), (0.037, 0.16), (0.013, 0.21), (0.013, 0.28)],
            (-0.22 + 0.1 * i, top, -0.08),
            12,
            2,
        )
    for i in range(3):
        yield vessel(
            "glass",
            [(0.028, 0.0), (0.006, 0.008), (0.006, 0.07), (0.035, 0.1), (0.032, 0.16)],
            0.003,
            (-0.1 + 0.12 * i, top, 0.1),
            12,
            2,
        )


def tea_trolley() -> Iterator[Solid]:
    """Build a serving trolley with a pot and cups."""
    yield from _trolley("wood", "wood", 0.7, 0.42, (0.2, 0.72))
    top = 0.72 + 0.015
    for i in range(2):
        yield vessel(
            "crockery", [(0.022, 0.0), (0.04, 0.03), (0.042, 0.06)], 0.004, (0.08 + 0.16 * i, top, 0.06), 14, 2
        )
    yield revolve(
        "crockery",
        [(0.05, 0.0), (0.085, 0.05), (0.06, 0.11), (0.02, 0.12), (0.012, 0.14)],
        (-0.15, top, 0.0),
        16,
        2,
    )


def basket_trolley() -> Iterator[Solid]:
    """Build a trolley of plastic baskets."""
    levels = (0.12, 0.42, 0.72)
    yield from _trolley("paint", "paint", 0.42, 0.34, levels)
    for k, y in enumerate(levels):
        yield rounded_box(f"bright_{k}", (0.3, 0.12, 0.24), (0.0, y + 0.016, 0.0), 0.03, 1)


def _lock(height: float) -> Iterator[Solid]:
    """Build the dial and handle of a safe."""
    yield disc("chrome", 0.05, 0.03, (-0.06, 0.58 * height, 0.215), 24)
    yield disc("black", 0.03, 0.03, (-0.06, 0.58 * height, 0.23), 20)
    for a in range(3):
        c, s = np.cos(2.1 * a), np.sin(2.1 * a)
        yield rod("chrome", (0.08, 0.56 * height, 0.25), (0.08 + 0.05 * c, 0.56 * height + 0.05 * s, 0.25), 0.006)
    yield disc("chrome", 0.02, 0.05, (0.08, 0.56 * height, 0.215), 14)


def safe(height: float = 0.5) -> Iterator[Solid]:
    """Build a steel box with a thick door, a dial and a handle."""
    yield rounded_box("gray", (0.46, height - 0.03, 0.42), (0.0, 0.03, 0.0), 0.015, 2)
    for x, z in corners(0.36, 0.32):
        yield cylinder("black", 0.03, 0.035, (x, 0.0, z), sides=12)
    door = rounded_box("iron", (0.38, height - 0.12, 0.03), (0.0, 0.08, 0.205), 0.01, 1)
    yield from panel("right", door, *_lock(height))
    for y in (0.14, height - 0.14):
        yield cylinder("chrome", 0.012, 0.07, (0.205, y, 0.22), sides=10)


def key_safe() -> Iterator[Solid]:
    """Build a low steel box with a keypad, for a cupboard."""
    yield rounded_box("black", (0.36, 0.26, 0.3), (0.0, 0.0, 0.0), 0.008, 1)
    door = rounded_box("black", (0.32, 0.22, 0.02), (0.0, 0.02, 0.155), 0.006, 1)
    lock = [
        rounded_box("gray", (0.09, 0.13, 0.008), (-0.06, 0.07, 0.168), 0.003, 1),
        cylinder("chrome", 0.02, 0.02, (0.07, 0.12, 0.165), sides=16),
    ]
    keys = [
        rounded_box(
            "white", (0.018, 0.016, 0.005), (-0.085 + 0.025 * (k % 3), 0.085 + 0.025 * (k // 3), 0.173), 0.002, 1
        )
        for k in range(12)
    ]
    yield from panel("right", door, *lock, *keys)


FAMILIES = (
    FurnitureFamily("cart", "cart", (design(tea_trolley), design(bar_trolley), design(basket_trolley))),
    FurnitureFamily("safe", "safe", (design(safe), design(safe, height=0.8), design(key_safe))),
)
