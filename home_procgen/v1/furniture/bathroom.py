"""Bathroom fittings."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import make_fronts
from home_procgen.primitives.solids import Solid, box, cushion, cylinder, lathe, move, rotate
from home_procgen.v1.furniture.kitchen import tap


def toilet(width: float, tank: float) -> Iterator[Solid]:
    """Bowl, seat ring, lid leaning on the tank."""
    bowl = [(0.12, 0.0), (0.13, 0.12), (0.19, 0.34), (0.2, 0.39)]
    yield lathe("ceramic", [(r * width / 0.4, h) for r, h in bowl], (0.0, 0.0, 0.06), stretch=1.25)
    ring = [(0.12, 0.39), (0.2, 0.39), (0.2, 0.42), (0.12, 0.42)]
    yield lathe("ceramic", [(r * width / 0.4, h) for r, h in ring], (0.0, 0.0, 0.06), closed=True, stretch=1.25)
    yield box("ceramic", (0.2, 0.36, 0.22), (0.0, 0.0, -0.19))
    yield cushion("ceramic", (width, tank, 0.17), (0.0, 0.38, -0.235), 0.02)
    lid = cushion("ceramic", (width - 0.02, 0.4, 0.025), (0.0, 0.43, -0.13), 0.008)
    yield rotate(lid, 0, -0.08, (0.0, 0.43, -0.13))
    yield box("chrome", (0.05, 0.012, 0.04), (0.0, 0.38 + tank, -0.235))


def pedestal_basin(width: float, depth: float) -> Iterator[Solid]:
    """A basin on a column, with a tap."""
    yield lathe("ceramic", [(0.11, 0.0), (0.08, 0.1), (0.08, 0.66), (0.12, 0.7)], (0.0, 0.0, -0.06), sides=12)
    yield from basin(width, depth, 0.7)


def vanity(width: float, depth: float) -> Iterator[Solid]:
    """A basin on a cabinet."""
    yield box("black", (width - 0.08, 0.08, depth - 0.12), (0.0, 0.0, -0.04))
    yield box("wood", (width - 0.02, 0.62, depth - 0.04), (0.0, 0.08, -0.02))
    yield from make_fronts("wood", "chrome", width - 0.02, 0.6, 0.09, depth / 2 - 0.02, 2)
    yield from basin(width, depth, 0.7)


def basin(width: float, depth: float, bottom: float, rim: float = 0.06) -> Iterator[Solid]:
    """A rectangular bowl: floor and four rims, 0.15 m high, and a tap at the back."""
    high, back = 0.15, rim + 0.05
    yield box("ceramic", (width, 0.03, depth), (0.0, bottom, 0.0))
    for side in (-1, 1):
        yield box("ceramic", (rim, high - 0.03, depth), (side * (width - rim) / 2, bottom + 0.03, 0.0))
    inner = width - 2 * rim
    yield box("ceramic", (inner, high - 0.03, rim), (0.0, bottom + 0.03, (depth - rim) / 2))
    yield box("ceramic", (inner, high - 0.03, back), (0.0, bottom + 0.03, (back - depth) / 2))
    yield from tap(bottom + high, (back - depth) / 2)


def bathtub(width: float, depth: float, height: float) -> Iterator[Solid]:
    """A rectangular tub: floor, rims and a tap at one end."""
    rim, floor = 0.08, 0.14
    yield box("ceramic", (width, floor, depth))
    for side in (-1, 1):
        yield box("ceramic", (width, height - floor, rim), (0.0, floor, side * (depth - rim) / 2))
        yield box("ceramic", (rim, height - floor, depth - 2 * rim), (side * (width - rim) / 2, floor, 0.0))
    turned = (rotate(piece, 1, np.pi / 2) for piece in tap(height, rim / 2 - width / 2))
    yield from turned


def shower(size: float, height: float) -> Iterator[Solid]:
    """A tray with two glass panes (front and right) and a pole with a shower head in the back corner."""
    yield box("ceramic", (size, 0.1, size))
    half = size / 2 - 0.01
    yield box("glass", (0.46 * size, height - 0.1, 0.012), (-0.27 * size, 0.1, half))
    yield box("glass", (0.012, height - 0.1, size - 0.02), (half, 0.1, -0.004))
    for x in (-half, half):
        yield box("chrome", (0.02, height - 0.1, 0.02), (x, 0.1, half))
    yield cylinder("chrome", 0.014, height - 0.2, (0.08 - half, 0.1, 0.08 - half), sides=8)
    yield cylinder("chrome", 0.1, 0.02, (0.2 - half, height - 0.12, 0.2 - half), sides=12)
    yield box("chrome", (0.17, 0.02, 0.17), (0.13 - half, height - 0.1, 0.13 - half))


def washer(width: float, height: float, depth: float) -> Iterator[Solid]:
    """A front-loading washing machine."""
    yield box("ceramic", (width, height, depth))
    window = rotate(cylinder("screen", 0.17, 0.03, sides=20), 0, np.pi / 2)
    ring = rotate(
        lathe("chrome", [(0.17, 0.0), (0.21, 0.0), (0.2, 0.04), (0.17, 0.035)], closed=True, sides=20), 0, np.pi / 2
    )
    for piece in (window, ring):
        yield move(piece, (0.0, 0.42, depth / 2))
    yield box("black", (width - 0.24, 0.07, 0.01), (0.08, height - 0.12, depth / 2 + 0.004))


def mirror(width: float, height: float) -> Iterator[Solid]:
    """A framed wall mirror."""
    rim = 0.03
    yield box("mirror", (width - rim, height - rim, 0.012), (0.0, rim / 2, -0.004))
    for side in (-1, 1):
        yield box("wood", (rim, height, 0.024), (side * (width - rim) / 2, 0.0, 0.0))
        yield box("wood", (width - 2 * rim, rim, 0.024), (0.0, (height - rim) * (side + 1) / 2, 0.0))


_FITTING = make_slots("ceramic", "chrome")

FAMILIES = (
    VariantFamily(
        "toilet",
        "toilet",
        toilet,
        make_slots("ceramic", "chrome"),
        (make_variant(width=0.38, tank=0.36), make_variant(width=0.4, tank=0.42)),
    ),
    VariantFamily(
        "basin",
        "sink",
        pedestal_basin,
        _FITTING,
        (make_variant(width=0.56, depth=0.46), make_variant(width=0.46, depth=0.38)),
    ),
    VariantFamily(
        "vanity",
        "sink",
        vanity,
        make_slots("ceramic", "chrome", "wood", "black"),
        (make_variant(width=0.8, depth=0.48),),
    ),
    VariantFamily(
        "bathtub",
        "bathtub",
        bathtub,
        _FITTING,
        (make_variant(width=1.7, depth=0.75, height=0.56), make_variant(width=1.5, depth=0.7, height=0.54)),
    ),
    VariantFamily(
        "shower", "shower", shower, make_slots("ceramic", "chrome", "glass"), (make_variant(size=0.9, height=2.0),)
    ),
    VariantFamily(
        "washer",
        "washer",
        washer,
        make_slots("ceramic", "chrome", "screen", "black"),
        (make_variant(width=0.6, height=0.85, depth=0.56),),
    ),
    VariantFamily(
        "mirror",
        "mirror",
        mirror,
        make_slots("wood", "mirror"),
        (make_variant(width=0.6, height=0.8), make_variant(width=0.5, height=1.2)),
    ),
)
