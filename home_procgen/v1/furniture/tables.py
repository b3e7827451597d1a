"""Tables and desks."""

from collections.abc import Iterator

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import BOARD_THICKNESS, make_fronts, make_legs
from home_procgen.primitives.solids import Solid, box, cylinder, move


def table(
    width: float,
    height: float,
    depth: float,
    top: str = "wood_1",
    leg: float = 0.07,
    apron: float = 0.08,
    shelf: bool = False,
) -> Iterator[Solid]:
    """A top on four legs, with an apron beneath it; chairs fit under a dining table."""
    yield box(top, (width, 0.03, depth), (0.0, height - 0.03, 0.0))
    yield from make_legs("wood", width - 0.06, depth - 0.06, height - 0.03, leg)
    for side in (-1, 1):
        yield box("wood", (width - 0.1, apron, 0.02), (0.0, height - 0.03 - apron, side * (depth / 2 - 0.05)))
        yield box("wood", (0.02, apron, depth - 0.1), (side * (width / 2 - 0.05), height - 0.03 - apron, 0.0))
    if shelf:
        yield box("wood", (width - 0.1, BOARD_THICKNESS, depth - 0.1), (0.0, 0.12, 0.0))


def round_table(radius: float, height: float, top: str = "wood_1") -> Iterator[Solid]:
    """A round top on one column with a broad foot."""
    yield cylinder(top, radius, 0.03, (0.0, height - 0.03, 0.0), sides=24)
    yield cylinder("wood", 0.05, height - 0.03, sides=12)
    yield cylinder("wood", 0.55 * radius, 0.03, top=0.4 * radius, sides=16)


def desk(width: float, height: float, depth: float, drawers: int) -> Iterator[Solid]:
    """A top on a drawer unit (right) and a side panel (left), with a modesty panel at the back."""
    yield box("wood_1", (width, 0.03, depth), (0.0, height - 0.03, 0.0))
    yield box("wood", (0.03, height - 0.03, depth - 0.06), (0.03 - width / 2, 0.0, 0.0))
    yield box("wood", (width - 0.1, 0.35, BOARD_THICKNESS), (0.0, height - 0.38, 0.05 - depth / 2))
    unit, right = 0.4, width / 2 - 0.22
    yield box("wood", (unit, height - 0.03, depth - 0.08), (right, 0.0, 0.0))
    for front in make_fronts(
        "wood_1", "chrome", unit, height - 0.1, 0.06, depth / 2 - BOARD_THICKNESS, 1, drawers, upright=False
    ):
        yield move(front, (right, 0.0, 0.0))


_TOPPED = make_slots("wood", "wood_1")
_GLASS = make_slots("wood", "glass")

FAMILIES = (
    VariantFamily(
        "dining_table",
        "dining_table",
        table,
        _TOPPED,
        (make_variant(width=1.4, height=0.75, depth=0.85), make_variant(width=1.8, height=0.75, depth=0.95)),
    ),
    VariantFamily("round_table", "dining_table", round_table, _TOPPED, (make_variant(radius=0.55, height=0.74),)),
    VariantFamily(
        "coffee_table",
        "coffee_table",
        table,
        _TOPPED,
        (
            make_variant(width=1.0, height=0.44, depth=0.6, leg=0.05, apron=0.05, shelf=True),
            make_variant(width=0.8, height=0.4, depth=0.8, leg=0.06, apron=0.06),
        ),
    ),
    VariantFamily(
        "glass_table",
        "coffee_table",
        table,
        _GLASS,
        (make_variant(width=1.1, height=0.42, depth=0.6, top="glass", leg=0.05, apron=0.04, shelf=True),),
    ),
    VariantFamily("side_table", "coffee_table", round_table, _TOPPED, (make_variant(radius=0.28, height=0.5),)),
    VariantFamily(
        "desk",
        "desk",
        desk,
        make_slots("wood", "wood_1", "chrome"),
        (
            make_variant(width=1.3, height=0.75, depth=0.68, drawers=3),
            make_variant(width=1.6, height=0.74, depth=0.75, drawers=4),
        ),
    ),
)
