"""Garden seats."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import padded_block, pillow, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, rod, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import corners, roller
from home_procgen.things.seats.sofas import upright_pillow


def park_bench(width: float = 1.5) -> Iterator[Solid]:
    """Build a board bench with cast-iron ends."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.1)
        side = [(0.26, 0.0), (0.2, 0.4), (-0.2, 0.42), (-0.36, 0.84)]
        yield tube("iron", fillet([(x, y, z) for z, y in side], 0.08), 0.02)
        yield tube(
            "iron",
            fillet([(x, 0.0, -0.28), (x, 0.42, -0.18), (x, 0.62, -0.24), (x, 0.62, 0.22), (x, 0.4, 0.2)], 0.06),
            0.018,
        )
    for z in (-0.14, -0.03, 0.08, 0.19):
        yield rounded_box("wood", (width, 0.03, 0.09), (0.0, 0.43, z), 0.01, 1)
    for y in (0.54, 0.66, 0.78):
        yield beam(
            "wood",
            (-width / 2, y, -0.225 - 0.38 * (y - 0.46)),
            (width / 2, y, -0.225 - 0.38 * (y - 0.46)),
            0.026,
            0.085,
        )


def adirondack(width: float = 0.74) -> Iterator[Solid]:
    """Build a garden chair of broad boards with a fanned back."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.06)
        yield beam("wood", (x, 0.36, 0.3), (x, 0.04, -0.5), 0.03, 0.1)
        yield beam("wood", (x, 0.0, 0.3), (x, 0.55, 0.3), 0.03, 0.1)
        yield rounded_box("wood", (0.13, 0.025, 0.74), (s * (width / 2 - 0.04), 0.55, -0.02), 0.01, 1)
    for i in range(6):
        y, z = 0.39 - 0.05 * i, 0.26 - 0.1 * i
        yield beam("wood", (-width / 2 + 0.05, y, z), (width / 2 - 0.05, y, z), 0.09, 0.02)
    for i in range(5):
        x = (i - 2) * 0.105
        top = 1.0 - 0.035 * (i - 2) ** 2
        yield beam("wood", (x, 0.2, -0.24), (1.25 * x, top, -0.6), 0.092, 0.02)
    yield beam("wood", (-0.32, 0.56, -0.42), (0.32, 0.56, -0.42), 0.03, 0.06)


def wicker_chair(seats: int = 1) -> Iterator[Solid]:
    """Build a woven tub with a cushion; two seats make a loveseat."""
    width = 0.3 + 0.5 * seats

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (0.9 + 1.2 * u)
        x = np.sign(np.cos(angle)) * np.abs(np.cos(angle)) ** 0.6
        return (
            width / 2 * x * (1 + 0.06 * v),
            0.02 + v * (0.58 + 0.22 * np.sin(np.pi * u) ** 2),
            0.36 * np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** 0.6 * (1 + 0.06 * v),
        )

    yield surface("cane", place, 26, 4, 0.045)
    yield box("cane", (width - 0.1, 0.3, 0.62), (0.0, 0.02, 0.03))
    for i in range(seats):
        x = (i - (seats - 1) / 2) * 0.52
        yield padded_block("textile", (0.5 + 0.1 * (seats == 1), 0.12, 0.6), (x, 0.31, 0.04), 6.0, 5)
        yield upright_pillow("textile_1", (0.46, 0.42, 0.14), (x, 0.42, -0.2), 0.3)


def sunbed(width: float = 0.66) -> Iterator[Solid]:
    """Build a slatted lounger with a raised back, a mat and wheels."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.02)
        yield beam("wood", (x, 0.3, -0.45), (x, 0.3, 0.98), 0.035, 0.06)
        yield beam("wood", (x, 0.31, -0.42), (x, 0.68, -0.98), 0.03, 0.05)
        yield beam("wood", (x, 0.0, 0.85), (x, 0.3, 0.85), 0.05)
        yield _wheel(x + s * 0.03)
    for z in np.linspace(-0.4, 0.95, 14):
        yield beam("wood", (-width / 2, 0.335, float(z)), (width / 2, 0.335, float(z)), 0.06, 0.014)
    yield rounded_box("textile", (width - 0.04, 0.06, 1.4), (0.0, 0.34, 0.27), 0.025, 2)
    yield rotate(
        rounded_box("textile", (width - 0.04, 0.06, 0.7), (0.0, 0.34, -0.77), 0.025, 2), 0, 0.58, (0.0, 0.34, -0.42)
    )
    yield rotate(pillow("textile", (0.5, 0.1, 0.24), (0.0, 0.39, -0.98)), 0, 0.58, (0.0, 0.34, -0.42))


