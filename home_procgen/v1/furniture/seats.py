"""Sofas, armchairs, chairs and stools."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import make_legs
from home_procgen.primitives.solids import Solid, box, cushion, cylinder, rotate


def sofa(
    width: float, depth: float, height: float, seats: int, arm: float = 0.2, chaise: float = 0.0
) -> Iterator[Solid]:
    """Base, back, arms and cushions on short feet.

    Args:
        width: Overall [m].
        depth: Overall, without the chaise [m].
        height: Of the back [m].
        seats: Number of seat cushions.
        arm: Width of an arm [m].
        chaise: How far the last seat reaches further forward [m].
    """
    foot, back = 0.08, 0.22
    yield from make_legs("wood", width - 0.06, depth - 0.06, foot, 0.06)
    yield cushion("upholstery", (width, 0.24, depth), (0.0, foot, 0.0), 0.03)
    yield cushion("upholstery", (width, height - foot - 0.06, back), (0.0, foot, (back - depth) / 2), 0.05)
    for side in (-1, 1):
        at = (side * (width - arm) / 2, foot, 0.0)
        yield cushion("upholstery", (arm, 0.52, depth), at, 0.05)
    wide, deep = (width - 2 * arm) / seats, depth - back
    for i in range(seats):
        x = (i - (seats - 1) / 2) * wide
        reach = chaise if i == seats - 1 else 0.0
        seat = cushion("upholstery_1", (wide - 0.01, 0.17, deep + reach), (x, 0.3, (back + reach) / 2), 0.04)
        yield seat
        rest = cushion("upholstery_1", (wide - 0.02, 0.4, 0.18), (x, 0.46, back - depth / 2 + 0.06), 0.06)
        yield rotate(rest, 0, -0.2, (x, 0.46, back - depth / 2 + 0.06))
    if chaise:
        x = (seats - 1) / 2 * wide
        yield cushion("upholstery", (wide, 0.24, chaise), (x, foot, (depth + chaise) / 2), 0.03)
        yield box("wood", (wide - 0.1, foot, 0.06), (x, 0.0, depth / 2 + chaise - 0.06))


def chair(width: float, depth: float, height: float, slats: int = 0, turned: bool = False) -> Iterator[Solid]:
    """A dining chair; its back has slats, or a padded panel if there are none."""
    seat, leg = 0.45, 0.04
    yield from make_legs("wood", width, depth, seat - 0.03, leg, turned)
    yield box("wood", (width, 0.03, depth), (0.0, seat - 0.05, 0.0))
    yield cushion("upholstery", (width - 0.03, 0.05, depth - 0.04), (0.0, seat - 0.02, 0.01), 0.018)
    hinge = (0.0, seat, leg / 2 - depth / 2)
    back: list[Solid] = [
        box("wood", (leg, height - seat + 0.01, leg * 0.7), (x * (width - leg) / 2, seat - 0.03, hinge[2]))
        for x in (-1, 1)
    ]
    back += [
        box("wood", (width - 2 * leg, 0.06, 0.018), (0.0, seat + (i + 1) * (height - seat - 0.1) / slats, hinge[2]))
        for i in range(slats)
    ]
    if not slats:
        panel = (width - 2 * leg, (height - seat) * 0.62, 0.045)
        back.append(cushion("upholstery", panel, (0.0, seat + (height - seat) * 0.34, hinge[2]), 0.018))
    yield from (rotate(piece, 0, -0.12, hinge) for piece in back)


def office_chair(width: float, height: float) -> Iterator[Solid]:
    """A swivel chair on a star foot."""
    for i in range(5):
        arm = box("black", (0.05, 0.03, 0.29), (0.0, 0.05, 0.145))
        yield rotate(arm, 1, 2 * np.pi * i / 5)
        x, z = 0.27 * np.sin(2 * np.pi * i / 5), 0.27 * np.cos(2 * np.pi * i / 5)
        yield cylinder("black", 0.03, 0.055, (x, 0.0, z), sides=8)
    yield cylinder("chrome", 0.03, 0.38, (0.0, 0.06, 0.0), sides=8)
    yield cushion("upholstery", (width, 0.08, width), (0.0, 0.43, 0.02), 0.03)
    yield box("black", (0.07, 0.3, 0.02), (0.0, 0.42, -width / 2))
    rest = cushion("upholstery", (width - 0.06, height - 0.62, 0.07), (0.0, 0.62, -width / 2), 0.03)
    yield rotate(rest, 0, -0.1, (0.0, 0.62, -width / 2))
    for side in (-1, 1):
        yield box("black", (0.03, 0.22, 0.04), (side * (width / 2 + 0.02), 0.45, 0.0))
        yield box("black", (0.05, 0.03, 0.26), (side * (width / 2 + 0.02), 0.66, 0.0))


def ottoman(width: float, height: float, depth: float) -> Iterator[Solid]:
    """A padded footstool."""
    yield from make_legs("wood", width - 0.08, depth - 0.08, 0.1, 0.05, turned=True)
    yield cushion("upholstery", (width, height - 0.1, depth), (0.0, 0.1, 0.0), 0.05)


def bench(width: float, depth: float) -> Iterator[Solid]:
    """A low bench with a padded seat, as at an entrance or a bed's foot."""
    yield from make_legs("wood", width, depth, 0.38, 0.05)
    yield box("wood", (width, 0.04, depth), (0.0, 0.36, 0.0))
    yield cushion("upholstery", (width - 0.02, 0.06, depth - 0.02), (0.0, 0.4, 0.0), 0.025)


_PADDED = make_slots("wood", "upholstery")

FAMILIES = (
    VariantFamily(
        "sofa",
        "sofa",
        sofa,
        make_slots("wood", "upholstery", "upholstery_1"),
        (
            make_variant(width=1.7, depth=0.9, height=0.85, seats=2),
            make_variant(width=2.2, depth=0.95, height=0.85, seats=3),
            make_variant(width=2.5, depth=0.95, height=0.8, seats=3, arm=0.16, chaise=0.65),
        ),
    ),
    VariantFamily(
        "armchair",
        "armchair",
        sofa,
        make_slots("wood", "upholstery", "upholstery_1"),
        (
            make_variant(width=0.9, depth=0.88, height=0.86, seats=1, arm=0.15),
            make_variant(width=0.78, depth=0.8, height=0.95, seats=1, arm=0.1),
        ),
    ),
    VariantFamily(
        "chair",
        "chair",
        chair,
        _PADDED,
        (
            make_variant(width=0.44, depth=0.46, height=0.88, slats=3),
            make_variant(width=0.46, depth=0.48, height=0.95),
            make_variant(width=0.42, depth=0.44, height=0.84, slats=1, turned=True),
        ),
    ),
    VariantFamily(
        "office_chair",
        "office_chair",
        office_chair,
        make_slots("black", "chrome", "upholstery"),
        (make_variant(width=0.5, height=1.06), make_variant(width=0.48, height=0.94)),
    ),
    VariantFamily("ottoman", "ottoman", ottoman, _PADDED, (make_variant(width=0.66, height=0.42, depth=0.5),)),
    VariantFamily(
        "bench",
        "bench_chair",
        bench,
        _PADDED,
        (make_variant(width=1.1, depth=0.36), make_variant(width=1.4, depth=0.4)),
    ),
)
