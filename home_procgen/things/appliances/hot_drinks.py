"""Coffee machines and kettles."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc


def _filter() -> Iterator[Solid]:
    yield rounded_box("black", (0.2, 0.03, 0.26), (0.0, 0.0, 0.0), 0.012, 1)
    yield rounded_box("black", (0.2, 0.33, 0.1), (0.0, 0.02, -0.08), 0.02, 2)
    yield rounded_box("black", (0.2, 0.11, 0.24), (0.0, 0.25, -0.005), 0.025, 2)
    yield revolve("glass", [(0.06, 0.0), (0.075, 0.05), (0.065, 0.1), (0.05, 0.13)], (0.0, 0.035, 0.05), 18, 2)
    yield revolve("brown", [(0.056, 0.0), (0.068, 0.05), (0.062, 0.07)], (0.0, 0.038, 0.05), 16, 2)
    yield tube(
        "black", fillet([(0.0, 0.15, 0.11), (0.0, 0.15, 0.17), (0.0, 0.06, 0.17), (0.0, 0.06, 0.125)], 0.03), 0.009
    )


def _espresso() -> Iterator[Solid]:
    yield rounded_box("steel", (0.3, 0.06, 0.3), (0.0, 0.012, 0.0), 0.012, 2)
    yield rounded_box("steel", (0.3, 0.28, 0.14), (0.0, 0.06, -0.08), 0.015, 2)
    yield rounded_box("steel", (0.3, 0.1, 0.26), (0.0, 0.28, -0.02), 0.02, 2)
    yield cylinder("chrome", 0.035, 0.05, (0.0, 0.235, 0.06), sides=16)
    yield tube("black", [(0.0, 0.25, 0.09), (0.0, 0.24, 0.17), (0.0, 0.235, 0.22)], [0.01, 0.014, 0.016])
    yield tube("chrome", fillet([(0.11, 0.3, 0.06), (0.11, 0.2, 0.09), (0.12, 0.12, 0.1)], 0.04), 0.006)
    for i in range(3):
        yield disc("black", 0.016, 0.014, (-0.09 + 0.05 * i, 0.33, 0.105), 14)
    for i in range(3):
        yield vessel(
            "crockery", [(0.02, 0.0), (0.032, 0.04), (0.033, 0.055)], 0.003, (-0.09 + 0.08 * i, 0.38, -0.03), 12, 2
        )
    yield vessel("crockery", [(0.02, 0.0), (0.032, 0.04), (0.033, 0.055)], 0.003, (0.0, 0.072, 0.06), 12, 2)


def _capsule() -> Iterator[Solid]:
    yield rounded_box("bright", (0.13, 0.24, 0.2), (0.0, 0.0, -0.06), 0.03, 3)
    yield rounded_box("bright", (0.13, 0.09, 0.3), (0.0, 0.2, 0.0), 0.035, 3)
    yield rounded_box("black", (0.13, 0.025, 0.13), (0.0, 0.0, 0.1), 0.01, 1)
    yield rounded_box("chrome", (0.03, 0.03, 0.14), (0.0, 0.288, 0.02), 0.012, 2)
    yield cylinder("black", 0.018, 0.03, (0.0, 0.18, 0.1), sides=12)
    yield vessel("crockery", [(0.022, 0.0), (0.034, 0.04), (0.035, 0.06)], 0.003, (0.0, 0.025, 0.1), 14, 2)


def _percolator() -> Iterator[Solid]:
    yield revolve(
        "steel",
        [
            (0.055, 0.0),
            (0.05, 0.07),
            (0.04, 0.085),
            (0.05, 0.1),
            (0.058, 0.18),
            (0.03, 0.2),
            (0.008, 0.215),
            (0.012, 0.225),
        ],
        sides=8,
        steps=1,
    )
    yield prism("steel", [(0.045, 0.15), (0.085, 0.185), (0.05, 0.185)], 0.02)
    yield tube("black", fillet([(-0.05, 0.17, 0.0), (-0.1, 0.17, 0.0), (-0.095, 0.08, 0.0)], 0.03), 0.009)


_COFFEE_KINDS = {
    "filter": _filter,
    "espresso": _espresso,
    "capsule": _capsule,
    "percolator": _percolator,
}


def coffee(kind: str = "filter") -> Iterator[Solid]:
    """Build a coffee machine: filter, espresso, capsule or percolator."""
    yield from _COFFEE_KINDS[kind]()


def _electric_kettle() -> Iterator[Solid]:
    yield revolve("black", [(0.085, 0.0), (0.085, 0.02), (0.07, 0.025)], sides=20, steps=1)
    yield revolve("steel", [(0.078, 0.025), (0.08, 0.08), (0.06, 0.2), (0.045, 0.215), (0.01, 0.22)], sides=24, steps=2)
    yield prism("steel", [(0.05, 0.17), (0.1, 0.21), (0.05, 0.21)], 0.035)
    yield tube(
        "black",
        fillet([(-0.05, 0.21, 0.0), (-0.13, 0.22, 0.0), (-0.12, 0.07, 0.0), (-0.08, 0.05, 0.0)], 0.04),
        0.012,
    )
    yield ball("black", 0.012, (0.0, 0.228, 0.0), 10, 6)


def _stove_kettle() -> Iterator[Solid]:
    yield revolve("bright", [(0.1, 0.0), (0.11, 0.02), (0.09, 0.1), (0.04, 0.14), (0.035, 0.15)], sides=24, steps=3)
    yield revolve("bright", [(0.036, 0.15), (0.03, 0.16), (0.005, 0.165)], sides=16, steps=1)
    yield ball("black", 0.014, (0.0, 0.178, 0.0), 10, 6)
    yield tube("bright", [(0.08, 0.07, 0.0), (0.13, 0.12, 0.0), (0.15, 0.13, 0.0)], [0.022, 0.013, 0.01], 10)
    arch = [(0.085 * np.cos(a), 0.12 + 0.12 * np.sin(a), 0.0) for a in np.linspace(0.15, np.pi - 0.15, 12)]
    yield tube("black", arch, 0.009)


def _swan() -> Iterator[Solid]:
    yield revolve("steel", [(0.075, 0.0), (0.09, 0.03), (0.085, 0.1), (0.06, 0.13), (0.01, 0.135)], sides=22, steps=2)
    yield ball("wood", 0.014, (0.0, 0.15, 0.0), 10, 6)
    yield tube(
        "steel",
        spline([(0.08, 0.03, 0.0), (0.13, 0.05, 0.0), (0.13, 0.12, 0.0), (0.17, 0.15, 0.0), (0.2, 0.14, 0.0)], 4),
        0.007,
    )
    yield tube("wood", fillet([(-0.07, 0.12, 0.0), (-0.16, 0.15, 0.0), (-0.15, 0.05, 0.0)], 0.05), 0.011)


def _glass_kettle() -> Iterator[Solid]:
    yield revolve("black", [(0.085, 0.0), (0.085, 0.03), (0.075, 0.035)], sides=20, steps=1)
    yield vessel("glass", [(0.075, 0.035), (0.08, 0.1), (0.07, 0.19)], 0.003, (0.0, 0.0, 0.0), 22, 2)
    yield revolve("water", [(0.07, 0.04), (0.076, 0.08), (0.075, 0.12)], sides=20, steps=1)
    yield revolve("black", [(0.072, 0.19), (0.07, 0.21), (0.03, 0.22)], sides=20, steps=1)
    yield tube(
        "black",
        fillet([(-0.06, 0.205, 0.0), (-0.13, 0.2, 0.0), (-0.13, 0.05, 0.0), (-0.075, 0.045, 0.0)], 0.03),
        0.012,
    )


def _iron_kettle() -> Iterator[Solid]:
    yield revolve("iron", [(0.06, 0.0), (0.09, 0.03), (0.088, 0.06), (0.05, 0.1), (0.04, 0.105)], sides=24, steps=3)
    for i in range(24):
        a = 2 * np.pi * i / 24
        yield ball("iron", 0.007, (0.09 * np.cos(a), 0.05, 0.09 * np.sin(a)), 6, 4)
    yield revolve("iron", [(0.04, 0.104), (0.02, 0.112), (0.006, 0.115)], sides=14, steps=1)
    yield ball("iron", 0.01, (0.0, 0.123, 0.0), 8, 6)
    yield tube("iron", [(0.08, 0.05, 0.0), (0.12, 0.09, 0.0)], [0.016, 0.01], 8)
    yield tube("iron", [(0.06 * np.cos(a), 0.09 + 0.1 * np.sin(a), 0.0) for a in np.linspace(0, np.pi, 11)], 0.006)


_KETTLE_KINDS = {
    "electric": _electric_kettle,
    "stove": _stove_kettle,
    "swan": _swan,
    "glass": _glass_kettle,
    "iron": _iron_kettle,
}


def kettle(kind: str = "electric") -> Iterator[Solid]:
    """Build a kettle: electric, whistling, gooseneck, glass or cast iron."""
    yield from _KETTLE_KINDS[kind]()


KETTLES = tuple(design(kettle, kind=kind) for kind in ("electric", "stove", "swan", "glass", "iron"))

COFFEES = tuple(design(coffee, kind=kind) for kind in ("filter", "espresso", "capsule", "percolator"))


FAMILIES = (
    FurnitureFamily("coffee_machine", "coffee_machine", COFFEES),
    FurnitureFamily("kettle", "kettle", KETTLES),
)
