"""Vases, pictures, clocks, books, figures, and other ornaments."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, loop, spline
from home_mjx.datasets.homes.shapes.sheets import leaf
from home_mjx.datasets.homes.shapes.soft import ball, between_loops, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import book_row, disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, picture_uv, rotate

VASE_SHAPES = {
    "amphora": [(0.05, 0.0), (0.1, 0.12), (0.11, 0.2), (0.05, 0.3), (0.045, 0.34), (0.07, 0.37)],
    "bottle": [(0.07, 0.0), (0.085, 0.05), (0.08, 0.14), (0.025, 0.22), (0.022, 0.33), (0.03, 0.34)],
    "trumpet": [(0.05, 0.0), (0.02, 0.02), (0.03, 0.08), (0.05, 0.22), (0.11, 0.32)],
    "globe": [(0.04, 0.0), (0.11, 0.08), (0.1, 0.16), (0.045, 0.2), (0.05, 0.215)],
    "cylinder": [(0.06, 0.0), (0.06, 0.28)],
    "hourglass": [(0.08, 0.0), (0.085, 0.05), (0.04, 0.14), (0.075, 0.24), (0.085, 0.28)],
    "floor": [(0.12, 0.0), (0.15, 0.1), (0.18, 0.4), (0.1, 0.62), (0.08, 0.7), (0.11, 0.74)],
}


def vase(kind: str = "amphora", slot: str = "glaze", stems: int = 0) -> Iterator[Solid]:
    """A turned vase, with flowers, grasses or none."""
    shape = VASE_SHAPES[kind]
    yield vessel(slot, shape, 0.005, sides=24, steps=1 if kind == "cylinder" else 4)
    if slot in ("glass", "tint"):
        yield (
            cylinder("water", 0.85 * shape[1][0], 0.45 * shape[-1][1], (0.0, 0.008, 0.0), sides=20)
            if kind == "cylinder"
            else ball("water", (0.09, 0.05, 0.09), (0.0, 0.07, 0.0), 18, 10)
        )
    yield from flowers(stems, shape[-1][1], shape[-1][0])


def flowers(stems: int, top: float, mouth: float) -> Iterator[Solid]:
    """Stems with blossoms and leaves that rise from a vase's mouth."""
    for i in range(stems):
        a, r = 2.4 * i, 0.045 * np.sqrt(i) + 0.02
        tip = (r * np.cos(a) * 1.6, top + 0.26 - 0.35 * r, r * np.sin(a) * 1.6)
        foot = (0.4 * mouth * np.cos(a), 0.5 * top, 0.4 * mouth * np.sin(a))
        yield tube("leaf", [foot, (0.6 * mouth * np.cos(a), top, 0.6 * mouth * np.sin(a)), tip], 0.003, 4)
        yield leaf("leaf", 0.12, 0.03, (0.5 * tip[0], top + 0.07, 0.5 * tip[2]), a, 0.9, 1.0, pieces=3)
        for k in range(2):
            for p in range(6):
                yield leaf(
                    f"petal_{i % 3}",
                    0.045 - 0.012 * k,
                    0.028,
                    tip,
                    np.pi * (p / 3 + k / 6),
                    0.35 + 0.6 * k,
                    0.5,
                    1.2,
                    2,
                )
        yield ball("yellow", 0.01, (tip[0], tip[1] + 0.008, tip[2]), 8, 4)


def twigs(kind: str = "floor") -> Iterator[Solid]:
    """A tall vase with branches or pampas grass."""
    yield from vase(kind)
    top = VASE_SHAPES[kind][-1][1]
    for i in range(9):
        a = 2.4 * i
        tip = (0.22 * np.cos(a), top + 0.5 - 0.03 * (i % 4), 0.22 * np.sin(a))
        path = spline([(0.0, 0.4 * top, 0.0), (0.03 * np.cos(a), top, 0.03 * np.sin(a)), tip], 4)
        yield tube("bark", path, 0.004, 5)
        yield tube(
            "cream",
            np.array([path[-3], path[-2], tip, (1.25 * tip[0], tip[1] + 0.05, 1.25 * tip[2])]),
            [0.012, 0.03, 0.022, 0.003],
            7,
        )


def ribbed(square: bool = False) -> Iterator[Solid]:
    """A vase with flutes, or a twisted square one."""
    if square:
        base = loop(0.16, 0.16, 16, 5.0)
        loops = []
        for k, y in enumerate(np.linspace(0, 0.3, 13)):
            t = 0.12 * k
            turn = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]])
            loops.append(np.insert(base @ turn.T * (0.8 + 0.3 * np.sin(2.4 * y / 0.3)), 1, y, axis=1))
        inner = [np.stack([0.8 * p[:, 0], np.maximum(p[:, 1], 0.01), 0.8 * p[:, 2]], -1) for p in loops[::-3]]
        yield between_loops("glaze", [*loops, *inner])
        return
    angle = 2 * np.pi * np.arange(36) / 36
    flute = 1 + 0.07 * (np.arange(36) % 2)
    profile = spline([(0.06, 0.0), (0.09, 0.08), (0.08, 0.2), (0.05, 0.26), (0.07, 0.3)], 3)
    loops = [np.stack([r * flute * np.cos(angle), np.full(36, y), r * flute * np.sin(angle)], -1) for r, y in profile]
    inner = [np.stack([0.85 * p[:, 0], np.maximum(p[:, 1], 0.012), 0.85 * p[:, 2]], -1) for p in loops[::-2]]
    yield between_loops("glaze", [*loops, *inner])


