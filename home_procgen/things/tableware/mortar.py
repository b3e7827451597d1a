"""Mortar and pestle."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.sweep import tube
from home_procgen.things.family import FurnitureFamily, design


def mortar() -> Iterator[Solid]:
    """Build a stone mortar with its pestle."""
    yield vessel(
        "stone", [(0.05, 0.0), (0.055, 0.015), (0.045, 0.03), (0.07, 0.06), (0.075, 0.1)], 0.014, sides=24, steps=2
    )
    yield tube("stone", [(0.0, 0.045, 0.0), (0.03, 0.09, 0.01), (0.075, 0.15, 0.02)], [0.02, 0.013, 0.018], 10)


FAMILIES = (FurnitureFamily("mortar", "mortar_and_pestle", (design(mortar),)),)
