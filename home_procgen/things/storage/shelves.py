"""Open shelving."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import corners, open_case
from home_procgen.things.storage.bookshelves import shelf_contents, zigzag


def wall_shelf(width: float = 0.8, count: int = 2, kind: str = "bracket") -> Iterator[Solid]:
    """Build `count` wall-mounted boards with objects on them; `kind` of support: `bracket` or `rope`."""
    for i in range(count):
        y = 0.36 * i + 0.12
        yield rounded_box("wood", (width, 0.026, 0.22), (0.0, y, 0.0), 0.006, 1)
        yield from shelf_contents(width - 0.1, y + 0.026, 0.27, 0.0, 130 + 3 * i + count)
        for s in (-1, 1):
            x = s * (width / 2 - 0.12)
            if kind == "bracket":
                yield box("iron", (0.025, 0.12, 0.008), (x, y - 0.12, -0.106))
                yield beam("iron", (x, y - 0.1, -0.1), (x, y - 0.012, 0.07), 0.012)
            else:
                for z in (-0.09, 0.09):
                    yield rod("cream", (x, y - 0.01, z), (x, y + 0.36, 0.5 * z), 0.006, sides=6)


def plate_shelf(width: float = 0.6, depth: float = 0.18, count: int = 2) -> Iterator[Solid]:
    """Build empty plates on two brackets each."""
    for k in range(count):
        y = 0.3 * k
        yield rounded_box("wood", (width, 0.02, depth), (0.0, y + 0.16, 0.0), 0.006, 1)
        for s in (-1, 1):
            x = s * (width / 2 - 0.06)
            yield rounded_box("chrome", (0.02, 0.16, 0.012), (x, y, -depth / 2 + 0.006), 0.004, 1)
            yield beam("chrome", (x, y + 0.02, -depth / 2 + 0.01), (x, y + 0.155, depth / 2 - 0.03), 0.012)


def wall_cubes(count: int = 3) -> Iterator[Solid]:
    """Build open wall boxes at two heights, each with random contents."""
    for i in range(count):
        x, y = (i - (count - 1) / 2) * 0.42, 0.14 * (i % 2)
        yield from open_case("wood", 0.34, 0.34, 0.22, (), (x, y, 0.0), (), "wood_1")
        yield from shelf_contents(0.28, y + 0.02, 0.29, 0.0, 200 + i, x)


def metal_rack(width: float = 0.9, height: float = 1.8, depth: float = 0.42) -> Iterator[Solid]:
    """Build a storeroom rack: perforated posts and steel shelves with boxes and tins."""
    for x, z in corners(width - 0.03, depth - 0.03):
        yield box("steel", (0.03, height, 0.03), (x, 0.0, z))
    for i in range(5):
        y = 0.08 + i * (height - 0.12) / 4
        yield rounded_box("steel", (width - 0.01, 0.03, depth - 0.01), (0.0, y, 0.0), 0.005, 1)
        if i < 4:
            yield rounded_box("crust", (0.34, 0.26, 0.32), (-0.22 + 0.05 * (i % 2), y + 0.03, 0.0), 0.005, 1)
            yield cylinder(f"bright_{i % 3}", 0.08, 0.2, (0.14, y + 0.03, 0.04), sides=16)
            yield cylinder("white", 0.07, 0.16, (0.31, y + 0.03, -0.03), sides=16)


def wire_rack(width: float = 0.6, height: float = 1.3) -> Iterator[Solid]:
    """Build chrome wire shelves with towels, a basket and jars."""
    for x, z in corners(width, 0.34):
        yield rod("chrome", (x, 0.0, z), (x, height, z), 0.012)
    for y in (0.12, 0.5, 0.88, 1.22):
        for z in (-0.17, 0.17):
            yield rod("chrome", (-width / 2, y, z), (width / 2, y, z), 0.006, sides=6)
        for i in range(13):
            x = (i - 6) * width / 12
            yield rod("chrome", (x, y, -0.17), (x, y, 0.17), 0.003, sides=5)
    for i in range(3):
        yield padded_block("towel", (0.42, 0.07, 0.26), (0.0, 0.507 + 0.065 * i, 0.0), 5.0, 4)
    yield rounded_box("cane", (0.4, 0.22, 0.28), (0.0, 0.127, 0.0), 0.03, 1)
    for i in range(3):
        yield cylinder(f"glaze_{i}", 0.03, 0.16, (-0.15 + 0.12 * i, 0.886, 0.0), sides=12)


def corner_etagere(height: float = 1.6) -> Iterator[Solid]:
    """Build five quarter-round corner shelves on turned posts, with a vase on all but the top."""
    arc = [(0.36 * np.cos(a) - 0.16, 0.36 * np.sin(a) - 0.16) for a in np.linspace(0, np.pi / 2, 10)]
    for i in range(5):
        y = 0.06 + i * (height - 0.1) / 4
        yield prism("wood", [(-0.16, -0.16), *arc], 0.02, (0.0, y, 0.0), "top")
        if i < 4:
            yield revolve(
                "glaze", [(0.03, 0.0), (0.05, 0.05), (0.02, 0.11), (0.03, 0.14)], (-0.04, y + 0.02, -0.04), 12, 2
            )
    for x, z in ((-0.14, -0.14), (0.18, -0.14), (-0.14, 0.18)):
        yield revolve(
            "wood",
            [(0.014, 0.0), (0.02, 0.3), (0.012, 0.6), (0.02, 1.0), (0.012, 1.3), (0.016, height)],
            (x, 0.0, z),
            10,
            2,
        )


def pegboard(width: float = 1.2) -> Iterator[Solid]:
    """Build a wall board with tools."""
    yield rounded_box("wood", (width, 0.8, 0.02), (0.0, 0.0, -0.06), 0.006, 1)
    for i in range(4):
        x = -0.48 + 0.13 * i
        yield rod(f"bright_{i % 3}", (x, 0.52, -0.03), (x, 0.66, -0.03), 0.016)
        yield rod("chrome", (x, 0.36, -0.03), (x, 0.52, -0.03), 0.005)
    yield box("wood_1", (0.035, 0.3, 0.03), (0.12, 0.3, -0.034))
    yield rounded_box("iron", (0.13, 0.05, 0.04), (0.12, 0.6, -0.03), 0.01, 1)
    yield prism("gray", [(0.25, 0.42), (0.55, 0.5), (0.55, 0.58), (0.25, 0.6)], 0.006, (0.0, 0.0, -0.045))
    yield rounded_box("red", (0.1, 0.14, 0.03), (0.3, 0.45, -0.034), 0.02, 1)
    yield ring("orange", 0.12, 0.035, (-0.3, 0.18, -0.032), 2, 20)
    yield ring("iron", 0.05, 0.02, (0.05, 0.16, -0.036), 2, 16)
    yield rounded_box("wood_1", (0.5, 0.06, 0.14), (0.3, 0.04, 0.02), 0.01, 1)
    for i in range(4):
        yield cylinder("tint", 0.03, 0.08, (0.14 + 0.1 * i, 0.1, 0.02), sides=12)


def wine_rack(columns: int = 4, rows: int = 5) -> Iterator[Solid]:
    """Build a lattice with bottles."""
    size = 0.12
    for s in (-1, 1):
        for i in range(columns + 1):
            yield beam(
                "wood",
                ((i - columns / 2) * size, 0.0, s * 0.1),
                ((i - columns / 2) * size, rows * size + 0.02, s * 0.1),
                0.02,
            )
        for j in range(rows + 1):
            yield beam(
                "wood",
                (-columns / 2 * size, j * size + 0.01, s * 0.1),
                (columns / 2 * size, j * size + 0.01, s * 0.1),
                0.018,
            )
    for j in range(rows):
        for i in range(columns):
            if (i * 3 + j * 5) % 4:
                x, y = (i + 0.5 - columns / 2) * size, (j + 0.42) * size
                yield tube(
                    "green", [(x, y, -0.15), (x, y, 0.05), (x, y, 0.08), (x, y, 0.15)], [0.038, 0.038, 0.015, 0.015], 10
                )


SHELVING = (
    design(wall_shelf), design(metal_rack), design(wire_rack), design(corner_etagere), design(pegboard),
    design(wine_rack), design(wall_shelf, count=1, width=1.0), design(wall_shelf, count=2, kind="rope", width=0.7),
    design(zigzag, width=0.6, height=1.4), design(metal_rack, width=1.2, height=2.0, depth=0.5), design(wall_cubes),
    design(plate_shelf),
)  # fmt: skip


FAMILIES = (FurnitureFamily("shelving", "shelving", SHELVING),)
