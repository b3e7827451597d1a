"""Chests of drawers."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, Vector, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import BOARD_THICKNESS, carcass, drawers, legs, open_case
from home_procgen.things.movable_parts import panel


def dresser(
    width: float = 1.2,
    height: float = 0.85,
    depth: float = 0.48,
    columns: int = 2,
    rows: int = 3,
    style: str = "flat",
    kind: str = "taper",
    grip: tuple = ("brass", "knob"),
    graded: bool = False,
    foot: float = 0.14,
) -> Iterator[Solid]:
    """Build a chest of drawers over its whole face."""
    yield from carcass(width, height, depth, foot if kind != "plinth" else 0.06, kind, "wood", 0.02)
    low = foot if kind != "plinth" else 0.06
    yield from drawers(
        "wood_1",
        width - 0.02,
        height - low - 0.03,
        (0.01 - width / 2, low + 0.005, depth / 2 - BOARD_THICKNESS),
        columns,
        rows,
        style,
        grip,
        graded,
        depth - 0.12,
    )


def bow_front(width: float = 1.0, height: float = 0.85, depth: float = 0.5) -> Iterator[Solid]:
    """Build a bow-front chest of three drawers on cabriole legs; each drawer slides out by 0.35 m."""
    xs = np.linspace(-width / 2, width / 2, 13)
    bow = [(float(x), depth / 2 - 0.1 + 0.12 * float(np.cos(np.pi * x / width))) for x in xs]
    outline = [(-width / 2, -depth / 2), (width / 2, -depth / 2), *bow[::-1]]
    yield from legs("wood", width - 0.02, depth - 0.12, 0.16, "cabriole", 0.06)
    yield prism("wood", outline, height - 0.18, (0.0, 0.14, 0.0), "top")
    yield prism("marble", [(1.03 * x, 1.04 * z) for x, z in outline], 0.03, (0.0, height - 0.04, 0.0), "top")
    for row in range(3):
        y = 0.17 + row * 0.215
        face = [*[(0.92 * x, z + 0.012) for x, z in bow], *[(0.92 * x, z - 0.03) for x, z in bow[::-1]]]
        pulls = []
        for x in (-0.26, 0.26):
            z = depth / 2 - 0.1 + 0.12 * float(np.cos(np.pi * x / width)) + 0.014
            pulls += _pull((x, y + 0.1, z))
        yield from panel(0.35, prism("wood_1", face, 0.195, (0.0, y, 0.0), "top"), *pulls)


def _pull(at: Vector) -> Iterator[Solid]:
    x, y, z = at
    yield rounded_box("brass", (0.09, 0.05, 0.008), (x, y - 0.025, z - 0.002), 0.004, 1)
    yield tube(
        "brass",
        fillet(
            [(x - 0.03, y, z), (x - 0.03, y - 0.02, z + 0.018), (x + 0.03, y - 0.02, z + 0.018), (x + 0.03, y, z)], 0.01
        ),
        0.004,
        6,
    )


def basket_chest(width: float = 0.9, height: float = 0.9, depth: float = 0.4) -> Iterator[Solid]:
    """Build a frame with woven baskets as drawers."""
    yield from open_case("wood", width, height - 0.06, depth, (0.28, 0.56), (0.0, 0.06, 0.0), (0.5,), "wood_1")
    yield from legs("wood", width, depth, 0.07, "block", 0.05)
    for row in range(3):
        for s in (-1, 1):
            x, y, size = s * width / 4, 0.28 * row, (width / 2 - 0.05, 0.22, depth - 0.02)
            basket = rounded_box("cane", size, (x, 0.09 + y, 0.01), 0.025, 2)
            yield from panel(0.3, basket, box("black", (0.09, 0.022, 0.006), (x, 0.24 + y, depth / 2 - 0.0)))


def apothecary(width: float = 0.95, height: float = 1.05, depth: float = 0.36) -> Iterator[Solid]:
    """Build a chest of many small drawers with label holders."""
    yield from carcass(width, height, depth, 0.1, "block", "wood", 0.03)
    yield from drawers(
        "wood_1",
        width - 0.02,
        height - 0.14,
        (0.01 - width / 2, 0.105, depth / 2 - BOARD_THICKNESS),
        4,
        5,
        "flat",
        ("brass", "cup"),
        opens=0.26,
    )


def tallboy(width: float = 0.55, height: float = 1.3, depth: float = 0.42) -> Iterator[Solid]:
    """Build a tower of shallow drawers."""
    yield from dresser(width, height, depth, 1, 6, "flat", "plinth", ("black", "slot"))


DRESSERS = (
    design(dresser),
    design(
        dresser, style="raised", kind="cabriole", grip=("brass", "ring"), graded=True, columns=1, rows=4, width=0.95
    ),
    design(bow_front), design(basket_chest), design(apothecary), design(tallboy),
    design(dresser, style="shaker", kind="block", columns=3, rows=3, width=1.5, grip=("black", "cup")),
    design(dresser, style="cane", kind="splay", rows=2, height=0.75),
    design(dresser, kind="plinth", grip=("black", "slot"), rows=4, columns=1, width=0.8, height=1.0),
    design(dresser, style="slats", kind="sled", rows=2, width=1.4, height=0.75),
)  # fmt: skip


FAMILIES = (FurnitureFamily("dresser", "dresser", DRESSERS),)
