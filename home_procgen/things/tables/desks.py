"""Desks."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism, rod
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, book_row, drawers, legs, open_case
from home_procgen.things.tables.bases import top

DESK_HEIGHT = 0.75  # [m], height of desks


def drawer_unit(
    x: float,
    width: float,
    depth: float,
    rows: int,
    style: str = "flat",
    grip: tuple = ("chrome", "bar"),
    foot: float = 0.05,
) -> Iterator[Solid]:
    """Build a drawer unit under a desk."""
    yield box("wood", (width, DESK_HEIGHT - 0.03 - foot, depth - 0.08), (x, foot, -0.02))
    yield box("black", (width - 0.04, foot, depth - 0.14), (x, 0.0, -0.02))
    yield from drawers(
        "wood_1",
        width - 0.01,
        DESK_HEIGHT - 0.05 - foot,
        (x - width / 2 + 0.005, foot + 0.01, depth / 2 - 0.06),
        1,
        rows,
        style,
        grip,
        opens=depth - 0.2,
    )


def pedestal_desk(width: float = 1.4, depth: float = 0.7, both: bool = False) -> Iterator[Solid]:
    """Build a top on one or two drawer units."""
    yield from top("wood_1", width, depth, DESK_HEIGHT, "board", 0.03)
    yield from drawer_unit(width / 2 - 0.23, 0.42, depth, 3)
    if both:
        yield from drawer_unit(0.23 - width / 2, 0.42, depth, 4)
    else:
        yield box("wood", (0.03, DESK_HEIGHT - 0.03, depth - 0.08), (0.035 - width / 2, 0.0, -0.02))
    yield box("wood", (width - 0.5, 0.32, 0.018), (-0.18 * (not both), DESK_HEIGHT - 0.35, 0.06 - depth / 2))


def writing(width: float = 1.2, depth: float = 0.6, kind: LegKind = "taper") -> Iterator[Solid]:
    """Build a light desk with a shallow drawer."""
    yield from legs("wood", width - 0.06, depth - 0.06, DESK_HEIGHT - 0.13, kind, 0.05)
    yield box("wood", (width - 0.04, 0.1, depth - 0.08), (0.0, DESK_HEIGHT - 0.125, -0.01))
    yield from drawers(
        "wood_1",
        width - 0.1,
        0.09,
        (0.05 - width / 2, DESK_HEIGHT - 0.12, depth / 2 - 0.05),
        2,
        1,
        "flat",
        ("brass", "knob"),
        opens=depth - 0.2,
    )
    yield from top("wood", width, depth, DESK_HEIGHT, "board", 0.026)


def hutch(width: float = 1.2, depth: float = 0.62) -> Iterator[Solid]:
    """Build a pedestal desk with shelves above its back edge, with books."""
    yield from pedestal_desk(width, depth)
    yield from open_case("wood", width, 0.62, 0.24, (0.3,), (0.0, DESK_HEIGHT, 0.12 - depth / 2), (0.35, 0.7), "wood_1")
    yield from book_row(-width / 2 + 0.03, DESK_HEIGHT + 0.32, 0.34, 0.26, 0.12 - depth / 2, 3)
    yield from book_row(0.22, DESK_HEIGHT + 0.02, 0.3, 0.26, 0.12 - depth / 2, 4)


def secretary(width: float = 0.9, depth: float = 0.45) -> Iterator[Solid]:
    """Build a chest of drawers with a fold-down writing flap and pigeonholes."""
    yield box("wood", (width, 0.7, depth - 0.03), (0.0, 0.06, -0.015))
    yield from legs("wood", width, depth, 0.07, "block", 0.07)
    yield from drawers(
        "wood_1", width - 0.02, 0.64, (0.01 - width / 2, 0.09, depth / 2 - 0.03), 1, 3, "flat", ("brass", "ring")
    )
    yield from open_case(
        "wood", width, 0.4, depth - 0.06, (0.13, 0.26), (0.0, 0.76, -0.03), (0.25, 0.5, 0.75), "wood_1"
    )
    yield rounded_box("wood_1", (width - 0.02, 0.022, 0.34), (0.0, 0.765, depth / 2 + 0.13), 0.006, 1)
    yield from add_mirror_images(
        [
            rod(
                "brass",
                (width / 2 - 0.02, 0.79, depth / 2 + 0.2),
                (width / 2 - 0.02, 1.0, depth / 2 - 0.07),
                0.004,
                sides=5,
            )
        ]
    )
    yield box("leather", (width - 0.12, 0.002, 0.26), (0.0, 0.786, depth / 2 + 0.13))


def corner_desk(size: float = 1.5, depth: float = 0.6) -> Iterator[Solid]:
    """Build an L-shaped corner desk."""
    half = size / 2
    inner, y = depth - half, DESK_HEIGHT - 0.03
    yield rounded_box("wood_1", (size, 0.03, depth), (0.0, y, depth / 2 - half), 0.006, 2)
    yield rounded_box("wood_1", (depth, 0.03, size - depth), (depth / 2 - half, y, depth / 2), 0.006, 2)
    yield prism("wood_1", [(inner, inner), (inner + 0.2, inner), (inner, inner + 0.2)], 0.03, (0.0, y, 0.0), "top")
    for x, z in (
        (0.05 - half, 0.05 - half),
        (half - 0.05, 0.05 - half),
        (half - 0.05, depth - half - 0.06),
        (0.05 - half, half - 0.05),
        (depth - half - 0.06, half - 0.05),
    ):
        yield rounded_box("iron", (0.05, DESK_HEIGHT - 0.03, 0.05), (x, 0.0, z), 0.008, 1)
    yield box("wood", (size - 0.2, 0.3, 0.018), (0.0, DESK_HEIGHT - 0.34, 0.04 - half))
    yield box("wood", (0.018, 0.3, size - 0.2), (0.04 - half, DESK_HEIGHT - 0.34, 0.0))


def standing_desk(width: float = 1.4, depth: float = 0.7, height: float = 0.98) -> Iterator[Solid]:
    """Build a top on two telescopic columns."""
    yield from top("wood", width, depth, height, "board", 0.026)
    for s in (-1, 1):
        x = s * (width / 2 - 0.24)
        yield rounded_box("gray", (0.08, 0.03, depth - 0.06), (x, 0.0, 0.0), 0.01, 1)
        yield rounded_box("gray", (0.08, 0.6, 0.06), (x, 0.02, 0.0), 0.008, 1)
        yield rounded_box("gray", (0.06, height - 0.08, 0.045), (x, 0.03, 0.0), 0.006, 1)
        yield box("gray", (0.05, 0.025, depth - 0.12), (x, height - 0.05, 0.0))
    yield box("gray", (width - 0.5, 0.05, 0.04), (0.0, height - 0.07, 0.0))
    yield rounded_box("black", (0.12, 0.02, 0.03), (0.4, height - 0.045, depth / 2 - 0.02), 0.005, 1)


def sawhorse(width: float = 1.5, depth: float = 0.7) -> Iterator[Solid]:
    """Build a loose top on two sawhorses."""
    yield from top("wood_1", width, depth, DESK_HEIGHT, "board", 0.03)
    for s in (-1, 1):
        x = s * (width / 2 - 0.28)
        yield box("wood", (0.05, 0.05, depth - 0.06), (x, DESK_HEIGHT - 0.08, 0.0))
        for a in (-1, 1):
            for z in (-1, 1):
                yield beam(
                    "wood",
                    (x + a * 0.16, 0.0, z * (depth / 2 - 0.08)),
                    (x + a * 0.02, DESK_HEIGHT - 0.04, z * (depth / 2 - 0.1)),
                    0.03,
                    0.05,
                )
            yield beam(
                "wood", (x + a * 0.115, 0.24, -depth / 2 + 0.08), (x + a * 0.115, 0.24, depth / 2 - 0.08), 0.02, 0.04
            )


def ladder_desk(width: float = 0.8) -> Iterator[Solid]:
    """Build leaning side rails with a desk and two shelves, one with a row of books."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.02)
        yield beam("wood", (x, 0.0, 0.28), (x, 1.8, -0.24), 0.03, 0.05)
        yield beam("wood", (x, 0.0, -0.22), (x, 0.72, -0.22), 0.03)
    for y, deep in ((0.72, 0.5), (1.16, 0.28), (1.5, 0.2)):
        middle = 0.28 - 0.52 * y / 1.8
        z = middle - deep / 2 + 0.04 if y > 1 else 0.03
        yield box("wood_1", (width - 0.07, 0.02, deep), (0.0, y, z))
        yield box("wood_1", (width - 0.07, 0.05, 0.015), (0.0, y + 0.018, z - deep / 2 + 0.008))
    yield from book_row(-0.3, 1.18, 0.3, 0.26, -0.1, 9, False)