def twin_handles() -> Iterator[Solid]:
    """An urn with two handles on a foot."""
    yield vessel(
        "terracotta",
        [(0.07, 0.0), (0.03, 0.04), (0.1, 0.16), (0.11, 0.24), (0.05, 0.32), (0.06, 0.36)],
        0.006,
        sides=24,
        steps=3,
    )
    for s in (-1, 1):
        yield tube(
            "terracotta",
            spline([(s * 0.105, 0.23, 0.0), (s * 0.17, 0.3, 0.0), (s * 0.11, 0.36, 0.0), (s * 0.05, 0.33, 0.0)], 4),
            0.011,
            8,
        )


def picture(
    width: float = 0.6, height: float = 0.45, rim: float = 0.03, mount: float = 0.0, slot: str = "wood"
) -> Iterator[Solid]:
    """A picture in a frame, with a pale mount or none, flat or carved."""
    inner = rim + mount
    if mount:
        yield box("paper", (width - rim, height - rim, 0.01), (0.0, rim / 2, -0.008))
    yield picture_uv(
        box("picture", (width - 2 * inner + 0.002, height - 2 * inner + 0.002, 0.006), (0.0, inner - 0.001, 0.0))
    )
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    path = [(x * (width - rim) / 2, height / 2 + y * (height - rim) / 2, 0.0) for x, y in corners]
    for a, b in zip(path, path[1:] + path[:1], strict=True):
        grow = np.sign(np.subtract(b, a)) * rim / 2
        yield (
            beam(slot, tuple(np.subtract(a, grow).tolist()), tuple(np.add(b, grow).tolist()), 0.026, rim)
            if a[1] == b[1]
            else beam(slot, tuple(np.add(a, grow).tolist()), tuple(np.subtract(b, grow).tolist()), rim, 0.026)
        )


def gallery(count: int = 3) -> Iterator[Solid]:
    """Several pictures in a group."""
    places = {
        3: ((-0.5, 0.0, 0.44, 0.6), (0.0, 0.0, 0.44, 0.6), (0.5, 0.0, 0.44, 0.6)),
        5: (
            (-0.36, 0.3, 0.5, 0.38),
            (0.2, 0.34, 0.44, 0.34),
            (-0.44, 0.0, 0.3, 0.26),
            (-0.02, 0.0, 0.4, 0.28),
            (0.44, 0.0, 0.34, 0.3),
        ),
    }
    for i, (x, y, w, h) in enumerate(places[count]):
        for piece in picture(w, h, 0.022, 0.04 if count == 3 else 0.03 * (i % 2), "black" if count == 3 else "wood"):
            material = f"picture_{i}" if piece.material == "picture" else piece.material
            yield replace(move(piece, (x, y, 0.0)), material=material)


def canvas(width: float = 0.9, height: float = 0.6) -> Iterator[Solid]:
    """A canvas without a frame."""
    yield rounded("paper", (width, height, 0.03), (0.0, 0.0, -0.004), 0.006, 2)
    yield picture_uv(box("picture", (width - 0.006, height - 0.006, 0.006), (0.0, 0.003, 0.01)))
    for s in (-1, 1):
        yield rod("chrome", (s * 0.3, height - 0.02, -0.02), (0.0, height + 0.04, -0.016), 0.0015, sides=4)
    yield ball("chrome", 0.006, (0.0, height + 0.042, -0.014), 8, 4)


def scroll(width: float = 0.45, height: float = 1.1) -> Iterator[Solid]:
    """A painting on cloth between two rods."""
    yield box("cream", (width, height, 0.004), (0.0, 0.0, -0.004))
    yield picture_uv(box("picture", (width - 0.1, 0.62 * height, 0.004), (0.0, 0.2 * height, 0.0)))
    for y in (0.0, height):
        yield rod("wood", (-width / 2 - 0.03, y, 0.0), (width / 2 + 0.03, y, 0.0), 0.014)
    for s in (-1, 1):
        yield rod("leather", (s * width / 3, height + 0.01, -0.004), (0.0, height + 0.12, -0.008), 0.002, sides=4)


def triptych(width: float = 1.3, height: float = 0.8) -> Iterator[Solid]:
    """One picture over three canvases."""
    for i in range(3):
        third = width / 3
        for piece in canvas(third - 0.03, height):
            if piece.material in ("picture", "paper"):
                uv = piece.uv * (1 / 3, 1.0) + np.array([i / 3, 0.0])
                yield replace(move(piece, ((i - 1) * third, 0.0, 0.0)), uv=uv)


def poster(width: float = 0.5, height: float = 0.7) -> Iterator[Solid]:
    """A sheet that hangs between two pairs of laths."""
    yield picture_uv(box("picture", (width, height, 0.003)))
    for y in (0.0, height):
        for z in (-0.008, 0.008):
            yield rounded("wood", (width + 0.02, 0.024, 0.01), (0.0, y - 0.012, z), 0.003, 1)
    for s in (-1, 1):
        yield rod("black", (s * width / 2.2, height + 0.01, 0.0), (0.0, height + 0.14, -0.006), 0.0015, sides=4)


