"""Room dividers."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import ring
from home_procgen.things.family import FurnitureFamily, design_kinds


def _folding_screen(kind: str) -> Iterator[Solid]:
    wide = 0.48
    for i in range(4 if kind != "cane" else 3):
        turn = 0.5 * (-1) ** i
        count = 4 if kind != "cane" else 3
        x = (i - (count - 1) / 2) * wide * np.cos(0.5)
        fill = {"folding": "patterned", "paper": "paper", "cane": "cane"}[kind]
        parts = [box(fill, (wide - 0.07, 1.6, 0.012), (0.0, 0.12, 0.0))]
        for s in (-1, 1):
            parts.append(box("wood", (0.035, 1.78, 0.028), (s * (wide - 0.04) / 2, 0.0, 0.0)))
            parts.append(box("wood", (wide - 0.07, 0.035, 0.028), (0.0, 0.09 + 1.66 * (s + 1) / 2, 0.0)))
        if kind == "paper":
            parts += [box("wood", (0.014, 1.6, 0.02), ((k - 1) * 0.14, 0.12, 0.0)) for k in range(3)]
            parts += [box("wood", (wide - 0.07, 0.014, 0.021), (0.0, 0.12 + 0.27 * k, 0.0)) for k in range(1, 6)]
        yield from (p for p in (move(rotate(q, 1, turn), (x, 0.0, 0.0)) for q in parts))


def _slats() -> Iterator[Solid]:
    for y in (0.0, 2.2):
        yield rounded_box("wood", (1.5, 0.06, 0.08), (0.0, y, 0.0), 0.01, 1)
    for i in range(16):
        yield rotate(
            rounded_box("wood", (0.02, 2.16, 0.07), ((i - 7.5) * 0.092, 0.05, 0.0), 0.004, 1),
            1,
            0.35,
            ((i - 7.5) * 0.092, 0.0, 0.0),
        )


def _rings() -> Iterator[Solid]:
    for i in range(4):
        for j in range(4):
            x, y = (i - 1.5) * 0.38, 0.05 + 0.42 * j
            yield ring("wood", 0.19, 0.035, (x, y + 0.2, 0.0), 2, 20)
    for s in (-1, 1):
        yield rounded_box("wood", (0.05, 1.78, 0.06), (s * 0.775, 0.0, 0.0), 0.01, 1)
        yield rounded_box("wood", (1.5, 0.05, 0.06), (0.0, 1.73 * (s + 1) / 2, 0.0), 0.01, 1)
        yield rounded_box("wood", (0.08, 0.04, 0.36), (s * 0.775, 0.0, 0.0), 0.012, 1)


_SCREEN_KINDS = {
    "folding": partial(_folding_screen, "folding"),
    "paper": partial(_folding_screen, "paper"),
    "cane": partial(_folding_screen, "cane"),
    "slats": _slats,
    "rings": _rings,
}


def screen(kind: str = "folding") -> Iterator[Solid]:
    """Build a room divider: folding panels of wood, paper or cane, slats or rings."""
    yield from _SCREEN_KINDS[kind]()


FAMILIES = (FurnitureFamily("screen", "partition", design_kinds(screen, "folding", "slats", "paper", "rings", "cane")),)
