"""Bins."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, kinds_of
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, rotate


def _pedal() -> Iterator[Solid]:
    yield turned("steel", [(0.15, 0.0), (0.15, 0.56)], sides=28, steps=1)
    yield turned("black", [(0.155, 0.0), (0.155, 0.03)], sides=28, steps=1)
    yield turned("steel", [(0.155, 0.56), (0.15, 0.6), (0.08, 0.64), (0.02, 0.645)], sides=28, steps=2)
    yield rounded("black", (0.07, 0.02, 0.06), (0.0, 0.01, 0.17), 0.006, 1)


def _wire() -> Iterator[Solid]:
    for y, r in ((0.005, 0.1), (0.15, 0.118), (0.3, 0.138)):
        yield ring("iron", r, 0.01, (0.0, y, 0.0), 1, 26)
    for i in range(26):
        a = 2 * np.pi * i / 26
        yield rod(
            "iron",
            (0.1 * np.cos(a), 0.0, 0.1 * np.sin(a)),
            (0.138 * np.cos(a), 0.3, 0.138 * np.sin(a)),
            0.002,
            sides=4,
        )
    yield cylinder("iron", 0.1, 0.006, sides=24)
    for i in range(4):
        yield ball("paper", 0.045, (0.045 * np.cos(2.4 * i), 0.05 + 0.04 * i, 0.045 * np.sin(2.4 * i)), 7, 5)


def _woven() -> Iterator[Solid]:
    yield vessel("cane", [(0.11, 0.0), (0.14, 0.16), (0.15, 0.32)], 0.01, sides=26, steps=2)
    yield ring("cane", 0.147, 0.018, (0.0, 0.32, 0.0), 1, 26)


def _swing() -> Iterator[Solid]:
    yield turned("plastic", [(0.13, 0.0), (0.16, 0.42)], sides=4, steps=1)
    yield prism(
        "plastic",
        fillet([(-0.12, 0.42), (0.12, 0.42), (0.1, 0.52), (0.0, 0.58), (-0.1, 0.52)], 0.04, 3, True),
        0.23,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rotate(rounded("gray", (0.17, 0.1, 0.012), (0.0, 0.44, 0.085), 0.005, 1), 0, -0.5, (0.0, 0.5, 0.08))


def _two() -> Iterator[Solid]:
    for s, slot in ((-1, "green"), (1, "blue")):
        yield rounded("gray", (0.24, 0.5, 0.34), (s * 0.125, 0.01, 0.0), 0.02, 2)
        yield rounded(slot, (0.235, 0.04, 0.34), (s * 0.125, 0.51, 0.0), 0.016, 2)
        yield box(slot, (0.1, 0.1, 0.004), (s * 0.125, 0.22, 0.17))


def _barrel() -> Iterator[Solid]:
    yield turned("plastic", [(0.16, 0.0), (0.19, 0.55), (0.2, 0.56)], sides=22, steps=1)
    yield turned("black", [(0.205, 0.56), (0.2, 0.6), (0.06, 0.64), (0.04, 0.66)], sides=22, steps=1)
    for s in (-1, 1):
        yield tube(
            "black",
            fillet(
                [(s * 0.19, 0.5, -0.05), (s * 0.24, 0.5, -0.04), (s * 0.24, 0.5, 0.04), (s * 0.19, 0.5, 0.05)], 0.02
            ),
            0.01,
            6,
        )


_BIN_KINDS = {
    "pedal": _pedal,
    "wire": _wire,
    "woven": _woven,
    "swing": _swing,
    "two": _two,
    "barrel": _barrel,
}


def bin_(kind: str = "pedal") -> Iterator[Solid]:
    """A bin: with a pedal, of wire, woven, swinging, for paper, for two kinds, a tall barrel."""
    yield from _BIN_KINDS[kind]()


FAMILIES = (Family("trash_can", "trash_can", kinds_of(bin_, "pedal", "wire", "woven", "swing", "two", "barrel")),)
