"""Ottomans, footstools and poufs."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, legs


def cube() -> Iterator[Solid]:
    """Build a padded cube with piped edges."""
    yield box("black", (0.4, 0.02, 0.4))
    yield rounded_box("upholstery", (0.46, 0.42, 0.46), (0.0, 0.015, 0.0), 0.03, 3)
    for y in (0.05, 0.42):
        yield tube(
            "black",
            fillet(
                [(x, y, z) for x, z in ((-0.23, -0.23), (0.23, -0.23), (0.23, 0.23), (-0.23, 0.23))], 0.03, closed=True
            ),
            0.006,
            6,
            closed=True,
        )


def pouf(radius: float = 0.3, ribs: int = 12) -> Iterator[Solid]:
    """Build a round knitted pouf with gores."""
    for i in range(ribs):
        angle = 2 * np.pi * i / ribs
        x, z = np.cos(angle), np.sin(angle)
        gore = [
            (0.08 * x, 0.37, 0.08 * z),
            (0.7 * radius * x, 0.345, 0.7 * radius * z),
            (radius * x, 0.2, radius * z),
            (0.7 * radius * x, 0.045, 0.7 * radius * z),
        ]
        yield tube("textile", spline(gore, 3), np.interp(np.arange(10), [0, 3, 6, 9], [0.03, 0.052, 0.075, 0.045]), 8)
    yield revolve("textile", [(0.2, 0.02), (0.26, 0.1), (0.27, 0.2), (0.2, 0.34), (0.05, 0.37)], sides=20, steps=2)
    yield ball("textile", (0.05, 0.02, 0.05), (0.0, 0.39, 0.0), 10, 4)


def footstool(kind: LegKind = "turned", width: float = 0.6, fabric: str = "patterned") -> Iterator[Solid]:
    """Build a padded top on four legs."""
    yield from legs("wood", width - 0.06, 0.38, 0.26, kind, 0.05)
    yield rounded_box("wood", (width - 0.02, 0.05, 0.42), (0.0, 0.23, 0.0), 0.01, 1)
    yield padded_block(fabric, (width, 0.15, 0.44), (0.0, 0.27, 0.0), 6.0, 6)


def drum() -> Iterator[Solid]:
    """Build a round padded drum with a metal foot ring."""
    yield cylinder("brass", 0.27, 0.04, sides=28)
    yield revolve("upholstery", [(0.26, 0.04), (0.28, 0.08), (0.28, 0.36), (0.25, 0.41)], sides=28, steps=2)


def tufted(width: float = 0.9) -> Iterator[Solid]:
    """Build a large square ottoman with a grid of pads."""
    yield from legs("wood", width - 0.1, width - 0.1, 0.12, "block", 0.06)
    yield rounded_box("leather", (width, 0.2, width), (0.0, 0.11, 0.0), 0.03, 1)
    step = width / 4
    for i in range(4):
        for j in range(4):
            yield padded_block("leather", (step, 0.14, step), ((i - 1.5) * step, 0.29, (j - 1.5) * step), 3.5, 4)


def x_stool() -> Iterator[Solid]:
    """Build a cushion on crossed legs."""
    for s in (-1, 1):
        for a in (-1, 1):
            yield beam("brass", (a * 0.24, 0.0, s * 0.16), (-a * 0.24, 0.4, s * 0.16), 0.022)
    yield rod("brass", (0.0, 0.2, -0.16), (0.0, 0.2, 0.16), 0.012)
    yield padded_block("upholstery", (0.58, 0.12, 0.42), (0.0, 0.38, 0.0), 5.0, 6)


def storage_pouf() -> Iterator[Solid]:
    """Build a round tub with a padded lid above a gap."""
    yield cylinder("cane", 0.24, 0.3, (0.0, 0.02, 0.0), 0.26, 24)
    yield cylinder("black", 0.24, 0.03, (0.0, 0.31, 0.0), sides=24)
    yield revolve("upholstery", [(0.25, 0.0), (0.27, 0.02), (0.26, 0.07), (0.2, 0.1)], (0.0, 0.335, 0.0), 24, 2)
    for angle in (0.4, 2.5, 4.6):
        yield cylinder("wood", 0.025, 0.03, (0.18 * np.cos(angle), 0.0, 0.18 * np.sin(angle)), sides=10)


def saddle() -> Iterator[Solid]:
    """Build a saddle-shaped seat on splayed legs."""
    yield from legs("wood", 0.5, 0.34, 0.36, "splay", 0.05)
    yield surface("wood", lambda u, v: ((u - 0.5) * 0.56, 0.36 + 0.1 * (2 * u - 1) ** 2, (v - 0.5) * 0.38), 12, 3, 0.03)
    yield surface(
        "leather", lambda u, v: ((u - 0.5) * 0.48, 0.395 + 0.1 * (2 * u - 1) ** 2 * 0.73, (v - 0.5) * 0.34), 12, 4, 0.04
    )


OTTOMANS = (
    design(cube), design(pouf), design(footstool), design(drum), design(tufted), design(x_stool),
    design(storage_pouf), design(footstool, kind="splay", fabric="upholstery"),
    design(footstool, kind="sled", width=0.8, fabric="leather"), design(footstool, kind="cabriole", width=0.54),
    design(saddle),
)  # fmt: skip


FAMILIES = (FurnitureFamily("ottoman", "ottoman", OTTOMANS),)