def oval_picture(width: float = 0.4, height: float = 0.5) -> Iterator[Solid]:
    """An oval portrait in a gilded frame."""
    flat = prism("picture", loop(width, height, 32), 0.01, (0.0, height / 2, 0.0))
    yield picture_uv(flat)
    for r, t, slot in ((1.0, 0.02, "gold"), (1.1, 0.012, "gold")):
        yield tube(
            slot,
            np.insert(loop(width * r, height * r, 36) + np.array([0.0, height / 2]), 2, 0.004, axis=1),
            t,
            8,
            closed=True,
        )


def easel(width: float = 0.18, height: float = 0.24) -> Iterator[Solid]:
    """A small frame that stands on a table."""
    frame = list(picture(width, height, 0.02, 0.015))
    yield from (rotate(p, 0, -0.2) for p in frame)
    yield beam("wood", (0.0, 0.15, -0.06), (0.0, 0.0, -0.13), 0.04, 0.006)


def _face(radius: float, y: float, z: float, numbers: int = 12) -> Iterator[Solid]:
    yield disc("face", radius, 0.008, (0.0, y, z), 30)
    for i in range(numbers):
        a = 2 * np.pi * i / numbers
        r = 0.84 * radius
        yield move(
            rotate(box("black", (0.05 * radius, 0.16 * radius, 0.004), (0.0, r - 0.08 * radius, 0.0)), 2, -a),
            (0.0, y, z + 0.009),
        )
    for turn, long in ((-0.9, 0.5), (0.9, 0.72)):
        yield move(
            rotate(box("black", (0.06 * radius, long * radius, 0.004), (0.0, 0.0, 0.0)), 2, turn),
            (0.0, y, z + 0.013),
        )
    yield disc("brass", 0.07 * radius, 0.012, (0.0, y, z + 0.008), 12)


def _rim_clock(kind: str) -> Iterator[Solid]:
    yield from _face(0.14, 0.16, -0.01)
    yield ring("brass" if kind == "sun" else "black", 0.15, 0.024, (0.0, 0.16, -0.004), 2, 36)
    if kind == "sun":
        for i in range(16):
            a = 2 * np.pi * i / 16
            yield rod(
                "brass",
                (0.16 * np.cos(a), 0.16 + 0.16 * np.sin(a), -0.005),
                ((0.24 + 0.06 * (i % 2)) * np.cos(a), 0.16 + (0.24 + 0.06 * (i % 2)) * np.sin(a), -0.005),
                0.007,
                0.003,
                6,
            )


def _square_clock() -> Iterator[Solid]:
    yield rounded("wood", (0.3, 0.3, 0.035), (0.0, 0.0, -0.02), 0.03, 3)
    yield from _face(0.12, 0.15, -0.004, 4)


def _pendulum_clock(kind: str) -> Iterator[Solid]:
    base = 1.45 if kind == "tall" else 0.42
    if kind == "tall":
        yield rounded("wood", (0.42, 0.3, 0.28), (0.0, 0.0, 0.0), 0.015, 2)
        yield rounded("wood", (0.28, 0.95, 0.2), (0.0, 0.28, -0.01), 0.01, 1)
        yield rounded("wood", (0.4, 0.5, 0.26), (0.0, 1.2, 0.0), 0.012, 1)
        yield prism("wood", fillet([(-0.22, 0.0), (0.22, 0.0), (0.0, 0.2)], 0.12, 5, True), 0.26, (0.0, 1.7, 0.0))
    else:
        yield rounded("wood", (0.26, 0.62, 0.12), (0.0, 0.0, -0.02), 0.012, 1)
        yield prism("wood", fillet([(-0.16, 0.0), (0.16, 0.0), (0.0, 0.12)], 0.08, 4, True), 0.12, (0.0, 0.62, -0.02))
    z = 0.131 if kind == "tall" else 0.041
    yield from _face(0.15 if kind == "tall" else 0.1, base, z)
    low = 0.45 if kind == "tall" else 0.1
    zz = 0.1 if kind == "tall" else 0.046
    yield box("black", (0.2 if kind == "tall" else 0.16, base - low - 0.22, 0.006), (0.0, low - 0.03, zz - 0.006))
    yield rod("brass", (0.0, low + 0.06, zz), (0.0, base - 0.24, zz), 0.004, sides=6)
    yield disc("brass", 0.05 if kind == "tall" else 0.035, 0.01, (0.0, low + 0.05, zz), 20)


def _alarm() -> Iterator[Solid]:
    yield disc("bright", 0.065, 0.05, (0.0, 0.085, -0.03), 28)
    yield from _face(0.055, 0.085, 0.02)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.035, 0.03, -0.005), (s * 0.05, 0.0, 0.0), 0.006)
        yield ball("brass", (0.03, 0.022, 0.03), (s * 0.038, 0.15, -0.005), 12, 6)
    yield tube("chrome", fillet([(-0.03, 0.155, -0.005), (0.0, 0.19, -0.005), (0.03, 0.155, -0.005)], 0.03), 0.004, 6)


