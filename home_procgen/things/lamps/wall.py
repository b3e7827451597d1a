"""Wall lamps."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, shade, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.shapes.transforms import Piece
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb, disc

_WALL_Z = -0.09  # [m], z of the wall surface


def _cone_wall_lamp() -> Iterator[Piece]:
    yield vessel("paint", [(0.03, 0.0), (0.05, 0.08), (0.09, 0.2)], 0.005, (0.0, 0.0, 0.0), 22, 2)
    yield rounded_box("paint", (0.06, 0.1, 0.05), (0.0, 0.03, -0.065), 0.01, 1)
    yield from bulb(0.14, 40.0, light=0.24)


def _on_arms(kind: str) -> Iterator[Piece]:
    for x in (0.0,) if kind == "shade" else (-0.09, 0.09):
        yield rounded_box("brass", (0.07, 0.12, 0.015), (0.0, 0.06, _WALL_Z), 0.006, 2)
        yield tube("brass", fillet([(0.0, 0.11, _WALL_Z), (x, 0.06, 0.0), (x, 0.13, 0.0)], 0.05, 4), 0.007)
        yield revolve("brass", [(0.01, 0.12), (0.03, 0.13), (0.03, 0.14)], (x, 0.0, 0.0), 14, 1)
        yield cylinder("cream", 0.012, 0.07, (x, 0.13, 0.0), sides=10)
        yield from bulb(0.22, 25.0, x, 0.0, 0.018)
        if kind == "shade":
            yield shade("shade", [(0.085, 0.0), (0.055, 0.12)], (x, 0.16, 0.0), 0.004, 20)


def _bulkhead() -> Iterator[Piece]:
    yield disc("white", 0.12, 0.03, (0.0, 0.12, _WALL_Z), 26)
    yield ball("opal", (0.1, 0.1, 0.07), (0.0, 0.12, -0.055), 20, 12)
    for t in (-0.05, 0.05):
        yield tube(
            "white",
            [(0.1 * np.cos(a), 0.12 + t, -0.06 + 0.08 * np.sin(a)) for a in np.linspace(0, np.pi, 10)],
            0.006,
            6,
        )
    yield Bulb((0.0, 0.12, 0.06), 40.0)


def _swing() -> Iterator[Piece]:
    yield rounded_box("black", (0.06, 0.16, 0.02), (0.0, 0.0, -0.2), 0.008, 1)
    yield rod("black", (0.0, 0.08, -0.19), (0.12, 0.08, -0.05), 0.008)
    yield rod("black", (0.12, 0.08, -0.05), (-0.02, 0.08, 0.1), 0.008)
    yield ball("brass", 0.014, (0.12, 0.08, -0.05), 10, 6)
    yield shade("black", [(0.08, -0.02), (0.07, 0.04), (0.03, 0.1)], (-0.02, 0.0, 0.13), 0.004, 20, 2)
    yield from bulb(0.02, 25.0, -0.02, 0.13, 0.025, light=-0.05)


def _half() -> Iterator[Piece]:
    outline = [(0.15 * np.cos(a), 0.15 * np.sin(a) - 0.075) for a in np.linspace(0, np.pi, 16)]
    for k in range(4):
        yield prism(
            "opal",
            [(x * (0.7 + 0.1 * k), (z + 0.075) * (0.7 + 0.1 * k) - 0.075) for x, z in outline],
            0.03,
            (0.0, 0.03 * k, 0.0),
            "top",
        )
    yield Bulb((0.0, 0.18, 0.02), 40.0)


def _picture() -> Iterator[Piece]:
    yield rounded_box("brass", (0.1, 0.05, 0.015), (0.0, 0.0, -0.13), 0.006, 1)
    yield tube("brass", fillet([(0.0, 0.03, -0.12), (0.0, 0.12, -0.1), (0.0, 0.13, 0.0)], 0.06), 0.006)
    yield tube("brass", [(-0.17, 0.13, 0.01), (0.17, 0.13, 0.01)], 0.024, 12)
    yield tube("bulb", [(-0.15, 0.112, 0.016), (0.15, 0.112, 0.016)], 0.012)
    yield Bulb((0.0, 0.08, 0.02), 20.0)


def _globe_wall_lamp() -> Iterator[Piece]:
    yield disc("brass", 0.055, 0.015, (0.0, 0.16, _WALL_Z), 20)
    yield tube("brass", fillet([(0.0, 0.16, _WALL_Z), (0.0, 0.16, 0.0), (0.0, 0.11, 0.0)], 0.03), 0.008)
    yield ball("opal", 0.07, (0.0, 0.07, 0.0), 20, 12)
    yield Bulb((0.0, -0.03, 0.02), 40.0)


def _lantern_wall_lamp() -> Iterator[Piece]:
    yield rounded_box("iron", (0.09, 0.18, 0.015), (0.0, 0.1, -0.13), 0.006, 1)
    yield tube("iron", fillet([(0.0, 0.2, -0.12), (0.0, 0.32, -0.08), (0.0, 0.3, 0.0)], 0.06), 0.007)
    yield revolve("iron", [(0.03, 0.0), (0.075, 0.03)], sides=6, steps=1)
    yield revolve("glass", [(0.07, 0.03), (0.085, 0.2)], sides=6, steps=1)
    yield revolve("iron", [(0.1, 0.2), (0.02, 0.28), (0.01, 0.3)], sides=6, steps=1)
    yield from bulb(0.1, 40.0, radius=0.025, light=-0.03)


def _tube() -> Iterator[Piece]:
    yield rounded_box("chrome", (0.08, 0.1, 0.03), (0.0, 0.2, -0.05), 0.008, 1)
    yield tube("opal", [(0.0, 0.02, 0.0), (0.0, 0.48, 0.0)], 0.025, 14)
    for y in (0.0, 0.46):
        yield cylinder("chrome", 0.029, 0.04, (0.0, y, 0.0), sides=16)
    yield Bulb((0.0, 0.25, 0.06), 30.0)


def _block() -> Iterator[Piece]:
    yield rounded_box("paint", (0.1, 0.2, 0.1), (0.0, 0.0, -0.04), 0.012, 3)
    yield rounded_box("paint", (0.13, 0.06, 0.012), (0.0, 0.07, -0.09), 0.005, 2)
    for y in (-0.004, 0.196):
        yield box("bulb", (0.07, 0.008, 0.07), (0.0, y, -0.04))
    for y in (-0.05, 0.25):
        yield Bulb((0.0, y, -0.03), 20.0)


_WALL_LAMP_KINDS = {
    "cone": _cone_wall_lamp,
    "shade": partial(_on_arms, "shade"),
    "candles": partial(_on_arms, "candles"),
    "bulkhead": _bulkhead,
    "swing": _swing,
    "half": _half,
    "picture": _picture,
    "globe": _globe_wall_lamp,
    "lantern": _lantern_wall_lamp,
    "tube": _tube,
    "block": _block,
}


def wall_lamp(kind: str = "cone") -> Iterator[Piece]:
    """Build a wall lamp: cone, shade, candles, bulkhead, swing, half bowl, picture, globe, lantern, tube or block."""
    yield from _WALL_LAMP_KINDS[kind]()


WALL_LAMPS = design_kinds(
    wall_lamp, "cone", "shade", "candles", "bulkhead", "swing", "half", "picture", "globe", "lantern", "tube", "block"
)


FAMILIES = (FurnitureFamily("wall_lamp", "wall_lamp", WALL_LAMPS),)
