"""Bins."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.movable_parts import assign_part, lid_part


def _pedal() -> Iterator[Solid]:
    yield revolve("steel", [(0.15, 0.0), (0.15, 0.56)], sides=28, steps=1)
    yield revolve("black", [(0.155, 0.0), (0.155, 0.03)], sides=28, steps=1)
    lid = revolve("steel", [(0.155, 0.56), (0.15, 0.6), (0.08, 0.64), (0.02, 0.645)], sides=28, steps=2)
    yield from assign_part(lid_part(0.56, -0.155), [lid])
    yield rounded_box("black", (0.07, 0.02, 0.06), (0.0, 0.01, 0.17), 0.006, 1)


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
    yield rounded_box("plastic", (0.23, 0.43, 0.23), (0.0, 0.0, 0.0), 0.03, 3)
    yield prism(
        "plastic",
        fillet([(-0.12, 0.42), (0.12, 0.42), (0.1, 0.52), (0.0, 0.58), (-0.1, 0.52)], 0.04, 3, True),
        0.23,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rotate(rounded_box("gray", (0.17, 0.1, 0.012), (0.0, 0.44, 0.085), 0.005, 1), 0, -0.5, (0.0, 0.5, 0.08))


def _two() -> Iterator[Solid]:
    for s, slot in ((-1, "green"), (1, "blue")):
        yield rounded_box("gray", (0.24, 0.5, 0.34), (s * 0.125, 0.01, 0.0), 0.02, 2)
        lid = rounded_box(slot, (0.235, 0.04, 0.34), (s * 0.125, 0.51, 0.0), 0.016, 2)
        yield from assign_part(lid_part(0.51, -0.17, s * 0.125), [lid])
        yield box(slot, (0.1, 0.1, 0.004), (s * 0.125, 0.22, 0.17))


def _barrel() -> Iterator[Solid]:
    yield revolve("plastic", [(0.16, 0.0), (0.19, 0.55), (0.2, 0.56)], sides=22, steps=1)
    yield revolve("black", [(0.205, 0.56), (0.2, 0.6), (0.06, 0.64), (0.04, 0.66)], sides=22, steps=1)
    for s in (-1, 1):
        yield tube(
            "black",
            fillet(
                [(s * 0.19, 0.5, -0.05), (s * 0.24, 0.5, -0.04), (s * 0.24, 0.5, 0.04), (s * 0.19, 0.5, 0.05)], 0.02
            ),
            0.01,
            6,
        )


def _paper() -> Iterator[Solid]:
    yield vessel("plastic", [(0.1, 0.0), (0.112, 0.14), (0.13, 0.3)], 0.006, sides=24, steps=2)
    for y, r in ((0.06, 0.105), (0.29, 0.13)):
        yield ring("plastic", r, 0.012, (0.0, y, 0.0), 1, 24)
    for i in range(5):
        at = (0.05 * np.cos(2.2 * i), 0.2 + 0.03 * (i % 3), 0.05 * np.sin(2.2 * i))
        yield ball("paper", 0.045, at, 7, 5)


def _tall_pedal() -> Iterator[Solid]:
    yield rounded_box("steel", (0.3, 0.56, 0.24), (0.0, 0.03, 0.0), 0.03, 3)
    yield rounded_box("black", (0.31, 0.04, 0.25), (0.0, 0.0, 0.0), 0.01, 1)
    yield from assign_part(
        lid_part(0.595, -0.13), [rounded_box("steel", (0.31, 0.05, 0.26), (0.0, 0.595, 0.0), 0.022, 3)]
    )
    yield rounded_box("black", (0.14, 0.014, 0.06), (0.0, 0.012, 0.14), 0.005, 1)


def _dome() -> Iterator[Solid]:
    yield revolve("paint", [(0.14, 0.0), (0.14, 0.46)], sides=26, steps=1)
    yield revolve("paint", [(0.146, 0.46), (0.14, 0.54), (0.1, 0.6), (0.02, 0.63)], sides=26, steps=3)
    for y in (0.01, 0.46):
        yield ring("chrome", 0.142, 0.016, (0.0, y, 0.0), 1, 28)
    flap = rounded_box("chrome", (0.14, 0.1, 0.02), (0.0, 0.48, 0.128), 0.008, 2)
    yield rotate(flap, 0, -0.35, (0.0, 0.48, 0.128))


def _bag() -> Iterator[Solid]:
    """Build a bag in a rod frame below a lid."""
    for x in (-0.16, 0.16):
        for z in (-0.13, 0.13):
            yield rod("iron", (x, 0.0, z), (x, 0.66, z), 0.009)
    for y in (0.08, 0.64):
        corners = [(-0.16, y, -0.13), (0.16, y, -0.13), (0.16, y, 0.13), (-0.16, y, 0.13)]
        yield tube("iron", fillet(corners, 0.03, 2, True), 0.008, 6, closed=True)
    yield vessel("black", [(0.07, 0.1), (0.125, 0.2), (0.12, 0.45), (0.15, 0.64)], 0.004, sides=14, steps=2)
    yield from assign_part(
        lid_part(0.655, -0.15), [rounded_box("plastic", (0.36, 0.02, 0.3), (0.0, 0.655, 0.0), 0.008, 2)]
    )


_BIN_KINDS = {
    "pedal": _pedal,
    "wire": _wire,
    "woven": _woven,
    "swing": _swing,
    "two": _two,
    "barrel": _barrel,
    "paper": _paper,
    "tall": _tall_pedal,
    "dome": _dome,
    "bag": _bag,
}


def bin_(kind: str = "pedal") -> Iterator[Solid]:
    """Build a bin: pedal, wire, woven, swing lid, twin, barrel, paper, tall pedal, dome or bag."""
    yield from _BIN_KINDS[kind]()


KINDS = ("pedal", "wire", "woven", "swing", "two", "barrel", "paper", "tall", "dome", "bag")

FAMILIES = (FurnitureFamily("trash_can", "trash_can", design_kinds(bin_, *KINDS)),)
