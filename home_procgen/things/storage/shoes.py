"""Shoe cabinets."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import beam, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import HandleKind, carcass, doors, drawers, open_case
from home_procgen.things.movable_parts import assign_part, collect_parts, panel
from home_procgen.things.textiles.wear import shoe


def shoe_flaps(width: float = 0.75, count: int = 3, grip: HandleKind = "slot") -> Iterator[Solid]:
    """Build a narrow cabinet with tip-out fronts."""
    height = 0.1 + 0.36 * count
    yield from carcass(width, height, 0.24, 0.06)
    corner = (0.005 - width / 2, 0.065, 0.1)
    yield from drawers("wood_1", width - 0.01, height - 0.09, corner, 1, count, "flat", ("black", grip), opens="tips")


def shoe_rack(width: float = 0.8, cushioned: bool = False) -> Iterator[Solid]:
    """Build slatted shelves with pairs of shoes and an optional seat cushion."""
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
        yield padded_block("textile", (width, 0.08, 0.32), (0.0, 0.474, 0.0), 9.0, 5)


def louvred(width: float = 0.8, height: float = 0.95) -> Iterator[Solid]:
    """Build a shoe cabinet with louvred doors."""
    yield from carcass(width, height, 0.34, 0.1, "taper", "wood", 0.03)
    corner = (0.01 - width / 2, 0.105, 0.15)
    leaves = list(doors("wood_1", width - 0.02, height - 0.13, corner, 2, "shaker", ("brass", "knob")))
    yield from leaves
    for s, part in zip((-1, 1), collect_parts(leaves), strict=True):
        for i in range(12):
            louvre = box("wood_1", (width / 2 - 0.15, 0.035, 0.02), (s * width / 4, 0.18 + 0.055 * i, 0.166))
            yield from assign_part(part, [louvre])


def cubbies(width: float = 0.9) -> Iterator[Solid]:
    """Build a grid of open boxes, some with shoes, below a bench."""
    yield from open_case("wood", width, 0.46, 0.34, (0.22,), (0.0, 0.02, 0.0), (0.25, 0.5, 0.75), "wood_1")
    yield padded_block("textile", (width, 0.07, 0.34), (0.0, 0.475, 0.0), 9.0, 6)
    for i, (column, y) in enumerate(((0, 0.04), (1, 0.26), (2, 0.04), (3, 0.26))):
        x = (column - 1.5) * width / 4
        for s in (-1, 1):
            yield from (move(p, (x + s * 0.05, y, 0.0)) for p in shoe(f"leather_{i}"))


def wire_tiers(width: float = 0.7, tiers: int = 4) -> Iterator[Solid]:
    """Build sloping tiers of rods with shoes between ladders of tube."""
    for s in (-1, 1):
        for z in (-0.13, 0.13):
            yield rod("chrome", (s * width / 2, 0.0, z), (s * width / 2, 0.2 * tiers, z), 0.011, sides=10)
    for k in range(tiers):
        y = 0.07 + 0.2 * k
        for z, rise in ((-0.12, 0.05), (-0.04, 0.032), (0.04, 0.014), (0.12, 0.0)):
            yield rod("chrome", (-width / 2, y + rise, z), (width / 2, y + rise, z), 0.006, sides=6)
        for i in range(3):
            if (i + k) % 3 < 2:
                for dx in (-0.05, 0.05):
                    tilted = (rotate(p, 0, 0.2) for p in shoe(f"leather_{(i + k) % 3}"))
                    yield from (move(p, ((i - 1) * 0.22 + dx, y + 0.036, 0.0)) for p in tilted)


def lifted_bench(width: float = 0.9) -> Iterator[Solid]:
    """Build a chest on legs with a lid, two flaps below and a backrest."""
    yield from carcass(width, 0.48, 0.36, 0.1, "block", "wood", 0.02)
    corner = (0.015 - width / 2, 0.12, 0.16)
    yield from drawers("paint", width - 0.03, 0.32, corner, 2, 1, "shaker", ("brass", "cup"), opens="tips")
    for i in range(5):
        x = (i - 2) * (width - 0.1) / 4
        yield rounded_box("wood", (0.07, 0.34, 0.02), (x, 0.48, -0.165), 0.006, 1)
    yield rounded_box("wood", (width, 0.07, 0.03), (0.0, 0.82, -0.165), 0.01, 2)


def tall_flaps(width: float = 0.6, height: float = 1.7) -> Iterator[Solid]:
    """Build a slim tower of mirrored flaps."""
    yield from carcass(width, height, 0.22, 0.06)
    high = (height - 0.09) / 4
    for k in range(4):
        y = 0.066 + k * high
        board = rounded_box("wood_1", (width - 0.012, high - 0.008, 0.02), (0.0, y, 0.1), 0.004, 1)
        pane = rounded_box("glass", (width - 0.08, high - 0.08, 0.006), (0.0, y + 0.036, 0.113), 0.002, 1)
        grip = rounded_box("chrome", (0.12, 0.014, 0.02), (0.0, y + high - 0.03, 0.115), 0.005, 2)
        yield from panel("tips", board, pane, grip)


SHOE_CABINETS = (
    design(shoe_flaps), design(shoe_rack), design(louvred), design(shoe_rack, cushioned=True, width=0.95),
    design(shoe_flaps, count=2, width=0.9, grip="ring"), design(cubbies), design(wire_tiers), design(lifted_bench),
    design(tall_flaps), design(wire_tiers, tiers=6, width=0.6),
)  # fmt: skip


FAMILIES = (FurnitureFamily("shoes_cabinet", "shoes_cabinet", SHOE_CABINETS),)
