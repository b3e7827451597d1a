"""Single beds."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.beds.bedding import MATTRESS_LENGTH, Cover, bedding, rails
from home_procgen.things.beds.frames import futon_floor, iron, platform, sleigh, upholstered
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import drawers, roller


def captain(width: float = 0.9, cover: Cover = "made") -> Iterator[Solid]:
    """Build a bed with bedding, boards on three sides, and drawers on the fourth, for a wall."""
    yield rounded_box("wood", (width + 0.06, 0.38, MATTRESS_LENGTH + 0.06), (0.0, 0.0, 0.0), 0.01, 1)
    yield from (
        rotate(p, 1, np.pi / 2)
        for p in drawers("wood_1", 1.9, 0.3, (-0.95, 0.05, width / 2 + 0.03), 3, 1, "flat", ("brass", "knob"))
    )
    for z, high in ((-MATTRESS_LENGTH / 2 - 0.04, 0.92), (MATTRESS_LENGTH / 2 + 0.04, 0.62)):
        yield rounded_box("wood", (width + 0.08, high, 0.03), (0.0, 0.0, z), 0.01, 1)
    yield rounded_box("wood", (0.03, 0.72, MATTRESS_LENGTH + 0.08), (-width / 2 - 0.035, 0.0, 0.0), 0.01, 1)
    yield from bedding(width, MATTRESS_LENGTH, 0.38, cover, 1, 0.18, seed=4)


def day_bed(width: float = 0.9) -> Iterator[Solid]:
    """Build a day bed with spindle rails on three sides and pillows along the wall."""
    for x, z, w in ((-width / 2 - 0.02, 0.0, MATTRESS_LENGTH),):
        yield beam("wood", (x, 0.85, -w / 2), (x, 0.85, w / 2), 0.04)
        for i in range(16):
            zz = (i - 7.5) * w / 16
            yield rod("wood", (x, 0.3, zz + z), (x, 0.84, zz + z), 0.01, sides=6)
    for s in (-1, 1):
        z = s * (MATTRESS_LENGTH / 2 + 0.02)
        yield beam("wood", (-width / 2, 0.72, z), (width / 2, 0.72, z), 0.04)
        for i in range(7):
            x = (i - 3) * width / 7.5
            yield rod("wood", (x, 0.3, z), (x, 0.71, z), 0.01, sides=6)
        for x in (-width / 2 - 0.02, width / 2 + 0.02):
            yield revolve(
                "wood", [(0.02, 0.0), (0.03, 0.3), (0.022, 0.6), (0.03, 0.74), (0.02, 0.8)], (x, 0.0, z), 10, 2
            )
    yield from rails(width, 0.2, 0.36)
    yield from bedding(width, MATTRESS_LENGTH, 0.31, "throw", 1, 0.18)
    for z in (-0.3, 0.25, 0.75):
        piece = rotate(padded_block("patterned", (0.5, 0.44, 0.16), (0.0, 0.0, 0.0), 3.0, 5), 1, np.pi / 2)
        piece = rotate(piece, 2, 0.25)
        yield move(piece, (-width / 2 + 0.14, 0.545, z))


def car_bed(width: float = 0.9) -> Iterator[Solid]:
    """Build a child's bed shaped like a racing car."""
    side = [
        (-1.1, 0.12),
        (-1.12, 0.5),
        (-0.95, 0.66),
        (-0.6, 0.6),
        (-0.2, 0.52),
        (0.6, 0.46),
        (1.05, 0.34),
        (1.12, 0.18),
        (1.1, 0.12),
    ]
    yield from add_mirror_images([prism("red", [(z, y) for z, y in side], 0.05, (width / 2 + 0.03, 0.0, 0.0), "side")])
    yield rounded_box("red", (width + 0.1, 0.24, 0.06), (0.0, 0.12, 1.08), 0.025, 2)
    yield rounded_box("red", (width + 0.1, 0.62, 0.06), (0.0, 0.12, -1.08), 0.025, 2)
    yield box("black", (width, 0.2, 2.1), (0.0, 0.06, 0.0))
    for z in (-0.7, 0.68):
        for s in (-1, 1):
            for slot, r, w in (("rubber", 0.19, 0.09), ("chrome", 0.1, 0.1)):
                yield roller(slot, r, w, (s * (width / 2 + 0.06), 0.19, z), 20)
    for s in (-1, 1):
        yield ball("yellow", (0.09, 0.06, 0.03), (s * 0.3, 0.28, 1.1), 12, 6)
        yield box("red", (0.04, 0.2, 0.16), (s * 0.34, 0.72, -1.06))
    yield rounded_box("red", (width, 0.03, 0.24), (0.0, 0.9, -1.06), 0.012, 1)
    yield from bedding(width - 0.06, 1.96, 0.24, "made", 1, 0.16, seed=6)


def house_bed(width: float = 0.9) -> Iterator[Solid]:
    """Build a child's bed in a house-shaped frame."""
    x, z = width / 2 + 0.02, MATTRESS_LENGTH / 2 + 0.02
    for sz in (-z, 0.0, z):
        yield beam("wood", (-x, 1.25, sz), (0.02, 1.68, sz), 0.045)
        yield beam("wood", (x, 1.25, sz), (-0.02, 1.68, sz), 0.045)
    for sx in (-x, x):
        for sz in (-z, z):
            yield beam("wood", (sx, 0.0, sz), (sx, 1.27, sz), 0.05)
        yield beam("wood", (sx, 1.24, -z), (sx, 1.24, z), 0.045)
    yield beam("wood", (0.0, 1.67, -z), (0.0, 1.67, z), 0.045)
    yield from rails(width, 0.16, 0.3)
    for i in range(9):
        yield rod("wood", (-x, 0.3, (i - 4) * 0.22), (-x, 0.6, (i - 4) * 0.22), 0.012, sides=6)
    yield beam("wood", (-x, 0.6, -z), (-x, 0.6, z), 0.04)
    yield from bedding(width, MATTRESS_LENGTH, 0.24, "made", 1, 0.14, seed=7)


SINGLE = (
    design(platform, width=0.9, pillows=1), design(captain), design(day_bed),
    design(iron, width=0.95, pillows=1, cover="rumpled"), design(house_bed),
    design(upholstered, width=0.9, pillows=1, cover="throw"), design(car_bed), design(sleigh, width=0.9, pillows=1),
    design(platform, width=0.9, pillows=1, head="slats", cover="aside", kind="square"),
    design(futon_floor, width=0.9, pillows=1),
)  # fmt: skip


FAMILIES = (FurnitureFamily("single_bed", "single_bed", SINGLE),)
