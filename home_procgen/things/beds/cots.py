"""Cots for babies."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design


def crib(width: float = 0.66, length: float = 1.26, kind: str = "bars") -> Iterator[Solid]:
    """Build a cot with barred sides and flat or sleigh-shaped ends."""
    x, z, high = width / 2, length / 2, 0.92
    for sx in (-x, x):
        for y in (0.24, high - 0.06):
            yield beam("wood", (sx, y, -z), (sx, y, z), 0.03, 0.05)
        count = 15
        for i in range(count):
            yield rod(
                "wood",
                (sx, 0.24, (i - (count - 1) / 2) * length / count),
                (sx, high - 0.06, (i - (count - 1) / 2) * length / count),
                0.008,
                sides=6,
            )
    for s in (-1, 1):
        if kind == "bars":
            for sx in (-x, x):
                yield beam("wood", (sx, 0.0, s * z), (sx, high, s * z), 0.045)
            yield rounded_box("wood", (width, 0.62, 0.022), (0.0, 0.24, s * z), 0.008, 1)
        else:
            curve = fillet([(s * z, 0.0), (s * z, 0.7), (s * (z + 0.12), 1.02)], 0.3, 5)
            outline = np.concatenate([curve + np.array([0.016, 0.0]), (curve - np.array([0.016, 0.0]))[::-1]])
            yield prism("wood", outline, width + 0.04, (0.0, 0.0, 0.0), "side")
    yield box("wood", (width - 0.02, 0.02, length - 0.02), (0.0, 0.32, 0.0))
    yield rounded_box("linen", (width - 0.05, 0.12, length - 0.05), (0.0, 0.34, 0.0), 0.03, 2)
    yield padded_block("linen_2", (width - 0.1, 0.06, 0.6), (0.0, 0.45, 0.22), 6.0, 6)
    yield ball("fur_coat", (0.06, 0.07, 0.05), (0.1, 0.53, -0.35), 12, 8)
    yield ball("fur_coat", 0.045, (0.1, 0.62, -0.35), 12, 8)


def cradle() -> Iterator[Solid]:
    """Build a basket cradle on rockers with a hood."""

    def side(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = 2 * np.pi * u * 0.998
        return (0.2 + 0.06 * v) * np.cos(angle), 0.24 + 0.3 * v, (0.38 + 0.07 * v) * np.sin(angle)

    yield surface("cane", side, 32, 3, 0.02)
    yield prism(
        "wood",
        np.asarray([(0.2 * np.cos(a), 0.38 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 24, endpoint=False)]),
        0.02,
        (0.0, 0.24, 0.0),
        "top",
    )
    yield padded_block("linen", (0.36, 0.1, 0.7), (0.0, 0.26, 0.0), 3.0, 6)
    yield padded_block("linen_2", (0.4, 0.06, 0.45), (0.0, 0.34, 0.14), 3.0, 5)
    yield surface(
        "textile",
        lambda u, v: (
            0.265 * np.cos(np.pi * u),
            0.54 + 0.26 * np.sin(np.pi * u) * np.cos(0.9 * v),
            -0.45 + 0.36 * v + 0.06 * np.sin(np.pi * u),
        ),
        12,
        5,
        0.012,
    )
    for z in (-0.26, 0.26):
        yield tube("wood", [(x, 0.02 + 0.35 * x**2, z) for x in np.linspace(-0.34, 0.34, 11)], 0.016)
        for s in (-1, 1):
            yield rod("wood", (s * 0.2, 0.035, z), (s * 0.16, 0.25, z), 0.013)


COTS = (design(crib), design(crib, kind="sleigh"), design(cradle), design(crib, width=0.72, length=1.4))


FAMILIES = (FurnitureFamily("baby_bed", "baby_bed", COTS),)
