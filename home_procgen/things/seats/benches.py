"""Benches and storage chests with seats."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, sweep, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, legs
from home_procgen.things.movable_parts import assign_part, lid_part
from home_procgen.things.seats.garden_seats import park_bench


def plank(width: float = 1.2, kind: LegKind = "square") -> Iterator[Solid]:
    """Build a thick board on legs."""
    yield from legs("wood", width - 0.1, 0.32, 0.42, kind, 0.055)
    yield rounded_box("wood_1", (width, 0.045, 0.36), (0.0, 0.41, 0.0), 0.015, 2)


def padded(width: float = 1.15, kind: LegKind = "hairpin") -> Iterator[Solid]:
    """Build a long padded seat on legs."""
    yield from legs("iron", width - 0.06, 0.36, 0.4, kind, 0.05)
    yield rounded_box("wood", (width - 0.02, 0.03, 0.38), (0.0, 0.38, 0.0), 0.01, 1)
    yield padded_block("upholstery", (width, 0.1, 0.4), (0.0, 0.39, 0.0), 14.0, 6)


def scroll_bench(width: float = 1.2) -> Iterator[Solid]:
    """Build an upholstered bench with scrolled ends."""
    path = fillet(
        [(-width / 2, 0.62, 0.0), (-width / 2 + 0.08, 0.4, 0.0), (width / 2 - 0.08, 0.4, 0.0), (width / 2, 0.62, 0.0)],
        0.16,
        5,
    )
    yield sweep(
        "upholstery", path, np.array([[-0.2, -0.05], [0.2, -0.05], [0.2, 0.05], [-0.2, 0.05]]), up=(0.0, 1.0, 0.0)
    )
    yield from add_mirror_images(
        [tube("upholstery", [(width / 2 + 0.01, 0.63, -0.2), (width / 2 + 0.01, 0.63, 0.2)], 0.06, 12)]
    )
    yield from legs("wood", width - 0.2, 0.36, 0.37, "turned", 0.055)


def hall_bench(width: float = 1.1) -> Iterator[Solid]:
    """Build a bench with a slatted back and arms."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.025)
        yield beam("wood", (x, 0.0, 0.19), (x, 0.64, 0.19), 0.045)
        yield beam("wood", (x, 0.0, -0.19), (x, 0.9, -0.23), 0.045)
        yield rounded_box("wood", (0.06, 0.03, 0.48), (x, 0.64, 0.0), 0.01, 1)
    yield rounded_box("wood", (width, 0.035, 0.42), (0.0, 0.42, 0.0), 0.01, 1)
    for y in (0.56, 0.85):
        yield beam("wood", (-width / 2 + 0.04, y, -0.21), (width / 2 - 0.04, y, -0.225), 0.025, 0.06)
    for i in range(9):
        x = (i - 4) * (width - 0.14) / 9
        yield beam("wood", (x, 0.56, -0.21), (x, 0.85, -0.225), 0.045, 0.012)


def chest_bench(width: float = 1.1, style: str = "panels", back: bool = False) -> Iterator[Solid]:
    """Build a chest with a seat cushion on its lid."""
    yield rounded_box("wood", (width, 0.38, 0.42), (0.0, 0.03, 0.0), 0.01, 1)
    yield box("wood", (width - 0.06, 0.04, 0.36))
    if style == "panels":
        for i in range(3):
            yield rounded_box("wood_1", (width / 3 - 0.1, 0.24, 0.02), ((i - 1) * width / 3, 0.1, 0.21), 0.008, 1)
    else:
        for i in range(3):
            yield rounded_box("cane", (width / 3 - 0.04, 0.3, 0.03), ((i - 1) * width / 3, 0.06, 0.205), 0.01, 1)
            yield box("black", (0.1, 0.025, 0.01), ((i - 1) * width / 3, 0.28, 0.222))
    lid = [rounded_box("wood_1", (width + 0.03, 0.03, 0.45), (0.0, 0.41, 0.0), 0.01, 1)]
    lid.append(padded_block("textile", (width - 0.04, 0.07, 0.4), (0.0, 0.435, 0.01), 12.0, 6))
    yield from assign_part(None if back else lid_part(0.44, -0.225), lid)
    if back:
        yield prism(
            "wood",
            fillet(
                [(-width / 2, 0.4), (width / 2, 0.4), (width / 2, 0.85), (0.0, 0.95), (-width / 2, 0.85)], 0.08, 4, True
            ),
            0.03,
            (0.0, 0.0, -0.2),
        )
    yield from add_mirror_images([box("iron", (0.02, 0.03, 0.1), (width / 2 + 0.008, 0.25, 0.0))])


BENCHES = (
    design(plank), design(padded), design(scroll_bench), design(hall_bench), design(plank, width=1.4, kind="sled"),
    design(padded, width=1.3, kind="taper"), design(park_bench), design(plank, width=1.0, kind="splay"),
)  # fmt: skip

CHESTS = (design(chest_bench), design(chest_bench, style="baskets"), design(chest_bench, back=True, width=0.95))


FAMILIES = (
    FurnitureFamily("bench", "bench_chair", BENCHES),
    FurnitureFamily("storage_bench", "storage_bench", CHESTS),
)
