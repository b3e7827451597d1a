"""More shoes: rain boots, clogs, ballerinas, high-tops, sandals; the outline of a sole."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import ball, padded_block
from home_procgen.shapes.sweep import band, prism, ring, rod, sweep, tube

# (x, z) [m], outline of a shoe sole with its toe towards +z.
SOLE = spline(
    [
        (0.0, 0.14),
        (0.038, 0.1),
        (0.042, 0.04),
        (0.03, -0.04),
        (0.034, -0.1),
        (0.0, -0.13),
        (-0.03, -0.1),
        (-0.028, -0.04),
        (-0.038, 0.05),
        (-0.034, 0.11),
    ],
    2,
)


def rain_boots() -> Iterator[Solid]:
    """Build high rubber boots, wide at the top."""
    for s in (-1, 1):
        x = s * 0.07
        yield prism("black", SOLE, 0.022, (x, 0.0, 0.0), "top")
        foot = [(x, 0.04, 0.12), (x, 0.05, 0.06), (x, 0.07, 0.0), (x, 0.08, -0.06)]
        yield tube("bright", foot, [0.024, 0.042, 0.05, 0.05], 14)
        shaft = [(0.05, 0.06), (0.054, 0.2), (0.066, 0.36)]
        yield vessel("bright", shaft, 0.004, (x, 0.0, -0.065), 18, 3)
        yield ring("black", 0.065, 0.012, (x, 0.36, -0.065), 1, 18)


def clogs() -> Iterator[Solid]:
    """Build wooden clogs with a leather strap."""
    for s in (-1, 1):
        x = s * 0.065
        yield prism("wood", SOLE, 0.035, (x, 0.0, 0.0), "top")
        yield padded_block("leather", (0.088, 0.06, 0.13), (x, 0.03, 0.062), 3.0, 6)
        strap = [(x - 0.042, 0.05, 0.0), (x - 0.03, 0.075, -0.09), (x + 0.03, 0.075, -0.09), (x + 0.042, 0.05, 0.0)]
        yield tube("leather", fillet(strap, 0.03), 0.007, 6)
        for k in (-1, 1):
            yield ball("brass", 0.006, (x + 0.043 * k, 0.052, 0.01), 8, 4)


def ballerinas() -> Iterator[Solid]:
    """Build flat, open-topped shoes with a bow."""
    section = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.2], [0.9, 0.5], [-0.9, 0.5], [-1.0, 0.2]])
    for s in (-1, 1):
        x = s * 0.06
        yield prism("rubber", SOLE, 0.01, (x, 0.0, 0.0), "top")
        path = [(x, 0.024, 0.13), (x, 0.03, 0.1), (x, 0.032, 0.055)]
        yield sweep("bright", path, section * 0.04, [0.4, 0.75, 0.95], up=(0.0, 1.0, 0.0))
        for k in (-1, 1):
            side = [(x + 0.036 * k, 0.03, 0.06), (x + 0.03 * k, 0.034, -0.04), (x + 0.022 * k, 0.036, -0.1)]
            yield tube("bright", [*side, (x, 0.038, -0.122)], 0.014, 8)
            yield ball("bright", (0.014, 0.005, 0.01), (x + 0.013 * k, 0.056, 0.06), 8, 4)


def high_tops() -> Iterator[Solid]:
    """Build ankle-high canvas shoes with white toes and laces."""
    for s in (-1, 1):
        x = s * 0.065
        yield prism("white", SOLE, 0.03, (x, 0.0, 0.0), "top")
        path = [(x, 0.045, 0.1), (x, 0.06, 0.05), (x, 0.08, 0.0), (x, 0.09, -0.06), (x, 0.08, -0.105)]
        section = np.array([[-0.9, -0.7], [0.9, -0.7], [0.9, 0.4], [0.5, 0.9], [-0.5, 0.9], [-0.9, 0.4]])
        yield sweep("textile", path, section * 0.046, [0.8, 0.95, 1.0, 1.0, 0.7], up=(0.0, 1.0, 0.0))
        yield tube("textile", [(x, 0.09, -0.06), (x, 0.16, -0.065)], [0.046, 0.042], 14)
        yield ball("white", (0.034, 0.022, 0.03), (x, 0.042, 0.1), 12, 6)
        for k in range(5):
            y, z = 0.095 + 0.014 * k, 0.04 - 0.02 * k
            yield rod("white", (x - 0.022, y, z), (x + 0.022, y, z), 0.004, sides=6)


def sandals() -> Iterator[Solid]:
    """Build sandals: a cork footbed with two straps and buckles."""
    for s in (-1, 1):
        x = s * 0.062
        yield prism("rubber", SOLE, 0.01, (x, 0.0, 0.0), "top")
        yield prism("cane", [(0.98 * a, 0.98 * b) for a, b in SOLE.tolist()], 0.018, (x, 0.01, 0.0), "top")
        for z in (0.075, 0.015):
            arch = [(x - 0.044, 0.014, z), (x - 0.036, 0.055, z), (x, 0.07, z - 0.008), (x + 0.036, 0.055, z)]
            yield band("leather", [*arch, (x + 0.044, 0.014, z)], 0.034, 0.004, (0.0, 1.0, 0.0))
            yield ring("brass", 0.009, 0.003, (x + 0.041 * s, 0.045, z), 0, 12)
