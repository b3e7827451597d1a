"""Wardrobes, chests of drawers, nightstands, television stands, shoe cabinets."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.soft import rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import (
    BOARD,
    LegKind,
    body,
    book_row,
    case,
    corners,
    disc,
    doors,
    drawers,
    front,
    legs,
)
from home_mjx.datasets.homes.things.small.wear import shoe
from home_mjx.datasets.procedural.primitives.solids import Solid, Vector, box, cylinder, move


def carcass(
    width: float,
    height: float,
    depth: float,
    foot: float = 0.06,
    kind: str = "plinth",
    wood: str = "wood",
    overhang: float = 0.0,
) -> Iterator[Solid]:
    """A closed body with a top board on a plinth or on legs; fronts are to cover its face at depth / 2 - 2 cm."""
    if kind == "plinth":
        yield box("black" if overhang == 0 else wood, (width - 0.04, foot, depth - 0.08), (0.0, 0.0, -0.02))
    else:
        yield from legs(wood, width - 0.04, depth - 0.04, foot, kind, 0.05)  # type: ignore[arg-type]
    yield body(wood, width, height - foot - BOARD, depth, (0.0, foot, 0.0))
    yield rounded(wood, (width + overhang, BOARD, depth + overhang), (0.0, height - BOARD, 0.0), 0.007, 1)


def wardrobe(
    width: float = 1.0,
    height: float = 2.0,
    depth: float = 0.58,
    count: int = 2,
    style: str = "flat",
    low: int = 0,
    mirror: bool = False,
) -> Iterator[Solid]:
    """Doors over the whole face, or above drawers."""
    yield from carcass(width, height, depth)
    rise, z = 0.07 + 0.24 * (low > 0) * max(low, 1), depth / 2 - BOARD
    if low:
        yield from drawers(
            "wood_1",
            width - 0.01,
            0.24 * low,
            (0.005 - width / 2, 0.07, z),
            2 if width > 0.9 else 1,
            low,
            style if style in ("flat", "raised") else "flat",
        )
    yield from doors(
        "wood_1", width - 0.01, height - rise - BOARD - 0.005, (0.005 - width / 2, rise, z), count, style, up=0.45
    )
    if mirror:
        wide = width / count
        yield box(
            "mirror",
            (wide - 0.1, height - rise - 0.2, 0.008),
            (0.0 if count % 2 else wide / 2, rise + 0.08, depth / 2 + 0.003),
        )


def sliding(width: float = 1.8, height: float = 2.1, depth: float = 0.62) -> Iterator[Solid]:
    """Two or three panels, one behind another, on rails, one of them a mirror."""
    yield from case("wood", width, height, depth, (), (0.0, 0.0, 0.0), (0.5,), "wood")
    panel = width / 2 + 0.02
    for i, slot in enumerate(("wood_1", "mirror")):
        x, z = (-1) ** (i + 1) * (width / 4 - 0.01), depth / 2 - 0.02 - 0.035 * i
        yield box(slot, (panel - 0.04, height - 0.09, 0.012), (x, 0.04, z))
        for s in (-1, 1):
            yield box("chrome", (0.025, height - 0.09, 0.024), (x + s * (panel - 0.03) / 2, 0.04, z))
            yield box("chrome", (panel - 0.05, 0.025, 0.024), (x, 0.04 + (height - 0.115) * (s + 1) / 2, z))


def armoire(width: float = 1.1, height: float = 2.05, depth: float = 0.6) -> Iterator[Solid]:
    """An old wardrobe with a cornice, arched panels and bun feet."""
    for x, z in corners(width - 0.1, depth - 0.1):
        yield turned("wood", [(0.03, 0.0), (0.055, 0.04), (0.035, 0.09)], (x, 0.0, z), 12, 2)
    yield rounded("wood", (width + 0.04, 0.08, depth + 0.03), (0.0, 0.08, 0.0), 0.02, 2)
    yield body("wood", width, height - 0.3, depth, (0.0, 0.15, 0.0))
    for k, grow in enumerate((0.02, 0.06, 0.12)):
        yield rounded("wood", (width + grow, 0.045, depth + grow), (0.0, height - 0.16 + 0.04 * k, 0.0), 0.012, 1)
    yield prism(
        "wood",
        fillet([(-width / 2, 0.0), (width / 2, 0.0), (0.0, 0.16)], 0.3, 6, True),
        0.03,
        (0.0, height - 0.04, depth / 2 - 0.03),
    )
    yield from doors(
        "wood_1",
        width - 0.1,
        height - 0.56,
        (0.05 - width / 2, 0.38, depth / 2 - BOARD),
        2,
        "shaker",
        ("brass", "knob"),
    )
    yield from drawers(
        "wood_1", width - 0.1, 0.2, (0.05 - width / 2, 0.17, depth / 2 - BOARD), 2, 1, "raised", ("brass", "ring")
    )
    for s in (-1, 1):
        arch = fillet([(-0.14, 0.0), (0.14, 0.0), (0.14, 0.7), (0.0, 0.86), (-0.14, 0.7)], 0.09, 4, True)
        yield prism("wood_1", arch, 0.014, (s * (width - 0.1) / 4, 0.55, depth / 2 - 0.004))


def open_wardrobe(width: float = 1.2, height: float = 1.95, depth: float = 0.5) -> Iterator[Solid]:
    """Rails with clothes between shelves."""
    yield from case("wood", width, height, depth, (0.3, height - 0.36), (0.0, 0.0, 0.0), (), "wood_1")
    yield rod("chrome", (0.02 - width / 2, height - 0.45, 0.0), (width / 2 - 0.02, height - 0.45, 0.0), 0.012)
    rng = np.random.default_rng(5)
    for i in range(11):
        x = -0.48 + 0.095 * i
        yield from garment(f"textile_{i % 5}", x, height - 0.45, float(rng.uniform(0.55, 0.95)))
    for i in range(3):
        yield soft(f"textile_{i}", (0.3, 0.16, 0.34), (-0.4 + 0.4 * i, height - 0.34, 0.0), 5.0, 4)
        yield rounded("cane", (0.34, 0.22, 0.38), (-0.38 + 0.38 * i, 0.03, 0.0), 0.03, 1)


def garment(slot: str, x: float, y: float, long: float) -> Iterator[Solid]:
    """A shirt or coat on a hanger, seen from its side, below a rail at height y."""
    yield rod("chrome", (x, y, 0.0), (x, y - 0.08, 0.0), 0.003, sides=5)
    shape = [
        (0.0, -0.06),
        (0.2, -0.13),
        (0.21, -0.3),
        (0.17, -0.32),
        (0.19, -long),
        (-0.19, -long),
        (-0.17, -0.32),
        (-0.21, -0.3),
        (-0.2, -0.13),
    ]
    yield prism(slot, [(z, y + h) for z, h in shape], 0.05, (x, 0.0, 0.0), "side")


def corner_wardrobe(size: float = 1.0, height: float = 2.0) -> Iterator[Solid]:
    """A five-sided cabinet for a corner with a slanted door."""
    half, short = size / 2, size / 2 - 0.45
    outline = [(-half, -half), (half, -half), (half, -short), (-short, half), (-half, half)]
    yield prism("wood", outline, height - 0.1, (0.0, 0.06, 0.0), "top")
    yield prism("black", [(0.95 * x, 0.95 * z) for x, z in outline], 0.06, (0.0, 0.0, 0.0), "top")
    yield prism("wood", [(1.02 * x, 1.02 * z) for x, z in outline], 0.04, (0.0, height - 0.04, 0.0), "top")
    a, b = (half, height / 2 + 0.01, -short), (-short, height / 2 + 0.01, half)
    shift = 0.008
    p = (a[0] - 0.04 + shift, a[1], a[2] + 0.04 + shift)
    q = (b[0] + 0.04 + shift, b[1], b[2] - 0.04 + shift)
    yield beam("wood_1", p, q, 0.022, height - 0.2)
    for t in (0.47, 0.53):
        x, z = p[0] + t * (q[0] - p[0]) + 0.02, p[2] + t * (q[2] - p[2]) + 0.02
        yield rod("chrome", (x, 0.9, z), (x, 1.1, z), 0.008)


def cupboard_top(width: float = 1.0, height: float = 2.0, depth: float = 0.42) -> Iterator[Solid]:
    """A dresser: glazed doors with plates above, solid doors below."""
    yield from carcass(width, 0.86, depth, 0.07, "plinth", "wood", 0.03)
    yield from doors(
        "wood_1", width - 0.02, 0.52, (0.01 - width / 2, 0.08, depth / 2 - BOARD), 2, "shaker", ("brass", "knob"), 0.8
    )
    yield from drawers(
        "wood_1", width - 0.02, 0.2, (0.01 - width / 2, 0.62, depth / 2 - BOARD), 2, 1, "flat", ("brass", "cup")
    )
    yield from case("wood", width - 0.04, height - 0.88, 0.28, (0.34, 0.7), (0.0, 0.86, -0.06), (), "wood_1")
    for row in range(3):
        for i in range(3):
            yield disc("crockery", 0.1, 0.012, (-0.3 + 0.3 * i, 1.0 + 0.35 * row, -0.16), 20)
    yield from doors("wood", width - 0.04, height - 0.92, (0.02 - width / 2, 0.88, 0.08), 2, "glass", ("brass", "knob"))
    yield rounded("wood", (width + 0.04, 0.05, 0.34), (0.0, height - 0.03, -0.05), 0.015, 1)


def dresser(
    width: float = 1.2,
    height: float = 0.85,
    depth: float = 0.48,
    columns: int = 2,
    rows: int = 3,
    style: str = "flat",
    kind: str = "taper",
    grip: tuple = ("brass", "knob"),
    graded: bool = False,
    foot: float = 0.14,
) -> Iterator[Solid]:
    """Drawers over the whole face."""
    yield from carcass(width, height, depth, foot if kind != "plinth" else 0.06, kind, "wood", 0.02)
    low = foot if kind != "plinth" else 0.06
    yield from drawers(
        "wood_1",
        width - 0.02,
        height - low - 0.03,
        (0.01 - width / 2, low + 0.005, depth / 2 - BOARD),
        columns,
        rows,
        style,
        grip,
        graded,
    )


def bow_front(width: float = 1.0, height: float = 0.85, depth: float = 0.5) -> Iterator[Solid]:
    """A swelling front on curved feet, with brass fittings."""
    xs = np.linspace(-width / 2, width / 2, 13)
    bow = [(float(x), depth / 2 - 0.1 + 0.12 * float(np.cos(np.pi * x / width))) for x in xs]
    outline = [(-width / 2, -depth / 2), (width / 2, -depth / 2), *bow[::-1]]
    yield from legs("wood", width - 0.02, depth - 0.12, 0.16, "cabriole", 0.06)
    yield prism("wood", outline, height - 0.18, (0.0, 0.14, 0.0), "top")
    yield prism("marble", [(1.03 * x, 1.04 * z) for x, z in outline], 0.03, (0.0, height - 0.04, 0.0), "top")
    for row in range(3):
        y = 0.17 + row * 0.215
        yield prism(
            "wood_1",
            [*[(0.92 * x, z + 0.012) for x, z in bow], *[(0.92 * x, z - 0.03) for x, z in bow[::-1]]],
            0.195,
            (0.0, y, 0.0),
            "top",
        )
        for x in (-0.26, 0.26):
            z = depth / 2 - 0.1 + 0.12 * float(np.cos(np.pi * x / width)) + 0.014
            yield from (Solid(p.vertices, p.faces, p.uv, p.material) for p in _pull((x, y + 0.1, z)))


def _pull(at: Vector) -> Iterator[Solid]:
    x, y, z = at
    yield rounded("brass", (0.09, 0.05, 0.008), (x, y - 0.025, z - 0.002), 0.004, 1)
    yield tube(
        "brass",
        fillet(
            [(x - 0.03, y, z), (x - 0.03, y - 0.02, z + 0.018), (x + 0.03, y - 0.02, z + 0.018), (x + 0.03, y, z)], 0.01
        ),
        0.004,
        6,
    )


def basket_chest(width: float = 0.9, height: float = 0.9, depth: float = 0.4) -> Iterator[Solid]:
    """A frame with woven baskets for drawers."""
    yield from case("wood", width, height - 0.06, depth, (0.28, 0.56), (0.0, 0.06, 0.0), (0.5,), "wood_1")
    yield from legs("wood", width, depth, 0.07, "block", 0.05)
    for row in range(3):
        for s in (-1, 1):
            yield rounded(
                "cane", (width / 2 - 0.05, 0.22, depth - 0.02), (s * width / 4, 0.09 + 0.28 * row, 0.01), 0.025, 2
            )
            yield box("black", (0.09, 0.022, 0.006), (s * width / 4, 0.24 + 0.28 * row, depth / 2 - 0.0))


def apothecary(width: float = 0.95, height: float = 1.05, depth: float = 0.36) -> Iterator[Solid]:
    """Many small drawers with label holders."""
    yield from carcass(width, height, depth, 0.1, "block", "wood", 0.03)
    yield from drawers(
        "wood_1",
        width - 0.02,
        height - 0.14,
        (0.01 - width / 2, 0.105, depth / 2 - BOARD),
        4,
        5,
        "flat",
        ("brass", "cup"),
    )


def tallboy(width: float = 0.55, height: float = 1.3, depth: float = 0.42) -> Iterator[Solid]:
    """A tower of shallow drawers."""
    yield from dresser(width, height, depth, 1, 6, "flat", "plinth", ("black", "slot"))


def nightstand(
    width: float = 0.46,
    height: float = 0.55,
    depth: float = 0.4,
    rows: int = 2,
    style: str = "flat",
    kind: str = "taper",
    grip: tuple = ("brass", "knob"),
    foot: float = 0.14,
) -> Iterator[Solid]:
    """A small chest of drawers."""
    yield from dresser(width, height, depth, 1, rows, style, kind, grip, False, foot)


def open_stand(
    width: float = 0.45, height: float = 0.55, depth: float = 0.38, kind: LegKind = "square"
) -> Iterator[Solid]:
    """A drawer above an open shelf with books."""
    yield from legs("wood", width, depth, height - 0.02, kind, 0.04)
    yield rounded("wood", (width + 0.02, 0.022, depth + 0.02), (0.0, height - 0.022, 0.0), 0.007, 1)
    yield box("wood", (width - 0.03, 0.14, depth - 0.04), (0.0, height - 0.165, -0.01))
    yield from drawers(
        "wood_1",
        width - 0.09,
        0.13,
        (0.045 - width / 2, height - 0.16, depth / 2 - 0.03),
        1,
        1,
        "flat",
        ("brass", "knob"),
    )
    yield box("wood", (width - 0.03, 0.018, depth - 0.03), (0.0, 0.14, 0.0))
    yield rounded("cover_1", (0.2, 0.03, 0.27), (-0.04, 0.158, 0.0), 0.004, 1)
    yield rounded("cover_2", (0.18, 0.024, 0.24), (-0.03, 0.188, 0.0), 0.004, 1)


def round_stand(radius: float = 0.22, height: float = 0.55) -> Iterator[Solid]:
    """A cylinder with a curved door."""
    yield cylinder("black", radius - 0.03, 0.05, sides=24)
    yield cylinder("wood", radius, height - 0.08, (0.0, 0.05, 0.0), sides=32)
    yield turned(
        "marble",
        [(radius, 0.0), (radius + 0.012, 0.008), (radius + 0.012, 0.022), (radius, 0.03)],
        (0.0, height - 0.03, 0.0),
        32,
        1,
    )
    for i in range(17):
        a = np.pi * (0.5 + 0.055 * (i - 8))
        yield rod(
            "wood_1",
            (radius * np.cos(a), 0.07, radius * np.sin(a)),
            (radius * np.cos(a), height - 0.05, radius * np.sin(a)),
            0.012,
            sides=6,
        )
    yield rod("brass", (0.03, 0.3, radius + 0.02), (0.03, 0.42, radius + 0.02), 0.006)


def crate_stand() -> Iterator[Solid]:
    """Two slatted crates, one on the other."""
    for k in range(2):
        for s in (-1, 1):
            for i in range(3):
                yield (
                    box("wood", (0.42, 0.065, 0.014), (0.0, 0.01 + 0.28 * k + 0.085 * i, 0.0 + s * 0.16))
                    if s < 0
                    else box("wood", (0.014, 0.065, 0.32), (0.2, 0.01 + 0.28 * k + 0.085 * i, 0.0))
                )
            yield box("wood", (0.42, 0.014, 0.33), (0.0, 0.28 * k + 0.262 * (s + 1) / 2, 0.0))
        for i in range(3):
            yield box("wood", (0.014, 0.065, 0.32), (-0.2, 0.01 + 0.28 * k + 0.085 * i, 0.0))
        for x, z in corners(0.38, 0.28):
            yield box("wood_1", (0.03, 0.26, 0.03), (x, 0.01 + 0.28 * k, z))
    yield rounded("cover_1", (0.2, 0.035, 0.26), (0.0, 0.014, 0.0), 0.004, 1)


def barley(width: float = 0.42) -> Iterator[Solid]:
    """A tripod stand with a drawer in a round top."""
    yield cylinder("wood", 0.21, 0.11, (0.0, 0.44, 0.0), sides=28)
    yield turned("wood", [(0.22, 0.0), (0.235, 0.012), (0.22, 0.024)], (0.0, 0.55, 0.0), 28, 1)
    yield disc("brass", 0.014, 0.03, (0.0, 0.495, 0.2), 10)
    for i in range(3):
        a = 2 * np.pi * i / 3 + 0.5
        yield tube(
            "wood",
            [
                (0.2 * np.cos(a), 0.01, 0.2 * np.sin(a)),
                (0.12 * np.cos(a), 0.2, 0.12 * np.sin(a)),
                (0.16 * np.cos(a), 0.45, 0.16 * np.sin(a)),
            ],
            [0.013, 0.016, 0.022],
        )


def floating(width: float = 0.48) -> Iterator[Solid]:
    """A drawer box on a wall bracket post."""
    yield rounded("wood", (width, 0.2, 0.34), (0.0, 0.34, 0.0), 0.012, 2)
    yield from drawers("wood_1", width - 0.03, 0.16, (0.015 - width / 2, 0.36, 0.165), 1, 1, "flat", ("black", "slot"))
    yield rounded("wood", (0.12, 0.36, 0.06), (0.0, 0.0, -0.13), 0.01, 1)
    yield rounded("wood", (0.34, 0.02, 0.3), (0.0, 0.0, -0.02), 0.008, 1)


def tv_low(
    width: float = 1.6, height: float = 0.5, depth: float = 0.42, layout: str = "doors", kind: str = "taper"
) -> Iterator[Solid]:
    """A low board with doors, drawers, open niches or slats."""
    foot = 0.14 if kind != "plinth" else 0.05
    if kind == "plinth":
        yield box("black", (width - 0.06, foot, depth - 0.08), (0.0, 0.0, -0.02))
    else:
        yield from legs("wood", width - 0.1, depth - 0.04, foot, kind, 0.05)  # type: ignore[arg-type]
    z, high = depth / 2 - BOARD, height - foot - 0.03
    yield from case(
        "wood",
        width,
        height - foot,
        depth,
        (0.5 * high,) if layout == "niches" else (),
        (0.0, foot, 0.0),
        (1 / 3, 2 / 3),
        "wood_1",
    )
    third = width / 3
    if layout == "niches":
        yield rounded("black", (0.4, 0.05, 0.26), (0.0, foot + 0.022, 0.0), 0.008, 1)
        yield from book_row(third / 2 + 0.04, foot + 0.022, third - 0.08, 0.14, 0.0, 2)
        yield rounded("cane", (third - 0.08, 0.13, 0.3), (-third, foot + 0.022, 0.0), 0.02, 1)
    else:
        style = {"doors": "flat", "slats": "slats", "cane": "cane", "shaker": "shaker"}[layout]
        for i in (0, 2):
            yield from front(
                "wood_1",
                (third - 0.01, high),
                (0.005 - width / 2 + i * third, foot + 0.015, z),
                style,  # type: ignore[arg-type]
                ("brass", "knob", 0.88 if i == 0 else 0.12, 0.5),
            )
        yield from drawers(
            "wood_1",
            third - 0.01,
            high / 2,
            (0.005 - third / 2, foot + 0.015 + high / 2, z),
            1,
            1,
            "flat",
            ("brass", "knob"),
        )
        yield rounded("black", (0.36, 0.05, 0.26), (0.0, foot + 0.022, 0.0), 0.008, 1)


def media_wall(width: float = 2.2, height: float = 1.9) -> Iterator[Solid]:
    """A low board with a shelf tower at each end and a bridge above."""
    yield from tv_low(width, 0.48, 0.42, "doors", "plinth")
    for s in (-1, 1):
        yield from case(
            "wood", 0.42, height - 0.48, 0.32, (0.36, 0.72, 1.06), (s * (width / 2 - 0.21), 0.48, -0.05), (), "wood_1"
        )
        yield from book_row(s * (width / 2 - 0.21) - 0.17, 0.86, 0.32, 0.28, -0.05, 4 + s)
        yield turned(
            "glaze", [(0.04, 0.0), (0.07, 0.06), (0.03, 0.16), (0.04, 0.2)], (s * (width / 2 - 0.21), 0.5, -0.03), 14, 2
        )
    yield box("wood", (width, 0.03, 0.34), (0.0, height, -0.05))


def glass_media(width: float = 1.2) -> Iterator[Solid]:
    """Glass shelves on chrome tubes."""
    for y in (0.1, 0.3, 0.5):
        yield rounded("glass", (width, 0.012, 0.42), (0.0, y, 0.0), 0.004, 1)
    for x, z in corners(width - 0.16, 0.32):
        yield rod("chrome", (x, 0.0, z), (x, 0.52, z), 0.022, sides=12)
    yield rounded("black", (0.43, 0.06, 0.28), (-0.2, 0.113, 0.0), 0.008, 1)
    yield rounded("black", (0.3, 0.05, 0.24), (0.25, 0.313, 0.0), 0.008, 1)


def corner_tv(width: float = 1.2) -> Iterator[Solid]:
    """A five-sided low cabinet for a corner."""
    outline = [(-0.6, 0.22), (-0.35, -0.26), (0.35, -0.26), (0.6, 0.22), (0.6, 0.28), (-0.6, 0.28)]
    for y, t in ((0.05, 0.03), (0.28, 0.02), (0.5, 0.03)):
        yield prism("wood", outline, t, (0.0, y, 0.0), "top")
    for x, z in ((-0.57, 0.25), (0.57, 0.25), (-0.33, -0.23), (0.33, -0.23)):
        yield rounded("wood", (0.05, 0.5, 0.05), (x, 0.0, z), 0.008, 1)
    yield box("wood_1", (0.66, 0.45, 0.015), (0.0, 0.06, -0.245))
    yield rounded("black", (0.43, 0.06, 0.28), (0.0, 0.082, 0.02), 0.008, 1)
    yield from front("wood_1", (0.54, 0.19), (-0.55, 0.305, 0.26), "flat", ("chrome", "knob", 0.9, 0.5))
    yield from front("wood_1", (0.54, 0.19), (0.01, 0.305, 0.26), "flat", ("chrome", "knob", 0.1, 0.5))


def pipe_media(width: float = 1.4) -> Iterator[Solid]:
    """Boards on a frame of iron pipes."""
    for y in (0.14, 0.46):
        yield rounded("wood", (width, 0.04, 0.4), (0.0, y, 0.0), 0.008, 1)
    for x in (-width / 2 + 0.12, 0.0, width / 2 - 0.12):
        for z in (-0.14, 0.14):
            yield rod("iron", (x, 0.0, z), (x, 0.46, z), 0.016, sides=10)
            yield cylinder("iron", 0.035, 0.012, (x, 0.0, z), sides=14)
            yield cylinder("iron", 0.03, 0.012, (x, 0.18, z), sides=12)
    yield rounded("black", (0.43, 0.06, 0.28), (0.34, 0.18, 0.0), 0.008, 1)
    yield from book_row(-0.5, 0.18, 0.4, 0.24, 0.0, 12)


def shoe_flaps(width: float = 0.75, count: int = 3) -> Iterator[Solid]:
    """A narrow cabinet whose fronts tip out."""
    height = 0.1 + 0.36 * count
    yield from carcass(width, height, 0.24, 0.06)
    yield from drawers(
        "wood_1", width - 0.01, height - 0.09, (0.005 - width / 2, 0.065, 0.1), 1, count, "flat", ("black", "slot")
    )


def shoe_rack(width: float = 0.8, cushioned: bool = False) -> Iterator[Solid]:
    """Slatted shelves with pairs of shoes, perhaps with a cushion to sit on."""
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
        yield soft("textile", (width, 0.08, 0.32), (0.0, 0.474, 0.0), 9.0, 5)


def louvred(width: float = 0.8, height: float = 0.95) -> Iterator[Solid]:
    """A shoe cabinet with louvred doors."""
    yield from carcass(width, height, 0.34, 0.1, "taper", "wood", 0.03)
    yield from doors(
        "wood_1", width - 0.02, height - 0.13, (0.01 - width / 2, 0.105, 0.15), 2, "shaker", ("brass", "knob")
    )
    for s in (-1, 1):
        for i in range(12):
            yield box("wood_1", (width / 2 - 0.15, 0.035, 0.02), (s * width / 4, 0.18 + 0.055 * i, 0.166))


WARDROBES = (
    design(wardrobe), design(wardrobe, style="shaker", low=1, width=1.1), design(sliding), design(armoire),
    design(open_wardrobe), design(corner_wardrobe), design(wardrobe, width=1.5, count=3, mirror=True, style="flat"),
    design(wardrobe, style="slats", width=0.9), design(wardrobe, style="cane", width=1.0, low=2, height=1.9),
    design(cupboard_top), design(wardrobe, style="grooves", width=0.8, height=1.85),
    design(wardrobe, style="raised", width=2.0, count=4, low=1, height=2.15),
    design(wardrobe, style="glass", width=0.9, low=2),
)  # fmt: skip
DRESSERS = (
    design(dresser),
    design(
        dresser, style="raised", kind="cabriole", grip=("brass", "ring"), graded=True, columns=1, rows=4, width=0.95
    ),
    design(bow_front), design(basket_chest), design(apothecary), design(tallboy),
    design(dresser, style="shaker", kind="block", columns=3, rows=3, width=1.5, grip=("black", "cup")),
    design(dresser, style="cane", kind="splay", rows=2, height=0.75),
    design(dresser, kind="plinth", grip=("black", "slot"), rows=4, columns=1, width=0.8, height=1.0),
    design(dresser, style="slats", kind="sled", rows=2, width=1.4, height=0.75),
)  # fmt: skip
STANDS = (
    design(nightstand), design(open_stand), design(round_stand), design(crate_stand), design(barley),
    design(floating),
    design(nightstand, style="raised", kind="cabriole", grip=("brass", "ring"), rows=1, height=0.58, foot=0.3),
    design(nightstand, style="cane", kind="splay", rows=1, width=0.5, foot=0.22),
    design(nightstand, kind="plinth", rows=3, grip=("black", "slot")), design(open_stand, kind="turned", height=0.62),
    design(nightstand, style="slats", kind="sled", rows=2),
)  # fmt: skip
MEDIA = (
    design(tv_low), design(tv_low, layout="niches", kind="plinth", width=1.4), design(media_wall),
    design(glass_media), design(corner_tv), design(pipe_media),
    design(tv_low, layout="slats", kind="sled", width=1.8), design(tv_low, layout="cane", kind="splay", width=1.5),
    design(tv_low, layout="shaker", kind="block", height=0.6),
    design(tv_low, layout="niches", kind="hairpin", width=1.3),
)  # fmt: skip
SHOE_CABINETS = (
    design(shoe_flaps),
    design(shoe_rack),
    design(louvred),
    design(shoe_rack, cushioned=True, width=0.95),
    design(shoe_flaps, count=2, width=0.9),
)

FAMILIES = (
    Family("wardrobe", "wardrobe_cabinet", WARDROBES),
    Family("dresser", "dresser", DRESSERS),
    Family("nightstand", "stand", STANDS),
    Family("tv_stand", "tv_stand", MEDIA),
    Family("shoes_cabinet", "shoes_cabinet", SHOE_CABINETS),
)