def executive_desk(width: float = 1.7, depth: float = 0.85) -> Iterator[Solid]:
    """Build two panelled units under a leather-covered top."""
    yield from top("wood", width, depth, DESK_HEIGHT + 0.03, "edge", 0.06)
    yield box("leather", (width - 0.3, 0.002, depth - 0.3), (0.0, DESK_HEIGHT + 0.03, 0.0))
    for s in (-1, 1):
        x = s * (width / 2 - 0.3)
        yield box("wood", (0.5, DESK_HEIGHT - 0.05, depth - 0.12), (x, 0.02, 0.0))
        yield rounded_box("wood", (0.54, 0.07, depth - 0.06), (x, 0.0, 0.0), 0.015, 1)
        yield from drawers(
            "wood_1", 0.46, 0.58, (x - 0.23, 0.1, depth / 2 - 0.07), 1, 3, "raised", ("brass", "ring"), opens=0.5
        )
    yield box("wood", (width - 1.0, 0.12, depth - 0.14), (0.0, DESK_HEIGHT - 0.14, 0.0))
    yield box("wood", (width - 1.0, 0.6, 0.02), (0.0, 0.12, -depth / 2 + 0.1))


def glass_desk(width: float = 1.3, depth: float = 0.65) -> Iterator[Solid]:
    """Build a glass plate on a bent tube frame."""
    yield from top("glass", width, depth, DESK_HEIGHT, "board", 0.012)
    for s in (-1, 1):
        x = s * (width / 2 - 0.08)
        for z in (-0.26, 0.26):
            yield rod("chrome", (x, 0.0, z), (x, DESK_HEIGHT - 0.012, z), 0.018)
        yield rod("chrome", (x, 0.1, -0.26), (x, 0.1, 0.26), 0.014)
    yield rod("chrome", (0.08 - width / 2, 0.4, -0.26), (width / 2 - 0.08, 0.4, -0.26), 0.014)
    yield box("black", (0.5, 0.018, 0.24), (0.0, DESK_HEIGHT - 0.09, 0.16))


