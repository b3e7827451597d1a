"""Guitars, drums, microphones."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc


def guitar(kind: str = "folk") -> Iterator[Solid]:
    """Build a guitar on a stand, acoustic or electric."""
    electric = kind == "electric"
    right = (
        [(0.0, -0.24), (0.13, -0.22), (0.18, -0.1), (0.12, 0.02), (0.13, 0.1), (0.11, 0.2), (0.04, 0.22)]
        if not electric
        else [(0.0, -0.2), (0.13, -0.18), (0.16, -0.06), (0.12, 0.03), (0.15, 0.16), (0.1, 0.17), (0.05, 0.1)]
    )
    outline = spline([*right, *[(-x, y) for x, y in right[-1:0:-1]], right[0]], 3)[:-1]
    lean = [prism("bright" if electric else "wood", outline, 0.045 if electric else 0.1, (0.0, 0.36, 0.0))]
    z = 0.024 if electric else 0.051
    if not electric:
        lean += [
            disc("black", 0.05, 0.002, (0.0, 0.42, z), 24),
            ring("cream", 0.053, 0.006, (0.0, 0.42, z), 2, 24),
            rounded_box("black", (0.15, 0.02, 0.012), (0.0, 0.25, z + 0.004), 0.004, 1),
        ]
    else:
        lean += [rounded_box("black", (0.08, 0.02, 0.012), (0.0, 0.32 + 0.07 * k, z), 0.004, 1) for k in range(2)]
        lean += [
            rounded_box("white", (0.12, 0.16, 0.004), (0.03, 0.28, z), 0.002, 1),
            rounded_box("chrome", (0.09, 0.02, 0.014), (0.0, 0.25, z), 0.004, 1),
        ]
    lean += [
        box("wood_1", (0.052, 0.48, 0.022), (0.0, 0.52, z - 0.006)),
        rounded_box("wood", (0.075, 0.16, 0.016), (0.0, 1.0, z - 0.012), 0.006, 1),
    ]
    lean += [
        rod("chrome", (s * 0.034, 1.03 + 0.04 * k, z), (s * 0.056, 1.03 + 0.04 * k, z - 0.005), 0.006)
        for s in (-1, 1)
        for k in range(3)
    ]
    lean += [
        rod("chrome", ((k - 2.5) * 0.008, 0.26, z + 0.012), ((k - 2.5) * 0.008, 1.04, z + 0.006), 0.0012, sides=4)
        for k in range(6)
    ]
    yield from (rotate(p, 0, -0.2, (0.0, 0.1, 0.0)) for p in lean)
    for s in (-1, 1):
        yield rod("iron", (s * 0.2, 0.0, 0.16), (s * 0.06, 0.3, -0.08), 0.01)
        yield tube(
            "iron", fillet([(s * 0.06, 0.14, -0.03), (s * 0.09, 0.12, 0.1), (s * 0.09, 0.17, 0.11)], 0.02), 0.009, 6
        )
    yield rod("iron", (0.0, 0.0, -0.32), (0.0, 0.5, -0.12), 0.01)


def ukulele() -> Iterator[Solid]:
    """Build a small guitar with four strings on a low stand."""
    right = [(0.0, -0.15), (0.08, -0.14), (0.11, -0.06), (0.075, 0.01), (0.085, 0.06), (0.07, 0.12), (0.02, 0.14)]
    outline = spline([*right, *[(-x, y) for x, y in right[-1:0:-1]], right[0]], 3)[:-1]
    lean = [prism("wood", outline, 0.065, (0.0, 0.24, 0.0)), disc("black", 0.032, 0.002, (0.0, 0.27, 0.033), 22)]
    lean += [
        box("wood_1", (0.036, 0.3, 0.018), (0.0, 0.35, 0.024)),
        rounded_box("wood", (0.055, 0.1, 0.014), (0.0, 0.65, 0.02), 0.005, 1),
    ]
    lean += [rounded_box("black", (0.09, 0.014, 0.01), (0.0, 0.16, 0.034), 0.003, 1)]
    lean += [
        rod("white", ((k - 1.5) * 0.008, 0.17, 0.044), ((k - 1.5) * 0.007, 0.68, 0.036), 0.001, sides=4)
        for k in range(4)
    ]
    yield from (rotate(p, 0, -0.2, (0.0, 0.08, 0.0)) for p in lean)
    for s in (-1, 1):
        yield rod("iron", (s * 0.12, 0.0, 0.1), (s * 0.04, 0.2, -0.06), 0.008)
        yield tube(
            "iron", fillet([(s * 0.05, 0.1, -0.02), (s * 0.06, 0.09, 0.07), (s * 0.06, 0.12, 0.08)], 0.02), 0.007, 6
        )
    yield rod("iron", (0.0, 0.0, -0.2), (0.0, 0.3, -0.08), 0.008)


def drums() -> Iterator[Solid]:
    """Build a drum set with cymbals."""

    def drum(
        radius: float, high: float, at: tuple[float, float, float], tilt: float = 0.0, turn: float = 0.0
    ) -> Iterator[Solid]:
        parts = [
            cylinder("bright", radius, high, sides=26),
            cylinder("white", 0.97 * radius, 0.006, (0.0, high, 0.0), sides=26),
            cylinder("white", 0.97 * radius, 0.006, (0.0, -0.006, 0.0), sides=26),
        ]
        parts += [ring("chrome", radius, 0.016, (0.0, y, 0.0), 1, 14) for y in (0.0, high)]
        yield from (move(rotate(rotate(p, 0, tilt), 1, turn), at) for p in parts)

    yield from drum(0.28, 0.4, (0.0, 0.29, 0.02), np.pi / 2)
    yield from drum(0.15, 0.2, (-0.2, 0.66, 0.1), 0.35, 0.3)
    yield from drum(0.16, 0.22, (0.2, 0.66, 0.1), 0.35, -0.3)
    yield from drum(0.2, 0.36, (0.52, 0.22, -0.3))
    yield from drum(0.17, 0.14, (-0.42, 0.5, -0.32))
    for x, z, y, r in ((-0.62, 0.1, 1.1, 0.2), (0.66, 0.12, 1.2, 0.25), (-0.72, -0.4, 0.85, 0.17)):
        yield revolve("brass", [(r, 0.0), (0.3 * r, 0.02), (0.24 * r, 0.035), (0.01, 0.045)], (x, y, z), 26, 1)
        yield rod("chrome", (x, 0.1, z), (x, y + 0.05, z), 0.01)
        yield from (
            p
            for p in (
                move(q, (x, 0.0, z))
                for q in (
                    rod("chrome", (0.0, 0.2, 0.0), (0.2 * np.cos(a), 0.0, 0.2 * np.sin(a)), 0.008)
                    for a in (0.3, 2.4, 4.5)
                )
            )
        )
    for s in (-1, 1):
        yield rod("chrome", (s * 0.1, 0.5, 0.2), (s * 0.16, 0.74, 0.14), 0.012)
        yield rod("chrome", (s * 0.2, 0.3, 0.36), (s * 0.34, 0.0, 0.44), 0.01)
    for x, z in ((-0.42, -0.32), (0.52, -0.3)):
        yield from (
            rod(
                "chrome",
                (x + 0.12 * np.cos(a), 0.5 if x < 0 else 0.24, z + 0.12 * np.sin(a)),
                (x + 0.2 * np.cos(a), 0.0, z + 0.2 * np.sin(a)),
                0.009,
            )
            for a in (0.2, 2.3, 4.4)
        )
    yield padded_block("black", (0.34, 0.1, 0.34), (0.0, 0.5, -0.62), 3.0, 5)
    yield rod("chrome", (0.0, 0.06, -0.62), (0.0, 0.52, -0.62), 0.02)
    yield from (
        rod("chrome", (0.0, 0.2, -0.62), (0.24 * np.cos(a), 0.0, -0.62 + 0.24 * np.sin(a)), 0.012)
        for a in (0.5, 2.6, 4.7)
    )


def microphone() -> Iterator[Solid]:
    """Build a microphone on a stand."""
    yield revolve("black", [(0.14, 0.0), (0.13, 0.02), (0.02, 0.03)], sides=24, steps=1)
    yield rod("black", (0.0, 0.02, 0.0), (0.0, 1.3, 0.0), 0.009)
    yield rod("black", (0.0, 1.3, 0.0), (0.0, 1.4, 0.1), 0.014, 0.02)
    yield ball("gray", 0.03, (0.0, 1.42, 0.115), 14, 8)
    yield ring("chrome", 0.028, 0.008, (0.0, 1.415, 0.112), 1, 18)


def boom_microphone(low: bool = False) -> Iterator[Solid]:
    """Build a microphone on a boom above three legs, or a large one on a foot for a table."""
    high = 0.2 if low else 1.35
    if low:
        yield revolve("black", [(0.08, 0.0), (0.075, 0.015), (0.015, 0.022)], sides=24, steps=1)
    else:
        for k in range(3):
            a = 2 * np.pi * k / 3
            yield rod("black", (0.0, 0.18, 0.0), (0.32 * np.cos(a), 0.01, 0.32 * np.sin(a)), 0.009)
        yield rod("gray", (0.0, high, -0.25), (0.0, high + 0.2, 0.45), 0.008)
    yield rod("black", (0.0, 0.015, 0.0), (0.0, high + 0.05 * (not low), 0.0), 0.009)
    at = (0.0, high - 0.02, 0.0) if low else (0.0, high + 0.1, 0.45)
    yield revolve("gray", [(0.024, 0.0), (0.03, 0.02), (0.03, 0.1), (0.02, 0.13)], at, 20, 2)
    yield ring("chrome", 0.031, 0.008, (at[0], at[1] + 0.05, at[2]), 1, 20)


FAMILIES = (
    FurnitureFamily("guitar", "guitar", (design(guitar), design(guitar, kind="electric"), design(ukulele))),
    FurnitureFamily("drumset", "drumset", (design(drums),)),
    FurnitureFamily(
        "microphone", "microphone", (design(microphone), design(boom_microphone), design(boom_microphone, low=True))
    ),
)
