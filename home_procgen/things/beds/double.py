"""Double beds."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam
from home_procgen.things.beds.bedding import MATTRESS_LENGTH, Cover, bedding, rails
from home_procgen.things.beds.frames import futon_floor, iron, platform, sleigh, upholstered
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import drawers


def four_poster(width: float = 1.7, cover: Cover = "made", pillows: int = 2, canopy: bool = True) -> Iterator[Solid]:
    """Build a four-poster bed with bedding and rails above; `canopy` adds drapes at the head."""
    yield from rails(width, 0.26, 0.42)
    x, z = width / 2 + 0.02, MATTRESS_LENGTH / 2 + 0.02
    for sx in (-x, x):
        for sz in (-z, z):
            shape = [(0.045, 0.0), (0.05, 0.45), (0.028, 0.55), (0.04, 0.9), (0.028, 1.5), (0.03, 2.02)]
            yield revolve("wood", shape, (sx, 0.0, sz), 12, 2)
    for s in (-1, 1):
        yield beam("wood", (s * x, 2.04, -z), (s * x, 2.04, z), 0.05)
        yield beam("wood", (-x, 2.04, s * z), (x, 2.04, s * z), 0.05)
    yield rounded_box("wood", (width, 0.7, 0.04), (0.0, 0.42, -z), 0.01, 1)
    yield from bedding(width, MATTRESS_LENGTH, 0.37, cover, pillows)
    if canopy:
        for s in (-1, 1):
            yield surface(
                "sheer",
                lambda u, v, s=s: (s * (x - 0.02 - 0.01 * np.cos(36 * u)), 0.06 + 1.95 * v, -z + 0.03 + 0.4 * u),
                36,
                2,
                0.008,
            )


def storage_bed(width: float = 1.6, cover: Cover = "rumpled", pillows: int = 2) -> Iterator[Solid]:
    """Build a box bed with bedding, drawers on both sides, and shelves with books in its headboard."""
    yield rounded_box("wood", (width + 0.06, 0.36, MATTRESS_LENGTH + 0.06), (0.0, 0.02, 0.0), 0.01, 1)
    yield box("black", (width - 0.1, 0.03, MATTRESS_LENGTH - 0.1))
    yield from (
        rotate(p, 1, np.pi / 2)
        for p in drawers("wood_1", 1.5, 0.28, (-0.75, 0.06, width / 2 + 0.03), 2, 1, "flat", ("chrome", "bar"))
    )
    yield from (
        rotate(p, 1, -np.pi / 2)
        for p in drawers("wood_1", 1.5, 0.28, (-0.75, 0.06, width / 2 + 0.03), 2, 1, "flat", ("chrome", "bar"))
    )
    z = -MATTRESS_LENGTH / 2 - 0.13
    for y in (0.02, 0.6, 1.0):
        yield box("wood", (width + 0.06, 0.025, 0.22), (0.0, y, z))
    for x in (-0.5, 0.0, 0.5):
        yield box("wood", (0.025, 1.0, 0.22), (x * (width + 0.03), 0.02, z))
    yield box("wood_1", (width + 0.04, 1.0, 0.015), (0.0, 0.02, z - 0.1))
    for i in range(6):
        yield box(f"cover_{i + 1}", (0.03, 0.22, 0.15), (-0.6 + 0.034 * i, 0.625, z + 0.01))
    yield from bedding(width, MATTRESS_LENGTH, 0.36, cover, pillows)


def round_bed(radius: float = 1.05) -> Iterator[Solid]:
    """Build a round mattress in a padded ring with a curved back."""
    yield cylinder("black", radius - 0.1, 0.08, sides=36)
    yield revolve(
        "upholstery", [(radius - 0.04, 0.06), (radius, 0.1), (radius, 0.26), (radius - 0.04, 0.3)], sides=40, steps=1
    )
    yield revolve(
        "linen",
        [(radius - 0.08, 0.28), (radius - 0.05, 0.34), (radius - 0.05, 0.42), (radius - 0.1, 0.46)],
        sides=40,
        steps=1,
    )

    def back(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (1.2 + 0.6 * u)
        return radius * np.cos(angle), 0.1 + (0.75 + 0.1 * np.sin(np.pi * u)) * v, radius * np.sin(angle)

    yield surface("upholstery", back, 24, 5, 0.12)
    yield revolve(
        "linen_2",
        [(radius * 0.9, 0.45), (radius * 0.93, 0.48), (radius * 0.5, 0.5), (0.1, 0.51)],
        (0.0, 0.0, 0.06),
        36,
        2,
    )
    for x in (-0.36, 0.36):
        yield padded_block("linen_1", (0.6, 0.16, 0.4), (x, 0.48, -0.6), 3.0, 6)


DOUBLE = (
    design(platform), design(upholstered), design(sleigh), design(iron), design(four_poster), design(storage_bed),
    design(upholstered, head="channels", cover="throw"),
    design(platform, head="slats", kind="block", cover="rumpled"),
    design(platform, head="cane", kind="splay", cover="aside", width=1.5), design(round_bed), design(futon_floor),
    design(upholstered, head="wings", cover="aside", width=1.8), design(upholstered, cover="rumpled", width=1.4),
)  # fmt: skip


FAMILIES = (FurnitureFamily("double_bed", "double_bed", DOUBLE),)
