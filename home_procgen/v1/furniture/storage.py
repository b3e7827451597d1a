"""Wardrobes, drawers, shelves and stands."""

from collections.abc import Iterator

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import BOARD_THICKNESS, make_case, make_fronts, make_legs
from home_procgen.primitives.solids import Solid, box


def cabinet(
    width: float, height: float, depth: float, columns: int, rows: int = 1, upright: bool = False, foot: float = 0.06
) -> Iterator[Solid]:
    """A closed body on a plinth (or on legs if `foot` >= 0.1 m) with doors or drawers and a top board."""
    if foot >= 0.1:
        yield from make_legs("wood", width - 0.04, depth - 0.04, foot, 0.04, turned=True)
    else:
        yield box("wood", (width - 0.06, foot, depth - 0.08), (0.0, 0.0, -0.02))
    yield box(
        "wood", (width, height - foot - BOARD_THICKNESS, depth - BOARD_THICKNESS), (0.0, foot, -BOARD_THICKNESS / 2)
    )
    yield box("wood", (width, BOARD_THICKNESS, depth), (0.0, height - BOARD_THICKNESS, 0.0))
    yield from make_fronts(
        "wood_1", "chrome", width, height - foot - BOARD_THICKNESS, foot, depth / 2, columns, rows, upright
    )


def wardrobe(width: float, height: float, depth: float, doors: int, mirrored: bool = False) -> Iterator[Solid]:
    """A tall cabinet with doors, on which a mirror may hang."""
    yield from cabinet(width, height, depth, doors, upright=True)
    if mirrored:
        at = (0.0, 0.25, depth / 2 + 0.004)
        yield box("mirror", (width / doors - 0.12, height - 0.5, 0.008), at)


def bookcase(
    width: float, height: float, depth: float, shelves: int, columns: int = 1, filled: int = 3
) -> Iterator[Solid]:
    """An open case with rows of books; `filled` is how many of four places per shelf hold some."""
    yield from make_case("wood", width, height, depth, shelves, columns)
    pitch = (height - 0.04 - BOARD_THICKNESS) / (shelves + 1)
    wide = (width - BOARD_THICKNESS * (columns + 1)) / columns
    for level in range(shelves + 1):
        for column in range(columns):
            if (3 * level + column) % 4 >= filled:
                continue
            left = -width / 2 + BOARD_THICKNESS + column * (wide + BOARD_THICKNESS)
            base = 0.04 + BOARD_THICKNESS + level * pitch
            yield from _books(left, base, wide, pitch - BOARD_THICKNESS, depth, level + 2 * column)


def _books(left: float, base: float, wide: float, high: float, depth: float, shift: int) -> Iterator[Solid]:
    """Three blocks of books of differing height, from the left."""
    for i, (share, tall) in enumerate(((0.28, 0.8), (0.22, 0.66), (0.18, 0.74))):
        slot = f"book_{(i + shift) % 3 + 1}"
        yield box(slot, (share * wide, tall * high, 0.7 * depth), (left + share * wide / 2, base, 0.0))
        left += share * wide


def rack(width: float, height: float, depth: float, shelves: int) -> Iterator[Solid]:
    """Open shelves between four posts."""
    yield from make_legs("chrome", width, depth, height, 0.03)
    for level in range(shelves):
        y = 0.08 + level * (height - 0.08 - BOARD_THICKNESS) / (shelves - 1)
        yield box("wood", (width - 0.01, BOARD_THICKNESS, depth - 0.01), (0.0, y, 0.0))


def coat_stand(height: float, arms: int) -> Iterator[Solid]:
    """A post on a foot with crossed arms near the top."""
    yield box("wood", (0.4, 0.03, 0.06))
    yield box("wood", (0.06, 0.03, 0.4))
    yield box("wood", (0.045, height, 0.045))
    for i in range(arms):
        y = height - 0.08 - 0.1 * (i // 2)
        yield box("wood", (0.34, 0.03, 0.025) if i % 2 else (0.025, 0.03, 0.34), (0.0, y, 0.0))


_BODY = make_slots("wood", "wood_1", "chrome")

FAMILIES = (
    VariantFamily(
        "wardrobe",
        "wardrobe_cabinet",
        wardrobe,
        make_slots("wood", "wood_1", "chrome", "mirror"),
        (
            make_variant(width=0.9, height=2.05, depth=0.58, doors=2),
            make_variant(width=1.2, height=2.2, depth=0.6, doors=3, mirrored=True),
            make_variant(width=1.6, height=2.1, depth=0.6, doors=4),
        ),
    ),
    VariantFamily(
        "nightstand",
        "stand",
        cabinet,
        _BODY,
        (
            make_variant(width=0.45, height=0.5, depth=0.4, columns=1, rows=2),
            make_variant(width=0.5, height=0.55, depth=0.42, columns=1, rows=3),
            make_variant(width=0.42, height=0.52, depth=0.38, columns=1, rows=1, foot=0.2),
        ),
    ),
    VariantFamily(
        "dresser",
        "dresser",
        cabinet,
        _BODY,
        (
            make_variant(width=1.2, height=0.85, depth=0.48, columns=2, rows=3),
            make_variant(width=0.9, height=1.0, depth=0.46, columns=1, rows=4, foot=0.12),
        ),
    ),
    VariantFamily(
        "tv_stand",
        "tv_stand",
        cabinet,
        _BODY,
        (
            make_variant(width=1.5, height=0.5, depth=0.42, columns=3, rows=1, upright=True),
            make_variant(width=1.8, height=0.45, depth=0.45, columns=2, rows=2, foot=0.12),
        ),
    ),
    VariantFamily(
        "shoes_cabinet",
        "shoes_cabinet",
        cabinet,
        _BODY,
        (make_variant(width=0.8, height=0.95, depth=0.32, columns=1, rows=3),),
    ),
    VariantFamily(
        "bookshelf",
        "bookshelf",
        bookcase,
        make_slots("wood", "book_1", "book_2", "book_3"),
        (
            make_variant(width=0.8, height=1.95, depth=0.3, shelves=4),
            make_variant(width=1.2, height=1.3, depth=0.34, shelves=2, columns=2),
            make_variant(width=1.6, height=2.1, depth=0.34, shelves=4, columns=3),
        ),
    ),
    VariantFamily(
        "shelving",
        "shelving",
        rack,
        make_slots("wood", "chrome"),
        (
            make_variant(width=0.9, height=1.7, depth=0.36, shelves=5),
            make_variant(width=0.6, height=1.2, depth=0.34, shelves=4),
        ),
    ),
    VariantFamily("coat_stand", "hanger", coat_stand, make_slots("wood"), (make_variant(height=1.72, arms=4),)),
)
