"""Headphones and cameras."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, picture_uv, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import disc


def headphones() -> Iterator[Solid]:
    """Build headphones on a stand."""
    yield revolve("wood", [(0.07, 0.0), (0.065, 0.015), (0.02, 0.02)], sides=20, steps=1)
    yield rod("wood", (0.0, 0.01, 0.0), (0.0, 0.26, 0.0), 0.01)
    yield tube("wood", [(-0.03, 0.262, 0.0), (0.0, 0.27, 0.0), (0.03, 0.262, 0.0)], 0.016, 10)
    yield tube(
        "black",
        [(0.085 * np.cos(a), 0.195 + 0.095 * np.sin(a), 0.0) for a in np.linspace(-0.2, np.pi + 0.2, 16)],
        0.01,
        8,
    )
    for s in (-1, 1):
        cup = revolve("black", [(0.036, 0.0), (0.042, 0.01), (0.04, 0.03)], sides=18, steps=2)
        yield move(rotate(cup, 2, s * np.pi / 2), (s * 0.085, 0.165, 0.0))


def lying_headphones(slot: str = "black") -> Iterator[Solid]:
    """Build headphones that lie on their cups."""
    turns = np.linspace(0.15, np.pi - 0.15, 16).tolist()
    yield tube(slot, [(0.085 * np.cos(a), 0.02, -0.1 * np.sin(a)) for a in turns], 0.01, 8)
    for s in (-1, 1):
        yield revolve(slot, [(0.036, 0.0), (0.042, 0.012), (0.04, 0.032)], (s * 0.07, 0.0, 0.02), 18, 2)
        yield ring("gray", 0.03, 0.014, (s * 0.07, 0.034, 0.02), 1, 20)
    yield tube("black", [(0.07, 0.006, 0.06), (0.1, 0.004, 0.11), (0.02, 0.004, 0.14), (-0.06, 0.004, 0.1)], 0.003, 6)


def photo_tripod() -> Iterator[Solid]:
    """Build a camera on a tripod."""
    yield from repeat_around([rod("black", (0.0, 0.0, 0.38), (0.0, 1.1, 0.03), 0.011, 0.016)], 3)
    yield rod("chrome", (0.0, 0.9, 0.0), (0.0, 1.3, 0.0), 0.014)
    yield rounded_box("black", (0.1, 0.03, 0.1), (0.0, 1.29, 0.0), 0.01, 2)
    yield rod("black", (0.0, 1.3, -0.04), (0.0, 1.22, -0.24), 0.008)
    yield from (move(p, (0.0, 1.32, 0.0)) for p in camera("camera"))


def easel() -> Iterator[Solid]:
    """Build a painter's easel with a canvas."""
    for s in (-1, 1):
        yield rod("wood", (s * 0.34, 0.0, 0.1), (s * 0.06, 1.62, -0.06), 0.016, sides=6)
    yield rod("wood", (0.0, 0.0, -0.5), (0.0, 1.55, -0.07), 0.016, sides=6)
    yield rounded_box("wood", (0.56, 0.03, 0.09), (0.0, 0.7, 0.06), 0.006, 1)
    canvas = rounded_box("picture", (0.5, 0.62, 0.02), (0.0, 0.0, 0.0), 0.002, 1)
    yield move(rotate(picture_uv(canvas), 0, -0.1), (0.0, 0.73, 0.055))


def camera(kind: str = "camera") -> Iterator[Solid]:
    """Build a camera, or a telescope on a tripod."""
    if kind == "camera":
        yield rounded_box("black", (0.13, 0.08, 0.06), (0.0, 0.0, 0.0), 0.015, 2)
        yield prism("black", [(-0.03, 0.08), (0.03, 0.08), (0.02, 0.105), (-0.02, 0.105)], 0.05)
        for r, z, t in ((0.035, 0.028, 0.03), (0.03, 0.058, 0.03)):
            yield disc("black", r, t, (0.0, 0.04, z), 24)
        yield disc("glass", 0.024, 0.004, (0.0, 0.04, 0.086), 20)
        yield cylinder("chrome", 0.012, 0.012, (0.045, 0.08, 0.0), sides=14)
        return
    yield from repeat_around([rod("black", (0.0, 0.0, 0.42), (0.0, 0.95, 0.03), 0.013, 0.018)], 3)
    yield cylinder("black", 0.04, 0.09, (0.0, 0.93, 0.0), sides=14)
    for z0, z1, r in ((-0.35, -0.2, 0.018), (-0.2, 0.1, 0.03), (0.1, 0.45, 0.042)):
        yield tube("white", [(0.0, 1.1 + 0.35 * z0, z0), (0.0, 1.1 + 0.35 * z1, z1)], r, 14)
    yield tube("black", [(0.0, 1.257, 0.45), (0.0, 1.275, 0.5)], 0.047, 14)


FAMILIES = (
    FurnitureFamily(
        "headphones",
        "headphones_on_stand",
        (design(headphones), design(lying_headphones), design(lying_headphones, slot="bright")),
    ),
    FurnitureFamily("tripod", "tripod", (*design_kinds(camera, "telescope"), design(photo_tripod), design(easel))),
)
