"""Dining tables, small tables and game tables."""

import itertools
from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.shapes.transforms import add_mirror_images, repeat_around
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, corners, legs
from home_procgen.things.tables.bases import TopKind, crossed, drum_base, four_legs, panels, pedestal, top, trestle

TABLE_HEIGHT = 0.75  # [m], height of dining tables


def farmhouse(width: float = 1.6, depth: float = 0.9, kind: LegKind = "turned") -> Iterator[Solid]:
    """Build a plank top on an apron with four legs."""
    count = 5
    for i in range(count):
        yield rounded_box(
            "wood_1",
            (width - 0.16, 0.03, depth / count - 0.002),
            (0.0, TABLE_HEIGHT - 0.03, (i - 2) * depth / count),
            0.006,
            1,
        )
    yield from add_mirror_images(
        [rounded_box("wood_1", (0.08, 0.03, depth), (width / 2 - 0.04, TABLE_HEIGHT - 0.03, 0.0), 0.006, 1)]
    )
    yield from four_legs(width, depth, TABLE_HEIGHT - 0.03, kind, 0.09)


def slim(width: float = 1.4, depth: float = 0.8, kind: LegKind = "taper", shape: TopKind = "board") -> Iterator[Solid]:
    """Build a thin top on light legs."""
    yield from top("wood_1", width, depth, TABLE_HEIGHT, shape, 0.026)
    inside = 0.7 if shape == "round" else 1.0
    yield from four_legs(inside * width - 0.1, inside * depth - 0.06, TABLE_HEIGHT - 0.026, kind, 0.05, 0.06)


def trestle_table(width: float = 1.8, depth: float = 0.9) -> Iterator[Solid]:
    """Build a thick top on trestles."""
    yield from top("wood", width, depth, TABLE_HEIGHT, "board", 0.05)
    yield from trestle(width, depth, TABLE_HEIGHT - 0.05)


def steel_frame(width: float = 1.7, depth: float = 0.9) -> Iterator[Solid]:
    """Build a thick wooden top on crossed steel ends."""
    yield from top("wood_1", width, depth, TABLE_HEIGHT, "board", 0.045)
    yield from crossed(width, depth, TABLE_HEIGHT - 0.045)


def tulip(radius: float = 0.55, material: str = "marble") -> Iterator[Solid]:
    """Build a round top on one flared foot."""
    yield from top(material, 2 * radius, 2 * radius, TABLE_HEIGHT, "round", 0.025)
    yield from pedestal(radius, TABLE_HEIGHT - 0.025, "white")


def claw_foot(width: float = 1.15) -> Iterator[Solid]:
    """Build a round wooden top on a turned column with four feet."""
    yield from top("wood", width, width, TABLE_HEIGHT, "round", 0.03)
    yield cylinder("wood", 0.25, 0.03, (0.0, TABLE_HEIGHT - 0.06, 0.0), sides=24)
    yield from pedestal(width / 2, TABLE_HEIGHT - 0.06, "wood", 4)


def double_pedestal(width: float = 1.9, depth: float = 1.0) -> Iterator[Solid]:
    """Build an oval top on two columns."""
    yield from top("wood", width, depth, TABLE_HEIGHT, "oval", 0.035)
    yield box("wood", (width - 0.6, 0.06, 0.1), (0.0, TABLE_HEIGHT - 0.095, 0.0))
    for x in (-0.42, 0.42):
        yield from (move(p, (x, 0.0, 0.0)) for p in pedestal(0.48, TABLE_HEIGHT - 0.09, "wood", 3))


def panel_table(width: float = 1.6, depth: float = 0.85) -> Iterator[Solid]:
    """Build a top between two full ends."""
    yield from top("wood", width, depth, TABLE_HEIGHT, "board", 0.04)
    yield from panels(width, depth, TABLE_HEIGHT - 0.04)


def glass_dining(width: float = 1.5, depth: float = 0.9) -> Iterator[Solid]:
    """Build a glass plate on two steel loops."""
    yield from top("glass", width, depth, TABLE_HEIGHT, "board", 0.014)
    for x in (-0.4, 0.4):
        path = fillet(
            [(x, 0.012, -0.34), (x, TABLE_HEIGHT - 0.026, -0.28), (x, TABLE_HEIGHT - 0.026, 0.28), (x, 0.012, 0.34)],
            0.06,
            closed=True,
        )
        yield tube("chrome", path, 0.014, 8, closed=True)
    yield rod("chrome", (-0.4, 0.012, 0.0), (0.4, 0.012, 0.0), 0.012)
    for x, z in corners(0.8, 0.4):
        yield cylinder("chrome", 0.02, 0.01, (x, TABLE_HEIGHT - 0.024, z), sides=10)


