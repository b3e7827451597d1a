"""Nightstands."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import MovablePart, Solid, box, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, corners, disc, drawers, legs
from home_procgen.things.movable_parts import QUARTER_TURN, assign_part
from home_procgen.things.storage.dressers import dresser


def nightstand(
    width: float = 0.46,
    height: float = 0.55,
    depth: float = 0.4,
    rows: int = 2,
    style: str = "flat",
    kind: str = "taper",
    grip: tuple = ("brass", "knob"),
    foot: float = 0.14,
) -> Iterator[Solid]:
    """Build a small chest of drawers."""
    yield from dresser(width, height, depth, 1, rows, style, kind, grip, False, foot)


def open_stand(
    width: float = 0.45, height: float = 0.55, depth: float = 0.38, kind: LegKind = "square"
) -> Iterator[Solid]:
    """Build a drawer above an open shelf with books."""
    yield from legs("wood", width, depth, height - 0.02, kind, 0.04)
    yield rounded_box("wood", (width + 0.02, 0.022, depth + 0.02), (0.0, height - 0.022, 0.0), 0.007, 1)
    yield box("wood", (width - 0.03, 0.14, depth - 0.04), (0.0, height - 0.165, -0.01))
    yield from drawers(
        "wood_1",
        width - 0.09,
        0.13,
        (0.045 - width / 2, height - 0.16, depth / 2 - 0.03),
        1,
        1,
        "flat",
        ("brass", "knob"),
        opens=0.24,
    )
    yield box("wood", (width - 0.03, 0.018, depth - 0.03), (0.0, 0.14, 0.0))
    yield rounded_box("cover_1", (0.2, 0.03, 0.27), (-0.04, 0.158, 0.0), 0.004, 1)
    yield rounded_box("cover_2", (0.18, 0.024, 0.24), (-0.03, 0.188, 0.0), 0.004, 1)


def round_stand(radius: float = 0.22, height: float = 0.55) -> Iterator[Solid]:
    """Build a cylindrical nightstand with a curved door."""
    yield cylinder("black", radius - 0.03, 0.05, sides=24)
    yield cylinder("wood", radius, height - 0.08, (0.0, 0.05, 0.0), sides=32)
    yield revolve(
        "marble",
        [(radius, 0.0), (radius + 0.012, 0.008), (radius + 0.012, 0.022), (radius, 0.03)],
        (0.0, height - 0.03, 0.0),
        32,
        1,
    )
    staves = []
    for i in range(17):
        a = np.pi * (0.5 + 0.055 * (i - 8))
        x, z = radius * np.cos(a), radius * np.sin(a)
        staves.append(rod("wood_1", (x, 0.07, z), (x, height - 0.05, z), 0.012, sides=6))
    grip = rod("brass", (0.03, 0.3, radius + 0.02), (0.03, 0.42, radius + 0.02), 0.006)
    hinge = (float(x), 0.07, float(z))  # [m], at the last stave, the leftmost one
    yield from assign_part(MovablePart("door", "hinge", (0.0, -1.0, 0.0), hinge, QUARTER_TURN), [*staves, grip])


def crate_stand() -> Iterator[Solid]:
    """Build two stacked slatted crates with a book in the lower one."""
    for k in range(2):
        for s in (-1, 1):
            for i in range(3):
                yield (
                    box("wood", (0.42, 0.065, 0.014), (0.0, 0.01 + 0.28 * k + 0.085 * i, 0.0 + s * 0.16))
                    if s < 0
                    else box("wood", (0.014, 0.065, 0.32), (0.2, 0.01 + 0.28 * k + 0.085 * i, 0.0))
                )
            yield box("wood", (0.42, 0.014, 0.33), (0.0, 0.28 * k + 0.262 * (s + 1) / 2, 0.0))
        for i in range(3):
            yield box("wood", (0.014, 0.065, 0.32), (-0.2, 0.01 + 0.28 * k + 0.085 * i, 0.0))
        for x, z in corners(0.38, 0.28):
            yield box("wood_1", (0.03, 0.26, 0.03), (x, 0.01 + 0.28 * k, z))
    yield rounded_box("cover_1", (0.2, 0.035, 0.26), (0.0, 0.014, 0.0), 0.004, 1)


def barley(width: float = 0.42) -> Iterator[Solid]:
    """Build a tripod stand with a drawer in a round top."""
    yield cylinder("wood", 0.21, 0.11, (0.0, 0.44, 0.0), sides=28)
    yield revolve("wood", [(0.22, 0.0), (0.235, 0.012), (0.22, 0.024)], (0.0, 0.55, 0.0), 28, 1)
    yield disc("brass", 0.014, 0.03, (0.0, 0.495, 0.2), 10)
    for i in range(3):
        a = 2 * np.pi * i / 3 + 0.5
        yield tube(
            "wood",
            [
                (0.2 * np.cos(a), 0.01, 0.2 * np.sin(a)),
                (0.12 * np.cos(a), 0.2, 0.12 * np.sin(a)),
                (0.16 * np.cos(a), 0.45, 0.16 * np.sin(a)),
            ],
            [0.013, 0.016, 0.022],
        )


def floating(width: float = 0.48) -> Iterator[Solid]:
    """Build a drawer box on a wall bracket post."""
    yield rounded_box("wood", (width, 0.2, 0.34), (0.0, 0.34, 0.0), 0.012, 2)
    yield from drawers(
        "wood_1", width - 0.03, 0.16, (0.015 - width / 2, 0.36, 0.165), 1, 1, "flat", ("black", "slot"), opens=0.24
    )
    yield rounded_box("wood", (0.12, 0.36, 0.06), (0.0, 0.0, -0.13), 0.01, 1)
    yield rounded_box("wood", (0.34, 0.02, 0.3), (0.0, 0.0, -0.02), 0.008, 1)


STANDS = (
    design(nightstand), design(open_stand), design(round_stand), design(crate_stand), design(barley),
    design(floating),
    design(nightstand, style="raised", kind="cabriole", grip=("brass", "ring"), rows=1, height=0.58, foot=0.3),
    design(nightstand, style="cane", kind="splay", rows=1, width=0.5, foot=0.22),
    design(nightstand, kind="plinth", rows=3, grip=("black", "slot")), design(open_stand, kind="turned", height=0.62),
    design(nightstand, style="slats", kind="sled", rows=2),
)  # fmt: skip


FAMILIES = (FurnitureFamily("nightstand", "stand", STANDS),)
