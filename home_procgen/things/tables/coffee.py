"""Coffee tables, side tables and consoles."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet, loop
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import band, beam, prism, ring, rod, tube
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, corners, drawers, legs
from home_procgen.things.movable_parts import assign_part, lid_part
from home_procgen.things.tables.bases import TopKind, crossed, drum_base, four_legs, pedestal, top, wire_base


def shelved(width: float = 1.1, depth: float = 0.6, height: float = 0.44, kind: LegKind = "square") -> Iterator[Solid]:
    """Build a top and a slatted shelf between four legs."""
    yield from top("wood", width, depth, height, "board", 0.03)
    yield from four_legs(width, depth, height - 0.03, kind, 0.055, 0.05)
    for i in range(6):
        yield box("wood", (width - 0.14, 0.015, 0.06), (0.0, 0.13, (i - 2.5) * (depth - 0.16) / 6))
    for s in (-1, 1):
        yield box("wood", (0.03, 0.03, depth - 0.14), (s * (width / 2 - 0.09), 0.1, 0.0))


def glass_top(width: float = 1.15, depth: float = 0.65, shape: TopKind = "board") -> Iterator[Solid]:
    """Build a glass top on a brass frame with a lower glass shelf."""
    yield from top("glass", width, depth, 0.42, shape, 0.012)
    if shape == "round":
        width, depth = 0.72 * width, 0.72 * depth
    for x, z in corners(width - 0.1, depth - 0.1):
        yield rod("brass", (x, 0.0, z), (x, 0.41, z), 0.013)
    for y in (0.12, 0.4):
        for a, b in (((-1, -1), (1, -1)), ((1, -1), (1, 1)), ((1, 1), (-1, 1)), ((-1, 1), (-1, -1))):
            p, q = (((width - 0.1) / 2 * c[0], y, (depth - 0.1) / 2 * c[1]) for c in (a, b))
            yield rod("brass", p, q, 0.009)
    yield box("glass", (width - 0.12, 0.008, depth - 0.12), (0.0, 0.128, 0.0))


def waterfall(width: float = 1.0, depth: float = 0.55, height: float = 0.4) -> Iterator[Solid]:
    """Build a top and both ends from one bent sheet, with a shelf."""
    path = fillet(
        [(-width / 2, 0.0, 0.0), (-width / 2, height, 0.0), (width / 2, height, 0.0), (width / 2, 0.0, 0.0)], 0.09, 10
    )
    yield band("wood", path, depth, 0.03, up=(1.0, 0.0, 0.0))
    yield box("wood", (width - 0.04, 0.018, depth - 0.03), (0.0, 0.15, 0.0))


def freeform(width: float = 1.25, depth: float = 0.85) -> Iterator[Solid]:
    """Build a three-cornered glass plate on two interlocked pieces of wood."""
    angle = 2 * np.pi * np.arange(36) / 36
    reach = 0.5 * (1 + 0.16 * np.cos(3 * angle))
    yield prism(
        "glass",
        np.stack([reach * np.cos(angle) * width, reach * np.sin(angle) * depth], -1),
        0.018,
        (0.0, 0.39, 0.0),
        "top",
    )
    for turn in (0, 1):
        arm = fillet([(0.36, 0.02, 0.0), (0.3, 0.39, 0.0), (-0.05, 0.06, 0.03), (-0.3, 0.02, 0.24)], 0.2, 5)
        yield tube("wood", np.asarray(arm) * ((1, 1, 1) if turn == 0 else (-1, 1, -1)), 0.035, 10)


def nest(count: int = 3) -> Iterator[Solid]:
    """Build a nest of tables of decreasing size."""
    for i in range(count):
        size, height, z = 0.56 - 0.1 * i, 0.48 - 0.06 * i, 0.1 * i
        yield rounded_box("wood", (size, 0.022, 0.4), (0.0, height - 0.022, z), 0.008, 1)
        for s in (-1, 1):
            x = s * (size / 2 - 0.03)
            for dz in (-0.16, 0.16):
                yield rod("wood", (x, 0.0, z + dz), (x, height - 0.02, z + dz), 0.013, 0.017)
            yield beam("wood", (x, 0.05, z - 0.16), (x, 0.05, z + 0.16), 0.02)


def chest(width: float = 1.0, depth: float = 0.55) -> Iterator[Solid]:
    """Build an old trunk with iron bands."""
    yield rounded_box("wood", (width, 0.3, depth), (0.0, 0.03, 0.0), 0.015, 1)
    lid = lid_part(0.33, -depth / 2 - 0.01)
    yield from assign_part(lid, [rounded_box("wood", (width + 0.02, 0.12, depth + 0.02), (0.0, 0.33, 0.0), 0.04, 3)])
    for x in (-0.34, 0.0, 0.34):
        yield box("iron", (0.05, 0.31, depth + 0.012), (x * width, 0.026, 0.0))
        yield from assign_part(lid, [rounded_box("iron", (0.05, 0.13, depth + 0.03), (x * width, 0.327, 0.0), 0.04, 3)])
    yield box("brass", (0.09, 0.1, 0.02), (0.0, 0.27, depth / 2 + 0.006))
    for s in (-1, 1):
        yield ring("iron", 0.05, 0.014, (s * (width / 2 + 0.012), 0.2, 0.0), 0, 12)
    yield from legs("iron", width - 0.02, depth - 0.02, 0.04, "block", 0.06)


def drawer_table(width: float = 1.1, depth: float = 0.6, kind: LegKind = "taper") -> Iterator[Solid]:
    """Build a shallow body with drawers on thin legs."""
    yield from legs("wood_1", width - 0.1, depth - 0.1, 0.26, kind, 0.045)
    yield box("wood", (width - 0.02, 0.14, depth - 0.06), (0.0, 0.25, -0.01))
    yield from drawers(
        "wood_1",
        width - 0.06,
        0.12,
        (0.03 - width / 2, 0.26, depth / 2 - 0.04),
        2,
        1,
        "flat",
        ("brass", "knob"),
        opens=0.35,
    )
    yield from top("wood", width, depth, 0.42, "board", 0.03)


def plinth(width: float = 0.9, depth: float = 0.9) -> Iterator[Solid]:
    """Build a heavy block with a shadow gap."""
    yield box("black", (width - 0.12, 0.05, depth - 0.12))
    yield rounded_box("stone", (width, 0.24, depth), (0.0, 0.05, 0.0), 0.012, 2)
    yield box("black", (width - 0.06, 0.012, depth - 0.06), (0.0, 0.29, 0.0))
    yield rounded_box("stone", (width, 0.05, depth), (0.0, 0.302, 0.0), 0.012, 2)


def round_coffee(width: float = 0.9, base: str = "legs") -> Iterator[Solid]:
    """Build a round top on legs, slats or wires."""
    yield from top("wood" if base != "wire" else "marble", width, width, 0.42, "round", 0.03)
    if base == "legs":
        yield from repeat_around([rod("wood", (0.0, 0.0, 0.42 * width), (0.0, 0.39, 0.3 * width), 0.013, 0.02, 10)], 3)
        yield cylinder("wood", 0.26, 0.018, (0.0, 0.14, 0.0), sides=28)
    elif base == "slats":
        yield from drum_base(0.34 * width, 0.39, 24)
    else:
        yield from wire_base(0.3 * width, 0.39, 18)


def tray_table(width: float = 0.7) -> Iterator[Solid]:
    """Build a tray with handles on a folding stand."""
    yield vessel(
        "brass", [(width / 2 - 0.03, 0.0), (width / 2 - 0.005, 0.01), (width / 2, 0.05)], 0.006, (0.0, 0.44, 0.0), 32, 1
    )
    for s in (-1, 1):
        for a in (-1, 1):
            yield rod("wood", (a * 0.24, 0.0, s * 0.18), (-a * 0.22, 0.445, s * 0.18), 0.012)
        yield tube(
            "brass",
            fillet(
                [(s * width / 2, 0.48, -0.08), (s * (width / 2 + 0.06), 0.49, 0.0), (s * width / 2, 0.48, 0.08)], 0.06
            ),
            0.006,
            6,
        )
    for x in (-0.24, 0.24):
        yield rod("wood", (x, 0.01, -0.18), (x, 0.01, 0.18), 0.01)


def x_coffee(width: float = 1.0, depth: float = 0.6) -> Iterator[Solid]:
    """Build a thick top on crossed iron ends."""
    yield from top("wood", width, depth, 0.44, "board", 0.045)
    yield from crossed(width, depth, 0.395)


def oval_coffee(width: float = 1.2, depth: float = 0.65, kind: LegKind = "splay") -> Iterator[Solid]:
    """Build an oval top over a magazine shelf."""
    yield from top("wood", width, depth, 0.43, "oval", 0.024)
    yield from legs("wood", width - 0.34, depth - 0.16, 0.41, kind, 0.045)
    yield prism("wood_1", loop(width - 0.4, depth - 0.24, 28), 0.014, (0.0, 0.22, 0.0), "top")


def lift_box(width: float = 1.05, depth: float = 0.6) -> Iterator[Solid]:
    """Build a box with open niches, a basket and a block in them, and a thick top."""
    yield box("wood", (width - 0.06, 0.03, depth - 0.06), (0.0, 0.03, 0.0))
    for x in (-0.5, 0.0, 0.5):
        yield box("wood", (0.025, 0.3, depth - 0.06), (x * (width - 0.1), 0.05, 0.0))
    yield box("wood_1", (width * 0.46, 0.12, 0.4), (0.24 * width, 0.07, 0.0))
    yield from top("wood_1", width, depth, 0.41, "board", 0.05)
    yield from legs("black", width - 0.1, depth - 0.1, 0.04, "block", 0.06)
    yield padded_block("cane", (0.36, 0.18, 0.36), (-0.24 * width, 0.06, 0.0), 8.0, 4)


def side_column(width: float = 0.42, feet: int = 3) -> Iterator[Solid]:
    """Build a small round top on a turned column."""
    yield from top("wood", width, width, 0.55, "round", 0.022)
    yield from pedestal(width / 2, 0.53, "wood", feet)


def c_table(width: float = 0.42) -> Iterator[Solid]:
    """Build a C-shaped side table that reaches over a sofa."""
    yield from top("wood", width, 0.36, 0.6, "board", 0.02)
    for z in (-0.15, 0.15):
        path = [(0.16, 0.588, z), (-0.18, 0.588, z), (-0.18, 0.012, z), (0.18, 0.012, z)]
        yield tube("iron", fillet(path, 0.03), 0.01)
    yield rod("iron", (0.18, 0.012, -0.15), (0.18, 0.012, 0.15), 0.01)


def garden_stool() -> Iterator[Solid]:
    """Build a glazed barrel with round openings."""
    yield revolve("glaze", [(0.14, 0.0), (0.17, 0.04), (0.2, 0.22), (0.17, 0.41), (0.13, 0.45)], sides=24, steps=3)
    for y in (0.06, 0.39):
        yield ring("glaze", 0.174, 0.014, (0.0, y, 0.0), 1, 24)
    for i in range(10):
        a = 2 * np.pi * i / 10
        yield ring(
            "brass", 0.026, 0.01, (0.195 * np.cos(a), 0.24, 0.195 * np.sin(a)), 0 if abs(np.cos(a)) > 0.7 else 2, 10
        )


def stump() -> Iterator[Solid]:
    """Build an upright log."""
    angle = 2 * np.pi * np.arange(26) / 26
    reach = 0.18 * (1 + 0.06 * np.sin(3 * angle) + 0.03 * np.sin(7 * angle + 1))
    outline = np.stack([reach * np.cos(angle), reach * np.sin(angle)], -1)
    yield prism("bark", outline, 0.44, (0.0, 0.0, 0.0), "top")
    yield prism("wood", 0.94 * outline, 0.012, (0.0, 0.436, 0.0), "top")


def demilune(width: float = 0.9, depth: float = 0.4) -> Iterator[Solid]:
    """Build a half-round wall console."""
    half = [(width / 2 * np.cos(a), -0.18 + depth * np.sin(a)) for a in np.linspace(0, np.pi, 19)]
    yield prism("wood", half, 0.028, (0.0, 0.77, 0.0), "top")
    yield prism("wood", [(0.9 * x, -0.17 + 0.88 * (z + 0.18)) for x, z in half], 0.09, (0.0, 0.68, 0.0), "top")
    for x, z in ((-0.38, -0.15), (0.38, -0.15), (-0.2, 0.14), (0.2, 0.14)):
        yield revolve(
            "wood", [(0.012, 0.0), (0.018, 0.1), (0.014, 0.4), (0.026, 0.62), (0.026, 0.69)], (x, 0.0, z), 10, 2
        )


def console(width: float = 1.1, depth: float = 0.34, base: str = "iron") -> Iterator[Solid]:
    """Build a long, narrow table for a hall or the back of a sofa."""
    yield from top("wood", width, depth, 0.8, "board", 0.035)
    if base == "iron":
        for s in (-1, 1):
            x = s * (width / 2 - 0.06)
            yield tube(
                "iron", fillet([(x, 0.78, -0.13), (x, 0.01, -0.13), (x, 0.01, 0.13), (x, 0.78, 0.13)], 0.02), 0.012
            )
        yield box("wood", (width - 0.12, 0.025, depth - 0.06), (0.0, 0.16, 0.0))
        for s in (-1, 1):
            yield rod(
                "iron", (-s * (width / 2 - 0.06), 0.18, -0.13), (s * (width / 2 - 0.06), 0.76, -0.13), 0.006, sides=6
            )
    else:
        yield from legs("wood", width - 0.06, depth - 0.04, 0.765, "turned", 0.055)
        yield box("wood", (width - 0.12, 0.1, depth - 0.08), (0.0, 0.666, -0.01))
        yield from drawers(
            "wood_1",
            width - 0.16,
            0.1,
            (0.08 - width / 2, 0.666, depth / 2 - 0.06),
            2,
            1,
            "flat",
            ("brass", "ring"),
            opens=0.2,
        )


COFFEE = (
    design(shelved), design(glass_top), design(waterfall), design(freeform), design(nest), design(chest),
    design(drawer_table), design(plinth), design(round_coffee), design(round_coffee, base="slats", width=0.8),
    design(round_coffee, base="wire", width=0.75), design(tray_table), design(x_coffee), design(oval_coffee),
    design(lift_box), design(glass_top, shape="round", width=0.85, depth=0.85),
)  # fmt: skip
SIDE_TABLES = (
    design(side_column),
    design(c_table),
    design(garden_stool),
    design(stump),
    design(round_coffee, width=0.45),
    design(tray_table, width=0.46),
)
CONSOLES = (design(console), design(console, base="turned", width=1.2), design(demilune))

FAMILIES = (
    FurnitureFamily("coffee_table", "coffee_table", COFFEE),
    FurnitureFamily("side_table", "coffee_table", SIDE_TABLES),
    FurnitureFamily("console", "coffee_table", CONSOLES),
)