def _mantel() -> Iterator[Solid]:
    shape = fillet(
        [(-0.2, 0.0), (0.2, 0.0), (0.19, 0.06), (0.1, 0.1), (0.0, 0.28), (-0.1, 0.1), (-0.19, 0.06)], 0.07, 4, True
    )
    yield prism("wood", shape, 0.11)
    yield rounded("wood", (0.44, 0.03, 0.14), (0.0, 0.0, 0.0), 0.008, 1)
    yield from _face(0.075, 0.13, 0.056)


def _digital() -> Iterator[Solid]:
    yield rounded("black", (0.2, 0.08, 0.06), (0.0, 0.0, 0.0), 0.012, 2)
    yield box("screen", (0.17, 0.055, 0.004), (0.0, 0.012, 0.03))
    for k, x in enumerate((-0.06, -0.025, 0.02, 0.055)):
        for dy, w, h in ((0.0, 0.02, 0.004), (0.018, 0.02, 0.004), (0.036, 0.02, 0.004)):
            yield box("red", (w, h, 0.002), (x, 0.02 + dy, 0.032))
        for s in (-1, 1):
            if (k + s) % 3:
                yield box("red", (0.004, 0.04, 0.002), (x + s * 0.009, 0.02, 0.032))


def _cuckoo() -> Iterator[Solid]:
    yield rounded("wood", (0.22, 0.22, 0.12), (0.0, 0.06, -0.02), 0.008, 1)
    for s in (-1, 1):
        yield prism("wood_1", [(0.0, 0.42), (s * 0.18, 0.26), (s * 0.18, 0.24), (0.0, 0.395)], 0.16)
        yield rod("brass", (s * 0.04, -0.22, 0.02), (s * 0.04, 0.06, 0.02), 0.002, sides=4)
        yield turned("bark", [(0.012, -0.3), (0.02, -0.26), (0.01, -0.21)], (s * 0.04, 0.0, 0.02), 10, 2)
    yield prism("wood", [(-0.11, 0.28), (0.11, 0.28), (0.0, 0.38)], 0.11, (0.0, 0.0, -0.02))
    yield from _face(0.07, 0.16, 0.041)
    yield box("black", (0.04, 0.05, 0.006), (0.0, 0.285, 0.036))
    yield ball("yellow", 0.016, (0.0, 0.31, 0.055), 10, 6)
    yield disc("brass", 0.025, 0.008, (0.0, -0.02, 0.02), 16)
    yield rod("brass", (0.0, -0.02, 0.022), (0.0, 0.07, 0.022), 0.003, sides=5)


_CLOCK_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "round": partial(_rim_clock, "round"),
    "sun": partial(_rim_clock, "sun"),
    "square": _square_clock,
    "pendulum": partial(_pendulum_clock, "pendulum"),
    "tall": partial(_pendulum_clock, "tall"),
    "alarm": _alarm,
    "mantel": _mantel,
    "digital": _digital,
    "cuckoo": _cuckoo,
}


def clock(kind: str = "round") -> Iterator[Solid]:
    """On a wall: round, sun, pendulum, square, cuckoo; on a table: alarm, mantel, digital; on the floor: tall."""
    yield from _CLOCK_KINDS[kind]()


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


def _open_book(seed: int) -> Iterator[Solid]:
    for s in (-1, 1):
        page = [(s * t * 0.15, 0.006 + 0.022 * np.sin(np.pi * t) ** 0.7 + 0.004, 0.0) for t in np.linspace(0.02, 1, 9)]
        under = [(x, 0.003, z) for x, _, z in page]
        outline = [(x, y) for x, y, _ in page] + [(x, y) for x, y, _ in under[::-1]]
        yield prism("paper", outline, 0.21)
        yield rounded("cover", (0.155, 0.004, 0.22), (s * 0.0785, 0.0, 0.0), 0.001, 1)
        for i in range(6):
            yield box("gray", (0.1, 0.0008, 0.004), (s * 0.075, 0.0315, -0.07 + 0.026 * i))


_BOOKS_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "row": partial(_book_line, "row"),
    "ends": partial(_book_line, "ends"),
    "pile": _pile,
    "single": _single_book,
    "open": _open_book,
}


def books(kind: str = "row", seed: int = 1) -> Iterator[Solid]:
    """Books in a row, in a pile, leaning, between supports, a single one closed or open."""
    yield from _BOOKS_KINDS[kind](seed)


def _book(width: float, thick: float, depth: float, slot: str) -> Iterator[Solid]:
    yield box(slot, (width, 0.003, depth), (0.0, 0.0, 0.0))
    yield box(slot, (width, 0.003, depth), (0.0, thick - 0.003, 0.0))
    yield box(slot, (width, thick - 0.006, 0.004), (0.0, 0.003, depth / 2 - 0.002))
    yield box("paper", (width - 0.012, thick - 0.006, depth - 0.012), (0.0, 0.003, -0.002))


def magazines(kind: str = "fan") -> Iterator[Solid]:
    """Magazines in a fan or in a rack."""
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


