"""Mixers, air fryers and water dispensers."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc
from home_procgen.things.movable_parts import panel


def _blender() -> Iterator[Solid]:
    yield revolve("bright", [(0.08, 0.0), (0.082, 0.03), (0.06, 0.12), (0.05, 0.14)], sides=8, steps=1)
    yield disc("black", 0.02, 0.02, (0.0, 0.05, 0.066), 14)
    yield vessel("glass", [(0.05, 0.14), (0.065, 0.22), (0.075, 0.34)], 0.004, sides=16, steps=2)
    yield revolve("orange", [(0.046, 0.146), (0.058, 0.21), (0.062, 0.24)], sides=14, steps=1)
    yield revolve("black", [(0.078, 0.34), (0.076, 0.365), (0.03, 0.37), (0.03, 0.39)], sides=16, steps=1)
    yield tube(
        "glass", fillet([(0.07, 0.32, 0.0), (0.12, 0.31, 0.0), (0.11, 0.19, 0.0), (0.06, 0.19, 0.0)], 0.03), 0.008
    )


def _mixer() -> Iterator[Solid]:
    yield rounded_box("bright", (0.18, 0.04, 0.34), (0.0, 0.0, 0.0), 0.018, 2)
    yield rounded_box("bright", (0.1, 0.22, 0.1), (0.0, 0.03, -0.11), 0.035, 3)
    yield tube(
        "bright",
        spline([(0.0, 0.29, -0.16), (0.0, 0.3, -0.05), (0.0, 0.3, 0.08), (0.0, 0.29, 0.17)], 3),
        [0.045, 0.055, 0.063, 0.066, 0.066, 0.066, 0.064, 0.06, 0.056, 0.045],
        14,
    )
    yield cylinder("chrome", 0.03, 0.05, (0.0, 0.2, 0.09), sides=14)
    yield vessel("steel", [(0.05, 0.0), (0.09, 0.03), (0.105, 0.12), (0.108, 0.14)], 0.004, (0.0, 0.04, 0.09), 22, 2)
    yield ball("chrome", 0.014, (0.062, 0.29, -0.02), 10, 6)
    yield disc("chrome", 0.025, 0.02, (0.0, 0.29, 0.165), 14)


def _chopper() -> Iterator[Solid]:
    yield rounded_box("white", (0.2, 0.13, 0.2), (0.0, 0.0, 0.0), 0.03, 2)
    yield disc("gray", 0.03, 0.02, (0.0, 0.065, 0.1), 16)
    yield vessel("glass", [(0.085, 0.13), (0.09, 0.16), (0.09, 0.27)], 0.004, sides=20, steps=1)
    yield revolve("white", [(0.094, 0.27), (0.09, 0.29), (0.04, 0.3)], sides=20, steps=1)
    yield revolve("glass", [(0.035, 0.3), (0.033, 0.38)], (0.03, 0.0, 0.0), 14, 1)
    yield cylinder("white", 0.038, 0.02, (0.03, 0.38, 0.0), sides=14)
    yield tube(
        "glass", fillet([(0.09, 0.26, 0.0), (0.14, 0.25, 0.0), (0.13, 0.16, 0.0), (0.09, 0.16, 0.0)], 0.03), 0.009
    )


def _juicer() -> Iterator[Solid]:
    yield revolve("steel", [(0.09, 0.0), (0.09, 0.1), (0.07, 0.14)], sides=22, steps=2)
    yield vessel("steel", [(0.06, 0.14), (0.09, 0.17), (0.09, 0.19)], 0.004, sides=20, steps=1)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield rod("white", (0.03 * np.cos(a), 0.15, 0.03 * np.sin(a)), (0.0, 0.23, 0.0), 0.008, 0.003, 6)
    yield rod("steel", (0.08, 0.12, 0.0), (0.13, 0.1, 0.0), 0.012, 0.008)


_PROCESSOR_KINDS = {
    "blender": _blender,
    "mixer": _mixer,
    "chopper": _chopper,
    "juicer": _juicer,
}


def processor(kind: str = "blender") -> Iterator[Solid]:
    """Build a blender, a stand mixer, a chopper or a juicer."""
    yield from _PROCESSOR_KINDS[kind]()


def water_column(high: float = 1.1) -> Iterator[Solid]:
    """Build a water dispenser without a bottle, on the floor or, if low, for a table."""
    yield rounded_box("steel", (0.3, high, 0.32), (0.0, 0.0, 0.0), 0.02, 2)
    yield rounded_box("black", (0.22, 0.28, 0.03), (0.0, high - 0.42, 0.155), 0.012, 2)
    yield box("gray", (0.2, 0.012, 0.07), (0.0, high - 0.41, 0.19))
    for x, slot in ((-0.05, "blue"), (0.05, "red")):
        yield rounded_box(slot, (0.03, 0.02, 0.012), (x, high - 0.1, 0.16), 0.005, 1)
        yield cylinder("chrome", 0.01, 0.05, (x, high - 0.2, 0.18), sides=12)


def dispenser() -> Iterator[Solid]:
    """Build a water dispenser with a large inverted bottle."""
    yield rounded_box("white", (0.31, 0.95, 0.32), (0.0, 0.02, 0.0), 0.025, 2)
    yield rounded_box("black", (0.22, 0.2, 0.04), (0.0, 0.66, 0.15), 0.015, 1)
    for x, slot in ((-0.05, "blue"), (0.05, "red")):
        yield rounded_box(slot, (0.025, 0.04, 0.04), (x, 0.78, 0.185), 0.008, 1)
    yield box("gray", (0.2, 0.012, 0.05), (0.0, 0.665, 0.18))
    yield revolve(
        "water",
        [
            (0.035, 0.95),
            (0.04, 1.0),
            (0.135, 1.06),
            (0.135, 1.16),
            (0.128, 1.18),
            (0.135, 1.2),
            (0.135, 1.3),
            (0.1, 1.34),
        ],
        sides=24,
        steps=1,
    )
    yield from add_mirror_images(
        [
            cylinder("black", 0.02, 0.025, (0.12, 0.0, 0.1), sides=10),
            cylinder("black", 0.02, 0.025, (0.12, 0.0, -0.1), sides=10),
        ]
    )


def air_fryer() -> Iterator[Solid]:
    """Build a rounded air fryer with a drawer and a screen."""
    yield revolve("black", [(0.12, 0.0), (0.145, 0.04), (0.15, 0.2), (0.12, 0.29), (0.05, 0.31)], sides=26, steps=3)
    drawer = rounded_box("black", (0.2, 0.14, 0.06), (0.0, 0.03, 0.12), 0.025, 2)
    yield from panel(0.15, drawer, rounded_box("gray", (0.035, 0.05, 0.1), (0.0, 0.08, 0.19), 0.014, 2))
    yield rounded_box("screen", (0.1, 0.05, 0.02), (0.0, 0.215, 0.138), 0.008, 1)


MIXERS = tuple(design(processor, kind=kind) for kind in ("blender", "mixer", "chopper", "juicer"))


FAMILIES = (
    FurnitureFamily("food_processor", "food_processor", (*MIXERS, design(air_fryer))),
    FurnitureFamily(
        "water_dispenser", "water_dispenser", (design(dispenser), design(water_column), design(water_column, high=0.5))
    ),
)
