"""Ceiling-mounted lamps."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.shapes.revolve import revolve, shade
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import rod
from home_procgen.shapes.transforms import Piece, rotate_pieces, translate
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb


def _bowl() -> Iterator[Piece]:
    yield revolve("opal", [(0.03, 0.0), (0.14, 0.02), (0.2, 0.08)], sides=30, steps=3)
    yield revolve("chrome", [(0.205, 0.075), (0.215, 0.085), (0.2, 0.1)], sides=30, steps=1)
    yield ball("chrome", 0.012, (0.0, 0.0, 0.0), 10, 6)
    yield Bulb((0.0, -0.04, 0.0), 60.0)


def _square() -> Iterator[Piece]:
    yield rounded_box("opal", (0.4, 0.06, 0.4), (0.0, 0.0, 0.0), 0.02, 3)
    yield rounded_box("wood", (0.44, 0.04, 0.44), (0.0, 0.05, 0.0), 0.008, 2)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _disc() -> Iterator[Piece]:
    yield revolve("opal", [(0.22, 0.0), (0.24, 0.015), (0.24, 0.04)], sides=36, steps=2)
    yield revolve("black", [(0.25, 0.02), (0.25, 0.05), (0.2, 0.06)], sides=36, steps=1)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _rail() -> Iterator[Piece]:
    yield rounded_box("white", (1.0, 0.03, 0.04), (0.0, 0.14, 0.0), 0.006, 1)
    for i in range(4):
        x = -0.39 + 0.26 * i
        yield rod("white", (x, 0.09, 0.0), (x, 0.145, 0.0), 0.008)
        spot = [
            shade("white", [(0.04, -0.06), (0.035, 0.04), (0.02, 0.06)], (0.0, 0.0, 0.0), 0.004, 16, 1),
            *bulb(-0.03, 15.0, radius=0.02, light=-0.09),
        ]
        yield from translate(rotate_pieces(spot, 0, 0.4 * (-1) ** i), x, 0.065, 0.0)


def _cluster() -> Iterator[Piece]:
    yield revolve("brass", [(0.12, 0.2), (0.12, 0.22), (0.05, 0.23)], sides=26, steps=1)
    for i in range(5):
        a = 2 * np.pi * i / 5
        x, z, y = 0.16 * np.cos(a), 0.16 * np.sin(a), 0.08 + 0.03 * (i % 2)
        yield rod("brass", (0.4 * x, 0.21, 0.4 * z), (x, y, z), 0.007)
        yield ball("opal", 0.07, (x, y, z), 16, 10)
        yield Bulb((x, y - 0.1, z), 12.0)


_CEILING_KINDS = {
    "bowl": _bowl,
    "square": _square,
    "disc": _disc,
    "rail": _rail,
    "cluster": _cluster,
}


def ceiling(kind: str = "bowl") -> Iterator[Piece]:
    """Build a ceiling-mounted lamp: a bowl, a square, a disc, a rail with spots or a cluster."""
    yield from _CEILING_KINDS[kind]()


CEILING = design_kinds(ceiling, "bowl", "square", "disc", "rail", "cluster")


FAMILIES = (FurnitureFamily("ceiling_lamp", "chandelier", CEILING),)
