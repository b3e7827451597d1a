"""Wall clocks, and dials shared by all clocks."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import disc


def face(radius: float, y: float, z: float, numbers: int = 12) -> Iterator[Solid]:
    """Build a dial with marks and hands, with its centre at (y, z) [m]."""
    yield disc("face", radius, 0.008, (0.0, y, z), 30)
    for i in range(numbers):
        a = 2 * np.pi * i / numbers
        r = 0.84 * radius
        yield move(
            rotate(box("black", (0.05 * radius, 0.16 * radius, 0.004), (0.0, r - 0.08 * radius, 0.0)), 2, -a),
            (0.0, y, z + 0.009),
        )
    for turn, long in ((-0.9, 0.5), (0.9, 0.72)):
        yield move(
            rotate(box("black", (0.06 * radius, long * radius, 0.004), (0.0, 0.0, 0.0)), 2, turn),
            (0.0, y, z + 0.013),
        )
    yield disc("brass", 0.07 * radius, 0.012, (0.0, y, z + 0.008), 12)


def _rim_clock(kind: str) -> Iterator[Solid]:
    yield from face(0.14, 0.16, -0.01)
    yield ring("brass" if kind == "sun" else "black", 0.15, 0.024, (0.0, 0.16, -0.004), 2, 36)
    if kind == "sun":
        for i in range(16):
            a = 2 * np.pi * i / 16
            yield rod(
                "brass",
                (0.16 * np.cos(a), 0.16 + 0.16 * np.sin(a), -0.005),
                ((0.24 + 0.06 * (i % 2)) * np.cos(a), 0.16 + (0.24 + 0.06 * (i % 2)) * np.sin(a), -0.005),
                0.007,
                0.003,
                6,
            )


def _square_clock() -> Iterator[Solid]:
    yield rounded_box("wood", (0.3, 0.3, 0.035), (0.0, 0.0, -0.02), 0.03, 3)
    yield from face(0.12, 0.15, -0.004, 4)


def pendulum_clock(kind: str) -> Iterator[Solid]:
    """Build a pendulum clock in a wooden case: tall, or for a wall."""
    base = 1.45 if kind == "tall" else 0.42
    if kind == "tall":
        yield rounded_box("wood", (0.42, 0.3, 0.28), (0.0, 0.0, 0.0), 0.015, 2)
        yield rounded_box("wood", (0.28, 0.95, 0.2), (0.0, 0.28, -0.01), 0.01, 1)
        yield rounded_box("wood", (0.4, 0.5, 0.26), (0.0, 1.2, 0.0), 0.012, 1)
        yield prism("wood", fillet([(-0.22, 0.0), (0.22, 0.0), (0.0, 0.2)], 0.12, 5, True), 0.26, (0.0, 1.7, 0.0))
    else:
        yield rounded_box("wood", (0.26, 0.62, 0.12), (0.0, 0.0, -0.02), 0.012, 1)
        yield prism("wood", fillet([(-0.16, 0.0), (0.16, 0.0), (0.0, 0.12)], 0.08, 4, True), 0.12, (0.0, 0.62, -0.02))
    z = 0.131 if kind == "tall" else 0.041
    yield from face(0.15 if kind == "tall" else 0.1, base, z)
    low = 0.45 if kind == "tall" else 0.1
    zz = 0.1 if kind == "tall" else 0.046
    yield box("black", (0.2 if kind == "tall" else 0.16, base - low - 0.22, 0.006), (0.0, low - 0.03, zz - 0.006))
    yield rod("brass", (0.0, low + 0.06, zz), (0.0, base - 0.24, zz), 0.004, sides=6)
    yield disc("brass", 0.05 if kind == "tall" else 0.035, 0.01, (0.0, low + 0.05, zz), 20)


def _cuckoo() -> Iterator[Solid]:
    yield rounded_box("wood", (0.22, 0.22, 0.12), (0.0, 0.06, -0.02), 0.008, 1)
    for s in (-1, 1):
        yield prism("wood_1", [(0.0, 0.42), (s * 0.18, 0.26), (s * 0.18, 0.24), (0.0, 0.395)], 0.16)
        yield rod("brass", (s * 0.04, -0.22, 0.02), (s * 0.04, 0.06, 0.02), 0.002, sides=4)
        yield revolve("bark", [(0.012, -0.3), (0.02, -0.26), (0.01, -0.21)], (s * 0.04, 0.0, 0.02), 10, 2)
    yield prism("wood", [(-0.11, 0.28), (0.11, 0.28), (0.0, 0.38)], 0.11, (0.0, 0.0, -0.02))
    yield from face(0.07, 0.16, 0.041)
    yield box("black", (0.04, 0.05, 0.006), (0.0, 0.285, 0.036))
    yield ball("yellow", 0.016, (0.0, 0.31, 0.055), 10, 6)
    yield disc("brass", 0.025, 0.008, (0.0, -0.02, 0.02), 16)
    yield rod("brass", (0.0, -0.02, 0.022), (0.0, 0.07, 0.022), 0.003, sides=5)


def _ball_clock() -> Iterator[Solid]:
    """Build a clock of twelve balls on rods around a hub."""
    yield disc("brass", 0.05, 0.03, (0.0, 0.2, -0.02), 24)
    for i in range(12):
        c, s = np.cos(np.pi * i / 6), np.sin(np.pi * i / 6)
        yield rod("brass", (0.04 * c, 0.2 + 0.04 * s, -0.006), (0.17 * c, 0.2 + 0.17 * s, -0.006), 0.0035, sides=6)
        yield ball("bright", 0.02, (0.18 * c, 0.2 + 0.18 * s, -0.006), 10, 6)
    for turn, long in ((-0.9, 0.07), (0.9, 0.11)):
        yield move(rotate(box("black", (0.01, long, 0.004), (0.0, 0.0, 0.0)), 2, turn), (0.0, 0.2, 0.013))
    yield disc("black", 0.012, 0.012, (0.0, 0.2, 0.009), 12)


def _hexagon() -> Iterator[Solid]:
    """Build a kitchen clock in a hexagonal case with a rim."""
    way = np.pi * (np.arange(6) + 0.5) / 3
    outline = np.stack([0.17 * np.cos(way), 0.16 + 0.17 * np.sin(way)], -1)
    yield prism("bright", outline, 0.04, (0.0, 0.0, -0.02))
    yield tube("white", np.insert(outline, 2, 0.002, axis=1), 0.011, 8, closed=True)
    yield from face(0.125, 0.16, 0.0)


_CLOCK_KINDS = {
    "round": partial(_rim_clock, "round"),
    "sun": partial(_rim_clock, "sun"),
    "square": _square_clock,
    "pendulum": partial(pendulum_clock, "pendulum"),
    "cuckoo": _cuckoo,
    "balls": _ball_clock,
    "hexagon": _hexagon,
}


def clock(kind: str = "round") -> Iterator[Solid]:
    """Build a wall clock."""
    yield from _CLOCK_KINDS[kind]()


FAMILIES = (
    FurnitureFamily(
        "wall_clock", "clock", design_kinds(clock, "round", "sun", "square", "pendulum", "cuckoo", "balls", "hexagon")
    ),
)
