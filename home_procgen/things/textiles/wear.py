"""Shoes and clothes."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import padded_block
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import prism, rod, sweep, tube
from home_procgen.shapes.transforms import rotate_pieces, translate
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.textiles.footwear import SOLE, ballerinas, clogs, high_tops, rain_boots, sandals


def shoe(slot: str = "leather", kind: str = "low") -> Iterator[Solid]:
    """Build one shoe, 0.27 m long with its toe towards +z."""
    yield prism(
        "white" if kind == "trainer" else "rubber", SOLE, 0.026 if kind == "trainer" else 0.014, (0.0, 0.0, 0.0), "top"
    )
    path = [
        (0.0, 0.03, 0.125),
        (0.0, 0.035, 0.08),
        (0.0, 0.045, 0.03),
        (0.0, 0.06, -0.03),
        (0.0, 0.06, -0.08),
        (0.0, 0.05, -0.118),
    ]
    section = np.array([[-0.9, -0.6], [0.9, -0.6], [1.0, 0.0], [0.6, 0.8], [-0.6, 0.8], [-1.0, 0.0]])
    yield sweep(slot, path, section * 0.042, [0.4, 0.75, 0.95, 1.0, 0.95, 0.55], up=(0.0, 1.0, 0.0))
    if kind == "boot":
        yield tube(slot, [(0.0, 0.05, -0.07), (0.0, 0.16, -0.075), (0.0, 0.27, -0.07)], [0.045, 0.046, 0.055], 12)
    elif kind == "trainer":
        for z in (-0.005, 0.02, 0.045):
            yield rod("white", (-0.025, 0.09 - 0.35 * z, z), (0.025, 0.09 - 0.35 * z, z), 0.005, sides=6)
    elif kind == "heel":
        yield rod("rubber", (0.0, 0.0, -0.11), (0.0, 0.05, -0.105), 0.007, 0.018)


def pair(kind: str = "low", slot: str = "leather", astray: float = 0.0) -> Iterator[Solid]:
    """Build two shoes side by side, one turned by `astray` [rad]."""
    for s in (-1, 1):
        one = rotate_pieces(shoe(slot, kind), 1, astray * (s > 0) + 0.06 * s)
        yield from (
            p
            for p in translate(one, s * (0.06 + 0.02 * abs(astray)), 0.0, 0.05 * astray * (s > 0))
            if isinstance(p, Solid)
        )


def slippers() -> Iterator[Solid]:
    """Build soft open slippers."""
    for s in (-1, 1):
        sole = prism("textile", SOLE, 0.02, (s * 0.06, 0.0, 0.0), "top")
        yield sole
        yield surface(
            "fur",
            lambda u, v, s=s: (
                s * 0.06 + 0.043 * np.cos(np.pi * u),
                0.02 + 0.055 * np.sin(np.pi * u),
                0.02 + 0.11 * v - 0.02 * np.sin(np.pi * u),
            ),
            10,
            4,
            0.008,
        )


def flip_flops() -> Iterator[Solid]:
    """Build sandals with two straps."""
    for s in (-1, 1):
        yield prism("bright", SOLE, 0.016, (s * 0.06, 0.0, 0.0), "top")
        for k in (-1, 1):
            yield tube(
                "white",
                fillet(
                    [
                        (s * 0.06, 0.014, 0.075),
                        (s * 0.06 + 0.015 * k, 0.05, 0.03),
                        (s * 0.06 + 0.036 * k, 0.012, -0.02),
                    ],
                    0.03,
                ),
                0.005,
                6,
            )


def folded(count: int = 3) -> Iterator[Solid]:
    """Build a pile of folded clothes."""
    for i in range(count):
        yield padded_block(
            f"textile_{i}", (0.32 - 0.01 * (i % 2), 0.05, 0.26), (0.005 * (i % 2), 0.045 * i, 0.0), 5.0, 5
        )


def heap() -> Iterator[Solid]:
    """Build a crumpled garment on the floor."""
    rng = np.random.default_rng(3)
    shift = rng.uniform(0, 6.28, (4, 2))

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        x, z = (u - 0.5) * 0.5, (v - 0.5) * 0.45
        rise = 0.07 * np.exp(-((x / 0.16) ** 2) - (z / 0.14) ** 2)
        for k, (a, b) in enumerate(shift):
            rise = rise + 0.012 * np.abs(np.sin((14 + 5 * k) * x + a) * np.sin((12 + 4 * k) * z + b))
        edge = 1 + 0.12 * np.sin(9 * u + 3) * np.sin(8 * v)
        return x * edge, 0.012 + rise, z * edge

    yield surface("textile", place, 22, 20, 0.008)


SHOES = (
    design(pair), design(pair, kind="boot"), design(pair, kind="trainer", slot="textile"), design(slippers),
    design(flip_flops), design(pair, kind="heel", slot="bright"),
    design(pair, kind="trainer", slot="bright", astray=0.7), design(pair, astray=-0.5),
    design(rain_boots), design(clogs), design(ballerinas), design(high_tops), design(sandals),
)  # fmt: skip


FAMILIES = (
    FurnitureFamily("shoes", "shoes", SHOES),
    FurnitureFamily("cloth", "cloth", (design(folded), design(heap), design(folded, count=5))),
)
