"""Cushions."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, rotate
from home_procgen.shapes.rounded import ball, join_loops, pillow
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design


def _square() -> Iterator[Solid]:
    yield pillow("patterned", (0.45, 0.15, 0.45), steps=10)


def _oblong() -> Iterator[Solid]:
    yield pillow("patterned", (0.6, 0.15, 0.36), steps=10)
    for s in (-1, 1):
        for i in range(9):
            yield rod("cream", (s * 0.29, 0.075, (i - 4) * 0.035), (s * 0.33, 0.07, (i - 4) * 0.035), 0.004, sides=5)


def _roll() -> Iterator[Solid]:
    yield tube(
        "textile",
        [(-0.3, 0.09, 0.0), (-0.28, 0.09, 0.0), (0.28, 0.09, 0.0), (0.3, 0.09, 0.0)],
        [0.07, 0.09, 0.09, 0.07],
        20,
    )
    for s in (-1, 1):
        yield ball("brass", 0.018, (s * 0.305, 0.09, 0.0), 10, 6)


def _ball() -> Iterator[Solid]:
    yield ball("textile", (0.17, 0.15, 0.17), (0.0, 0.15, 0.0), 20, 12)
    yield ball("brass", (0.02, 0.008, 0.02), (0.0, 0.3, 0.0), 10, 6)


def _heart() -> Iterator[Solid]:
    t = np.linspace(0, 2 * np.pi, 33)[:-1]
    outline = (
        np.stack([16 * np.sin(t) ** 3, -(13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t))], -1)
        * 0.0135
    )
    bulge = ((0.0, 0.7), (0.012, 0.88), (0.04, 1.0), (0.08, 1.0), (0.108, 0.88), (0.12, 0.7))
    yield join_loops("bright", [np.insert(outline * size, 1, y, axis=1) for y, size in bulge])


def _pile() -> Iterator[Solid]:
    yield pillow("patterned", (0.5, 0.15, 0.5), steps=8)
    yield rotate(pillow("patterned_1", (0.44, 0.14, 0.44), (0.0, 0.125, 0.0), 8), 1, 0.5)


_CUSHION_KINDS = {
    "square": _square,
    "oblong": _oblong,
    "roll": _roll,
    "ball": _ball,
    "heart": _heart,
    "pile": _pile,
}


def cushion(kind: str = "square") -> Iterator[Solid]:
    """Build loose pillows: square, oblong, a roll, a ball, a heart or a pile."""
    yield from _CUSHION_KINDS[kind]()


PILLOWS = tuple(design(cushion, kind=kind) for kind in ("square", "oblong", "roll", "ball", "heart", "pile"))


FAMILIES = (FurnitureFamily("pillow", "pillow", PILLOWS),)