def _cat() -> Iterator[Solid]:
    yield turned("glaze", [(0.06, 0.0), (0.07, 0.05), (0.045, 0.14), (0.03, 0.17)], sides=18, steps=3)
    yield ball("glaze", (0.045, 0.04, 0.045), (0.0, 0.2, 0.01), 16, 10)
    for s in (-1, 1):
        yield turned("glaze", [(0.016, 0.0), (0.002, 0.035)], (s * 0.024, 0.225, 0.005), 8, 1)
        yield ball("black", 0.006, (s * 0.016, 0.205, 0.05), 8, 4)
        yield ball("glaze", (0.016, 0.012, 0.026), (s * 0.025, 0.012, 0.06), 10, 6)
    yield tube("glaze", spline([(0.05, 0.02, -0.03), (0.09, 0.03, 0.01), (0.06, 0.03, 0.07)], 4), 0.012, 8)


def _bust() -> Iterator[Solid]:
    yield turned("marble", [(0.07, 0.0), (0.07, 0.02), (0.03, 0.04), (0.03, 0.07)], sides=20, steps=1)
    yield soft("white", (0.22, 0.1, 0.12), (0.0, 0.07, 0.0), 3.0, 6)
    yield tube("white", [(0.0, 0.14, 0.0), (0.0, 0.22, 0.005)], 0.034, 12)
    yield ball("white", (0.05, 0.068, 0.058), (0.0, 0.27, 0.01), 18, 12)
    yield ball("white", (0.054, 0.045, 0.062), (0.0, 0.305, -0.006), 18, 10)
    yield prism("white", [(0.058, 0.285), (0.058, 0.25), (0.082, 0.255)], 0.018, (0.0, 0.0, 0.0), "side")


def _beast(kind: str) -> Iterator[Solid]:
    slot, big = ("wood", 1.0) if kind == "horse" else ("gray", 1.2)
    yield ball(slot, (0.04 * big, 0.045 * big, 0.09), (0.0, 0.15, 0.0), 16, 10)
    for x in (-0.022, 0.022):
        for z in (-0.055, 0.055):
            yield rod(slot, (x, 0.0, z), (x, 0.14, z), 0.011 * big, 0.017 * big)
    if kind == "horse":
        yield tube(slot, [(0.0, 0.16, 0.07), (0.0, 0.24, 0.11), (0.0, 0.25, 0.13)], [0.032, 0.022, 0.02], 10)
        yield tube(slot, [(0.0, 0.26, 0.11), (0.0, 0.23, 0.18)], [0.022, 0.013], 10)
        yield tube("black", [(0.0, 0.18, -0.085), (0.0, 0.13, -0.12), (0.0, 0.06, -0.12)], [0.008, 0.014, 0.004], 8)
        yield prism("black", [(0.06, 0.2), (0.1, 0.28), (0.08, 0.28), (0.035, 0.2)], 0.01, (0.0, 0.0, 0.0), "side")
    else:
        yield ball(slot, (0.042, 0.045, 0.042), (0.0, 0.2, 0.1), 16, 10)
        yield tube(
            slot,
            spline([(0.0, 0.19, 0.13), (0.0, 0.12, 0.17), (0.0, 0.06, 0.16), (0.0, 0.05, 0.19)], 3),
            np.linspace(0.018, 0.008, 10),
            8,
        )
        for s in (-1, 1):
            yield ball(slot, (0.012, 0.05, 0.038), (s * 0.05, 0.2, 0.09), 12, 8)
            yield tube("cream", [(s * 0.02, 0.16, 0.13), (s * 0.026, 0.14, 0.18)], [0.006, 0.002], 6)


def _obelisk() -> Iterator[Solid]:
    yield rounded("marble", (0.1, 0.04, 0.1), (0.0, 0.0, 0.0), 0.006, 1)
    yield turned("marble", [(0.05, 0.04), (0.032, 0.3), (0.002, 0.34)], sides=4, steps=1)
    yield rounded("brass", (0.08, 0.012, 0.08), (0.0, 0.035, 0.0), 0.004, 1)
    yield turned("brass", [(0.051, 0.05), (0.0495, 0.07)], sides=4, steps=1)
    yield ball("brass", 0.012, (0.0, 0.348, 0.0), 12, 8)


def _seated() -> Iterator[Solid]:
    yield rounded("wood", (0.2, 0.03, 0.14), (0.0, 0.0, 0.0), 0.008, 1)
    yield ball("gold", (0.09, 0.03, 0.055), (0.0, 0.055, 0.01), 18, 8)
    yield turned("gold", [(0.06, 0.05), (0.055, 0.1), (0.06, 0.14), (0.03, 0.17)], (0.0, 0.0, -0.01), 18, 3)
    yield ball("gold", (0.034, 0.042, 0.036), (0.0, 0.21, -0.005), 16, 10)
    yield ball("gold", 0.016, (0.0, 0.255, -0.008), 10, 6)
    for s in (-1, 1):
        yield tube(
            "gold", spline([(s * 0.055, 0.15, -0.01), (s * 0.08, 0.1, 0.01), (s * 0.02, 0.085, 0.06)], 3), 0.014, 8
        )


def _rings() -> Iterator[Solid]:
    yield rounded("black", (0.16, 0.025, 0.08), (0.0, 0.0, 0.0), 0.005, 1)
    yield ring("brass", 0.12, 0.034, (0.0, 0.16, 0.0), 2, 30)
    yield ring("brass", 0.07, 0.026, (0.0, 0.17, 0.0), 0, 26)


