"""Bookshelves, open shelving, coat stands, trolleys, safes."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.groups import around
from home_mjx.datasets.homes.shapes.sheets import leaf
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import book_row, case, corners, disc, doors, foot_plate
from home_mjx.datasets.homes.things.storage.cabinets import garment
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def filled(width: float, bottom: float, height: float, z: float, seed: int, x: float = 0.0) -> Iterator[Solid]:
    """What may stand on a shelf of this width around x: books, a basket, a vase, a box, a plant."""
    rng = np.random.default_rng(seed)
    kind = int(rng.integers(0, 6))
    left = x - width / 2 + 0.01
    if kind <= 1:
        yield from book_row(left, bottom, 0.9 * width, height - 0.03, z, seed)
    elif kind == 2:
        yield from book_row(left, bottom, 0.5 * width, height - 0.03, z, seed)
        yield turned(
            "glaze",
            [(0.03, 0.0), (0.055, 0.05), (0.025, 0.12), (0.035, 0.15)],
            (x + 0.27 * width, bottom, z + 0.03),
            12,
            2,
        )
    elif kind == 3:
        yield rounded("cane", (min(0.3, 0.8 * width), min(0.2, 0.7 * height), 0.22), (x, bottom, z + 0.01), 0.02, 1)
    elif kind == 4:
        for i in range(3):
            yield box(f"cover_{i + 2}", (0.2 - 0.01 * i, 0.03, 0.16), (x - 0.1 * width, bottom + 0.031 * i, z + 0.02))
        yield ball("brass", 0.04, (x - 0.1 * width, bottom + 0.131, z + 0.02), 10, 6)
    else:
        yield turned("terracotta", [(0.035, 0.0), (0.05, 0.07), (0.052, 0.09)], (x, bottom, z + 0.02), 12, 1)
        for i in range(7):
            yield leaf("leaf", 0.13, 0.035, (x, bottom + 0.08, z + 0.02), 0.9 * i, 1.1, 1.5, pieces=3)


def bookcase(
    width: float = 0.8, height: float = 2.0, depth: float = 0.3, shelves: int = 4, columns: int = 1, seed: int = 1
) -> Iterator[Solid]:
    """An open case full of books and things."""
    pitch = (height - 0.08) / (shelves + 1)
    yield box("wood", (width - 0.02, 0.06, depth - 0.04), (0.0, 0.0, -0.01))
    yield from case(
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
            yield from filled(
                width / columns - 0.05, 0.081 + row * pitch, pitch - 0.03, 0.0, seed * 31 + row * 7 + column, x
            )


def glazed(width: float = 1.0, height: float = 2.0, depth: float = 0.36) -> Iterator[Solid]:
    """Books behind glass above a closed base."""
    yield box("wood", (width, 0.62, depth - 0.02), (0.0, 0.06, -0.01))
    yield box("black", (width - 0.04, 0.06, depth - 0.06))
    yield from doors(
        "wood_1", width - 0.01, 0.58, (0.005 - width / 2, 0.08, depth / 2 - 0.02), 2, "raised", ("brass", "knob")
    )
    yield from case("wood", width, height - 0.7, depth - 0.06, (0.32, 0.64, 0.96), (0.0, 0.68, -0.03), (0.5,), "wood_1")
    for row in range(4):
        for s in (-1, 1):
            yield from book_row(
                s * width / 4 - width / 4 + 0.03, 0.70 + 0.32 * row, width / 2 - 0.06, 0.28, -0.03, 3 * row + s + 1
            )
    yield from doors("wood", width, height - 0.72, (-width / 2, 0.69, depth / 2 - 0.06), 2, "glass", ("brass", "knob"))
    yield rounded("wood", (width + 0.06, 0.05, depth + 0.02), (0.0, height - 0.02, 0.0), 0.015, 1)


def ladder(width: float = 0.7, height: float = 1.8) -> Iterator[Solid]:
    """Shelves that grow deeper towards the floor between leaning rails."""
    for s in (-1, 1):
        yield beam("wood", (s * width / 2, 0.0, 0.24), (s * width / 2, height, -0.17), 0.03, 0.045)
    for i in range(5):
        y = 0.15 + 0.37 * i
        deep = 0.42 - 0.065 * i
        z = 0.24 - 0.41 * y / height - deep / 2 + 0.05
        yield box("wood_1", (width - 0.03, 0.02, deep), (0.0, y, z))
        yield from filled(width - 0.08, y + 0.02, 0.3, z, 40 + i)


def cube_shelf(columns: int = 3, rows: int = 3) -> Iterator[Solid]:
    """A grid of square boxes, some with doors or baskets."""
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
                yield rounded("textile", (0.31, 0.29, 0.34), (x, y, 0.01), 0.02, 1)
                yield box("black", (0.08, 0.02, 0.006), (x, y + 0.2, 0.182))
            elif kind == 3:
                yield box("wood_1", (0.322, 0.324, 0.02), (x, y + 0.001, 0.18))
                yield disc("brass", 0.012, 0.02, (x + 0.12, y + 0.16, 0.19), 10)
            else:
                yield from filled(0.32, y, 0.3, 0.0, 5 * i + 11 * j, x)


def zigzag(width: float = 0.8, height: float = 1.7) -> Iterator[Solid]:
    """Boards joined by uprights that alternate from side to side."""
    for i in range(6):
        y = i * (height - 0.02) / 5
        yield box("wood", (width, 0.022, 0.28), (0.0, y, 0.0))
        if i < 5:
            s = 1 if i % 2 else -1
            yield box("wood_1", (0.022, (height - 0.02) / 5 - 0.02, 0.28), (s * width / 2 - s * 0.16, y + 0.022, 0.0))
            yield from filled(width - 0.4, y + 0.022, 0.28, 0.0, 70 + i, -s * 0.1)


def pipes(width: float = 1.0, height: float = 1.9) -> Iterator[Solid]:
    """Boards on iron pipes."""
    for x in (-width / 2 + 0.08, width / 2 - 0.08):
        for z in (-0.11, 0.11):
            yield rod("iron", (x, 0.0, z), (x, height, z), 0.014, sides=8)
            yield cylinder("iron", 0.035, 0.01, (x, 0.0, z), sides=12)
        yield rod("iron", (x, height - 0.014, -0.11), (x, height - 0.014, 0.11), 0.014)
    for i in range(5):
        y = 0.12 + 0.4 * i
        yield rounded("wood", (width, 0.03, 0.3), (0.0, y, 0.0), 0.006, 1)
        yield from filled(width - 0.24, y + 0.03, 0.34, 0.0, 90 + i)


def revolving(height: float = 1.3) -> Iterator[Solid]:
    """A square tower of books that turns on its foot."""
    yield foot_plate("wood", 0.26, 0.04)
    for i in range(5):
        yield rounded("wood", (0.46, 0.022, 0.46), (0.0, 0.06 + i * 0.3, 0.0), 0.006, 1)
    yield box("wood_1", (0.03, height - 0.08, 0.03), (0.0, 0.06, 0.0))
    for row in range(4):
        for turn in range(4):
            for book in book_row(-0.2, 0.082 + 0.3 * row, 0.28, 0.27, 0.12, 7 * row + turn, False):
                yield rotate(book, 1, turn * np.pi / 2)


def spine(height: float = 1.5) -> Iterator[Solid]:
    """A column with books lying on short blades."""
    yield rounded("iron", (0.3, 0.02, 0.3), (0.0, 0.0, 0.0), 0.008, 1)
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
    """A low shelf shaped like a house with boxes of toys."""
    for s in (-1, 1):
        yield box("wood", (0.025, 0.95, 0.3), (s * width / 2, 0.0, 0.0))
        yield prism("wood", [(s * width / 2, 0.95), (s * width / 2, 0.925), (0.0, 1.255), (0.0, 1.28)], 0.3)
    for y in (0.02, 0.34, 0.66, 0.94):
        yield box("wood", (width - 0.02, 0.022, 0.29), (0.0, y, 0.0))
    for i in range(3):
        yield rounded(f"bright_{i}", (0.28, 0.2, 0.26), ((i - 1) * 0.31, 0.042, 0.01), 0.03, 2)
    yield from book_row(-0.44, 0.362, 0.5, 0.27, 0.0, 21)
    yield ball("bright_1", 0.09, (0.28, 0.452, 0.02), 14, 8)
    for i in range(3):
        yield rounded(f"bright_{i}", (0.09, 0.09, 0.09), (-0.3 + 0.1 * i, 0.682, 0.02), 0.008, 1)
    yield rounded("bright_2", (0.09, 0.09, 0.09), (-0.25, 0.772, 0.02), 0.008, 1)


def wall_shelf(width: float = 0.8, count: int = 2, kind: str = "bracket") -> Iterator[Solid]:
    """Boards on brackets, ropes or in a box, with things on them; it hangs on a wall."""
    for i in range(count):
        y = 0.36 * i + 0.12
        yield rounded("wood", (width, 0.026, 0.22), (0.0, y, 0.0), 0.006, 1)
        yield from filled(width - 0.1, y + 0.026, 0.27, 0.0, 130 + 3 * i + count)
        for s in (-1, 1):
            x = s * (width / 2 - 0.12)
            if kind == "bracket":
                yield box("iron", (0.025, 0.12, 0.008), (x, y - 0.12, -0.106))
                yield beam("iron", (x, y - 0.1, -0.1), (x, y - 0.012, 0.07), 0.012)
            else:
                for z in (-0.09, 0.09):
                    yield rod("cream", (x, y - 0.01, z), (x, y + 0.36, 0.5 * z), 0.006, sides=6)


def wall_cubes(count: int = 3) -> Iterator[Solid]:
    """Open boxes on a wall, at different heights."""
    for i in range(count):
        x, y = (i - (count - 1) / 2) * 0.42, 0.14 * (i % 2)
        yield from case("wood", 0.34, 0.34, 0.22, (), (x, y, 0.0), (), "wood_1")
        yield from filled(0.28, y + 0.02, 0.29, 0.0, 200 + i, x)


def metal_rack(width: float = 0.9, height: float = 1.8, depth: float = 0.42) -> Iterator[Solid]:
    """Perforated posts and steel shelves with boxes and tins, for a store."""
    for x, z in corners(width - 0.03, depth - 0.03):
        yield box("steel", (0.03, height, 0.03), (x, 0.0, z))
    for i in range(5):
        y = 0.08 + i * (height - 0.12) / 4
        yield rounded("steel", (width - 0.01, 0.03, depth - 0.01), (0.0, y, 0.0), 0.005, 1)
        if i < 4:
            yield rounded("crust", (0.34, 0.26, 0.32), (-0.22 + 0.05 * (i % 2), y + 0.03, 0.0), 0.005, 1)
            yield cylinder(f"bright_{i % 3}", 0.08, 0.2, (0.14, y + 0.03, 0.04), sides=16)
            yield cylinder("white", 0.07, 0.16, (0.31, y + 0.03, -0.03), sides=16)


def wire_rack(width: float = 0.6, height: float = 1.3) -> Iterator[Solid]:
    """Chrome wire shelves."""
    for x, z in corners(width, 0.34):
        yield rod("chrome", (x, 0.0, z), (x, height, z), 0.012)
    for y in (0.12, 0.5, 0.88, 1.22):
        for z in (-0.17, 0.17):
            yield rod("chrome", (-width / 2, y, z), (width / 2, y, z), 0.006, sides=6)
        for i in range(13):
            x = (i - 6) * width / 12
            yield rod("chrome", (x, y, -0.17), (x, y, 0.17), 0.003, sides=5)
    for i in range(3):
        yield soft("towel", (0.42, 0.07, 0.26), (0.0, 0.507 + 0.065 * i, 0.0), 5.0, 4)
    yield rounded("cane", (0.4, 0.22, 0.28), (0.0, 0.127, 0.0), 0.03, 1)
    for i in range(3):
        yield cylinder(f"glaze_{i}", 0.03, 0.16, (-0.15 + 0.12 * i, 0.886, 0.0), sides=12)


def corner_etagere(height: float = 1.6) -> Iterator[Solid]:
    """Quarter-round shelves for a corner on turned posts."""
    arc = [(0.36 * np.cos(a) - 0.16, 0.36 * np.sin(a) - 0.16) for a in np.linspace(0, np.pi / 2, 10)]
    for i in range(5):
        y = 0.06 + i * (height - 0.1) / 4
        yield prism("wood", [(-0.16, -0.16), *arc], 0.02, (0.0, y, 0.0), "top")
        if i < 4:
            yield turned(
                "glaze", [(0.03, 0.0), (0.05, 0.05), (0.02, 0.11), (0.03, 0.14)], (-0.04, y + 0.02, -0.04), 12, 2
            )
    for x, z in ((-0.14, -0.14), (0.18, -0.14), (-0.14, 0.18)):
        yield turned(
            "wood",
            [(0.014, 0.0), (0.02, 0.3), (0.012, 0.6), (0.02, 1.0), (0.012, 1.3), (0.016, height)],
            (x, 0.0, z),
            10,
            2,
        )


def pegboard(width: float = 1.2) -> Iterator[Solid]:
    """A board with tools; it hangs on a wall."""
    yield rounded("wood", (width, 0.8, 0.02), (0.0, 0.0, -0.06), 0.006, 1)
    for i in range(4):
        x = -0.48 + 0.13 * i
        yield rod(f"bright_{i % 3}", (x, 0.52, -0.03), (x, 0.66, -0.03), 0.016)
        yield rod("chrome", (x, 0.36, -0.03), (x, 0.52, -0.03), 0.005)
    yield box("wood_1", (0.035, 0.3, 0.03), (0.12, 0.3, -0.034))
    yield rounded("iron", (0.13, 0.05, 0.04), (0.12, 0.6, -0.03), 0.01, 1)
    yield prism("gray", [(0.25, 0.42), (0.55, 0.5), (0.55, 0.58), (0.25, 0.6)], 0.006, (0.0, 0.0, -0.045))
    yield rounded("red", (0.1, 0.14, 0.03), (0.3, 0.45, -0.034), 0.02, 1)
    yield ring("orange", 0.12, 0.035, (-0.3, 0.18, -0.032), 2, 20)
    yield ring("iron", 0.05, 0.02, (0.05, 0.16, -0.036), 2, 16)
    yield rounded("wood_1", (0.5, 0.06, 0.14), (0.3, 0.04, 0.02), 0.01, 1)
    for i in range(4):
        yield cylinder("tint", 0.03, 0.08, (0.14 + 0.1 * i, 0.1, 0.02), sides=12)


def wine_rack(columns: int = 4, rows: int = 5) -> Iterator[Solid]:
    """A lattice with bottles."""
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


def clothes_rail() -> Iterator[Solid]:
    """A rail with clothes on hangers."""
    for s in (-1, 1):
        yield tube("iron", fillet([(s * 0.45, 0.03, -0.22), (s * 0.45, 0.03, 0.22)], 0.01), 0.014)
        yield rod("iron", (s * 0.45, 0.03, 0.0), (s * 0.45, 1.5, 0.0), 0.014)
        for z in (-0.2, 0.2):
            yield ball("rubber", 0.025, (s * 0.45, 0.025, z), 10, 6)
    yield rod("iron", (-0.5, 1.5, 0.0), (0.5, 1.5, 0.0), 0.014)
    for i in range(7):
        yield from garment(f"textile_{i % 5}", -0.33 + 0.11 * i, 1.5, 0.7 + 0.06 * (i % 4))


def coat_tree() -> Iterator[Solid]:
    """A post with bent hooks and a coat."""
    yield turned(
        "wood",
        [(0.2, 0.0), (0.19, 0.03), (0.04, 0.06), (0.025, 0.2), (0.022, 1.6), (0.03, 1.68), (0.005, 1.74)],
        sides=14,
    )
    hook = [
        tube("wood", fillet([(0.0, 1.52, 0.0), (0.0, 1.5, 0.12), (0.0, 1.62, 0.17)], 0.05), 0.01),
        ball("brass", 0.016, (0.0, 1.63, 0.17), 8, 4),
    ]
    yield from around(hook, 6)
    yield from around(
        [tube("wood", fillet([(0.0, 1.2, 0.0), (0.0, 1.18, 0.1), (0.0, 1.27, 0.14)], 0.04), 0.009)], 4, 0.4
    )
    yield _coat()


def coat_tripod() -> Iterator[Solid]:
    """Three crossed poles and a coat."""
    yield from around([rod("wood", (0.0, 0.0, 0.26), (0.1, 1.72, -0.12), 0.018, 0.013)], 3)
    yield from around(
        [
            rod("wood", (0.0, 1.3, 0.0), (0.02, 1.38, 0.14), 0.009),
            rod("wood", (0.0, 1.52, 0.0), (0.02, 1.58, 0.12), 0.009),
        ],
        3,
        1.0,
    )
    yield ring("brass", 0.08, 0.012, (0.0, 0.95, 0.0), 1, 16)
    yield _coat()


def _coat() -> Solid:
    coat = [
        (0.0, 0.0),
        (0.16, -0.1),
        (0.22, -0.5),
        (0.16, -0.52),
        (0.2, -0.95),
        (-0.2, -0.95),
        (-0.16, -0.52),
        (-0.22, -0.5),
        (-0.16, -0.1),
    ]
    return prism("textile", fillet([(x, 1.56 + y) for x, y in coat], 0.03, 2, True), 0.07, (0.0, 0.0, 0.16))


def hook_board(width: float = 0.8, shelf: bool = False) -> Iterator[Solid]:
    """A board with hooks that hangs on a wall, with a hat, a bag and a scarf."""
    yield rounded("wood", (width, 0.12, 0.02), (0.0, 0.62, -0.08), 0.006, 1)
    for i in range(5):
        x = (i - 2) * width / 5.5
        yield tube("iron", fillet([(x, 0.68, -0.07), (x, 0.65, -0.03), (x, 0.68, -0.005)], 0.02), 0.006, 6)
    if shelf:
        yield rounded("wood", (width, 0.022, 0.2), (0.0, 0.74, 0.0), 0.006, 1)
        yield rounded("cane", (0.28, 0.14, 0.18), (0.2, 0.762, 0.0), 0.02, 1)
    x = -width / 5.5
    yield prism(
        "textile",
        fillet([(x - 0.05, 0.66), (x + 0.05, 0.66), (x + 0.07, 0.1), (x - 0.07, 0.1)], 0.02, 2, True),
        0.04,
        (0.0, 0.0, -0.03),
    )
    yield rounded("leather", (0.28, 0.24, 0.09), (width / 5.5, 0.22, -0.02), 0.03, 2)
    yield tube(
        "leather",
        fillet([(width / 5.5 - 0.1, 0.44, -0.02), (width / 5.5, 0.68, -0.02), (width / 5.5 + 0.1, 0.44, -0.02)], 0.06),
        0.008,
        6,
    )


def _trolley(slot: str, board: str, wide: float, deep: float, levels: tuple[float, ...]) -> Iterator[Solid]:
    for x, z in corners(wide, deep):
        yield rod(slot, (x, 0.05, z), (x, levels[-1] + 0.08, z), 0.013)
        wheel = rotate(cylinder("rubber", 0.03, 0.02, (0.0, -0.01, 0.0), sides=12), 2, np.pi / 2)
        yield move(wheel, (x, 0.03, z))
    for y in levels:
        yield rounded(board, (wide, 0.015, deep), (0.0, y, 0.0), 0.004, 1)
        for s in (-1, 1):
            yield rod(slot, (-wide / 2, y + 0.06, s * deep / 2), (wide / 2, y + 0.06, s * deep / 2), 0.007, sides=6)
            yield rod(slot, (s * wide / 2, y + 0.06, -deep / 2), (s * wide / 2, y + 0.06, deep / 2), 0.007, sides=6)
    yield tube(
        slot,
        fillet(
            [
                (-wide / 2, levels[-1] + 0.07, -deep / 2),
                (-wide / 2 - 0.1, levels[-1] + 0.1, -deep / 2),
                (-wide / 2 - 0.1, levels[-1] + 0.1, deep / 2),
                (-wide / 2, levels[-1] + 0.07, deep / 2),
            ],
            0.04,
        ),
        0.01,
    )


def bar_trolley() -> Iterator[Solid]:
    """A serving trolley with bottles and glasses."""
    yield from _trolley("brass", "glass", 0.7, 0.42, (0.2, 0.72))
    top = 0.72 + 0.015
    for i in range(4):
        yield turned(
            ("green", "tint", "brown", "tint_1")[i],
            [(0.035, 0.0), (0.037, 0.16), (0.013, 0.21), (0.013, 0.28)],
            (-0.22 + 0.1 * i, top, -0.08),
            12,
            2,
        )
    for i in range(3):
        yield vessel(
            "glass",
            [(0.028, 0.0), (0.006, 0.008), (0.006, 0.07), (0.035, 0.1), (0.032, 0.16)],
            0.003,
            (-0.1 + 0.12 * i, top, 0.1),
            12,
            2,
        )


def tea_trolley() -> Iterator[Solid]:
    """A serving trolley with a pot and cups."""
    yield from _trolley("wood", "wood", 0.7, 0.42, (0.2, 0.72))
    top = 0.72 + 0.015
    for i in range(2):
        yield vessel(
            "crockery", [(0.022, 0.0), (0.04, 0.03), (0.042, 0.06)], 0.004, (0.08 + 0.16 * i, top, 0.06), 14, 2
        )
    yield turned(
        "crockery",
        [(0.05, 0.0), (0.085, 0.05), (0.06, 0.11), (0.02, 0.12), (0.012, 0.14)],
        (-0.15, top, 0.0),
        16,
        2,
    )


def basket_trolley() -> Iterator[Solid]:
    """A trolley of plastic baskets."""
    levels = (0.12, 0.42, 0.72)
    yield from _trolley("paint", "paint", 0.42, 0.34, levels)
    for k, y in enumerate(levels):
        yield rounded(f"bright_{k}", (0.3, 0.12, 0.24), (0.0, y + 0.016, 0.0), 0.03, 1)


def safe(height: float = 0.5) -> Iterator[Solid]:
    """A steel box with a thick door, a dial and a handle."""
    yield rounded("gray", (0.46, height - 0.03, 0.42), (0.0, 0.03, 0.0), 0.015, 2)
    for x, z in corners(0.36, 0.32):
        yield cylinder("black", 0.03, 0.035, (x, 0.0, z), sides=12)
    yield rounded("iron", (0.38, height - 0.12, 0.03), (0.0, 0.08, 0.205), 0.01, 1)
    yield disc("chrome", 0.05, 0.03, (-0.06, 0.58 * height, 0.215), 24)
    yield disc("black", 0.03, 0.03, (-0.06, 0.58 * height, 0.23), 20)
    for a in range(3):
        c, s = np.cos(2.1 * a), np.sin(2.1 * a)
        yield rod("chrome", (0.08, 0.56 * height, 0.25), (0.08 + 0.05 * c, 0.56 * height + 0.05 * s, 0.25), 0.006)
    yield disc("chrome", 0.02, 0.05, (0.08, 0.56 * height, 0.215), 14)
    for y in (0.14, height - 0.14):
        yield cylinder("chrome", 0.012, 0.07, (0.205, y, 0.22), sides=10)


BOOKSHELVES = (
    design(bookcase), design(glazed), design(ladder), design(cube_shelf), design(zigzag), design(pipes),
    design(revolving), design(spine), design(children),
    design(bookcase, width=1.5, columns=2, shelves=5, height=2.1, seed=4), design(cube_shelf, columns=2, rows=4),
)  # fmt: skip
SHELVING = (
    design(wall_shelf), design(metal_rack), design(wire_rack), design(corner_etagere), design(pegboard),
    design(wine_rack), design(wall_shelf, count=1, width=1.0), design(wall_shelf, count=2, kind="rope", width=0.7),
    design(zigzag, width=0.6, height=1.4), design(metal_rack, width=1.2, height=2.0, depth=0.5), design(wall_cubes),
)  # fmt: skip
HANGERS = (
    design(coat_tree),
    design(coat_tripod),
    design(clothes_rail),
    design(hook_board),
    design(hook_board, shelf=True, width=1.0),
)

FAMILIES = (
    Family("bookshelf", "bookshelf", BOOKSHELVES),
    Family("shelving", "shelving", SHELVING),
    Family("hanger", "hanger", HANGERS),
    Family("cart", "cart", (design(tea_trolley), design(bar_trolley), design(basket_trolley))),
    Family("safe", "safe", (design(safe), design(safe, height=0.8))),
)
