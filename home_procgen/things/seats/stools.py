"""Stools."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import ring, rod
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import corners, foot_plate


def bar_stool(height: float = 0.72, base: str = "legs", back: bool = False) -> Iterator[Solid]:
    """Build a bar stool with a footrest, on four `legs`, or on one column with any other `base`."""
    yield padded_block("upholstery", (0.38, 0.08, 0.38), (0.0, height - 0.07, 0.0), 3.0, 5)
    if base == "legs":
        for x, z in corners(0.24, 0.24):
            yield rod("wood", (1.7 * x, 0.0, 1.7 * z), (x, height - 0.05, z), 0.014, 0.018)
        for i in range(4):
            turn = np.pi / 4 + i * np.pi / 2
            a, b = ((0.245 * np.cos(turn + k), 0.24, 0.245 * np.sin(turn + k)) for k in (0, np.pi / 2))
            yield rod("wood", a, b, 0.01)
    else:
        yield foot_plate("chrome", 0.2, 0.02)
        yield cylinder("chrome", 0.03, height - 0.06, sides=12)
        yield ring("chrome", 0.15, 0.02, (0.0, 0.26, 0.0))
        yield rod("chrome", (-0.15, 0.26, 0.0), (0.15, 0.26, 0.0), 0.008)
    if back:
        yield surface(
            "upholstery",
            lambda u, v: (
                0.19 * np.cos(np.pi * (1.15 + 0.7 * u)),
                height + 0.26 * v,
                0.19 * np.sin(np.pi * (1.15 + 0.7 * u)),
            ),
            10,
            3,
            0.03,
        )


def milking_stool() -> Iterator[Solid]:
    """Build a round wooden top on three splayed legs."""
    yield revolve("wood", [(0.15, 0.0), (0.17, 0.01), (0.17, 0.03), (0.155, 0.04)], (0.0, 0.41, 0.0), 24, 1)
    yield from repeat_around([rod("wood", (0.0, 0.0, 0.19), (0.0, 0.42, 0.1), 0.013, 0.019, 10)], 3)
    yield ring("wood", 0.14, 0.016, (0.0, 0.17, 0.0), 1, 18)


STOOLS = (
    design(bar_stool), design(bar_stool, base="column"), design(bar_stool, base="column", back=True, height=0.78),
    design(bar_stool, height=0.66, back=True), design(milking_stool),
)  # fmt: skip


FAMILIES = (FurnitureFamily("stool", "chair", STOOLS),)