def slatted_drum(width: float = 1.2) -> Iterator[Solid]:
    """Build a round top on a ring of slats."""
    yield from top("wood", width, width, TABLE_HEIGHT, "round", 0.035)
    yield from drum_base(0.3, TABLE_HEIGHT - 0.03)


def drop_leaf(width: float = 1.0, depth: float = 0.9) -> Iterator[Solid]:
    """Build a narrow drop-leaf table, one leaf up on a gate leg and one hanging."""
    yield from top("wood", 0.42, depth, TABLE_HEIGHT, "board", 0.024)
    yield rounded_box("wood", (0.4, 0.024, depth), (0.415, TABLE_HEIGHT - 0.024, 0.0), 0.008, 1)
    yield rounded_box("wood", (0.024, 0.42, depth), (-0.225, TABLE_HEIGHT - 0.45, 0.0), 0.008, 1)
    yield from four_legs(0.44, depth - 0.06, TABLE_HEIGHT - 0.024, "turned", 0.055)
    yield from (move(p, (0.48, 0.0, 0.0)) for p in legs("wood", 0.05, 0.05, TABLE_HEIGHT - 0.024, "turned", 0.05))
    yield beam("wood", (0.15, 0.16, 0.0), (0.48, 0.16, 0.0), 0.03)


def live_edge(width: float = 1.8, depth: float = 0.9) -> Iterator[Solid]:
    """Build a slab with a natural edge on steel frames."""
    t = np.linspace(-1, 1, 15)
    wave = 0.03 * np.sin(7 * t) + 0.02 * np.sin(17 * t + 1)
    outline = [
        *zip(t * width / 2, -depth / 2 + wave, strict=True),
        *zip(t[::-1] * width / 2, depth / 2 + 0.04 * np.cos(6 * t[::-1]), strict=True),
    ]
    yield prism("wood", outline, 0.06, (0.0, TABLE_HEIGHT - 0.06, 0.0), "top")
    for s in (-1, 1):
        x = s * (width / 2 - 0.3)
        path = [(x, TABLE_HEIGHT - 0.06, -0.3), (x, 0.02, -0.34), (x, 0.02, 0.34), (x, TABLE_HEIGHT - 0.06, 0.3)]
        for a, b in itertools.pairwise(path):
            yield beam("iron", a, b, 0.08, 0.03)


def bistro(width: float = 0.65, height: float = 0.74, shape: TopKind = "round") -> Iterator[Solid]:
    """Build a small top on an iron column with three feet, or four under a square top."""
    yield from top("marble" if shape == "round" else "wood", width, width, height, shape, 0.024)
    yield cylinder("iron", 0.03, height - 0.06, (0.0, 0.04, 0.0), sides=12)
    yield cylinder("iron", 0.14, 0.02, (0.0, height - 0.044, 0.0), sides=16)
    foot = [
        tube("iron", fillet([(0.0, 0.16, 0.02), (0.0, 0.1, 0.2), (0.0, 0.014, 0.3)], 0.08), 0.014),
        ball("iron", 0.018, (0.0, 0.018, 0.3), 8, 4),
    ]
    yield from repeat_around(foot, 3 if shape == "round" else 4)


def folding_table(width: float = 1.2, depth: float = 0.6) -> Iterator[Solid]:
    """Build a light top on crossed tubes."""
    yield from top("white", width, depth, 0.73, "board", 0.04)
    for x in (-0.42, 0.42):
        for s in (-1, 1):
            yield rod("gray", (x, 0.0, s * 0.26), (x, 0.7, -s * 0.2), 0.012)
    for z in (-0.26, 0.26):
        yield rod("gray", (-0.42, 0.04, z * 0.96), (0.42, 0.04, z * 0.96), 0.01)


def billiards(width: float = 2.4, depth: float = 1.35) -> Iterator[Solid]:
    """Build a billiard table with cushions, pockets, balls and turned legs."""
    yield box("felt", (width - 0.2, 0.03, depth - 0.2), (0.0, 0.76, 0.0))
    for s in (-1, 1):
        yield rounded_box("wood", (width, 0.09, 0.13), (0.0, 0.74, s * (depth / 2 - 0.065)), 0.02, 2)
        yield rounded_box("wood", (0.13, 0.09, depth - 0.26), (s * (width / 2 - 0.065), 0.74, 0.0), 0.02, 2)
        for x in (-0.5, 0.5):
            yield box("felt", (width / 2 - 0.24, 0.03, 0.04), (x * (width / 2 - 0.03), 0.788, s * (depth / 2 - 0.15)))
    for x in (-1, 0, 1):
        for s in (-1, 1):
            yield cylinder("black", 0.06, 0.012, (x * (width / 2 - 0.13), 0.79, s * (depth / 2 - 0.13)), sides=14)
    yield from legs("wood", width - 0.14, depth - 0.14, 0.74, "turned", 0.15)
    yield box("wood", (width - 0.2, 0.16, depth - 0.2), (0.0, 0.6, 0.0))
    for i in range(10):
        row = int((np.sqrt(8 * i + 1) - 1) / 2)
        place = i - row * (row + 1) / 2
        yield ball(f"bright_{1 + i % 4}", 0.029, (0.45 + 0.052 * row, 0.819, (place - row / 2) * 0.06), 10, 6)
    yield rod("wood", (-0.9, 0.802, 0.3), (0.3, 0.802, 0.1), 0.012, 0.006)


