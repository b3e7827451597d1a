"""Bathtubs, and bowls with superelliptic plans."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, loop
from home_procgen.shapes.rounded import ball, join_loops, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc
from home_procgen.things.kitchen.sinks import tap


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
    yield join_loops("ceramic", levels)
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


def _slipper(width: float) -> Iterator[Solid]:
    """Build a freestanding bathtub on a foot, with one end higher than the other."""
    yield tub("ceramic", [(0.0, 0.9, 0.4, 0.0), (0.08, 0.8, 0.36, 0.0), (0.13, 1.05, 0.5, 0.0)], 0.03, 2.4, 40)
    loops = []
    for w, d, y, rise in ((1.05, 0.5, 0.13, 0.0), (1.4, 0.68, 0.4, 0.12), (1.62, 0.76, 0.56, 0.28),
                          (1.56, 0.7, 0.56, 0.28), (1.3, 0.6, 0.4, 0.1), (0.95, 0.42, 0.17, 0.0)):  # fmt: skip
        plan = loop(w, d, 44, 2.5)
        high = y + rise * np.clip((plan[:, 0] / w + 0.1) / 0.6, 0.0, 1.0) ** 2
        loops.append(np.insert(plan, 1, high, axis=1))
    yield join_loops("ceramic", loops)
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.56, -0.76, "bridge"))


def _panelled(width: float) -> Iterator[Solid]:
    """Build a bathtub in a box of boards with a broad stone rim."""
    yield tub("ceramic", [(0.06, width - 0.12, 0.64, 0.0), (0.56, width - 0.12, 0.64, 0.0)], 0.05, 9.0, 44)
    for z in (-0.36, 0.36):
        for i in range(int(width / 0.1)):
            yield rounded_box("wood", (0.094, 0.5, 0.02), ((i + 0.5) * 0.1 - width / 2, 0.04, z), 0.006, 1)
    for s in (-1, 1):
        yield rounded_box("wood", (0.02, 0.5, 0.72), (s * (width / 2 - 0.02), 0.04, 0.0), 0.004, 1)
        yield rounded_box("stone", (width + 0.02, 0.03, 0.11), (0.0, 0.545, s * 0.335), 0.008, 1)
        yield rounded_box("stone", (0.1, 0.03, 0.58), (s * (width / 2 - 0.04), 0.545, 0.0), 0.008, 1)
    yield box("black", (width - 0.06, 0.04, 0.66))
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.575, 0.05 - width / 2, "lever"))


def _screened(width: float) -> Iterator[Solid]:
    """Build a built-in bathtub with a glass pane and a shower above the tap."""
    yield from _builtin(width)
    x = 0.06 - width / 2
    yield box("glass", (0.78, 1.35, 0.008), (x + 0.41, 0.56, 0.35))
    yield rounded_box("chrome", (0.025, 1.36, 0.025), (x + 0.01, 0.56, 0.35), 0.005, 1)
    yield rod("chrome", (x, 0.7, 0.0), (x, 1.85, 0.0), 0.011)
    yield tube(
        "chrome", fillet([(x, 1.84, 0.0), (x, 1.94, 0.0), (x + 0.3, 1.94, 0.0), (x + 0.3, 1.9, 0.0)], 0.05), 0.01
    )
    yield cylinder("chrome", 0.09, 0.02, (x + 0.3, 1.88, 0.0), sides=22)


def _whirlpool(width: float) -> Iterator[Solid]:
    """Build a wide whirlpool bathtub: a rectangle around an oval basin with jets and a headrest."""
    outer = [np.insert(loop(width, 0.8, 48, 12.0), 1, y, axis=1) for y in (0.0, 0.54, 0.56)]
    inner = [
        np.insert(loop(w, d, 48, 2.6), 1, y, axis=1)
        for w, d, y in ((1.5, 0.64, 0.56), (1.4, 0.56, 0.4), (1.1, 0.42, 0.14))
    ]
    yield join_loops("ceramic", [*outer, *inner])
    for s in (-1, 1):
        for x in (-0.35, 0.0, 0.35):
            yield disc("chrome", 0.028, 0.012, (x, 0.3, s * 0.23 - 0.006), 14)
    yield rounded_box("black", (0.08, 0.12, 0.26), (0.68, 0.45, 0.0), 0.03, 3)
    for k in range(3):
        yield cylinder("chrome", 0.022, 0.02, (-0.2 + 0.08 * k, 0.555, 0.36), sides=14)
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.56, 0.05 - width / 2, "lever"))


def _deep(width: float) -> Iterator[Solid]:
    """Build a short, deep, square stone bathtub with a wooden rim, a bench inside and a step before it."""
    wide = 0.75 * width
    yield tub("stone", [(0.0, wide, 0.9, 0.0), (0.66, wide, 0.9, 0.0)], 0.07, 16.0, 44)
    for s in (-1, 1):
        yield rounded_box("wood", (wide + 0.04, 0.035, 0.1), (0.0, 0.655, s * 0.42), 0.012, 2)
        yield rounded_box("wood", (0.1, 0.035, 0.74), (s * (wide / 2 - 0.03), 0.655, 0.0), 0.012, 2)
    yield rounded_box("stone", (0.26, 0.36, 0.74), (wide / 2 - 0.2, 0.05, 0.0), 0.02, 2)
    yield rounded_box("wood", (0.6, 0.2, 0.26), (0.0, 0.0, 0.58), 0.012, 2)
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.69, 0.06 - wide / 2, "lever"))


_BATHTUB_KINDS = {
    "builtin": _builtin,
    "free": _free,
    "claw": _claw,
    "corner": _corner_tub,
    "barrel": _barrel,
    "slipper": _slipper,
    "panelled": _panelled,
    "screened": _screened,
    "whirlpool": _whirlpool,
    "deep": _deep,
}


def bathtub(kind: str = "builtin", width: float = 1.7) -> Iterator[Solid]:
    """Build a bathtub: built-in, freestanding, claw-foot, corner, wooden, with jets or with a glass pane."""
    yield from _BATHTUB_KINDS[kind](width)


TUBS = (
    *(design(bathtub, kind=kind) for kind in ("builtin", "free", "claw", "corner", "barrel")),
    design(bathtub, width=1.5),
    *(design(bathtub, kind=kind) for kind in ("slipper", "panelled", "screened", "whirlpool", "deep")),
)


FAMILIES = (FurnitureFamily("bathtub", "bathtub", TUBS),)


def tub(
    slot: str, levels: list[tuple[float, float, float, float]], wall: float = 0.035, power: float = 4.0, sides: int = 36
) -> Solid:
    """Build an open bowl with a superelliptic plan.

    Args:
        slot: Slot name.
        levels: Height, width (x), depth (z) and shift along x of the outer surface, from the bottom up [m].
        wall: Wall thickness [m].
        power: Exponent of the superellipse; 2 is an ellipse, higher is squarer.
        sides: Number of facets around.
    """
    outer = [np.insert(loop(w, d, sides, power) + np.array([x, 0.0]), 1, y, axis=1) for y, w, d, x in levels]
    inner = [
        np.insert(
            loop(w - 2 * wall, d - 2 * wall, sides, power) + np.array([x, 0.0]), 1, max(y, levels[0][0] + wall), axis=1
        )
        for y, w, d, x in levels
    ]
    return join_loops(slot, [*outer, *inner[::-1]])
