"""Glasses and bottles."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds

PROFILES = {  # kind -> (radius, height) [m]
    "wine": [
        (0.035, 0.0),
        (0.03, 0.003),
        (0.005, 0.012),
        (0.004, 0.09),
        (0.03, 0.115),
        (0.04, 0.15),
        (0.033, 0.205),
    ],
    "flute": [
        (0.033, 0.0),
        (0.028, 0.003),
        (0.004, 0.012),
        (0.004, 0.1),
        (0.02, 0.13),
        (0.026, 0.18),
        (0.024, 0.235),
    ],
    "tumbler": [(0.034, 0.0), (0.036, 0.012), (0.041, 0.1)],
    "highball": [(0.03, 0.0), (0.032, 0.01), (0.034, 0.15)],
    "martini": [(0.036, 0.0), (0.03, 0.003), (0.004, 0.012), (0.004, 0.1), (0.03, 0.125), (0.056, 0.165)],
    "snifter": [(0.034, 0.0), (0.02, 0.008), (0.007, 0.02), (0.03, 0.045), (0.05, 0.08), (0.03, 0.13)],
    "coupe": [(0.034, 0.0), (0.028, 0.003), (0.004, 0.012), (0.004, 0.09), (0.04, 0.11), (0.05, 0.135)],
    "shot": [(0.02, 0.0), (0.021, 0.012), (0.027, 0.07)],
    "mug": [(0.038, 0.0), (0.04, 0.01), (0.04, 0.14)],
    "goblet": [(0.036, 0.0), (0.02, 0.01), (0.009, 0.025), (0.012, 0.045), (0.036, 0.07), (0.043, 0.13)],
}


def glass(kind: str = "wine") -> Iterator[Solid]:
    """Build a drinking glass with a profile of `PROFILES`."""
    yield vessel("glass" if kind != "goblet" else "tint", PROFILES[kind], 0.002, sides=22, steps=3)
    if kind == "mug":
        yield cylinder("yellow", 0.036, 0.1, (0.0, 0.008, 0.0), sides=22)
        yield revolve("cream", [(0.036, 0.107), (0.037, 0.138), (0.02, 0.15)], sides=20, steps=2)
        yield tube(
            "glass",
            fillet([(0.038, 0.12, 0.0), (0.075, 0.12, 0.0), (0.075, 0.03, 0.0), (0.038, 0.03, 0.0)], 0.025),
            0.006,
        )
        for k in range(8):
            a = np.pi * k / 4
            yield rod(
                "glass",
                (0.041 * np.cos(a), 0.02, 0.041 * np.sin(a)),
                (0.041 * np.cos(a), 0.11, 0.041 * np.sin(a)),
                0.004,
                sides=5,
            )
    elif kind == "martini":
        yield rod("wood", (-0.03, 0.13, 0.0), (0.06, 0.185, 0.0), 0.0015, sides=5)
        yield ball("green", 0.01, (0.0, 0.148, 0.0), 10, 6)
    elif kind == "snifter":
        yield revolve("tint", [(0.02, 0.036), (0.042, 0.06), (0.046, 0.075)], sides=18, steps=2)
    elif kind == "shot":
        yield cylinder("tint", 0.021, 0.035, (0.0, 0.012, 0.0), sides=16)
    elif kind == "highball":
        yield cylinder("orange", 0.031, 0.1, (0.0, 0.006, 0.0), sides=18)
        yield rod("red", (-0.02, 0.02, 0.0), (0.035, 0.2, 0.0), 0.003, sides=6)
        yield move(rotate(cylinder("yellow", 0.026, 0.005, sides=16), 2, 1.5), (0.036, 0.15, 0.0))
    elif kind == "wine":
        yield revolve("red", [(0.006, 0.102), (0.03, 0.118), (0.036, 0.14)], sides=18, steps=2)
    elif kind == "tumbler":
        for i, (x, z) in enumerate(((0.008, 0.006), (-0.012, -0.004))):
            yield rotate(rounded_box("water", (0.024, 0.024, 0.024), (x, 0.02 + 0.026 * i, z), 0.004, 1), 1, 0.6 * i)


def _wine_bottle() -> Iterator[Solid]:
    yield revolve(
        "green",
        [(0.034, 0.0), (0.038, 0.006), (0.038, 0.17), (0.03, 0.21), (0.014, 0.235), (0.013, 0.3)],
        sides=18,
        steps=1,
    )
    yield revolve("red", [(0.0145, 0.27), (0.0145, 0.302)], sides=14, steps=1)
    yield revolve("cream", [(0.0385, 0.05), (0.0385, 0.13)], sides=18, steps=1)


def _water_bottle() -> Iterator[Solid]:
    yield revolve(
        "water",
        [
            (0.03, 0.0),
            (0.034, 0.01),
            (0.034, 0.06),
            (0.03, 0.08),
            (0.034, 0.1),
            (0.034, 0.16),
            (0.013, 0.21),
            (0.013, 0.225),
        ],
        sides=18,
        steps=2,
    )
    yield cylinder("blue", 0.015, 0.018, (0.0, 0.222, 0.0), sides=14)
    yield revolve("blue", [(0.0345, 0.105), (0.0345, 0.15)], sides=18, steps=1)


def _oil_bottle() -> Iterator[Solid]:
    yield revolve("tint", [(0.035, 0.0), (0.038, 0.02), (0.034, 0.15), (0.012, 0.2), (0.011, 0.25)], sides=8, steps=2)
    yield tube("chrome", [(0.0, 0.25, 0.0), (0.0, 0.28, 0.0), (0.02, 0.3, 0.0)], [0.008, 0.006, 0.003])
    yield rounded_box("cream", (0.03, 0.06, 0.002), (0.0, 0.05, 0.029), 0.001, 1)


def _milk_bottle() -> Iterator[Solid]:
    yield revolve(
        "white",
        [(0.038, 0.0), (0.042, 0.01), (0.042, 0.14), (0.022, 0.19), (0.02, 0.22), (0.024, 0.225)],
        sides=20,
        steps=2,
    )
    yield revolve("red", [(0.025, 0.222), (0.024, 0.235)], sides=16, steps=1)


def _jar_bottle() -> Iterator[Solid]:
    yield revolve("tint", [(0.04, 0.0), (0.044, 0.012), (0.044, 0.1), (0.036, 0.115)], sides=20, steps=1)
    yield revolve("red", [(0.039, 0.115), (0.039, 0.13)], sides=20, steps=1)
    yield revolve("paper", [(0.0445, 0.03), (0.0445, 0.085)], sides=20, steps=1)


_BOTTLE_KINDS = {
    "wine": _wine_bottle,
    "water": _water_bottle,
    "oil": _oil_bottle,
    "milk": _milk_bottle,
    "jar": _jar_bottle,
}


def bottle(kind: str = "wine") -> Iterator[Solid]:
    """Build a bottle of wine, water, oil or milk, or a jar."""
    yield from _BOTTLE_KINDS[kind]()


GLASSES = ("wine", "flute", "tumbler", "highball", "goblet", "martini", "snifter", "coupe", "shot", "mug")

FAMILIES = (
    FurnitureFamily("glass", "glass", design_kinds(glass, *GLASSES)),
    FurnitureFamily("bottle", "bottle", design_kinds(bottle, "wine", "water", "oil", "milk", "jar")),
)