def ping_pong(width: float = 2.74, depth: float = 1.52) -> Iterator[Solid]:
    """Build a table tennis table with white lines, a net and bats."""
    yield rounded_box("blue", (width, 0.03, depth), (0.0, 0.73, 0.0), 0.008, 1)
    for s in (-1, 1):
        yield box("white", (width, 0.002, 0.02), (0.0, 0.7595, s * (depth / 2 - 0.012)))
        yield box("white", (0.02, 0.002, depth - 0.05), (s * (width / 2 - 0.012), 0.7595, 0.0))
    yield box("white", (width - 0.06, 0.002, 0.006), (0.0, 0.7595, 0.0))
    yield box("gray", (0.006, 0.15, depth + 0.2), (0.0, 0.762, 0.0))
    yield box("white", (0.008, 0.015, depth + 0.2), (0.0, 0.905, 0.0))
    for x in (-1.1, -0.2, 0.2, 1.1):
        for z in (-0.6, 0.6):
            yield rod("iron", (x, 0.0, z), (x * 0.95, 0.73, z), 0.02)
    for x, z, color in ((0.8, 0.3, "red"), (-0.8, -0.2, "black")):
        yield cylinder(color, 0.08, 0.01, (x, 0.76, z), sides=18)
        yield box("wood", (0.1, 0.014, 0.028), (x + np.sign(x) * 0.12, 0.76, z))
    yield ball("orange", 0.02, (0.4, 0.78, 0.2), 10, 6)


def foosball(width: float = 1.4, depth: float = 0.75) -> Iterator[Solid]:
    """Build a table football box with rods of players."""
    yield box("green", (width - 0.06, 0.02, depth - 0.06), (0.0, 0.76, 0.0))
    for s in (-1, 1):
        yield rounded_box("wood", (width, 0.28, 0.035), (0.0, 0.62, s * (depth / 2 - 0.018)), 0.008, 1)
        yield rounded_box("wood", (0.035, 0.28, depth - 0.06), (s * (width / 2 - 0.018), 0.62, 0.0), 0.008, 1)
        yield box("black", (0.012, 0.08, 0.2), (s * (width / 2 - 0.034), 0.78, 0.0))
    yield from legs("wood", width, depth, 0.64, "taper", 0.1)
    for i in range(8):
        x, color = (i - 3.5) * 0.155, "red" if i in (0, 1, 3, 5) else "blue"
        yield rod("chrome", (x, 0.86, -depth / 2 - 0.14), (x, 0.86, depth / 2 + 0.14), 0.007, sides=6)
        yield rod(
            "black",
            (x, 0.86, (depth / 2 + 0.1) * (1 if color == "red" else -1)),
            (x, 0.86, (depth / 2 + 0.22) * (1 if color == "red" else -1)),
            0.016,
            sides=8,
        )
        for z in np.linspace(-0.24, 0.24, (1, 2, 3, 5)[min(i, 7 - i)]) if i not in (0, 7) else [0.0]:
            yield rounded_box(color, (0.02, 0.1, 0.03), (x, 0.79, float(z)), 0.006, 1)


DINING = (
    design(farmhouse), design(slim), design(trestle_table), design(steel_frame), design(tulip), design(claw_foot),
    design(double_pedestal), design(panel_table), design(glass_dining), design(slatted_drum), design(live_edge),
    design(drop_leaf), design(slim, width=1.2, depth=1.2, kind="splay", shape="round"),
    design(farmhouse, kind="block", width=1.8),
)  # fmt: skip
SMALL_TABLES = (
    design(bistro), design(bistro, shape="board", width=0.7), design(folding_table),
    design(slim, width=0.8, depth=0.8, kind="square"), design(bistro, height=1.05, width=0.6),
)  # fmt: skip
GAMES = (design(billiards), design(ping_pong), design(foosball))

FAMILIES = (
    FurnitureFamily("dining_table", "dining_table", DINING),
    FurnitureFamily("table", "table", SMALL_TABLES),
    FurnitureFamily("game_table", "game_table", GAMES),
)
