"""Clocks for walls, tables and floors."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, kinds_of
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, move, rotate


def _face(radius: float, y: float, z: float, numbers: int = 12) -> Iterator[Solid]:
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
    yield from _face(0.14, 0.16, -0.01)
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
    yield rounded("wood", (0.3, 0.3, 0.035), (0.0, 0.0, -0.02), 0.03, 3)
    yield from _face(0.12, 0.15, -0.004, 4)


def _pendulum_clock(kind: str) -> Iterator[Solid]:
    base = 1.45 if kind == "tall" else 0.42
    if kind == "tall":
        yield rounded("wood", (0.42, 0.3, 0.28), (0.0, 0.0, 0.0), 0.015, 2)
        yield rounded("wood", (0.28, 0.95, 0.2), (0.0, 0.28, -0.01), 0.01, 1)
        yield rounded("wood", (0.4, 0.5, 0.26), (0.0, 1.2, 0.0), 0.012, 1)
        yield prism("wood", fillet([(-0.22, 0.0), (0.22, 0.0), (0.0, 0.2)], 0.12, 5, True), 0.26, (0.0, 1.7, 0.0))
    else:
        yield rounded("wood", (0.26, 0.62, 0.12), (0.0, 0.0, -0.02), 0.012, 1)
        yield prism("wood", fillet([(-0.16, 0.0), (0.16, 0.0), (0.0, 0.12)], 0.08, 4, True), 0.12, (0.0, 0.62, -0.02))
    z = 0.131 if kind == "tall" else 0.041
    yield from _face(0.15 if kind == "tall" else 0.1, base, z)
    low = 0.45 if kind == "tall" else 0.1
    zz = 0.1 if kind == "tall" else 0.046
    yield box("black", (0.2 if kind == "tall" else 0.16, base - low - 0.22, 0.006), (0.0, low - 0.03, zz - 0.006))
    yield rod("brass", (0.0, low + 0.06, zz), (0.0, base - 0.24, zz), 0.004, sides=6)
    yield disc("brass", 0.05 if kind == "tall" else 0.035, 0.01, (0.0, low + 0.05, zz), 20)


def _alarm() -> Iterator[Solid]:
    yield disc("bright", 0.065, 0.05, (0.0, 0.085, -0.03), 28)
    yield from _face(0.055, 0.085, 0.02)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.035, 0.03, -0.005), (s * 0.05, 0.0, 0.0), 0.006)
        yield ball("brass", (0.03, 0.022, 0.03), (s * 0.038, 0.15, -0.005), 12, 6)
    yield tube("chrome", fillet([(-0.03, 0.155, -0.005), (0.0, 0.19, -0.005), (0.03, 0.155, -0.005)], 0.03), 0.004, 6)


def _mantel() -> Iterator[Solid]:
    shape = fillet(
        [(-0.2, 0.0), (0.2, 0.0), (0.19, 0.06), (0.1, 0.1), (0.0, 0.28), (-0.1, 0.1), (-0.19, 0.06)], 0.07, 4, True
    )
    yield prism("wood", shape, 0.11)
    yield rounded("wood", (0.44, 0.03, 0.14), (0.0, 0.0, 0.0), 0.008, 1)
    yield from _face(0.075, 0.13, 0.056)


def _digital() -> Iterator[Solid]:
    yield rounded("black", (0.2, 0.08, 0.06), (0.0, 0.0, 0.0), 0.012, 2)
    yield box("screen", (0.17, 0.055, 0.004), (0.0, 0.012, 0.03))
    for k, x in enumerate((-0.06, -0.025, 0.02, 0.055)):
        for dy, w, h in ((0.0, 0.02, 0.004), (0.018, 0.02, 0.004), (0.036, 0.02, 0.004)):
            yield box("red", (w, h, 0.002), (x, 0.02 + dy, 0.032))
        for s in (-1, 1):
            if (k + s) % 3:
                yield box("red", (0.004, 0.04, 0.002), (x + s * 0.009, 0.02, 0.032))


def _cuckoo() -> Iterator[Solid]:
    yield rounded("wood", (0.22, 0.22, 0.12), (0.0, 0.06, -0.02), 0.008, 1)
    for s in (-1, 1):
        yield prism("wood_1", [(0.0, 0.42), (s * 0.18, 0.26), (s * 0.18, 0.24), (0.0, 0.395)], 0.16)
        yield rod("brass", (s * 0.04, -0.22, 0.02), (s * 0.04, 0.06, 0.02), 0.002, sides=4)
        yield turned("bark", [(0.012, -0.3), (0.02, -0.26), (0.01, -0.21)], (s * 0.04, 0.0, 0.02), 10, 2)
    yield prism("wood", [(-0.11, 0.28), (0.11, 0.28), (0.0, 0.38)], 0.11, (0.0, 0.0, -0.02))
    yield from _face(0.07, 0.16, 0.041)
    yield box("black", (0.04, 0.05, 0.006), (0.0, 0.285, 0.036))
    yield ball("yellow", 0.016, (0.0, 0.31, 0.055), 10, 6)
    yield disc("brass", 0.025, 0.008, (0.0, -0.02, 0.02), 16)
    yield rod("brass", (0.0, -0.02, 0.022), (0.0, 0.07, 0.022), 0.003, sides=5)


_CLOCK_KINDS = {
    "round": partial(_rim_clock, "round"),
    "sun": partial(_rim_clock, "sun"),
    "square": _square_clock,
    "pendulum": partial(_pendulum_clock, "pendulum"),
    "tall": partial(_pendulum_clock, "tall"),
    "alarm": _alarm,
    "mantel": _mantel,
    "digital": _digital,
    "cuckoo": _cuckoo,
}


def clock(kind: str = "round") -> Iterator[Solid]:
    """On a wall: round, sun, pendulum, square, cuckoo; on a table: alarm, mantel, digital; on the floor: tall."""
    yield from _CLOCK_KINDS[kind]()


WALL_CLOCKS = kinds_of(clock, "round", "sun", "square", "pendulum", "cuckoo")

TABLE_CLOCKS = kinds_of(clock, "alarm", "mantel", "digital")


FAMILIES = (
    Family("wall_clock", "clock", WALL_CLOCKS),
    Family("table_clock", "clock", TABLE_CLOCKS),
    Family("tall_clock", "clock", kinds_of(clock, "tall")),
)
