"""Gym machines."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import beam, rod, tube
from home_procgen.things.vehicles.wheels import wheel


def treadmill() -> Iterator[Solid]:
    """Build a treadmill with a console."""
    yield rounded_box("black", (0.72, 0.14, 1.6), (0.0, 0.02, 0.0), 0.03, 2)
    yield rounded_box("gray", (0.46, 0.02, 1.46), (0.0, 0.15, 0.02), 0.008, 1)
    for s in (-1, 1):
        yield beam("gray", (s * 0.33, 0.12, -0.62), (s * 0.33, 1.25, -0.5), 0.05, 0.08)
        yield tube("black", fillet([(s * 0.33, 1.05, -0.5), (s * 0.33, 1.05, -0.1), (s * 0.33, 0.9, 0.0)], 0.1), 0.022)
    yield rotate(rounded_box("black", (0.72, 0.34, 0.06), (0.0, 1.1, -0.52), 0.02, 2), 0, -0.4, (0.0, 1.1, -0.52))
    yield rotate(box("screen", (0.36, 0.2, 0.01), (0.0, 1.17, -0.485)), 0, -0.4, (0.0, 1.1, -0.52))
    yield rounded_box("black", (0.68, 0.14, 0.24), (0.0, 0.13, -0.68), 0.04, 2)


def bike() -> Iterator[Solid]:
    """Build an exercise bike."""
    for z in (-0.45, 0.45):
        yield rod("gray", (-0.26, 0.03, z), (0.26, 0.03, z), 0.03, sides=10)
    yield beam("gray", (0.0, 0.06, -0.45), (0.0, 0.06, 0.45), 0.08, 0.05)
    yield from wheel(0.0, 0.33, 0.26, 0.25, 0.05, hub="red")
    yield beam("black", (0.0, 0.08, -0.3), (0.0, 0.9, -0.36), 0.06)
    yield padded_block("black", (0.22, 0.08, 0.27), (0.0, 0.9, -0.36), 3.0, 6)
    yield beam("black", (0.0, 0.3, 0.1), (0.0, 1.08, 0.34), 0.07, 0.05)
    yield tube(
        "black",
        fillet([(-0.24, 1.12, 0.14), (-0.2, 1.14, 0.34), (0.2, 1.14, 0.34), (0.24, 1.12, 0.14)], 0.08),
        0.016,
    )
    yield rotate(rounded_box("black", (0.2, 0.14, 0.03), (0.0, 1.16, 0.36), 0.01, 1), 0, -0.5, (0.0, 1.16, 0.36))
    yield ball("gray", (0.07, 0.14, 0.2), (0.0, 0.32, -0.02), 16, 10)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.08, 0.32, -0.02), (s * 0.1, 0.32 + s * 0.15, 0.05), 0.012)
        yield rounded_box("black", (0.1, 0.025, 0.12), (s * 0.15, 0.31 + s * 0.15, 0.05), 0.008, 1)


def rower() -> Iterator[Solid]:
    """Build a rowing machine."""
    yield beam("gray", (0.0, 0.18, -0.9), (0.0, 0.3, 0.8), 0.09, 0.06)
    for z in (-0.85, 0.75):
        yield beam("gray", (-0.26, 0.03, z), (0.26, 0.03, z), 0.06)
        yield beam("gray", (0.0, 0.04, z), (0.0, 0.22 + 0.06 * (z > 0), z), 0.06)
    yield padded_block("black", (0.3, 0.09, 0.24), (0.0, 0.26, -0.3), 3.5, 6)
    yield move(
        rotate(revolve("black", [(0.24, -0.05), (0.26, 0.0), (0.24, 0.05)], sides=28, steps=1), 2, np.pi / 2),
        (0.0, 0.48, 0.78),
    )
    for s in (-1, 1):
        yield rotate(rounded_box("black", (0.12, 0.03, 0.3), (s * 0.16, 0.34, 0.4), 0.01, 1), 0, -0.9, (0.0, 0.34, 0.4))
    yield rod("black", (-0.24, 0.55, 0.4), (0.24, 0.55, 0.4), 0.016)
    yield rod("gray", (0.0, 0.55, 0.4), (0.0, 0.48, 0.6), 0.004, sides=5)
    yield beam("gray", (0.0, 0.6, 0.85), (0.0, 1.0, 0.95), 0.04)
    yield rotate(rounded_box("black", (0.2, 0.14, 0.03), (0.0, 0.98, 0.95), 0.01, 1), 0, -0.3, (0.0, 0.98, 0.95))


def cross() -> Iterator[Solid]:
    """Build a cross trainer."""
    for z in (-0.75, 0.65):
        yield beam("gray", (-0.28, 0.03, z), (0.28, 0.03, z), 0.06)
    yield beam("gray", (0.0, 0.06, -0.75), (0.0, 0.06, 0.65), 0.1, 0.06)
    yield move(
        rotate(revolve("black", [(0.28, -0.08), (0.3, 0.0), (0.28, 0.08)], sides=28, steps=1), 2, np.pi / 2),
        (0.0, 0.36, -0.45),
    )
    yield beam("gray", (0.0, 0.1, 0.35), (0.0, 1.45, 0.45), 0.08)
    yield rotate(rounded_box("black", (0.26, 0.18, 0.04), (0.0, 1.42, 0.45), 0.015, 1), 0, 0.3, (0.0, 1.42, 0.45))
    for s in (-1, 1):
        yield beam("gray", (s * 0.14, 0.36 + s * 0.14, -0.4), (s * 0.18, 0.34, 0.42), 0.035, 0.05)
        yield rounded_box("black", (0.14, 0.04, 0.36), (s * 0.16, 0.38 + s * 0.06, -0.05), 0.015, 1)
        yield tube(
            "gray",
            fillet([(s * 0.18, 0.34, 0.42), (s * 0.22, 1.0, 0.4), (s * 0.24, 1.4, 0.2), (s * 0.2, 1.55, 0.18)], 0.15),
            0.018,
        )
        yield rod("black", (s * 0.235, 1.36, 0.2), (s * 0.205, 1.53, 0.18), 0.024)
