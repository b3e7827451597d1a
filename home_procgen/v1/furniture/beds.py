"""Beds."""

from collections.abc import Iterator

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import make_legs
from home_procgen.primitives.solids import Solid, box, cushion, rotate


def bed(width: float, length: float, headboard: float, pillows: int, soft: bool = False) -> Iterator[Solid]:
    """A bed with its head at the back.

    Args:
        width: Of the frame [m].
        length: Of the frame [m].
        headboard: Height of the headboard [m].
        pillows: How many.
        soft: Upholstered headboard and frame on low feet instead of wood on legs.
    """
    foot = 0.06 if soft else 0.14
    yield from make_legs("wood", width, length, foot, 0.07)
    if soft:
        yield cushion("upholstery", (width, 0.26, length), (0.0, foot, 0.0), 0.03)
        yield cushion("upholstery", (width, headboard - foot, 0.12), (0.0, foot, -length / 2 + 0.06), 0.04)
    else:
        yield box("wood", (width, 0.18, length), (0.0, foot, 0.0))
        yield box("wood", (width, headboard - foot, 0.05), (0.0, foot, -length / 2 + 0.025))
    top, back = foot + (0.26 if soft else 0.18), 0.14 if soft else 0.06
    inner = length - back - 0.02
    yield cushion("linen", (width - 0.06, 0.22, inner), (0.0, top - 0.04, back / 2), 0.05)
    yield cushion(
        "textile", (width - 0.02, 0.16, 0.66 * inner), (0.0, top + 0.05, (back + 0.34 * inner) / 2 - 0.01), 0.04
    )
    wide = min(0.62, (width - 0.14) / pillows)
    for i in range(pillows):
        x = (i - (pillows - 1) / 2) * (width - 0.1) / pillows
        at = (x, top + 0.17, -length / 2 + back + 0.24)
        yield rotate(cushion("linen", (wide, 0.12, 0.38), at, 0.045), 0, 0.25, at)


FAMILIES = (
    VariantFamily(
        "double_bed",
        "double_bed",
        bed,
        make_slots("wood", "textile", "linen", "upholstery"),
        (
            make_variant(width=1.7, length=2.08, headboard=1.0, pillows=2),
            make_variant(width=1.5, length=2.05, headboard=0.85, pillows=2),
            make_variant(width=1.86, length=2.16, headboard=1.15, pillows=2, soft=True),
        ),
    ),
    VariantFamily(
        "single_bed",
        "single_bed",
        bed,
        make_slots("wood", "textile", "linen", "upholstery"),
        (
            make_variant(width=0.98, length=2.04, headboard=0.8, pillows=1),
            make_variant(width=1.1, length=2.02, headboard=0.95, pillows=1, soft=True),
        ),
    ),
)
