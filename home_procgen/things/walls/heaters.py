"""Heaters."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import disc


def _panels(kind: str, width: float, height: float) -> Iterator[Solid]:
    for z in (0.03,) if kind == "panel" else (0.04, -0.02):
        yield rounded_box("white", (width, height - 0.1, 0.02), (0.0, 0.1, z), 0.006, 1)
        for i in range(int(width / 0.05)):
            yield rounded_box(
                "white", (0.024, height - 0.16, 0.012), ((i + 0.5) * 0.05 - width / 2, 0.13, z + 0.01), 0.005, 1
            )
    yield box("white", (width, 0.012, 0.1), (0.0, height - 0.012, 0.0))


def _columns(width: float, height: float) -> Iterator[Solid]:
    for i in range(int(width / 0.07)):
        x = (i + 0.5) * 0.07 - width / 2
        for z in (-0.045, 0.045):
            yield tube("white", [(x, 0.1, z), (x, height - 0.03, z)], 0.02, 8)
        for y in (0.12, height - 0.05):
            yield ball("white", (0.034, 0.035, 0.07), (x, y, 0.0), 8, 6)


def _convector(width: float, height: float) -> Iterator[Solid]:
    yield rounded_box("wood", (width, height - 0.12, 0.16), (0.0, 0.12, 0.0), 0.008, 1)
    for i in range(8):
        yield box("black", (width - 0.1, 0.012, 0.006), (0.0, 0.17 + 0.04 * i, 0.08))
    for s in (-1, 1):
        yield rounded_box("wood", (0.08, 0.12, 0.16), (s * (width / 2 - 0.1), 0.0, 0.0), 0.006, 1)


def _oil(width: float, height: float) -> Iterator[Solid]:
    for i in range(9):
        yield rounded_box("white", (0.05, 0.5, 0.16), ((i - 4) * 0.062, 0.08, 0.0), 0.022, 2)
    yield rounded_box("gray", (0.07, 0.42, 0.15), (0.3, 0.1, 0.0), 0.015, 2)
    yield from (rotate(disc("black", 0.024, 0.02, (0.0, y, 0.336), 14), 1, np.pi / 2) for y in (0.4, 0.3))
    for x in (-0.22, 0.22):
        for z in (-0.1, 0.1):
            yield ball("black", 0.03, (x, 0.03, z), 10, 6)
        yield box("gray", (0.04, 0.03, 0.22), (x, 0.05, 0.0))


def _smooth(width: float, height: float) -> Iterator[Solid]:
    """Build a radiator with a plain plate before ribs and a grille above."""
    yield rounded_box("white", (width, height - 0.1, 0.014), (0.0, 0.1, 0.045), 0.004, 1)
    yield rounded_box("white", (width, height - 0.1, 0.014), (0.0, 0.1, -0.045), 0.004, 1)
    for i in range(int(width / 0.06)):
        yield box("white", (0.004, height - 0.16, 0.076), ((i + 0.5) * 0.06 - width / 2, 0.12, 0.0))
    for i in range(int(width / 0.03)):
        yield box("white", (0.014, 0.008, 0.1), ((i + 0.5) * 0.03 - width / 2, height - 0.012, 0.0))


def _tubes(width: float, height: float) -> Iterator[Solid]:
    """Build a radiator of horizontal flat tubes before two posts."""
    for i in range(int((height - 0.12) / 0.07)):
        yield rounded_box("white", (width, 0.055, 0.03), (0.0, 0.12 + 0.07 * i, 0.02), 0.014, 3)
    for s in (-1, 1):
        yield rounded_box("white", (0.04, height - 0.12, 0.04), (s * (width / 2 - 0.1), 0.12, -0.02), 0.012, 2)


def _baseboard(width: float, height: float) -> Iterator[Solid]:
    """Build a long, low case with fins inside, open below."""
    low = 0.2
    over = [(-0.04, low), (0.02, low), (0.04, low - 0.03), (0.04, 0.05), (0.03, 0.05), (0.03, low - 0.03)]
    case = [*over, (0.016, low - 0.01), (-0.03, low - 0.01), (-0.03, 0.0), (-0.04, 0.0)]
    yield prism("white", case, width, (0.0, 0.0, 0.0), "side")
    yield rod("brass", (-width / 2 + 0.02, 0.09, 0.0), (width / 2 - 0.02, 0.09, 0.0), 0.01)
    for i in range(int(width / 0.03)):
        yield box("gray", (0.002, 0.06, 0.05), ((i + 0.5) * 0.03 - width / 2, 0.06, 0.0))
    for s in (-1, 1):
        yield rounded_box("white", (0.02, low + 0.004, 0.09), (s * (width / 2 - 0.004), 0.0, 0.0), 0.006, 1)


def _electric(width: float, height: float) -> Iterator[Solid]:
    """Build a slim electric heater with air outlets, a dial and a lamp."""
    yield rounded_box("white", (width, height - 0.12, 0.08), (0.0, 0.12, 0.0), 0.02, 3)
    for i in range(5):
        yield box("black", (width - 0.16, 0.008, 0.004), (0.0, height - 0.12 + 0.018 * i, 0.039))
        yield box("black", (width - 0.16, 0.008, 0.004), (0.0, 0.15 + 0.018 * i, 0.039))
    yield disc("gray", 0.022, 0.02, (width / 2 - 0.06, height - 0.18, 0.038), 18)
    yield disc("red", 0.005, 0.006, (width / 2 - 0.06, height - 0.24, 0.038), 10)
    for s in (-1, 1):
        yield rounded_box("white", (0.05, 0.12, 0.16), (s * (width / 2 - 0.14), 0.0, 0.0), 0.012, 2)


def _fan_heater(width: float, height: float) -> Iterator[Solid]:
    """Build a small heater with a fan behind a grille."""
    yield rounded_box("white", (0.26, 0.26, 0.16), (0.0, 0.02, 0.0), 0.05, 4)
    for r in (0.03, 0.055, 0.08, 0.105):
        yield ring("gray", r, 0.006, (0.0, 0.15, 0.081), 2, 26)
    for k in range(6):
        c, s = np.cos(np.pi * k / 6), np.sin(np.pi * k / 6)
        yield rod("gray", (-0.105 * c, 0.15 - 0.105 * s, 0.08), (0.105 * c, 0.15 + 0.105 * s, 0.08), 0.002, sides=5)
    yield disc("black", 0.018, 0.02, (0.09, 0.045, 0.074), 14)
    yield rounded_box("gray", (0.2, 0.03, 0.18), (0.0, 0.0, 0.0), 0.01, 1)


_RADIATOR_KINDS = {
    "panel": partial(_panels, "panel"),
    "double": partial(_panels, "double"),
    "columns": _columns,
    "convector": _convector,
    "oil": _oil,
    "smooth": _smooth,
    "tubes": _tubes,
    "baseboard": _baseboard,
    "electric": _electric,
    "fan": _fan_heater,
}
PIPED = ("panel", "double", "columns", "smooth", "tubes")


def radiator(kind: str = "panel", width: float = 1.0, height: float = 0.6) -> Iterator[Solid]:
    """Build a heater: a wall radiator with or without pipes, or a portable one."""
    yield from _RADIATOR_KINDS[kind](width, height)
    if kind in PIPED:
        for s in (-1, 1):
            yield rod("chrome", (s * (width / 2 - 0.06), 0.0, 0.0), (s * (width / 2 - 0.06), 0.16, 0.0), 0.01)
        yield cylinder("white", 0.022, 0.07, (width / 2 - 0.06, 0.03, 0.0), sides=14)


FAMILIES = (
    FurnitureFamily(
        "radiator",
        "heater",
        (
            *design_kinds(radiator, "panel", "columns", "double", "convector"),
            design(radiator, width=0.6),
            design(radiator, kind="columns", width=0.6, height=0.8),
            *design_kinds(radiator, "smooth", "tubes", "baseboard", "electric"),
        ),
    ),
    FurnitureFamily("oil_heater", "heater", design_kinds(radiator, "oil", "fan")),
)
