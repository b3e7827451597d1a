"""Fans, and a whiteboard."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import disc


def _under_ceiling(wood: bool) -> Iterator[Solid]:
    yield revolve("brass", [(0.06, 0.46), (0.06, 0.5)], sides=18, steps=1)
    yield cylinder("brass", 0.012, 0.34, (0.0, 0.14, 0.0), sides=10)
    yield revolve(
        "brass" if wood else "white",
        [(0.05, 0.04), (0.11, 0.07), (0.11, 0.13), (0.05, 0.16)],
        sides=24,
        steps=2,
    )
    count = 5 if wood else 3
    blade = rotate(
        prism(
            "wood" if wood else "white",
            fillet([(-0.05, 0.12), (0.05, 0.12), (0.075, 0.58), (-0.075, 0.58)], 0.04, 3, True),
            0.008,
            (0.0, 0.1, 0.0),
            "top",
        ),
        2,
        0.16,
        (0.0, 0.1, 0.0),
    )
    yield from repeat_around([blade], count)
    yield ball("opal", (0.1, 0.06, 0.1), (0.0, 0.045, 0.0), 18, 10)


def _on_foot(y: float, foot: float, rim: float, size: float) -> Iterator[Solid]:
    yield revolve(
        "white",
        [(foot, 0.0), (rim, 0.02), (0.04, 0.05)],
        sides=24,
        steps=1,
    )
    yield rod("chrome", (0.0, 0.04, 0.0), (0.0, y - 0.03, 0.0), 0.012)
    yield tube("white", [(0.0, y, -0.1), (0.0, y, 0.02)], [0.04, 0.06], 14)
    yield from _cage(y, size)
    for i in range(4):
        blade = prism(
            "blue",
            fillet(
                [(-0.02, 0.02), (0.02, 0.02), (0.07 * size / 0.2, 0.85 * size), (-0.05 * size / 0.2, 0.85 * size)],
                0.03,
                3,
                True,
            ),
            0.004,
        )
        yield move(rotate(rotate(blade, 1, 0.35), 2, i * np.pi / 2), (0.0, y, 0.06))
    yield disc("white", 0.04, 0.03, (0.0, y, 0.05), 16)


def _cage(y: float, size: float) -> Iterator[Solid]:
    for z in (0.02, 0.1):
        for r in (size, 0.66 * size, 0.33 * size):
            yield ring("white", r, 0.006, (0.0, y, z + 0.03 * (1 - r / size) * (1 if z > 0.05 else -1)), 2, 22)
    for i in range(16):
        a = 2 * np.pi * i / 16
        c, s = size * np.cos(a), size * np.sin(a)
        yield tube("white", [(0.1 * c, y + 0.1 * s, 0.125), (c, y + s, 0.1), (c, y + s, 0.02)], 0.002, 4)


def _short_fan() -> Iterator[Solid]:
    """Build a flat fan close below the ceiling, with four broad blades."""
    yield revolve("white", [(0.11, 0.12), (0.12, 0.2), (0.1, 0.26)], sides=26, steps=1)
    yield revolve("wood", [(0.06, 0.06), (0.1, 0.09), (0.1, 0.12)], sides=24, steps=2)
    outline = fillet([(-0.06, 0.09), (0.06, 0.09), (0.085, 0.5), (-0.085, 0.5)], 0.05, 4, True)
    blade = rotate(prism("wood", outline, 0.01, (0.0, 0.1, 0.0), "top"), 2, 0.18, (0.0, 0.1, 0.0))
    yield from repeat_around([blade], 4)
    yield ball("opal", (0.09, 0.05, 0.09), (0.0, 0.05, 0.0), 18, 10)


def _box_fan() -> Iterator[Solid]:
    """Build a square fan on the floor."""
    for s in (-1, 1):
        yield rounded_box("white", (0.03, 0.5, 0.14), (s * 0.24, 0.02, 0.0), 0.01, 2)
        yield rounded_box("white", (0.45, 0.03, 0.14), (0.0, 0.02 + 0.235 * (s + 1), 0.0), 0.01, 2)
        yield rounded_box("black", (0.05, 0.022, 0.2), (s * 0.2, 0.0, 0.0), 0.008, 1)
    for i in range(15):
        yield rod("chrome", (-0.21 + 0.03 * i, 0.04, 0.06), (-0.21 + 0.03 * i, 0.5, 0.06), 0.002, sides=4)
    for i in range(5):
        outline = fillet([(-0.02, 0.03), (0.03, 0.03), (0.08, 0.2), (-0.06, 0.2)], 0.03, 3, True)
        yield move(rotate(rotate(prism("blue", outline, 0.004), 1, 0.4), 2, 0.4 * np.pi * i), (0.0, 0.27, 0.0))
    yield disc("white", 0.04, 0.03, (0.0, 0.27, -0.01), 16)


_FAN_KINDS = {
    "short": _short_fan,
    "box": _box_fan,
    "ceiling": partial(_under_ceiling, False),
    "ceiling_wood": partial(_under_ceiling, True),
    "stand": partial(_on_foot, 1.15, 0.2, 0.19, 0.2),
    "table": partial(_on_foot, 0.28, 0.1, 0.1, 0.14),
}


def fan(kind: str = "ceiling") -> Iterator[Solid]:
    """Build a `ceiling`, `ceiling_wood`, `short`, `stand`, `table` or `box` fan."""
    yield from _FAN_KINDS[kind]()


def whiteboard() -> Iterator[Solid]:
    """Build a whiteboard with writing and a pen tray."""
    yield rounded_box("white", (1.2, 0.8, 0.018), (0.0, 0.05, -0.006), 0.004, 1)
    for s in (-1, 1):
        yield box("gray", (0.02, 0.84, 0.026), (s * 0.61, 0.03, -0.004))
        yield box("gray", (1.2, 0.02, 0.026), (0.0, 0.03 + 0.82 * (s + 1) / 2, -0.004))
    yield box("gray", (0.5, 0.01, 0.06), (0.0, 0.03, 0.03))
    for i, slot in enumerate(("red", "blue", "black")):
        yield rod(slot, (-0.18 + 0.14 * i, 0.048, 0.04), (-0.07 + 0.14 * i, 0.048, 0.04), 0.008)
    for i, (x, y, w) in enumerate(((-0.3, 0.68, 0.4), (-0.32, 0.6, 0.34), (-0.28, 0.52, 0.44), (0.25, 0.6, 0.3))):
        yield box(("blue", "black", "black", "red")[i], (w, 0.014, 0.002), (x, y, 0.004))


def pin_board(kind: str = "cork") -> Iterator[Solid]:
    """Build a board of cork with notes, or a blackboard with chalk."""
    cork = kind == "cork"
    wide, high = (0.9, 0.6) if cork else (0.7, 1.0)
    yield box("brown" if cork else "black", (wide, high, 0.012), (0.0, 0.02, -0.004))
    for s in (-1, 1):
        yield rounded_box("wood", (0.03, high + 0.06, 0.024), (s * (wide + 0.03) / 2, -0.01, 0.0), 0.006, 1)
        yield rounded_box("wood", (wide, 0.03, 0.024), (0.0, -0.01 + (high + 0.03) * (s + 1) / 2, 0.0), 0.006, 1)
    for i in range(6):
        x, y = (-0.36 + 0.3 * (i % 3), 0.1 + 0.28 * (i // 3)) if cork else (-0.2 + 0.03 * (i % 2), 0.8 - 0.1 * i)
        size = (0.12 + 0.03 * (i % 2), 0.16, 0.002) if cork else (0.3 - 0.04 * (i % 3), 0.014, 0.001)
        yield rotate(
            box(("paper", "yellow", "white")[i % 3] if cork else "white", size, (x, y, 0.003)), 2, 0.04 * (i % 3 - 1)
        )
        if cork:
            yield ball("red", 0.007, (x, y + 0.15, 0.008), 8, 6)


FAMILIES = (
    FurnitureFamily("ceiling_fan", "ceiling_fan", design_kinds(fan, "ceiling", "ceiling_wood", "short")),
    FurnitureFamily("stand_fan", "pedestal_fan", design_kinds(fan, "stand", "table", "box")),
    FurnitureFamily("whiteboard", "whiteboard", (design(whiteboard), *design_kinds(pin_board, "cork", "chalk"))),
)