def _bird() -> Iterator[Solid]:
    yield foot(0.05)
    yield rod("brass", (0.0, 0.01, 0.0), (0.0, 0.12, 0.0), 0.004, sides=6)
    yield tube(
        "glaze",
        spline([(0.0, 0.16, -0.13), (0.0, 0.14, -0.06), (0.0, 0.15, 0.02), (0.0, 0.19, 0.06)], 4),
        [0.004, 0.008, 0.014, 0.022, 0.03, 0.036, 0.04, 0.04, 0.037, 0.034, 0.032, 0.03, 0.026],
        12,
    )
    yield ball("glaze", 0.028, (0.0, 0.205, 0.07), 14, 8)
    yield tube("yellow", [(0.0, 0.205, 0.095), (0.0, 0.2, 0.12)], [0.007, 0.001], 8)
    for s in (-1, 1):
        yield leaf("glaze", 0.13, 0.05, (s * 0.034, 0.17, 0.03), np.pi + 0.15 * s, 0.05, -0.2, pieces=4)
        yield ball("black", 0.004, (s * 0.022, 0.212, 0.085), 8, 4)


def _dancers() -> Iterator[Solid]:
    yield foot(0.08)
    for s in (-1, 1):
        yield tube(
            "iron",
            spline([(s * 0.03, 0.01, 0.0), (s * 0.05, 0.14, 0.0), (s * 0.02, 0.24, 0.0), (s * 0.05, 0.32, 0.0)], 4),
            np.concatenate([np.linspace(0.008, 0.022, 9), np.linspace(0.024, 0.01, 4)]),
            8,
        )
        yield ball("iron", 0.022, (s * 0.055, 0.35, 0.0), 12, 8)
        yield tube("iron", spline([(s * 0.04, 0.29, 0.0), (s * 0.0, 0.36, 0.04), (s * -0.04, 0.42, 0.02)], 4), 0.007, 6)


def _globe() -> Iterator[Solid]:
    yield turned("wood", [(0.09, 0.0), (0.08, 0.02), (0.02, 0.04), (0.015, 0.09)], sides=20, steps=2)
    yield ball("blue", 0.11, (0.0, 0.22, 0.0), 26, 16)
    for i in range(7):
        a, t = 2.4 * i, 0.6 * np.sin(1.7 * i)
        spot = [0.112 * np.cos(t) * np.cos(a), 0.22 + 0.112 * np.sin(t), 0.112 * np.cos(t) * np.sin(a)]
        yield ball(
            "green", (0.03, 0.024, 0.03), (0.82 * spot[0], 0.22 + 0.82 * (spot[1] - 0.22), 0.82 * spot[2]), 10, 6
        )
    yield tube(
        "brass",
        [(0.128 * np.sin(a), 0.22 + 0.128 * np.cos(a), 0.0) for a in np.linspace(0.2, np.pi + 0.2, 14)],
        0.006,
        6,
    )


def _ship() -> Iterator[Solid]:
    yield rounded("wood", (0.3, 0.02, 0.1), (0.0, 0.0, 0.0), 0.005, 1)
    hull = [(-0.15, 0.07), (0.16, 0.07), (0.12, 0.03), (-0.11, 0.03)]
    yield prism("wood", hull, 0.05)
    for x, h in ((-0.06, 0.24), (0.05, 0.28)):
        yield rod("wood", (x, 0.06, 0.0), (x, h, 0.0), 0.004, sides=6)
        yield prism("cream", fillet([(x - 0.005, 0.09), (x + 0.075, 0.1), (x, h - 0.01)], 0.02, 3, True), 0.004)
    yield prism("cream", [(0.06, 0.1), (0.14, 0.085), (0.06, 0.24)], 0.003)


_FIGURE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "cat": _cat,
    "bust": _bust,
    "horse": partial(_beast, "horse"),
    "elephant": partial(_beast, "elephant"),
    "obelisk": _obelisk,
    "seated": _seated,
    "ring": _rings,
    "bird": _bird,
    "dancers": _dancers,
    "globe": _globe,
    "ship": _ship,
}


def figure(kind: str = "cat") -> Iterator[Solid]:
    """Ornaments: a cat, a bust, a horse, an elephant, an obelisk, a seated figure, a ring, a bird, dancers, a globe."""
    yield from _FIGURE_KINDS[kind]()


def foot(radius: float) -> Solid:
    """A round plate that an ornament stands on."""
    return turned("black", [(radius, 0.0), (radius, 0.012), (0.8 * radius, 0.018)], sides=20, steps=1)


def _bowl() -> Iterator[Solid]:
    yield vessel("wood", [(0.06, 0.0), (0.13, 0.03), (0.16, 0.07)], 0.007, sides=26, steps=2)
    for i in range(6):
        a = 2 * np.pi * i / 5
        r = 0.075 if i < 5 else 0.0
        yield ball(
            ("cane", "bark", "cream")[i % 3], 0.042, (r * np.cos(a), 0.075 + 0.03 * (i == 5), r * np.sin(a)), 14, 8
        )


