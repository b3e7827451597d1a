"""Bookshelves."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import beam, prism, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import book_row, disc, doors, foot_plate, open_case
from home_procgen.things.movable_parts import panel


def shelf_contents(width: float, bottom: float, height: float, z: float, seed: int, x: float = 0.0) -> Iterator[Solid]:
    """Build random contents of a shelf section centred at x: books, a basket, a vase, a pile or a plant."""
    rng = np.random.default_rng(seed)
    kind = int(rng.integers(0, 6))
    left = x - width / 2 + 0.01
    if kind <= 1:
        yield from book_row(left, bottom, 0.9 * width, height - 0.03, z, seed)
    elif kind == 2:
        yield from book_row(left, bottom, 0.5 * width, height - 0.03, z, seed)
        yield revolve(
            "glaze",
            [(0.03, 0.0), (0.055, 0.05), (0.025, 0.12), (0.035, 0.15)],
            (x + 0.27 * width, bottom, z + 0.03),
            12,
            2,
        )
    elif kind == 3:
        yield rounded_box("cane", (min(0.3, 0.8 * width), min(0.2, 0.7 * height), 0.22), (x, bottom, z + 0.01), 0.02, 1)
    elif kind == 4:
        for i in range(3):
            yield box(f"cover_{i + 2}", (0.2 - 0.01 * i, 0.03, 0.16), (x - 0.1 * width, bottom + 0.031 * i, z + 0.02))
        yield ball("brass", 0.04, (x - 0.1 * width, bottom + 0.131, z + 0.02), 10, 6)
    else:
        yield revolve("terracotta", [(0.035, 0.0), (0.05, 0.07), (0.052, 0.09)], (x, bottom, z + 0.02), 12, 1)
        for i in range(7):
            yield leaf("leaf", 0.13, 0.035, (x, bottom + 0.08, z + 0.02), 0.9 * i, 1.1, 1.5, pieces=3)


def bookcase(
    width: float = 0.8, height: float = 2.0, depth: float = 0.3, shelves: int = 4, columns: int = 1, seed: int = 1
) -> Iterator[Solid]:
    """Build an open case full of books and ornaments."""
    pitch = (height - 0.08) / (shelves + 1)
    yield box("wood", (width - 0.02, 0.06, depth - 0.04), (0.0, 0.0, -0.01))
    yield from open_case(
        "wood",
        width,
        height - 0.06,
        depth,
        [pitch * (i + 1) for i in range(shelves)],
        (0.0, 0.06, 0.0),
        [k / columns for k in range(1, columns)],
        "wood_1",
    )
    for row in range(shelves + 1):
        for column in range(columns):
            x = (column + 0.5) / columns * width - width / 2
            yield from shelf_contents(
                width / columns - 0.05, 0.081 + row * pitch, pitch - 0.03, 0.0, seed * 31 + row * 7 + column, x
            )


def glazed(width: float = 1.0, height: float = 2.0, depth: float = 0.36) -> Iterator[Solid]:
    """Build full bookshelves behind glass doors, above a closed base with doors."""
    yield box("wood", (width, 0.62, depth - 0.02), (0.0, 0.06, -0.01))
    yield box("black", (width - 0.04, 0.06, depth - 0.06))
    yield from doors(
        "wood_1", width - 0.01, 0.58, (0.005 - width / 2, 0.08, depth / 2 - 0.02), 2, "raised", ("brass", "knob")
    )
    yield from open_case(
        "wood", width, height - 0.7, depth - 0.06, (0.32, 0.64, 0.96), (0.0, 0.68, -0.03), (0.5,), "wood_1"
    )
    for row in range(4):
        for s in (-1, 1):
            yield from book_row(
                s * width / 4 - width / 4 + 0.03, 0.70 + 0.32 * row, width / 2 - 0.06, 0.28, -0.03, 3 * row + s + 1
            )
    yield from doors("wood", width, height - 0.72, (-width / 2, 0.69, depth / 2 - 0.06), 2, "glass", ("brass", "knob"))
    yield rounded_box("wood", (width + 0.06, 0.05, depth + 0.02), (0.0, height - 0.02, 0.0), 0.015, 1)


def ladder(width: float = 0.7, height: float = 1.8) -> Iterator[Solid]:
    """Build shelves with random contents between leaning rails, deeper towards the floor."""
    for s in (-1, 1):
        yield beam("wood", (s * width / 2, 0.0, 0.24), (s * width / 2, height, -0.17), 0.03, 0.045)
    for i in range(5):
        y = 0.15 + 0.37 * i
        deep = 0.42 - 0.065 * i
        z = 0.24 - 0.41 * y / height - deep / 2 + 0.05
        yield box("wood_1", (width - 0.03, 0.02, deep), (0.0, y, z))
        yield from shelf_contents(width - 0.08, y + 0.02, 0.3, z, 40 + i)


def cube_shelf(columns: int = 3, rows: int = 3) -> Iterator[Solid]:
    """Build a grid of square boxes with doors, drawers that are baskets, or random contents."""
    size, thick = 0.36, 0.03
    width, height = columns * size + thick, rows * size + thick
    for i in range(columns + 1):
        yield box("wood", (thick, height, 0.38), (i * size - width / 2 + thick / 2, 0.0, 0.0))
    for j in range(rows + 1):
        yield box("wood", (width - 0.01, thick, 0.376), (0.0, j * size, 0.0))
    for j in range(rows):
        for i in range(columns):
            x, y, kind = (i - (columns - 1) / 2) * size, j * size + thick, (2 * i + 3 * j) % 5
            if kind == 0:
                basket = rounded_box("textile", (0.31, 0.29, 0.34), (x, y, 0.01), 0.02, 1)
                yield from panel(0.28, basket, box("black", (0.08, 0.02, 0.006), (x, y + 0.2, 0.182)))
            elif kind == 3:
                knob = disc("brass", 0.012, 0.02, (x + 0.12, y + 0.16, 0.19), 10)
                yield from panel("left", box("wood_1", (0.322, 0.324, 0.02), (x, y + 0.001, 0.18)), knob)
            else:
                yield from shelf_contents(0.32, y, 0.3, 0.0, 5 * i + 11 * j, x)


def zigzag(width: float = 0.8, height: float = 1.7) -> Iterator[Solid]:
    """Build boards with random contents on uprights that alternate from side to side."""
    for i in range(6):
        y = i * (height - 0.02) / 5
        yield box("wood", (width, 0.022, 0.28), (0.0, y, 0.0))
        if i < 5:
            s = 1 if i % 2 else -1
            yield box("wood_1", (0.022, (height - 0.02) / 5 - 0.02, 0.28), (s * width / 2 - s * 0.16, y + 0.022, 0.0))
            yield from shelf_contents(width - 0.4, y + 0.022, 0.28, 0.0, 70 + i, -s * 0.1)


def pipes(width: float = 1.0, height: float = 1.9) -> Iterator[Solid]:
    """Build boards with random contents on iron pipes."""
    for x in (-width / 2 + 0.08, width / 2 - 0.08):
        for z in (-0.11, 0.11):
            yield rod("iron", (x, 0.0, z), (x, height, z), 0.014, sides=8)
            yield cylinder("iron", 0.035, 0.01, (x, 0.0, z), sides=12)
        yield rod("iron", (x, height - 0.014, -0.11), (x, height - 0.014, 0.11), 0.014)
    for i in range(5):
        y = 0.12 + 0.4 * i
        yield rounded_box("wood", (width, 0.03, 0.3), (0.0, y, 0.0), 0.006, 1)
        yield from shelf_contents(width - 0.24, y + 0.03, 0.34, 0.0, 90 + i)


def revolving(height: float = 1.3) -> Iterator[Solid]:
    """Build a square book tower on a revolving foot."""
    yield foot_plate("wood", 0.26, 0.04)
    for i in range(5):
        yield rounded_box("wood", (0.46, 0.022, 0.46), (0.0, 0.06 + i * 0.3, 0.0), 0.006, 1)
    yield box("wood_1", (0.03, height - 0.08, 0.03), (0.0, 0.06, 0.0))
    for row in range(4):
        for turn in range(4):
            for book in book_row(-0.2, 0.082 + 0.3 * row, 0.28, 0.27, 0.12, 7 * row + turn, False):
                yield rotate(book, 1, turn * np.pi / 2)


def spine(height: float = 1.5) -> Iterator[Solid]:
    """Build a column with books lying on short blades."""
    yield rounded_box("iron", (0.3, 0.02, 0.3), (0.0, 0.0, 0.0), 0.008, 1)
    yield box("iron", (0.08, height, 0.02), (0.0, 0.02, -0.1))
    rng = np.random.default_rng(8)
    y = 0.1
    while y < height - 0.16:
        yield box("iron", (0.16, 0.004, 0.17), (0.0, y, -0.01))
        y += 0.004
        for _ in range(3):
            t = float(rng.uniform(0.02, 0.05))
            yield box(f"cover_{int(rng.integers(1, 7))}", (float(rng.uniform(0.16, 0.24)), t, 0.16), (0.0, y, 0.0))
            y += t
        y += 0.04


def children(width: float = 1.0) -> Iterator[Solid]:
    """Build a low house-shaped shelf with boxes of toys."""
    for s in (-1, 1):
        yield box("wood", (0.025, 0.95, 0.3), (s * width / 2, 0.0, 0.0))
        yield prism("wood", [(s * width / 2, 0.95), (s * width / 2, 0.925), (0.0, 1.255), (0.0, 1.28)], 0.3)
    for y in (0.02, 0.34, 0.66, 0.94):
        yield box("wood", (width - 0.02, 0.022, 0.29), (0.0, y, 0.0))
    for i in range(3):
        yield rounded_box(f"bright_{i}", (0.28, 0.2, 0.26), ((i - 1) * 0.31, 0.042, 0.01), 0.03, 2)
    yield from book_row(-0.44, 0.362, 0.5, 0.27, 0.0, 21)
    yield ball("bright_1", 0.09, (0.28, 0.452, 0.02), 14, 8)
    for i in range(3):
        yield rounded_box(f"bright_{i}", (0.09, 0.09, 0.09), (-0.3 + 0.1 * i, 0.682, 0.02), 0.008, 1)
    yield rounded_box("bright_2", (0.09, 0.09, 0.09), (-0.25, 0.772, 0.02), 0.008, 1)


BOOKSHELVES = (
    design(bookcase), design(glazed), design(ladder), design(cube_shelf), design(zigzag), design(pipes),
    design(revolving), design(spine), design(children),
    design(bookcase, width=1.5, columns=2, shelves=5, height=2.1, seed=4), design(cube_shelf, columns=2, rows=4),
)  # fmt: skip


FAMILIES = (FurnitureFamily("bookshelf", "bookshelf", BOOKSHELVES),)