def _wheel(x: float) -> Solid:
    return roller("rubber", 0.13, 0.03, (x, 0.13, -0.4), 18)


def swing(width: float = 1.5) -> Iterator[Solid]:
    """Build a swing bench that hangs from a frame with a canopy."""
    for s in (-1, 1):
        x = s * (width / 2 + 0.15)
        yield rod("iron", (x, 0.0, 0.55), (x, 1.8, 0.0), 0.025)
        yield rod("iron", (x, 0.0, -0.55), (x, 1.8, 0.0), 0.025)
        yield rod("iron", (s * width / 2, 0.58, 0.2), (s * width / 2, 1.78, 0.0), 0.008, sides=6)
        yield rod("iron", (s * width / 2, 0.9, -0.28), (s * width / 2, 1.78, 0.0), 0.008, sides=6)
    yield rod("iron", (-width / 2 - 0.2, 1.8, 0.0), (width / 2 + 0.2, 1.8, 0.0), 0.03)
    yield rounded_box("wood", (width, 0.04, 0.54), (0.0, 0.44, 0.0), 0.01, 1)
    yield padded_block("textile", (width - 0.04, 0.1, 0.52), (0.0, 0.47, 0.01), 14.0, 6)
    yield rotate(
        padded_block("textile", (width - 0.04, 0.46, 0.1), (0.0, 0.48, -0.25), 14.0, 6), 0, -0.2, (0.0, 0.48, -0.25)
    )
    yield surface(
        "textile_1",
        lambda u, v: ((u - 0.5) * (width + 0.4), 1.82 + 0.1 * np.sin(np.pi * v), (v - 0.5) * 1.1),
        4,
        8,
        0.02,
    )


def picnic_table(width: float = 1.7) -> Iterator[Solid]:
    """Build a picnic table with two attached benches."""
    for x in (-0.6, 0.6):
        for s in (-1, 1):
            yield beam("wood", (x, 0.0, s * 0.62), (x, 0.72, s * 0.25), 0.04, 0.1)
        yield beam("wood", (x + 0.045, 0.42, -0.78), (x + 0.045, 0.42, 0.78), 0.04, 0.09)
        yield beam("wood", (x + 0.045, 0.69, -0.36), (x + 0.045, 0.69, 0.36), 0.04, 0.08)
    for i in range(5):
        yield rounded_box("wood", (width, 0.035, 0.14), (0.0, 0.73, (i - 2) * 0.15), 0.01, 1)
    for s in (-1, 1):
        for z in (0.63, 0.77):
            yield rounded_box("wood", (width, 0.035, 0.13), (0.0, 0.465, s * z), 0.01, 1)


def plastic_chair() -> Iterator[Solid]:
    """Build a stackable one-piece garden chair with slots in its back."""
    for x, z in corners(0.46, 0.44):
        yield beam("white", (1.12 * x, 0.0, 1.15 * z), (x, 0.62 if z > 0 else 0.44, z), 0.05, 0.035)
    yield surface(
        "white",
        lambda u, v: ((u - 0.5) * 0.46, 0.43 - 0.03 * np.sin(np.pi * u) - 0.02 * (1 - v), (v - 0.5) * 0.46),
        6,
        6,
        0.014,
    )
    for i in range(6):
        x = (i - 2.5) * 0.075
        yield beam("white", (x, 0.42, -0.22), (1.1 * x, 0.82 - 0.8 * x**2, -0.3), 0.05, 0.012)
    yield tube(
        "white",
        [(-0.23, 0.6, -0.24), (-0.22, 0.8, -0.3), (0.0, 0.86, -0.32), (0.22, 0.8, -0.3), (0.23, 0.6, -0.24)],
        0.022,
    )
    yield from add_mirror_images(
        [tube("white", fillet([(0.24, 0.64, 0.2), (0.27, 0.65, 0.0), (0.23, 0.62, -0.24)], 0.08), 0.024)]
    )


GARDEN = (
    design(adirondack), design(wicker_chair), design(wicker_chair, seats=2), design(sunbed), design(swing),
    design(picnic_table), design(plastic_chair), design(park_bench, width=1.3),
)  # fmt: skip


FAMILIES = (FurnitureFamily("outdoor_seating", "outdoor_seating", GARDEN),)