def _wreath() -> Iterator[Solid]:
    yield ring("bark", 0.15, 0.04, (0.0, 0.2, 0.0), 2, 24)
    for i in range(54):
        a = 2 * np.pi * i / 54
        at = ((0.15 + 0.015 * np.sin(5 * i)) * np.cos(a), 0.2 + (0.15 + 0.015 * np.sin(5 * i)) * np.sin(a), 0.012)
        blade = leaf("leaf", 0.08, 0.03, (0.0, 0.0, 0.0), 0.0, 0.5, 0.4, pieces=2)
        yield move(rotate(rotate(blade, 1, np.pi / 2 * (-1) ** i), 2, a + 0.5), at)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield ball("red", 0.012, (0.15 * np.cos(a), 0.2 + 0.15 * np.sin(a), 0.03), 8, 6)


def _casket() -> Iterator[Solid]:
    yield rounded("wood", (0.22, 0.08, 0.14), (0.0, 0.0, 0.0), 0.006, 1)
    yield rounded("wood", (0.23, 0.035, 0.15), (0.0, 0.08, 0.0), 0.012, 2)
    yield rounded("brass", (0.03, 0.04, 0.008), (0.0, 0.065, 0.073), 0.003, 1)
    for x in (-0.105, 0.105):
        for z in (-0.065, 0.065):
            yield rounded("brass", (0.025, 0.025, 0.025), (x, 0.0, z), 0.004, 1)


def _jar() -> Iterator[Solid]:
    yield vessel(
        "glass", [(0.07, 0.0), (0.085, 0.03), (0.085, 0.15), (0.06, 0.19), (0.065, 0.2)], 0.003, sides=22, steps=2
    )
    for i in range(16):
        a = 2.4 * i
        r = 0.045 * ((i % 4) / 3)
        yield ball(
            ("cream", "terracotta", "white")[i % 3],
            (0.022, 0.015, 0.018),
            (r * np.cos(a), 0.02 + 0.006 * i, r * np.sin(a)),
            8,
            6,
        )
    yield turned("wood", [(0.062, 0.2), (0.062, 0.215), (0.05, 0.225)], sides=20, steps=1)


def _trophy() -> Iterator[Solid]:
    yield rounded("black", (0.1, 0.06, 0.1), (0.0, 0.0, 0.0), 0.006, 1)
    yield vessel(
        "gold", [(0.04, 0.06), (0.012, 0.08), (0.012, 0.13), (0.06, 0.19), (0.065, 0.27)], 0.004, sides=20, steps=3
    )
    for s in (-1, 1):
        yield tube(
            "gold",
            fillet([(s * 0.06, 0.25, 0.0), (s * 0.11, 0.25, 0.0), (s * 0.09, 0.18, 0.0), (s * 0.045, 0.17, 0.0)], 0.03),
            0.006,
            6,
        )
    yield box("gold", (0.06, 0.03, 0.004), (0.0, 0.015, 0.05))


def _plates() -> Iterator[Solid]:
    for i, (x, y, r) in enumerate(
        ((0.0, 0.32, 0.15), (-0.27, 0.18, 0.11), (0.26, 0.2, 0.12), (-0.1, 0.05, 0.09), (0.14, 0.02, 0.08))
    ):
        plate = vessel(f"crockery_{i}", [(0.5 * r, 0.0), (0.6 * r, 0.004), (r, 0.02)], 0.004, sides=24, steps=1)
        yield move(rotate(plate, 0, np.pi / 2), (x, y + 0.1, -0.01))
        yield disc(f"glaze_{i}", 0.4 * r, 0.006, (x, y + 0.1, -0.006), 18)


_ORNAMENT_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "bowl": _bowl,
    "wreath": _wreath,
    "box": _casket,
    "jar": _jar,
    "trophy": _trophy,
    "plates": _plates,
}


def ornament(kind: str = "bowl") -> Iterator[Solid]:
    """A bowl of balls, a lantern, a wreath, a box, shells in a jar, a trophy, letters, a wall plate set."""
    yield from _ORNAMENT_KINDS[kind]()


def _flame(x: float, y: float, z: float) -> Iterator[Solid]:
    yield rod("black", (x, y, z), (x, y + 0.012, z), 0.0015, sides=4)
    yield turned("bulb", [(0.003, y + 0.01), (0.007, y + 0.02), (0.001, y + 0.04)], (x, 0.0, z), 8, 2)


def _pillar() -> Iterator[Solid]:
    yield vessel("wood", [(0.15, 0.0), (0.155, 0.02)], 0.006, sides=26, steps=1)
    for x, z, h in ((-0.06, 0.02, 0.2), (0.05, 0.045, 0.13), (0.03, -0.055, 0.09)):
        yield turned("wax", [(0.036, 0.006), (0.036, h), (0.03, h + 0.003)], (x, 0.0, z), 18, 1)
        yield from _flame(x, h, z)


def _sticks(kind: str) -> Iterator[Solid]:
    for i, x in enumerate((0.0,) if kind == "stick" else (-0.1, 0.0, 0.1)):
        h = 0.22 + 0.08 * (i % 2)
        yield turned(
            "brass",
            [(0.05, 0.0), (0.012, 0.03), (0.02, 0.5 * h), (0.01, 0.7 * h), (0.022, h)],
            (x, 0.0, 0.0),
            16,
            3,
        )
        yield turned("wax", [(0.011, h), (0.009, h + 0.18)], (x, 0.0, 0.0), 12, 1)
        yield from _flame(x, h + 0.18, 0.0)


