"""Dressing tables."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import loop
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, drawers, legs
from home_procgen.things.tables.bases import top


def _oval_mirror(y: float, z: float, width: float, height: float) -> Iterator[Solid]:
    frame = [(x, y + h, z) for x, h in loop(width, height, 28)]
    yield prism("mirror", loop(width - 0.02, height - 0.02, 28), 0.012, (0.0, y, z))
    yield tube("wood", frame, 0.014, 8, closed=True)


def vanity(width: float = 1.0, depth: float = 0.42, kind: LegKind = "cabriole") -> Iterator[Solid]:
    """Build a dressing table with drawers beside the knees and an oval mirror."""
    yield from legs("wood", width, depth, 0.6, kind, 0.055)
    yield box("wood", (width - 0.02, 0.14, depth - 0.04), (0.0, 0.6, -0.01))
    yield from drawers(
        "wood_1", width - 0.04, 0.12, (0.02 - width / 2, 0.61, depth / 2 - 0.03), 3, 1, "flat", ("brass", "knob")
    )
    yield from top("wood", width + 0.03, depth, 0.765, "board", 0.025)
    yield from _oval_mirror(1.12, -depth / 2 + 0.04, 0.5, 0.66)
    for s in (-1, 1):
        yield beam("wood", (s * 0.2, 0.76, 0.04 - depth / 2), (s * 0.24, 1.12, 0.04 - depth / 2), 0.025)


def tri_mirror(width: float = 1.1, depth: float = 0.44) -> Iterator[Solid]:
    """Build two drawer towers and a three-part mirror."""
    for s in (-1, 1):
        yield box("wood", (0.3, 0.66, depth - 0.04), (s * (width / 2 - 0.15), 0.04, -0.01))
        yield from drawers(
            "wood_1",
            0.28,
            0.62,
            (s * (width / 2 - 0.15) - 0.14, 0.06, depth / 2 - 0.03),
            1,
            3,
            "raised",
            ("brass", "knob"),
        )
    yield from top("wood", width + 0.02, depth, 0.73, "board", 0.03)
    z = 0.05 - depth / 2
    yield rounded_box("wood", (0.46, 0.72, 0.025), (0.0, 0.74, z), 0.01, 1)
    yield box("mirror", (0.4, 0.64, 0.01), (0.0, 0.78, z + 0.012))
    for s in (-1, 1):
        x = s * 0.24
        a, b = (x, 0.76, z), (x + s * 0.22, 0.76, z + 0.14)
        for high, wide, slot, off in ((0.66, 0.02, "wood", 0.0), (0.58, 0.01, "mirror", 0.012)):
            p = (a[0] + s * 0.0, a[1] + high / 2 + (0.66 - high) / 2, a[2] + off)
            q = (b[0], p[1], b[2] + off)
            yield beam(slot, p, q, wide, high)


def hollywood(width: float = 1.1, depth: float = 0.42) -> Iterator[Solid]:
    """Build a white table with a large mirror framed by round bulbs."""
    yield from legs("white", width, depth, 0.62, "square", 0.05)
    yield box("white", (width, 0.13, depth - 0.03), (0.0, 0.61, -0.01))
    yield from drawers(
        "white", width - 0.02, 0.12, (0.01 - width / 2, 0.615, depth / 2 - 0.025), 2, 1, "flat", ("brass", "bar")
    )
    yield from top("glass", width, depth, 0.75, "board", 0.01)
    z = 0.05 - depth / 2
    yield rounded_box("white", (width - 0.1, 0.8, 0.04), (0.0, 0.75, z), 0.02, 2)
    yield box("mirror", (width - 0.3, 0.62, 0.01), (0.0, 0.84, z + 0.018))
    for i in range(5):
        yield from add_mirror_images([ball("bulb", 0.03, (width / 2 - 0.1, 0.85 + 0.15 * i, z + 0.04), 10, 6)])
        yield ball("bulb", 0.03, ((i - 2) * (width - 0.4) / 5, 1.5, z + 0.04), 10, 6)


def skirted(width: float = 0.95, depth: float = 0.45) -> Iterator[Solid]:
    """Build a kidney-shaped top with a pleated skirt and a round mirror."""
    yield prism("wood", loop(width, depth, 32, 2.6), 0.03, (0.0, 0.72, 0.0), "top")

    def skirt(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = 1.96 * np.pi * u + 0.02 * np.pi
        pleat = 1 + 0.03 * np.sin(40 * angle) * (1.2 - v)
        c, s = np.cos(angle), np.sin(angle)
        reach = 0.96 * pleat
        return (
            width / 2 * np.sign(c) * np.abs(c) ** (2 / 2.6) * reach,
            0.01 + 0.71 * v,
            depth / 2 * np.sign(s) * np.abs(s) ** (2 / 2.6) * reach,
        )

    yield surface("patterned", skirt, 160, 1, 0.008)
    yield from _oval_mirror(1.06, 0.05 - depth / 2, 0.5, 0.5)
    yield rod("wood", (0.0, 0.74, 0.05 - depth / 2), (0.0, 0.83, 0.05 - depth / 2), 0.015)


VANITIES = (
    design(vanity),
    design(tri_mirror),
    design(hollywood),
    design(skirted),
    design(vanity, kind="taper", width=0.9),
)


FAMILIES = (FurnitureFamily("dressing_table", "dressing_table", VANITIES),)
