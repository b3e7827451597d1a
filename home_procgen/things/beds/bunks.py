"""Bunk beds."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, move
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, rod, tube
from home_procgen.things.beds.bedding import MATTRESS_LENGTH, bedding
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import drawers


def bunk(width: float = 0.95, slide: bool = False, desk: bool = False) -> Iterator[Solid]:
    """Build a bunk bed with a ladder and guard rails; optionally a desk below, or a slide."""
    x, z = width / 2 + 0.02, MATTRESS_LENGTH / 2 + 0.02
    for sx in (-x, x):
        for sz in (-z, z):
            yield beam("wood", (sx, 0.0, sz), (sx, 1.72, sz), 0.07)
        for y in (1.28, 1.48, 1.68):
            yield beam("wood", (sx, y, -z), (sx, y, z if sx < 0 or y < 1.3 else z - 0.45), 0.025, 0.09)
    for sz in (-z, z):
        for y in (0.32, 1.28, 1.5, 1.68):
            yield beam("wood", (-x, y, sz), (x, y, sz), 0.025, 0.09)
    yield box("wood", (width, 0.03, 2 * z - 0.04), (0.0, 1.28, 0.0))
    yield from bedding(width - 0.06, MATTRESS_LENGTH - 0.04, 1.31, "made", 1, 0.13, seed=8)
    if desk:
        yield rounded_box("wood_1", (width, 0.03, 1.3), (-0.1, 0.72, -0.3), 0.008, 1)
        yield from (move(p, (0.0, 0.0, 0.8)) for p in drawers("wood_1", 0.7, 0.9, (-0.35, 0.1, 0.0), 1, 3, opens=0.15))
        yield box("wood", (width - 0.1, 1.0, 0.3), (-0.05, 0.02, 0.65))
    else:
        for sx in (-x, x):
            yield beam("wood", (sx, 0.32, -z), (sx, 0.32, z), 0.025, 0.12)
        yield box("wood", (width, 0.03, 2 * z - 0.04), (0.0, 0.3, 0.0))
        yield from bedding(width - 0.06, MATTRESS_LENGTH - 0.04, 0.33, "rumpled", 1, 0.13, seed=9)
    if slide:
        yield surface(
            "bright", lambda u, v: (x + 0.03 + 1.35 * u, 1.3 * (1 - u) ** 1.25 + 0.02, z - 0.45 + 0.4 * v), 12, 3, 0.02
        )
        for dz in (0.0, 0.4):
            yield tube(
                "bright",
                [(x + 0.03 + 1.35 * u, 1.3 * (1 - u) ** 1.25 + 0.09, z - 0.45 + dz) for u in np.linspace(0, 1, 9)],
                0.03,
            )
    for dz in (0.06, 0.4):
        yield beam(
            "wood",
            (x + 0.26, 0.0, -z + dz) if slide else (x + 0.26, 0.0, z - dz),
            (x + 0.03, 1.66, -z + dz) if slide else (x + 0.03, 1.66, z - dz),
            0.035,
        )
    for i in range(5):
        y = 0.25 + 0.26 * i
        at = x + 0.26 - 0.23 * y / 1.66
        a, b = (-z + 0.06, -z + 0.4) if slide else (z - 0.4, z - 0.06)
        yield rod("wood", (at, y, a), (at, y, b), 0.015)


BUNKS = (design(bunk), design(bunk, desk=True), design(bunk, slide=True))


FAMILIES = (FurnitureFamily("bunker_bed", "bunker_bed", BUNKS),)