def _arms() -> Iterator[Solid]:
    yield turned("brass", [(0.08, 0.0), (0.02, 0.04), (0.015, 0.3), (0.02, 0.36)], sides=18, steps=2)
    for i in range(5):
        x = (i - 2) * 0.085
        if i != 2:
            yield tube("brass", spline([(0.0, 0.22, 0.0), (0.7 * x, 0.22, 0.0), (x, 0.34, 0.0)], 5), 0.007, 6)
        yield turned("brass", [(0.012, 0.335), (0.025, 0.35), (0.02, 0.36)], (x, 0.0, 0.0), 12, 1)
        yield turned("wax", [(0.01, 0.355), (0.008, 0.5)], (x, 0.0, 0.0), 10, 1)
        yield from _flame(x, 0.5, 0.0)


def _jars() -> Iterator[Solid]:
    for x, z, r in ((-0.06, 0.0, 0.04), (0.045, 0.03, 0.034), (0.04, -0.05, 0.03)):
        yield vessel("tint", [(r, 0.0), (1.1 * r, 0.04), (r, 0.09)], 0.003, (x, 0.0, z), 16, 2)
        yield cylinder("wax", 0.85 * r, 0.04, (x, 0.005, z), sides=14)
        yield from _flame(x, 0.045, z)


def _lantern() -> Iterator[Solid]:
    for x in (-0.08, 0.08):
        for z in (-0.08, 0.08):
            yield box("iron", (0.012, 0.28, 0.012), (x, 0.02, z))
    yield rounded("iron", (0.2, 0.02, 0.2), (0.0, 0.0, 0.0), 0.005, 1)
    yield turned("iron", [(0.14, 0.3), (0.03, 0.37), (0.02, 0.38)], sides=4, steps=1)
    yield ring("iron", 0.04, 0.008, (0.0, 0.42, 0.0), 2, 16)
    yield from (box("glass", (0.15, 0.26, 0.003), (0.0, 0.03, s * 0.082)) for s in (-1, 1))
    yield turned("wax", [(0.04, 0.02), (0.04, 0.15)], sides=18, steps=1)
    yield from _flame(0.0, 0.15, 0.0)


_CANDLES_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "pillar": _pillar,
    "stick": partial(_sticks, "stick"),
    "tapers": partial(_sticks, "tapers"),
    "arms": _arms,
    "jars": _jars,
    "lantern": _lantern,
}


def candles(kind: str = "pillar") -> Iterator[Solid]:
    """Pillars on a tray, a candlestick, a five-armed one, lights in jars, a lantern, tapers."""
    yield from _CANDLES_KINDS[kind]()


VASES = (
    *(design(vase, kind=kind) for kind in ("amphora", "bottle", "trumpet", "hourglass")),
    design(vase, kind="globe", slot="glass", stems=9), design(vase, kind="cylinder", slot="glass", stems=6),
    design(twigs), design(ribbed), design(ribbed, square=True), design(twin_handles),
    design(vase, kind="amphora", stems=12), design(vase, kind="bottle", slot="tint", stems=1),
)  # fmt: skip
PICTURES = (
    design(picture), design(picture, width=0.5, height=0.7, mount=0.06, slot="black"),
    design(picture, width=1.0, height=0.7, rim=0.07, slot="gold"), design(gallery), design(gallery, count=5),
    design(canvas), design(oval_picture), design(picture, width=0.4, height=0.4, mount=0.05),
    design(canvas, width=0.5, height=0.9), design(picture, width=1.2, height=0.5, rim=0.025, slot="white"),
    design(scroll),
    design(triptych), design(poster),
)  # fmt: skip


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


WALL_CLOCKS = _of(clock, "round", "sun", "square", "pendulum", "cuckoo")
TABLE_CLOCKS = _of(clock, "alarm", "mantel", "digital")
FIGURES = _of(
    figure, "cat", "bust", "horse", "elephant", "obelisk", "seated", "ring", "bird", "dancers", "globe", "ship"
)

FAMILIES = (
    Family("vase", "vase", VASES),
    Family("picture", "picture_frame", PICTURES),
    Family("photo", "picture_frame", (design(easel), design(easel, width=0.24, height=0.18))),
    Family("wall_clock", "clock", WALL_CLOCKS),
    Family("table_clock", "clock", TABLE_CLOCKS),
    Family("tall_clock", "clock", _of(clock, "tall")),
    Family(
        "books",
        "books",
        (*_of(books, "row", "pile", "ends"), design(books, kind="row", seed=5), design(books, kind="pile", seed=6)),
    ),
    Family("book", "book", _of(books, "single", "open")),
    Family("magazines", "magazines", _of(magazines, "fan", "rack")),
    Family("figure", "trinket", FIGURES),
    Family("ornament", "decoration", _of(ornament, "bowl", "box", "jar", "trophy")),
    Family("wall_ornament", "decoration", _of(ornament, "wreath", "plates")),
    Family("candle", "candle", _of(candles, "pillar", "stick", "arms", "jars", "lantern", "tapers")),
)
