"""Books and magazines."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import book_row


def _book_line(kind: str, seed: int) -> Iterator[Solid]:
    yield from book_row(-0.2, 0.0, 0.42, 0.27, 0.0, seed)
    if kind == "ends":
        for s in (-1, 1):
            yield (
                prism("brass", [(0.0, 0.0), (0.09, 0.0), (0.0, 0.14)], 0.1, (0.22 * s, 0.0, 0.0))
                if s > 0
                else prism("brass", [(0.0, 0.0), (0.0, 0.14), (-0.09, 0.0)], 0.1, (-0.22, 0.0, 0.0))
            )


def _pile(seed: int) -> Iterator[Solid]:
    rng = np.random.default_rng(seed)
    y = 0.0
    for i in range(5):
        t, w, d = float(rng.uniform(0.02, 0.045)), float(rng.uniform(0.2, 0.27)), float(rng.uniform(0.15, 0.19))
        turn = float(rng.normal(0, 0.12))
        for piece in _book(w, t, d, f"cover_{i}"):
            yield rotate(move(piece, (0.0, y, 0.0)), 1, turn)
        y += t


def _single_book(seed: int) -> Iterator[Solid]:
    yield from _book(0.24, 0.035, 0.17, "cover")
    yield box("gold", (0.12, 0.001, 0.012), (0.0, 0.035, -0.03))


def _two_books(seed: int) -> Iterator[Solid]:
    yield from _book(0.26, 0.03, 0.19, "cover")
    yield from (rotate(move(p, (0.0, 0.03, 0.0)), 1, 0.35) for p in _book(0.18, 0.022, 0.12, "cover_1"))
    yield box("gold", (0.1, 0.001, 0.008), (0.0, 0.052, 0.0))


def _open_book(seed: int) -> Iterator[Solid]:
    for s in (-1, 1):
        page = [(s * t * 0.15, 0.006 + 0.022 * np.sin(np.pi * t) ** 0.7 + 0.004, 0.0) for t in np.linspace(0.02, 1, 9)]
        under = [(x, 0.003, z) for x, _, z in page]
        outline = [(x, y) for x, y, _ in page] + [(x, y) for x, y, _ in under[::-1]]
        yield prism("paper", outline, 0.21)
        yield rounded_box("cover", (0.155, 0.004, 0.22), (s * 0.0785, 0.0, 0.0), 0.001, 1)
        for i in range(6):
            yield box("gray", (0.1, 0.0008, 0.004), (s * 0.075, 0.0315, -0.07 + 0.026 * i))


_BOOKS_KINDS = {
    "row": partial(_book_line, "row"),
    "ends": partial(_book_line, "ends"),
    "pile": _pile,
    "single": _single_book,
    "open": _open_book,
    "two": _two_books,
}


def books(kind: str = "row", seed: int = 1) -> Iterator[Solid]:
    """Build books: a row, with bookends, a pile, one closed or one open."""
    yield from _BOOKS_KINDS[kind](seed)


def _book(width: float, thick: float, depth: float, slot: str) -> Iterator[Solid]:
    """Build a closed book lying flat, with its rounded spine towards +z."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 7)
    back = [(depth / 2 - 0.006 + 0.006 * np.cos(a), thick / 2 + thick / 2 * np.sin(a)) for a in turn]
    inner = [(z - 0.003, thick / 2 + (y - thick / 2) * (1 - 0.006 / thick)) for z, y in back[::-1]]
    cover = [(-depth / 2, 0.0), *back, (-depth / 2, thick), (-depth / 2, thick - 0.003), *inner, (-depth / 2, 0.003)]
    yield prism(slot, cover, width, (0.0, 0.0, 0.0), "side")
    pages = [
        (-depth / 2 + 0.006, 0.003),
        *[(z - 0.0005, y) for z, y in inner[::-1]],
        (-depth / 2 + 0.006, thick - 0.003),
    ]
    yield prism("paper", pages, width - 0.012, (0.0, 0.0, 0.0), "side")
    for k in (-0.3, 0.3):
        yield box(slot, (0.006, 0.6 * thick, 0.003), (k * width, 0.2 * thick, depth / 2 - 0.001))


def magazines(kind: str = "fan") -> Iterator[Solid]:
    """Build magazines in a fan, in a rack or in a pile."""
    if kind == "pile":
        for i in range(6):
            page = box(f"cover_{i % 4}", (0.21, 0.006, 0.28), (0.004 * (i % 3), 0.0062 * i, 0.003 * (i % 2)))
            yield rotate(page, 1, 0.05 * (i % 3) - 0.06)
        return
    if kind == "fan":
        for i in range(4):
            page = box(f"picture_{i}", (0.21, 0.005, 0.28), (0.0, 0.005 * i, 0.0))
            low, high = page.box[:, [0, 2]]
            page = Solid(
                page.vertices,
                page.faces,
                (page.vertices[page.faces][..., [0, 2]] - low) / (high - low) * (1, -1),
                page.material,
            )
            yield rotate(page, 1, 0.25 * i - 0.4, (0.0, 0.0, 0.1))
        return
    for s in (-1, 1):
        yield prism(
            "wood",
            fillet([(-0.15, 0.0), (0.15, 0.0), (0.2, 0.3), (-0.2, 0.3)], 0.03, 2, True),
            0.012,
            (s * 0.17, 0.0, 0.0),
            "side",
        )
    yield box("wood", (0.33, 0.012, 0.2), (0.0, 0.04, 0.0))
    for z, a in ((-0.12, -0.35), (0.0, 0.0), (0.12, 0.35)):
        yield rotate(box("wood_1", (0.33, 0.24, 0.01), (0.0, 0.05, z * 0.7)), 0, a, (0.0, 0.05, z * 0.7))
    for i in range(4):
        yield rotate(
            box(f"cover_{i}", (0.22, 0.29, 0.007), (0.02 * (i - 2), 0.055, -0.05 + 0.034 * i)),
            0,
            -0.15 + 0.1 * i,
            (0.0, 0.05, 0.0),
        )


FAMILIES = (
    FurnitureFamily(
        "books",
        "books",
        (
            *design_kinds(books, "row", "pile", "ends"),
            design(books, kind="row", seed=5),
            design(books, kind="pile", seed=6),
        ),
    ),
    FurnitureFamily("book", "book", design_kinds(books, "single", "open", "two")),
    FurnitureFamily("magazines", "magazines", design_kinds(magazines, "fan", "rack", "pile")),
)