def wall_desk(width: float = 0.9) -> Iterator[Solid]:
    """Build a shallow wall box with books and a fold-down writing front."""
    yield from open_case("wood", width, 0.5, 0.2, (0.16, 0.32), (0.0, 0.72, -0.2), (0.5,), "wood_1")
    yield box("wood_1", (width - 0.03, 0.022, 0.44), (0.0, 0.725, 0.12))
    yield from add_mirror_images(
        [rod("iron", (width / 2 - 0.03, 0.74, 0.2), (width / 2 - 0.03, 1.0, -0.1), 0.004, sides=5)]
    )
    yield from book_row(-0.4, 0.9, 0.3, 0.15, -0.2, 5)
    for s in (-1, 1):
        yield beam("wood", (s * 0.4, 0.0, 0.26), (s * 0.4, 0.725, 0.26), 0.03)


DESKS = (
    design(pedestal_desk), design(writing), design(hutch), design(secretary), design(corner_desk),
    design(standing_desk), design(sawhorse), design(ladder_desk), design(executive_desk), design(glass_desk),
    design(pedestal_desk, both=True, width=1.6), design(writing, kind="hairpin", width=1.1), design(wall_desk),
    design(writing, kind="sled", width=1.4, depth=0.65),
)  # fmt: skip


FAMILIES = (FurnitureFamily("desk", "desk", DESKS),)
