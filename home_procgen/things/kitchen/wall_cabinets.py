"""Kitchen wall cabinets."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, ring
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc, doors, front, open_case
from home_procgen.things.kitchen.wall_units import bifold, crossed, plate_rack, rounded_end, sliding_panes, tambour


def hanging(
    width: float = 0.6, height: float = 0.68, style: str = "flat", count: int = 1, grip: tuple = ("chrome", "bar")
) -> Iterator[Solid]:
    """Build a wall cabinet with doors and a light pelmet below; style `glass` has crockery behind its doors."""
    yield rounded_box("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 2)
    yield rounded_box("white", (width - 0.08, 0.012, 0.05), (0.0, -0.01, 0.06), 0.005, 1)
    for y in (0.12, height - 0.16):
        yield rounded_box("chrome", (0.012, 0.05, 0.02), (0.006 - width / 2, y, 0.145), 0.004, 1)
    if style == "glass":
        for y in (0.02, height / 2):
            for i in range(3):
                yield cylinder(f"crockery_{i}", 0.045, 0.09, ((i - 1) * width / 4, y, 0.16), sides=14)
    yield from doors(
        "paint",
        width - 0.006,
        height - 0.006,
        (0.003 - width / 2, 0.003, 0.15 + 0.06 * (style == "glass")),
        count,
        style,
        grip,
        0.15,
    )
    if style == "glass":
        for s in (-1, 1):
            yield box("paint", (0.02, height, 0.06), (s * (width / 2 - 0.01), 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, height - 0.02, 0.18))


def hanging_open(width: float = 0.6, height: float = 0.68) -> Iterator[Solid]:
    """Build open wall shelves with crockery and hooks with cups below."""
    yield from open_case("wood", width, height - 0.08, 0.32, (0.3,), (0.0, 0.08, 0.0), (), "wood")
    for i in range(7):
        yield disc("crockery", 0.1, 0.01, (-0.2 + 0.03 * i, 0.205, -0.05 + 0.02 * i), 18)
    for i in range(3):
        yield revolve(
            "glaze", [(0.04, 0.0), (0.05, 0.1), (0.045, 0.14), (0.02, 0.16)], (-0.18 + 0.18 * i, 0.4, 0.02), 14, 2
        )
        yield vessel(
            "crockery_1", [(0.03, 0.0), (0.038, 0.04), (0.036, 0.075)], 0.004, (-0.18 + 0.18 * i, 0.0, 0.08), 12, 2
        )
        yield ring("crockery_1", 0.02, 0.008, (-0.18 + 0.18 * i, 0.06, 0.122), 0, 10)


def corner_hanging(height: float = 0.68) -> Iterator[Solid]:
    """Build a five-sided corner wall cabinet with a door across it."""
    outline = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.0), (0.0, 0.3), (-0.3, 0.3)]
    yield prism("paint", outline, height, (0.0, 0.0, 0.0), "top")
    wide = [(1.02 * x, 1.02 * z) for x, z in outline]
    for y in (-0.012, height):
        yield prism("paint", wide, 0.012, (0.0, y, 0.0), "top")
    leaf = front(
        "paint", (0.4, height - 0.02), (-0.2, 0.01, 0.0), "shaker", ("chrome", "knob", 0.9, 0.15), opens="left"
    )
    yield from (move(rotate(piece, 1, np.pi / 4), (0.152, 0.0, 0.152)) for piece in leaf)


def flap(width: float = 0.9, height: float = 0.4) -> Iterator[Solid]:
    """Build a wide, low wall cabinet with a lift-up front."""
    yield rounded_box("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 2)
    size, corner = (width - 0.006, height - 0.006), (0.003 - width / 2, 0.003, 0.15)
    yield from front("paint", size, corner, "grooves", ("chrome", "bar", 0.5, 0.12), False, "top")


def splashback(slot: str = "tiling", trim: bool = False) -> Iterator[Solid]:
    """Build a panel for the wall between worktops and wall cabinets, which is stretched to its place."""
    yield rounded_box(slot, (0.6, 0.54, 0.0045), (0.0, 0.0, 0.0), 0.0015, 2)
    if trim:
        yield box("chrome", (0.6, 0.008, 0.0055), (0.0, 0.54, 0.0005))


WALL_CABINETS = (
    design(hanging), design(hanging, width=0.8, count=2, style="shaker", grip=("brass", "knob")),
    design(hanging, width=0.8, count=2, style="glass"), design(hanging_open), design(corner_hanging), design(flap),
    design(hanging, width=0.4, style="raised", grip=("brass", "knob")),
    design(hanging, width=0.6, style="grooves", grip=("black", "slot")), design(bifold), design(tambour),
    design(plate_rack), design(sliding_panes), design(rounded_end), design(crossed),
)  # fmt: skip

SPLASHBACKS = (design(splashback), design(splashback, trim=True), design(splashback, slot="stone"))

FAMILIES = (
    FurnitureFamily("hanging_cabinet", "hanging_kitchen_cabinet", WALL_CABINETS),
    FurnitureFamily("splashback", "partition", SPLASHBACKS),
)
