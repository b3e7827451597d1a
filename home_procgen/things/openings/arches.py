"""Garage doors and arches."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.openings.leaves import FRAME_DEPTH


def garage(width: float = 2.5, height: float = 2.15, lift: float = 1.0, style: str = "panels") -> Iterator[Solid]:
    """Build a frame and a sectional door; `lift` 0 is closed, 1 is open and flat below the ceiling, towards -z."""
    for s in (-1, 1):
        yield box("white", (0.06, height, FRAME_DEPTH), (s * (width - 0.06) / 2, 0.0, 0.0))
    yield box("white", (width - 0.12, 0.06, FRAME_DEPTH), (0.0, height - 0.06, 0.0))
    pivot = (0.0, height - 0.1, -0.08)
    for piece in _sections(width - 0.14, height - 0.12, style):
        yield rotate(piece, 0, lift * np.pi / 2, pivot)


def _sections(width: float, height: float, style: str) -> Iterator[Solid]:
    """Build four rows of panels; style "glass" glazes the third."""
    high = height / 4
    for i in range(4):
        y = 0.01 + i * high
        yield rounded_box("paint", (width, high - 0.006, 0.035), (0.0, y, -0.05), 0.006, 1)
        for k in range(4):
            x, glazed = (k - 1.5) * width / 4, style == "glass" and i == 2
            slot = "glass" if glazed else "paint"
            yield rounded_box(slot, (width / 4 - 0.12, high - 0.16, 0.047), (x, y + 0.08, -0.05), 0.006, 1)
    yield rounded_box("black", (0.16, 0.03, 0.03), (0.0, 0.5, -0.02), 0.01, 1)


def arch(width: float = 1.2, height: float = 2.2, kind: str = "round") -> Iterator[Solid]:
    """Build a lined opening without a door: a round arch, or a square head on pilasters."""
    post = 0.09
    for s in (-1, 1):
        yield rounded_box(
            "white",
            (post, height - 0.02 if kind == "square" else height - width / 2, 0.16),
            (s * (width - post) / 2, 0.0, 0.0),
            0.01,
            1,
        )
        yield rounded_box("white", (post + 0.02, 0.14, 0.18), (s * (width - post) / 2, 0.0, 0.0), 0.008, 1)
    if kind == "square":
        yield rounded_box("white", (width, 0.12, 0.16), (0.0, height - 0.12, 0.0), 0.01, 1)
        yield rounded_box("white", (width + 0.04, 0.04, 0.19), (0.0, height - 0.03, 0.0), 0.01, 1)
    else:
        spring = height - width / 2
        outer = [(width / 2 * np.cos(a), spring + (width / 2) * np.sin(a)) for a in np.linspace(0, np.pi, 21)]
        inner = [
            ((width / 2 - post) * np.cos(a), spring + (width / 2 - post) * np.sin(a)) for a in np.linspace(np.pi, 0, 21)
        ]
        yield prism("white", [*outer, *inner], 0.16)
        for s in (-1, 1):
            corner = [
                (s * width / 2, spring),
                *[(s * width / 2 * np.cos(a), spring + width / 2 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 11)],
                (s * width / 2, height),
            ]
            yield prism("white", corner, 0.12)


FAMILIES = (
    FurnitureFamily(
        "garage_door", "garage_door", (design(garage), design(garage, style="glass", width=2.6)), {"lift": 0.0}, False
    ),
    FurnitureFamily("arch", "arch", (design(arch), design(arch, kind="square")), None, False),
)
