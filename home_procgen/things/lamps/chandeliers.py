"""Chandeliers with several lights."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import cylinder
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve, shade
from home_procgen.shapes.rounded import ball
from home_procgen.shapes.sweep import beam, ring, rod, tube
from home_procgen.shapes.transforms import Piece
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb


def chandelier(kind: str = "arms", drop: float = 0.9, count: int = 6) -> Iterator[Piece]:
    """Build a chandelier: candle arms, crystal drops, a wheel, branches with balls, a row of domes or shades."""
    yield revolve("brass", [(0.02, drop - 0.04), (0.06, drop - 0.02), (0.06, drop)], sides=18, steps=1)
    if kind == "row":
        yield beam("wood", (-0.5, drop - 0.06, 0.0), (0.5, drop - 0.06, 0.0), 0.05, 0.04)
        for x in (-0.38, 0.0, 0.38):
            yield cylinder("black", 0.004, drop - 0.3, (x, 0.22, 0.0), sides=6)
            yield shade("tint", [(0.12, 0.0), (0.1, 0.1), (0.03, 0.18), (0.02, 0.22)], (x, 0.0, 0.0), 0.004, 22, 3)
            yield from bulb(0.09, 25.0, x, light=0.02)
        return
    yield cylinder("brass", 0.008, drop - 0.42, (0.0, 0.4, 0.0), sides=8)
    if kind == "wheel":
        yield ring("wood", 0.38, 0.05, (0.0, 0.06, 0.0), 1, 36)
        yield from (
            rod("iron", (0.0, 0.42, 0.0), (0.38 * np.cos(a), 0.08, 0.38 * np.sin(a)), 0.006, sides=6)
            for a in np.arange(4) * np.pi / 2
        )
        for i in range(8):
            a = 2 * np.pi * i / 8
            yield cylinder("cream", 0.016, 0.09, (0.38 * np.cos(a), 0.08, 0.38 * np.sin(a)), sides=10)
            yield from bulb(0.2, 10.0, 0.38 * np.cos(a), 0.38 * np.sin(a), 0.018)
        return
    yield revolve(
        "brass",
        [(0.01, 0.0), (0.035, 0.05), (0.015, 0.12), (0.05, 0.2), (0.015, 0.3), (0.03, 0.36), (0.01, 0.42)],
        sides=18,
        steps=3,
    )
    for i in range(count):
        a = 2 * np.pi * i / count
        c, s = np.cos(a), np.sin(a)
        if kind == "branches":
            y = 0.1 + 0.16 * (i % 3)
            reach = 0.3 + 0.08 * (i % 2)
            yield rod("brass", (0.0, y, 0.0), (reach * c, y + 0.02, reach * s), 0.008)
            yield ball("opal", 0.075, ((reach + 0.07) * c, y + 0.02, (reach + 0.07) * s), 16, 10)
            yield Bulb(((reach + 0.07) * c, y - 0.08, (reach + 0.07) * s), 10.0)
            continue
        arm = [(0.02, 0.16), (0.16, 0.04), (0.3, 0.08), (0.32, 0.2)]
        yield tube("brass", [(r * c, y, r * s) for r, y in spline(arm, 4)], 0.009)
        yield revolve("brass", [(0.01, 0.19), (0.04, 0.21), (0.042, 0.22)], (0.32 * c, 0.0, 0.32 * s), 14, 1)
        if kind == "shades":
            yield shade("shade", [(0.075, 0.0), (0.045, 0.1)], (0.32 * c, 0.26, 0.32 * s), 0.004, 18)
        yield cylinder("cream", 0.013, 0.09, (0.32 * c, 0.21, 0.32 * s), sides=10)
        yield from bulb(0.325, 12.0, 0.32 * c, 0.32 * s, 0.018)
        if kind == "crystal":
            for k in range(5):
                t = 0.1 + 0.2 * k
                r, y = 0.3 * (1 - t) + 0.05, 0.2 + 0.2 * t - 0.12 * np.sin(np.pi * t)
                yield ball("glass", (0.012, 0.02, 0.012), (r * c, y - 0.02, r * s), 6, 4)
            yield ball("glass", (0.014, 0.03, 0.014), (0.32 * c, 0.15, 0.32 * s), 6, 4)


CHANDELIERS = design_kinds(chandelier, "arms", "crystal", "wheel", "branches", "row", "shades")


FAMILIES = (FurnitureFamily("chandelier", "chandelier", CHANDELIERS),)
