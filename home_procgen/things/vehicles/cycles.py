"""Motorcycles, bicycles, tricycles."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from home_procgen.primitives.solids import Solid, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.vehicles.wheels import wheel


def _scooter() -> Iterator[Solid]:
    for z in (-0.62, 0.62):
        yield from wheel(0.0, 0.23, z, 0.23, 0.1)
    yield prism(
        "bright",
        fillet([(-0.85, 0.32), (-0.2, 0.24), (-0.16, 0.3), (-0.24, 0.72), (-0.8, 0.76), (-0.92, 0.6)], 0.1, 4, True),
        0.34,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rounded_box("bright", (0.34, 0.06, 0.6), (0.0, 0.24, 0.1), 0.025, 2)
    yield rotate(rounded_box("bright", (0.42, 0.66, 0.06), (0.0, 0.26, 0.42), 0.028, 3), 0, -0.22, (0.0, 0.26, 0.42))
    yield padded_block("black", (0.3, 0.12, 0.72), (0.0, 0.74, -0.5), 4.0, 6)
    yield tube("chrome", [(0.0, 0.24, 0.62), (0.0, 0.95, 0.34)], 0.03, 10)
    yield ball("bright", (0.12, 0.13, 0.13), (0.0, 1.0, 0.34), 16, 10)
    yield ball("white", (0.08, 0.08, 0.04), (0.0, 1.0, 0.45), 14, 8)
    yield prism(
        "bright",
        fillet([(0.38, 0.42), (0.86, 0.36), (0.84, 0.46), (0.6, 0.54), (0.42, 0.5)], 0.06, 3, True),
        0.16,
        (0.0, 0.0, 0.0),
        "side",
    )


def _road() -> Iterator[Solid]:
    for z in (-0.72, 0.72):
        yield from wheel(0.0, 0.32, z, 0.32, 0.13)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.09, 0.32, 0.72), (s * 0.09, 0.92, 0.44), 0.022)
        yield rod("black", (s * 0.09, 0.32, -0.72), (s * 0.09, 0.42, -0.1), 0.026)
        yield tube(
            "chrome",
            fillet(
                [(s * 0.12, 0.4, 0.22), (s * 0.17, 0.26, 0.2), (s * 0.17, 0.26, -0.75), (s * 0.17, 0.32, -0.95)],
                0.08,
            ),
            0.035,
            10,
        )
        yield rod("chrome", (s * 0.1, 0.5, -0.55), (s * 0.1, 0.75, -0.45), 0.025)
    yield rounded_box("gray", (0.3, 0.34, 0.44), (0.0, 0.28, 0.05), 0.06, 2)
    for i in range(5):
        yield rounded_box("gray", (0.28, 0.015, 0.24), (0.0, 0.6 + 0.03 * i, 0.08), 0.006, 1)
    yield ball("car", (0.16, 0.15, 0.3), (0.0, 0.82, 0.16), 20, 12)
    yield padded_block("black", (0.26, 0.12, 0.66), (0.0, 0.74, -0.42), 3.0, 6)
    yield prism(
        "car",
        fillet([(-0.5, 0.72), (-1.0, 0.78), (-0.98, 0.7), (-0.6, 0.62)], 0.06, 3, True),
        0.18,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield ball("chrome", (0.1, 0.1, 0.08), (0.0, 0.9, 0.58), 16, 10)
    yield ball("white", (0.085, 0.085, 0.03), (0.0, 0.9, 0.64), 14, 8)
    yield tube("car", [(0.0, 0.62, 0.98), (0.0, 0.68, 0.74), (0.0, 0.62, 0.46)], 0.06, 8)


_MOTORCYCLE_KINDS = {
    "scooter": _scooter,
    "road": _road,
}


def motorcycle(kind: str = "road") -> Iterator[Solid]:
    """Build a motorcycle or a scooter."""
    yield from _MOTORCYCLE_KINDS[kind]()
    yield tube(
        "chrome", fillet([(-0.36, 1.02, 0.24), (-0.2, 1.04, 0.38), (0.2, 1.04, 0.38), (0.36, 1.02, 0.24)], 0.1), 0.013
    )
    for s in (-1, 1):
        yield rod("rubber", (s * 0.28, 1.03, 0.31), (s * 0.38, 1.02, 0.22), 0.02)
        yield tube("chrome", [(s * 0.22, 1.04, 0.36), (s * 0.28, 1.2, 0.38)], 0.006, 6)
        yield ball("chrome", (0.06, 0.045, 0.015), (s * 0.28, 1.22, 0.38), 12, 6)
    yield rod("black", (0.16, 0.28, 0.0), (0.28, 0.0, -0.04), 0.014)


def bicycle(kind: str = "bike") -> Iterator[Solid]:
    """Build a bicycle or a tricycle."""
    if kind == "tricycle":
        yield from wheel(0.0, 0.16, 0.3, 0.16, 0.035, hub="white")
        for s in (-1, 1):
            yield from wheel(s * 0.19, 0.11, -0.22, 0.11, 0.035, hub="white")
        yield rod("red", (-0.19, 0.11, -0.22), (0.19, 0.11, -0.22), 0.012)
        yield tube("red", fillet([(0.0, 0.12, -0.22), (0.0, 0.24, -0.05), (0.0, 0.36, 0.22)], 0.1), 0.018)
        yield rod("red", (0.0, 0.16, 0.3), (0.0, 0.56, 0.19), 0.014)
        yield tube("chrome", fillet([(-0.17, 0.54, 0.1), (0.0, 0.58, 0.19), (0.17, 0.54, 0.1)], 0.06), 0.011)
        yield padded_block("black", (0.16, 0.05, 0.2), (0.0, 0.28, -0.1), 3.0, 5)
        for s in (-1, 1):
            yield rod("chrome", (0.0, 0.16, 0.3), (s * 0.1, 0.16 + 0.06 * s, 0.3), 0.006)
            yield rounded_box("black", (0.07, 0.02, 0.05), (s * 0.12, 0.15 + 0.06 * s, 0.3), 0.006, 1)
        return
    yield from _two_wheels(0.34, kind == "step")


def _two_wheels(r: float, low_step: bool) -> Iterator[Solid]:
    """Build a bicycle with a wheel radius [m]; with a low step it has a basket and mudguards."""
    back, front_ = -0.52, 0.54
    for z in (back, front_):
        yield from wheel(0.0, r, z, r, 0.04, 18)
    crank, seat, head = (0.0, 0.29, -0.08), (0.0, 0.82, -0.24), (0.0, 0.8, 0.36)
    upper = ((0.0, 0.4, -0.1), (0.0, 0.72, 0.38)) if low_step else ((0.0, 0.78, -0.22), head)
    for a, b in ((crank, seat), (crank, (0.0, 0.66, 0.39)), upper):
        yield rod("bright", a, b, 0.016)
    for s in (-1, 1):
        yield rod("bright", crank, (s * 0.05, r, back), 0.009)
        yield rod("bright", (0.0, 0.76, -0.22), (s * 0.05, r, back), 0.008)
        yield rod("bright", (s * 0.03, 0.68, 0.4), (s * 0.05, r, front_), 0.01)
        yield rod("chrome", (s * 0.04, 0.29, -0.08), (s * 0.08, 0.29 + s * 0.16, -0.06), 0.008)
        yield rounded_box("black", (0.09, 0.02, 0.08), (s * 0.13, 0.28 + s * 0.16, -0.06), 0.006, 1)
    yield rod("bright", (0.0, 0.66, 0.4), (0.0, 0.94, 0.33), 0.018)
    yield rod("chrome", seat, (0.0, 0.94, -0.28), 0.012)
    yield padded_block("black", (0.15, 0.06, 0.26), (0.0, 0.93, -0.26), 2.6, 6)
    yield tube(
        "chrome", fillet([(-0.28, 0.97, 0.16), (-0.2, 0.98, 0.33), (0.2, 0.98, 0.33), (0.28, 0.97, 0.16)], 0.1), 0.011
    )
    for s in (-1, 1):
        yield rod("rubber", (s * 0.265, 0.972, 0.2), (s * 0.285, 0.97, 0.1), 0.016)
    if low_step:
        yield rounded_box("cane", (0.34, 0.22, 0.24), (0.0, 0.72, 0.56), 0.03, 2)
        for z in (back, front_):
            arc = [(0.0, r + 0.4 * np.sin(a), z + 0.4 * np.cos(a)) for a in np.linspace(0.3, np.pi - 0.3, 12)]
            yield tube("bright", arc, 0.016, 6)
        yield rounded_box("black", (0.16, 0.016, 0.4), (0.0, 0.74, back), 0.006, 1)
    yield ring("chrome", 0.09, 0.01, (0.035, 0.29, -0.08), 0, 22)
    yield rod("black", (0.06, 0.29, -0.1), (0.2, 0.0, -0.16), 0.008)


def child_bicycle() -> Iterator[Solid]:
    """Build a child's bicycle with stabilisers."""
    size = 0.62
    for piece in bicycle("bike"):
        yield replace(piece, vertices=piece.vertices * size)
    for s in (-1, 1):
        yield from wheel(s * 0.16, 0.05, -0.33, 0.05, 0.02, hub="white")
        yield tube("chrome", [(s * 0.03, 0.21, -0.32), (s * 0.13, 0.19, -0.33), (s * 0.15, 0.05, -0.33)], 0.007, 6)


FAMILIES = (
    FurnitureFamily("motorcycle", "motorcycle", design_kinds(motorcycle, "road", "scooter")),
    FurnitureFamily("bicycle", "bicycle", (*design_kinds(bicycle, "bike", "step"), design(child_bicycle))),
    FurnitureFamily("tricycle", "tricycle", design_kinds(bicycle, "tricycle")),
)
