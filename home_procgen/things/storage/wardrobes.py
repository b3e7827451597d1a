"""Wardrobes."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import (
    BOARD_THICKNESS,
    cabinet_body,
    carcass,
    corners,
    disc,
    doors,
    drawers,
    garment,
    open_case,
)
from home_procgen.things.movable_parts import assign_part, collect_parts


def wardrobe(
    width: float = 1.0,
    height: float = 2.0,
    depth: float = 0.58,
    count: int = 2,
    style: str = "flat",
    low: int = 0,
    mirror: bool = False,
) -> Iterator[Solid]:
    """Build a wardrobe with doors over the whole face or above drawers."""
    yield from carcass(width, height, depth)
    rise, z = 0.07 + 0.24 * (low > 0) * max(low, 1), depth / 2 - BOARD_THICKNESS
    if low:
        yield from drawers(
            "wood_1",
            width - 0.01,
            0.24 * low,
            (0.005 - width / 2, 0.07, z),
            2 if width > 0.9 else 1,
            low,
            style if style in ("flat", "raised") else "flat",
            opens=depth - 0.12,
        )
    high = height - rise - BOARD_THICKNESS - 0.005
    leaves = list(doors("wood_1", width - 0.01, high, (0.005 - width / 2, rise, z), count, style, up=0.45))
    yield from leaves
    if mirror:
        wide = width / count
        x = 0.0 if count % 2 else wide / 2
        pane = box("mirror", (wide - 0.1, height - rise - 0.2, 0.008), (x, rise + 0.08, depth / 2 + 0.003))
        yield from assign_part(collect_parts(leaves)[count // 2], [pane])


def sliding(width: float = 1.8, height: float = 2.1, depth: float = 0.62) -> Iterator[Solid]:
    """Build a wardrobe with two overlapping sliding panels on rails, one of them a mirror."""
    yield from open_case("wood", width, height, depth, (), (0.0, 0.0, 0.0), (0.5,), "wood")
    panel = width / 2 + 0.02
    for i, slot in enumerate(("wood_1", "mirror")):
        x, z = (-1) ** (i + 1) * (width / 4 - 0.01), depth / 2 - 0.02 - 0.035 * i
        yield box(slot, (panel - 0.04, height - 0.09, 0.012), (x, 0.04, z))
        for s in (-1, 1):
            yield box("chrome", (0.025, height - 0.09, 0.024), (x + s * (panel - 0.03) / 2, 0.04, z))
            yield box("chrome", (panel - 0.05, 0.025, 0.024), (x, 0.04 + (height - 0.115) * (s + 1) / 2, z))


def armoire(width: float = 1.1, height: float = 2.05, depth: float = 0.6) -> Iterator[Solid]:
    """Build an antique wardrobe with a cornice, arched panels and bun feet."""
    for x, z in corners(width - 0.1, depth - 0.1):
        yield revolve("wood", [(0.03, 0.0), (0.055, 0.04), (0.035, 0.09)], (x, 0.0, z), 12, 2)
    yield rounded_box("wood", (width + 0.04, 0.08, depth + 0.03), (0.0, 0.08, 0.0), 0.02, 2)
    yield cabinet_body("wood", width, height - 0.3, depth, (0.0, 0.15, 0.0))
    for k, grow in enumerate((0.02, 0.06, 0.12)):
        yield rounded_box("wood", (width + grow, 0.045, depth + grow), (0.0, height - 0.16 + 0.04 * k, 0.0), 0.012, 1)
    yield prism(
        "wood",
        fillet([(-width / 2, 0.0), (width / 2, 0.0), (0.0, 0.16)], 0.3, 6, True),
        0.03,
        (0.0, height - 0.04, depth / 2 - 0.03),
    )
    corner, size = (0.05 - width / 2, 0.38, depth / 2 - BOARD_THICKNESS), (width - 0.1, height - 0.56)
    leaves = list(doors("wood_1", *size, corner, 2, "shaker", ("brass", "knob")))
    yield from leaves
    corner = (0.05 - width / 2, 0.17, depth / 2 - BOARD_THICKNESS)
    yield from drawers("wood_1", width - 0.1, 0.2, corner, 2, 1, "raised", ("brass", "ring"), opens=0.45)
    for s, part in zip((-1, 1), collect_parts(leaves), strict=True):
        arch = fillet([(-0.14, 0.0), (0.14, 0.0), (0.14, 0.7), (0.0, 0.86), (-0.14, 0.7)], 0.09, 4, True)
        yield from assign_part(part, [prism("wood_1", arch, 0.014, (s * (width - 0.1) / 4, 0.55, depth / 2 - 0.004))])


def open_wardrobe(width: float = 1.2, height: float = 1.95, depth: float = 0.5) -> Iterator[Solid]:
    """Build an open wardrobe: clothes on a rail, folded clothes above and baskets below."""
    yield from open_case("wood", width, height, depth, (0.3, height - 0.36), (0.0, 0.0, 0.0), (), "wood_1")
    yield rod("chrome", (0.02 - width / 2, height - 0.45, 0.0), (width / 2 - 0.02, height - 0.45, 0.0), 0.012)
    rng = np.random.default_rng(5)
    for i in range(11):
        x = -0.48 + 0.095 * i
        yield from garment(f"textile_{i % 5}", x, height - 0.45, float(rng.uniform(0.55, 0.95)))
    for i in range(3):
        yield padded_block(f"textile_{i}", (0.3, 0.16, 0.34), (-0.4 + 0.4 * i, height - 0.34, 0.0), 5.0, 4)
        yield rounded_box("cane", (0.34, 0.22, 0.38), (-0.38 + 0.38 * i, 0.03, 0.0), 0.03, 1)


def corner_wardrobe(size: float = 1.0, height: float = 2.0) -> Iterator[Solid]:
    """Build a five-sided corner wardrobe with a slanted door."""
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
    for low, high in ((0.14, 0.9), (1.14, height - 0.2)):
        ends = [(x + 0.009, (low + high) / 2, z + 0.009) for x, _, z in (p, q)]
        left, right = ((0.82 * np.array(a) + 0.18 * np.array(b)).tolist() for a, b in (ends, ends[::-1]))
        yield beam("wood_1", tuple(left), tuple(right), 0.016, high - low)
    for t in (0.47, 0.53):
        x, z = p[0] + t * (q[0] - p[0]) + 0.02, p[2] + t * (q[2] - p[2]) + 0.02
        yield rod("chrome", (x, 0.9, z), (x, 1.1, z), 0.008)


def cupboard_top(width: float = 1.0, height: float = 2.0, depth: float = 0.42) -> Iterator[Solid]:
    """Build a dresser: glazed doors with plates above, solid doors below."""
    yield from carcass(width, 0.86, depth, 0.07, "plinth", "wood", 0.03)
    yield from doors(
        "wood_1",
        width - 0.02,
        0.52,
        (0.01 - width / 2, 0.08, depth / 2 - BOARD_THICKNESS),
        2,
        "shaker",
        ("brass", "knob"),
        0.8,
    )
    yield from drawers(
        "wood_1",
        width - 0.02,
        0.2,
        (0.01 - width / 2, 0.62, depth / 2 - BOARD_THICKNESS),
        2,
        1,
        "flat",
        ("brass", "cup"),
    )
    yield from open_case("wood", width - 0.04, height - 0.88, 0.28, (0.34, 0.7), (0.0, 0.86, -0.06), (), "wood_1")
    for row in range(3):
        for i in range(3):
            yield disc("crockery", 0.1, 0.012, (-0.3 + 0.3 * i, 1.0 + 0.35 * row, -0.16), 20)
    yield from doors("wood", width - 0.04, height - 0.92, (0.02 - width / 2, 0.88, 0.08), 2, "glass", ("brass", "knob"))
    yield rounded_box("wood", (width + 0.04, 0.05, 0.34), (0.0, height - 0.03, -0.05), 0.015, 1)


WARDROBES = (
    design(wardrobe), design(wardrobe, style="shaker", low=1, width=1.1), design(sliding), design(armoire),
    design(open_wardrobe), design(corner_wardrobe), design(wardrobe, width=1.5, count=3, mirror=True, style="flat"),
    design(wardrobe, style="slats", width=0.9), design(wardrobe, style="cane", width=1.0, low=2, height=1.9),
    design(cupboard_top), design(wardrobe, style="grooves", width=0.8, height=1.85),
    design(wardrobe, style="raised", width=2.0, count=4, low=1, height=2.15),
    design(wardrobe, style="glass", width=0.9, low=2),
)  # fmt: skip


FAMILIES = (FurnitureFamily("wardrobe", "wardrobe_cabinet", WARDROBES),)
