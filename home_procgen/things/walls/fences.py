"""Fences and columns."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds

RAIL_HEIGHT = 1.0  # [m], height of a rail


def _planks(kind: str, width: float) -> Iterator[Solid]:
    high = 1.0 if kind == "pickets" else 1.6
    for x in (-width / 2 + 0.04, width / 2 - 0.04):
        yield rounded_box("wood", (0.08, high, 0.08), (x, 0.0, -0.03), 0.01, 1)
    for y in (0.2, high - 0.3):
        yield box("wood", (width, 0.08, 0.03), (0.0, y, 0.0))
    count = int(width / (0.13 if kind == "pickets" else 0.11))
    for i in range(count):
        x = (i + 0.5) / count * width - width / 2
        tip = high + 0.06 if kind == "pickets" else high
        yield prism(
            "wood",
            [(x - 0.045, 0.05), (x + 0.045, 0.05), (x + 0.045, high - 0.02), (x, tip), (x - 0.045, high - 0.02)],
            0.02,
            (0.0, 0.0, 0.025),
        )


def _balusters(width: float) -> Iterator[Solid]:
    yield box("wood", (width, 0.04, 0.08), (0.0, 0.06, 0.0))
    for i in range(int(width / 0.14)):
        x = (i + 0.5) / int(width / 0.14) * (width - 0.16) - (width - 0.16) / 2
        yield revolve(
            "wood",
            [(0.02, 0.1), (0.03, 0.2), (0.016, 0.3), (0.032, 0.5), (0.016, 0.78), (0.02, 0.98)],
            (x, 0.0, 0.0),
            10,
            2,
        )


def _bars(width: float) -> Iterator[Solid]:
    yield box("iron", (width, 0.03, 0.03), (0.0, 0.08, 0.0))
    for i in range(int(width / 0.11)):
        x = (i + 0.5) / int(width / 0.11) * (width - 0.1) - (width - 0.1) / 2
        yield rod("iron", (x, 0.1, 0.0), (x, 0.98, 0.0), 0.008, sides=6)
        if i % 3 == 1:
            yield ring("iron", 0.045, 0.012, (x, 0.88, 0.0), 2, 12)


def _panes(width: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("glass", (width / 2 - 0.07, 0.8, 0.012), (s * (width / 4 - 0.0), 0.1, 0.0))
    yield rounded_box("chrome", (0.045, RAIL_HEIGHT, 0.045), (0.0, 0.0, 0.0), 0.006, 1)


def _ropes(width: float) -> Iterator[Solid]:
    for k in range(7):
        yield rod(
            "chrome",
            (-width / 2 + 0.03, 0.13 + 0.12 * k, 0.0),
            (width / 2 - 0.03, 0.13 + 0.12 * k, 0.0),
            0.004,
            sides=6,
        )


_BETWEEN_POSTS = {"balusters": _balusters, "bars": _bars, "glass": _panes, "ropes": _ropes}


def _railing(kind: str, width: float) -> Iterator[Solid]:
    for x in (-width / 2 + 0.03, width / 2 - 0.03):
        if kind == "balusters":
            yield rounded_box("wood", (0.09, RAIL_HEIGHT + 0.06, 0.09), (x, 0.0, 0.0), 0.012, 1)
            yield ball("wood", 0.055, (x, RAIL_HEIGHT + 0.1, 0.0), 14, 8)
        else:
            yield rounded_box(
                "chrome" if kind != "bars" else "iron", (0.045, RAIL_HEIGHT, 0.045), (x, 0.0, 0.0), 0.006, 1
            )
    rail = "wood" if kind in ("balusters", "ropes") else "chrome" if kind == "glass" else "iron"
    yield tube(rail, [(-width / 2, RAIL_HEIGHT, 0.0), (width / 2, RAIL_HEIGHT, 0.0)], 0.028, 12)
    yield from _BETWEEN_POSTS[kind](width)


def fence(kind: str = "pickets", width: float = 2.0) -> Iterator[Solid]:
    """Build a fence or railing: balusters, iron bars, glass, steel ropes, pickets or boards."""
    yield from (_railing if kind in _BETWEEN_POSTS else _planks)(kind, width)


def column(kind: str = "round", height: float = 2.6) -> Iterator[Solid]:
    """Build a structural column: round with a capital, fluted or square."""
    yield rounded_box("white", (0.36, 0.12, 0.36), (0.0, 0.0, 0.0), 0.01, 1)
    yield rounded_box("white", (0.36, 0.1, 0.36), (0.0, height - 0.1, 0.0), 0.01, 1)
    if kind == "square":
        yield rounded_box("masonry", (0.28, height - 0.2, 0.28), (0.0, 0.1, 0.0), 0.006, 1)
        yield rounded_box("white", (0.32, 0.05, 0.32), (0.0, height - 0.18, 0.0), 0.01, 1)
        return
    yield revolve(
        "white",
        [
            (0.16, 0.12),
            (0.16, 0.16),
            (0.13, 0.2),
            (0.135, 0.9),
            (0.11, height - 0.25),
            (0.15, height - 0.14),
            (0.15, height - 0.1),
        ],
        sides=24,
        steps=2,
    )
    if kind == "fluted":
        for i in range(16):
            a = 2 * np.pi * i / 16
            yield rod(
                "white",
                (0.132 * np.cos(a), 0.24, 0.132 * np.sin(a)),
                (0.112 * np.cos(a), height - 0.3, 0.112 * np.sin(a)),
                0.014,
                sides=6,
            )


FAMILIES = (
    FurnitureFamily("fence", "fence", design_kinds(fence, "balusters", "bars", "glass", "ropes", "pickets", "boards")),
    FurnitureFamily("column", "column", design_kinds(column, "round", "fluted", "square")),
)
