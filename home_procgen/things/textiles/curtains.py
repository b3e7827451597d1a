"""Curtains and blinds."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design


def _folded_cloth(
    slot: str,
    left: float,
    right: float,
    top: float,
    low: float,
    folds: float,
    deep: float,
    tie: float = 0.0,
    side: int = 0,
) -> Solid:
    """Build folded cloth between two edges; `tie` gathers it towards `side` at 0.62 of its drop."""
    width = right - left

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        rise = np.clip(v / 0.62, 0, 1)
        gather = tie * rise**2 * (3 - 2 * rise) * (1 - 0.9 * np.clip(v - 0.62, 0, 1))
        share = u * (1 - gather) + gather * (side > 0)
        wave = deep * np.sin(2 * np.pi * folds * u) * (0.75 + 0.25 * v)
        return left + share * width, top - v * (top - low), wave + 0.2 * deep * np.sin(2 * np.pi * folds * 0.43 * u + 1)

    return surface(slot, place, int((7 if tie else 10) * folds), 8 if tie else 3, 0.006)


def _pole(width: float, y: float, slot: str = "wood", ends: str = "ball") -> Iterator[Solid]:
    yield rod(slot, (-width / 2 - 0.06, y, 0.0), (width / 2 + 0.06, y, 0.0), 0.014, sides=10)
    for s in (-1, 1):
        x = s * (width / 2 + 0.07)
        if ends == "ball":
            yield ball(slot, 0.03, (x, y, 0.0), 12, 8)
        else:
            yield rounded_box(slot, (0.03, 0.05, 0.05), (x, y - 0.025, 0.0), 0.006, 1)
        yield rod(slot, (s * width / 2, y, -0.1), (s * width / 2, y, 0.0), 0.008)
    for i in range(10):
        yield ring(slot, 0.02, 0.006, (-width / 2 + 0.02 + i * (width - 0.04) / 9, y - 0.008, 0.0), 0, 10)


def drapes(
    width: float = 2.0, height: float = 2.3, open_: float = 0.27, tied: bool = False, sheers: bool = False
) -> Iterator[Solid]:
    """Build two lengths of cloth on a pole to the floor, open or tied, with optional sheers between."""
    yield from _pole(width, height - 0.03)
    for s in (-1, 1):
        inner, outer = s * width / 2 * (1 - 2 * open_) if not tied else s * 0.04, s * width / 2
        left, right = min(inner, outer), max(inner, outer)
        yield _folded_cloth(
            "curtain", left, right, height - 0.05, 0.01, 5 if not tied else 7, 0.035, 0.62 if tied else 0.0, s
        )
        if tied:
            yield tube(
                "brass",
                [
                    (s * (width / 2 - 0.34), 0.95, 0.05),
                    (s * (width / 2 - 0.1), 0.9, 0.07),
                    (s * width / 2, 0.98, -0.05),
                ],
                0.012,
                6,
            )
    if sheers:
        yield _folded_cloth("sheer", -width / 2 + 0.02, width / 2 - 0.02, height - 0.05, 0.02, 11, 0.018)


def portiere(width: float = 1.0, height: float = 2.1) -> Iterator[Solid]:
    """Build one length of cloth drawn to one side."""
    yield from _pole(width, height - 0.03, "iron", "block")
    yield _folded_cloth("curtain", -width / 2, -0.05, height - 0.05, 0.01, 6, 0.04)


def cafe(width: float = 1.3, height: float = 0.75) -> Iterator[Solid]:
    """Build short curtains on a rod across the lower half of a window."""
    yield from _pole(width, height - 0.02, "brass", "ball")
    for s in (-1, 1):
        yield _folded_cloth(
            "curtain", min(s * 0.03, s * width / 2), max(s * 0.03, s * width / 2), height - 0.04, 0.0, 6, 0.022
        )


def valance(width: float = 1.7, height: float = 1.6) -> Iterator[Solid]:
    """Build a box with a scalloped cloth above short curtains."""
    yield rounded_box("wood", (width + 0.1, 0.05, 0.16), (0.0, height - 0.05, -0.01), 0.008, 1)
    t = np.linspace(-1, 1, 41)
    edge = [(x * (width / 2 + 0.03), height - 0.26 - 0.07 * abs(np.sin(2.5 * np.pi * x))) for x in t]
    yield prism(
        "curtain_1",
        [(width / 2 + 0.03, height - 0.05), (-width / 2 - 0.03, height - 0.05), *edge],
        0.02,
        (0.0, 0.0, 0.05),
    )
    for s in (-1, 1):
        inner, outer = s * width * 0.26, s * width / 2
        yield _folded_cloth("curtain", min(inner, outer), max(inner, outer), height - 0.08, 0.0, 5, 0.03)


def roman(width: float = 1.2, height: float = 1.5, drawn: float = 0.55) -> Iterator[Solid]:
    """Build a Roman blind that folds up in broad pleats."""
    yield rounded_box("wood", (width, 0.04, 0.05), (0.0, height - 0.04, 0.0), 0.006, 1)
    low, folds = height * (1 - drawn), 4
    yield surface(
        "curtain",
        lambda u, v: ((u - 0.5) * width, height - 0.03 - v * (height - low - 0.1), 0.012 + 0.006 * np.sin(8 * v)),
        2,
        8,
        0.006,
    )
    for i in range(folds):
        path = [(-width / 2, low + 0.05 * i, 0.02 + 0.012 * i), (width / 2, low + 0.05 * i, 0.02 + 0.012 * i)]
        yield tube("curtain", path, 0.035, 10)
    yield rod("cream", (width / 2 - 0.05, low - 0.25, 0.04), (width / 2 - 0.05, height - 0.05, 0.02), 0.003, sides=5)


def roller(width: float = 1.1, height: float = 1.5, drawn: float = 0.6) -> Iterator[Solid]:
    """Build a roller blind."""
    yield tube("white", [(-width / 2, height - 0.04, 0.0), (width / 2, height - 0.04, 0.0)], 0.035, 14)
    low = height * (1 - drawn)
    yield surface(
        "curtain",
        lambda u, v: ((u - 0.5) * (width - 0.04), height - 0.04 - v * (height - 0.04 - low), -0.03 + 0 * u),
        2,
        4,
        0.003,
    )
    yield rounded_box("wood", (width - 0.04, 0.03, 0.014), (0.0, low - 0.02, -0.03), 0.005, 1)
    for s in (-1, 1):
        yield rounded_box("white", (0.015, 0.09, 0.09), (s * (width / 2 + 0.008), height - 0.085, -0.01), 0.006, 1)
    yield rod("cream", (width / 2 - 0.02, low + 0.1, 0.03), (width / 2 - 0.02, height - 0.05, 0.03), 0.003, sides=5)


def slats(width: float = 1.2, height: float = 1.5, upright: bool = False) -> Iterator[Solid]:
    """Build a Venetian blind, or vertical slats on a rail."""
    yield rounded_box("white", (width, 0.05, 0.06), (0.0, height - 0.05, 0.0), 0.008, 1)
    if upright:
        count = int(width / 0.09)
        for i in range(count):
            x = (i + 0.5) / count * width - width / 2
            yield rotate(box("sheer", (0.085, height - 0.07, 0.003), (x, 0.02, 0.0)), 1, 0.6, (x, 0.0, 0.0))
    else:
        for i in range(int((height - 0.1) / 0.045)):
            y = 0.04 + 0.045 * i
            yield rotate(box("white", (width - 0.02, 0.003, 0.045), (0.0, y, 0.0)), 0, 0.5, (0.0, y, 0.0))
        yield rounded_box("white", (width - 0.02, 0.02, 0.05), (0.0, 0.0, 0.0), 0.006, 1)
        for x in (-0.35 * width, 0.35 * width):
            yield rod("white", (x, 0.01, 0.024), (x, height - 0.03, 0.024), 0.002, sides=4)
    yield rod("white", (0.45 * width, 0.5 * height, 0.04), (0.45 * width, height - 0.03, 0.04), 0.004, sides=5)


CURTAINS = (
    design(drapes), design(drapes, tied=True), design(drapes, sheers=True), design(cafe), design(valance),
    design(roman), design(roller), design(slats), design(slats, upright=True, width=1.8, height=2.2),
    design(drapes, width=1.4, open_=0.22), design(drapes, width=2.6, sheers=True, open_=0.2),
    design(roman, width=0.8, height=0.9, drawn=0.45), design(portiere),
)  # fmt: skip


FAMILIES = (FurnitureFamily("curtain", "curtain", CURTAINS),)
