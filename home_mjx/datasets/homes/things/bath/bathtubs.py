"""Bathtubs."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, loop
from home_mjx.datasets.homes.shapes.soft import ball, between_loops
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.things.bath.bowls import tub
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.kitchen.taps import tap
from home_mjx.datasets.procedural.primitives.solids import Solid, cylinder, move, rotate


def _builtin(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.0, width, 0.75, 0.0), (0.56, width, 0.75, 0.0)], 0.07, 14.0, 44)
    yield prism("ceramic", [(width / 2 - 0.08, 0.05), (width / 2 - 0.08, 0.5), (width / 2 - 0.3, 0.05)], 0.6)
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.56, 0.04 - width / 2, "lever"))


def _free(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.0, 1.3, 0.56, 0.0), (0.08, 1.38, 0.62, 0.0), (0.58, width, 0.8, 0.0)], 0.035, 2.5, 44)
    yield tube(
        "chrome",
        fillet([(0.0, 0.0, -0.48), (0.0, 0.95, -0.48), (0.0, 0.95, -0.22), (0.0, 0.82, -0.2)], 0.1, 5),
        0.018,
    )
    yield rod("chrome", (0.0, 0.72, -0.48), (0.1, 0.76, -0.46), 0.01)


def _claw(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.14, 1.0, 0.46, 0.0), (0.24, 1.3, 0.62, 0.0), (0.6, 1.6, 0.76, 0.0)], 0.03, 2.6, 40)
    yield tube("ceramic", np.insert(loop(1.6, 0.76, 40, 2.6), 1, 0.605, axis=1), 0.025, 8, closed=True)
    for x, z in ((-0.45, -0.2), (0.45, -0.2), (-0.45, 0.2), (0.45, 0.2)):
        yield tube(
            "brass", [(x, 0.22, z), (1.16 * x, 0.12, 1.3 * z), (1.1 * x, 0.03, 1.3 * z)], [0.035, 0.025, 0.02], 10
        )
        yield ball("brass", 0.03, (1.12 * x, 0.03, 1.35 * z), 10, 6)
    for z in (-0.06, 0.06):
        yield rod("brass", (0.72, 0.0, z), (0.72, 0.7, z), 0.012)
    yield from (move(rotate(p, 1, -np.pi / 2), (0.8, 0.08, 0.0)) for p in tap(0.0, 0.6, 0.06, "bridge"))


def _corner_tub(width: float) -> Iterator[Solid]:
    curve = [(0.75 - 1.5 * (1 - np.cos(a)) * 0.98, -0.75 + 1.48 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 14)]
    outline = np.array([(-0.75, -0.75), *[(x, z) for x, z in curve]])
    levels = [np.insert(outline * k, 1, y, axis=1) for k, y in ((1.0, 0.0), (1.0, 0.55), (0.86, 0.55), (0.72, 0.16))]
    yield between_loops("ceramic", levels)
    yield from (move(rotate(p, 1, np.pi / 4), (0.0, 0.0, 0.0)) for p in tap(0.0, 0.55, -0.86, "lever"))
    for i in range(4):
        yield cylinder("chrome", 0.025, 0.02, (-0.3 + 0.2 * i, 0.15, -0.2), sides=12)


def _barrel(width: float) -> Iterator[Solid]:
    for i in range(26):
        a = 2 * np.pi * i / 26
        x, z = 0.62 * np.cos(a), 0.62 * np.sin(a)
        yield rod("wood", (0.92 * x, 0.0, 0.92 * z), (x, 0.74, z), 0.082, sides=4)
    for y in (0.15, 0.58):
        yield ring("iron", 0.645 + 0.05 * y, 0.018, (0.0, y, 0.0), 1, 30)
    yield cylinder("wood", 0.55, 0.04, (0.0, 0.06, 0.0), sides=28)
    yield cylinder("water", 0.55, 0.01, (0.0, 0.6, 0.0), sides=28)


_BATHTUB_KINDS = {
    "builtin": _builtin,
    "free": _free,
    "claw": _claw,
    "corner": _corner_tub,
    "barrel": _barrel,
}


def bathtub(kind: str = "builtin", width: float = 1.7) -> Iterator[Solid]:
    """Built in, freestanding, on claw feet, for a corner, a wooden barrel."""
    yield from _BATHTUB_KINDS[kind](width)


TUBS = (
    *(design(bathtub, kind=kind) for kind in ("builtin", "free", "claw", "corner", "barrel")),
    design(bathtub, width=1.5),
)


FAMILIES = (Family("bathtub", "bathtub", TUBS),)
