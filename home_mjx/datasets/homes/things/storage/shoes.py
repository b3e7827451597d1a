"""Cabinets for shoes."""

from collections.abc import Iterator

from home_mjx.datasets.homes.shapes.soft import soft
from home_mjx.datasets.homes.shapes.swept import beam
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import (
    doors,
    drawers,
)
from home_mjx.datasets.homes.things.storage.cases import carcass
from home_mjx.datasets.homes.things.textiles.wear import shoe
from home_mjx.datasets.procedural.primitives.solids import Solid, box, move


def shoe_flaps(width: float = 0.75, count: int = 3) -> Iterator[Solid]:
    """A narrow cabinet whose fronts tip out."""
    height = 0.1 + 0.36 * count
    yield from carcass(width, height, 0.24, 0.06)
    yield from drawers(
        "wood_1", width - 0.01, height - 0.09, (0.005 - width / 2, 0.065, 0.1), 1, count, "flat", ("black", "slot")
    )


def shoe_rack(width: float = 0.8, cushioned: bool = False) -> Iterator[Solid]:
    """Slatted shelves with pairs of shoes, perhaps with a cushion to sit on."""
    for s in (-1, 1):
        for z in (-0.13, 0.13):
            yield beam("wood", (s * (width / 2 - 0.02), 0.0, z), (s * (width / 2 - 0.02), 0.48, z), 0.032)
    for y in (0.08, 0.26, 0.46):
        for z in (-0.11, -0.04, 0.04, 0.11):
            yield box("wood", (width - 0.04, 0.014, 0.045), (0.0, y, z))
    for i in range(3):
        for dx in (-0.055, 0.055):
            for k, y in enumerate((0.094, 0.274)):
                yield from (move(p, (-0.25 + 0.25 * i + dx, y, 0.0)) for p in shoe(f"leather_{(i + k) % 3}"))
    if cushioned:
        yield soft("textile", (width, 0.08, 0.32), (0.0, 0.474, 0.0), 9.0, 5)


def louvred(width: float = 0.8, height: float = 0.95) -> Iterator[Solid]:
    """A shoe cabinet with louvred doors."""
    yield from carcass(width, height, 0.34, 0.1, "taper", "wood", 0.03)
    yield from doors(
        "wood_1", width - 0.02, height - 0.13, (0.01 - width / 2, 0.105, 0.15), 2, "shaker", ("brass", "knob")
    )
    for s in (-1, 1):
        for i in range(12):
            yield box("wood_1", (width / 2 - 0.15, 0.035, 0.02), (s * width / 4, 0.18 + 0.055 * i, 0.166))


SHOE_CABINETS = (
    design(shoe_flaps),
    design(shoe_rack),
    design(louvred),
    design(shoe_rack, cushioned=True, width=0.95),
    design(shoe_flaps, count=2, width=0.9),
)


FAMILIES = (Family("shoes_cabinet", "shoes_cabinet", SHOE_CABINETS),)
