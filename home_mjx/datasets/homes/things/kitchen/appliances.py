"""Refrigerators, dishwashers, washing machines, and what stands on a worktop."""

from collections.abc import Callable, Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.groups import mirrored
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc, placed_front
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder


def fridge(width: float = 0.6, height: float = 1.85, split: float = 0.7, slot: str = "steel") -> Iterator[Solid]:
    """Two doors, one above the other."""
    yield box("black", (width - 0.02, 0.05, 0.56), (0.0, 0.0, -0.03))
    yield rounded(slot, (width, height - 0.05, 0.58), (0.0, 0.05, -0.04), 0.012, 1)
    for low, high, grip in ((0.06, split - 0.004, split - 0.36), (split + 0.004, height, split + 0.06)):
        yield rounded(slot, (width - 0.004, high - low, 0.065), (0.0, low, 0.285), 0.015, 2)
        for s in (0.02, 0.28):
            yield rod("chrome", (width / 2 - 0.05, grip + s, 0.31), (width / 2 - 0.05, grip + s, 0.35), 0.006)
        yield rod("chrome", (width / 2 - 0.05, grip, 0.35), (width / 2 - 0.05, grip + 0.3, 0.35), 0.01)


def side_by_side(width: float = 0.92, height: float = 1.8, dispenser: bool = True) -> Iterator[Solid]:
    """Two tall doors, one with a water dispenser."""
    yield box("black", (width - 0.02, 0.06, 0.6), (0.0, 0.0, -0.03))
    yield rounded("steel", (width, height - 0.06, 0.62), (0.0, 0.06, -0.04), 0.012, 1)
    for s in (-1, 1):
        yield rounded("steel", (width / 2 - 0.005, height - 0.08, 0.07), (s * width / 4, 0.07, 0.305), 0.018, 2)
        yield rod("chrome", (s * 0.04, 0.5, 0.38), (s * 0.04, 1.4, 0.38), 0.012)
        for y in (0.56, 1.34):
            yield rod("chrome", (s * 0.04, y, 0.33), (s * 0.04, y, 0.38), 0.008)
    if dispenser:
        yield rounded("black", (0.2, 0.36, 0.03), (-width / 4, 0.95, 0.335), 0.012, 1)
        yield box("screen", (0.14, 0.06, 0.006), (-width / 4, 1.22, 0.352))
        yield rounded("chrome", (0.05, 0.06, 0.03), (-width / 4, 1.12, 0.345), 0.008, 1)


def retro(height: float = 1.5) -> Iterator[Solid]:
    """A rounded refrigerator of the fifties on short feet."""
    for x in (-0.22, 0.22):
        for z in (-0.2, 0.2):
            yield cylinder("chrome", 0.02, 0.07, (x, 0.0, z), sides=10)
    yield rounded("bright", (0.6, height - 0.06, 0.56), (0.0, 0.06, -0.04), 0.1, 4)
    yield rounded("bright", (0.58, height - 0.1, 0.12), (0.0, 0.08, 0.25), 0.055, 4)
    yield box("chrome", (0.56, 0.014, 0.1), (0.0, height * 0.72, 0.262))
    yield rounded("chrome", (0.05, 0.2, 0.05), (0.22, height * 0.5, 0.32), 0.02, 2)
    yield rounded("chrome", (0.2, 0.035, 0.02), (-0.05, height * 0.82, 0.312), 0.009, 2)


def french(width: float = 0.9, height: float = 1.78) -> Iterator[Solid]:
    """Two doors above a freezer drawer."""
    yield box("black", (width - 0.02, 0.05, 0.6), (0.0, 0.0, -0.03))
    yield rounded("gray", (width, height - 0.05, 0.62), (0.0, 0.05, -0.04), 0.012, 1)
    for s in (-1, 1):
        yield rounded("gray", (width / 2 - 0.004, height - 0.74, 0.07), (s * width / 4, 0.73, 0.305), 0.016, 2)
        yield tube(
            "chrome",
            fillet(
                [(s * 0.05, 0.9, 0.33), (s * 0.05, 0.92, 0.38), (s * 0.05, 1.5, 0.38), (s * 0.05, 1.52, 0.33)], 0.03
            ),
            0.01,
        )
    yield rounded("gray", (width - 0.004, 0.64, 0.07), (0.0, 0.06, 0.305), 0.016, 2)
    yield tube(
        "chrome", fillet([(-0.34, 0.58, 0.33), (-0.32, 0.58, 0.38), (0.32, 0.58, 0.38), (0.34, 0.58, 0.33)], 0.03), 0.01
    )


def mini() -> Iterator[Solid]:
    """A small refrigerator with a magnet or two on its door."""
    yield rounded("white", (0.5, 0.8, 0.46), (0.0, 0.02, -0.03), 0.015, 2)
    yield rounded("white", (0.5, 0.79, 0.05), (0.0, 0.025, 0.225), 0.018, 2)
    yield box("black", (0.44, 0.03, 0.4))
    yield rounded("gray", (0.03, 0.16, 0.03), (0.21, 0.55, 0.25), 0.01, 1)
    for x, y, slot in ((-0.1, 0.6, "red"), (0.02, 0.5, "yellow"), (-0.06, 0.42, "blue")):
        yield disc(slot, 0.022, 0.012, (x, y, 0.247), 14)
    yield box("paper", (0.1, 0.14, 0.004), (-0.12, 0.36, 0.25))


def wine_cooler() -> Iterator[Solid]:
    """A glazed cooler with bottles on shelves."""
    for s in (-1, 1):
        yield box("black", (0.03, 1.2, 0.5), (s * 0.265, 0.03, 0.0))
    for y in (0.0, 1.2):
        yield box("black", (0.56, 0.05, 0.5), (0.0, y, 0.0))
    yield box("black", (0.54, 1.2, 0.02), (0.0, 0.03, -0.24))
    for row in range(6):
        y = 0.16 + 0.18 * row
        yield box("wood", (0.5, 0.012, 0.42), (0.0, y - 0.05, 0.0))
        for i in range(5):
            yield tube(
                "green",
                [
                    ((i - 2) * 0.095, y, -0.16),
                    ((i - 2) * 0.095, y, 0.06),
                    ((i - 2) * 0.095, y, 0.1),
                    ((i - 2) * 0.095, y, 0.17),
                ],
                [0.036, 0.036, 0.014, 0.014],
                8,
            )
    yield box("glass", (0.48, 1.12, 0.01), (0.0, 0.07, 0.245))
    for s in (-1, 1):
        yield box("steel", (0.035, 1.18, 0.03), (s * 0.255, 0.04, 0.255))
        yield box("steel", (0.48, 0.04, 0.03), (0.0, 0.04 + 1.14 * (s + 1) / 2, 0.255))
    yield rod("chrome", (0.22, 0.5, 0.3), (0.22, 0.9, 0.3), 0.009)


def dishwasher(open_: bool = False) -> Iterator[Solid]:
    """A door with a panel of buttons above."""
    yield box("black", (0.58, 0.1, 0.46), (0.0, 0.0, -0.05))
    yield box("steel", (0.6, 0.76, 0.54), (0.0, 0.1, -0.02))
    yield rounded("steel", (0.595, 0.62, 0.03), (0.0, 0.11, 0.265), 0.008, 1)
    yield rounded("black", (0.595, 0.1, 0.035), (0.0, 0.745, 0.262), 0.008, 1)
    yield rod("chrome", (-0.24, 0.69, 0.31), (0.24, 0.69, 0.31), 0.01)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.22, 0.69, 0.27), (s * 0.22, 0.69, 0.31), 0.007)
    for i in range(5):
        yield disc("chrome", 0.009, 0.01, (0.1 + 0.035 * i, 0.795, 0.277), 10)
    yield box("screen", (0.12, 0.035, 0.004), (-0.12, 0.778, 0.281))


def washer(kind: str = "front") -> Iterator[Solid]:
    """A washing machine with a round window, or one that is loaded from above."""
    if kind == "top":
        yield rounded("white", (0.58, 0.84, 0.6), (0.0, 0.02, 0.0), 0.02, 2)
        yield rounded("white", (0.5, 0.02, 0.42), (0.0, 0.86, 0.06), 0.008, 1)
        yield prism("gray", [(-0.3, 0.0), (-0.16, 0.0), (-0.22, 0.16), (-0.3, 0.16)], 0.58, (0.0, 0.86, 0.0), "side")
        for i in range(4):
            yield ball("chrome", 0.025, (-0.18 + 0.12 * i, 0.94, -0.185), 10, 6)
        return
    yield rounded("white", (0.6, 0.83, 0.54), (0.0, 0.02, -0.02), 0.015, 2)
    window = [turned("screen", [(0.16, 0.0), (0.15, 0.03), (0.1, 0.045), (0.02, 0.05)], sides=24, steps=2)]
    rim = [
        turned(
            "chrome" if kind == "front" else "black",
            [(0.21, 0.0), (0.2, 0.035), (0.165, 0.04), (0.16, 0.02)],
            sides=28,
            steps=2,
        )
    ]
    yield from placed_front([*window, *rim], (0.0, 0.44, 0.25))
    yield rounded("gray", (0.57, 0.11, 0.02), (0.0, 0.72, 0.248), 0.006, 1)
    yield rounded("white", (0.18, 0.09, 0.02), (-0.18, 0.73, 0.253), 0.006, 1)
    yield disc("chrome", 0.036, 0.035, (0.05, 0.775, 0.256), 20)
    yield box("screen", (0.14, 0.05, 0.006), (0.18, 0.75, 0.259))
    for x in (-0.25, 0.25):
        yield cylinder("black", 0.025, 0.025, (x, 0.0, 0.16), sides=10)
        yield cylinder("black", 0.025, 0.025, (x, 0.0, -0.2), sides=10)


def microwave(kind: str = "buttons") -> Iterator[Solid]:
    """A microwave oven with buttons or dials."""
    slot = "steel" if kind == "buttons" else "bright" if kind == "retro" else "white"
    yield rounded(slot, (0.48, 0.27, 0.36), (0.0, 0.012, 0.0), 0.03 if kind == "retro" else 0.01, 2)
    for x in (-0.18, 0.18):
        yield cylinder("black", 0.018, 0.014, (x, 0.0, 0.1), sides=10)
        yield cylinder("black", 0.018, 0.014, (x, 0.0, -0.1), sides=10)
    yield rounded("screen", (0.32, 0.22, 0.014), (-0.06, 0.037, 0.178), 0.008, 1)
    yield rod("chrome", (0.085, 0.06, 0.205), (0.085, 0.23, 0.205), 0.007)
    if kind == "buttons":
        for i in range(3):
            for j in range(4):
                yield rounded("gray", (0.024, 0.02, 0.008), (0.135 + 0.032 * i, 0.05 + 0.034 * j, 0.181), 0.003, 1)
        yield box("screen", (0.09, 0.035, 0.004), (0.167, 0.21, 0.181))
    else:
        for y in (0.1, 0.19):
            yield disc("chrome", 0.026, 0.025, (0.165, y, 0.178), 18)


def toaster(kind: str = "round", slots_: int = 2) -> Iterator[Solid]:
    """Two slots, a lever, perhaps bread that has popped up."""
    long = 0.26 + 0.06 * (slots_ > 2)
    yield rounded(
        "steel" if kind == "box" else "bright",
        (long, 0.17, 0.17),
        (0.0, 0.012, 0.0),
        0.02 if kind == "box" else 0.055,
        3,
    )
    yield box("black", (long - 0.03, 0.016, 0.14))
    for z in (-0.032, 0.032):
        yield box("black", (long - 0.09, 0.004, 0.026), (0.0, 0.1805, z))
        if kind == "round":
            yield rounded("crust", (0.11, 0.1, 0.016), (0.0, 0.14, z), 0.007, 1)
    yield rounded("black", (0.02, 0.02, 0.05), (long / 2 + 0.008, 0.12, 0.0), 0.006, 1)
    yield disc("black", 0.014, 0.012, (long / 2 - 0.05, 0.05, 0.08), 12)


def _filter() -> Iterator[Solid]:
    yield rounded("black", (0.2, 0.03, 0.26), (0.0, 0.0, 0.0), 0.012, 1)
    yield rounded("black", (0.2, 0.33, 0.1), (0.0, 0.02, -0.08), 0.02, 2)
    yield rounded("black", (0.2, 0.11, 0.24), (0.0, 0.25, -0.005), 0.025, 2)
    yield turned("glass", [(0.06, 0.0), (0.075, 0.05), (0.065, 0.1), (0.05, 0.13)], (0.0, 0.035, 0.05), 18, 2)
    yield turned("brown", [(0.056, 0.0), (0.068, 0.05), (0.062, 0.07)], (0.0, 0.038, 0.05), 16, 2)
    yield tube(
        "black", fillet([(0.0, 0.15, 0.11), (0.0, 0.15, 0.17), (0.0, 0.06, 0.17), (0.0, 0.06, 0.125)], 0.03), 0.009
    )


def _espresso() -> Iterator[Solid]:
    yield rounded("steel", (0.3, 0.06, 0.3), (0.0, 0.012, 0.0), 0.012, 2)
    yield rounded("steel", (0.3, 0.28, 0.14), (0.0, 0.06, -0.08), 0.015, 2)
    yield rounded("steel", (0.3, 0.1, 0.26), (0.0, 0.28, -0.02), 0.02, 2)
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
    yield rounded("bright", (0.13, 0.24, 0.2), (0.0, 0.0, -0.06), 0.03, 3)
    yield rounded("bright", (0.13, 0.09, 0.3), (0.0, 0.2, 0.0), 0.035, 3)
    yield rounded("black", (0.13, 0.025, 0.13), (0.0, 0.0, 0.1), 0.01, 1)
    yield rounded("chrome", (0.03, 0.03, 0.14), (0.0, 0.288, 0.02), 0.012, 2)
    yield cylinder("black", 0.018, 0.03, (0.0, 0.18, 0.1), sides=12)
    yield vessel("crockery", [(0.022, 0.0), (0.034, 0.04), (0.035, 0.06)], 0.003, (0.0, 0.025, 0.1), 14, 2)


def _percolator() -> Iterator[Solid]:
    yield turned(
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


_COFFEE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "filter": _filter,
    "espresso": _espresso,
    "capsule": _capsule,
    "percolator": _percolator,
}


def coffee(kind: str = "filter") -> Iterator[Solid]:
    """A coffee machine: filter, espresso, capsule or percolator."""
    yield from _COFFEE_KINDS[kind]()


def _electric_kettle() -> Iterator[Solid]:
    yield turned("black", [(0.085, 0.0), (0.085, 0.02), (0.07, 0.025)], sides=20, steps=1)
    yield turned("steel", [(0.078, 0.025), (0.08, 0.08), (0.06, 0.2), (0.045, 0.215), (0.01, 0.22)], sides=24, steps=2)
    yield prism("steel", [(0.05, 0.17), (0.1, 0.21), (0.05, 0.21)], 0.035)
    yield tube(
        "black",
        fillet([(-0.05, 0.21, 0.0), (-0.13, 0.22, 0.0), (-0.12, 0.07, 0.0), (-0.08, 0.05, 0.0)], 0.04),
        0.012,
    )
    yield ball("black", 0.012, (0.0, 0.228, 0.0), 10, 6)


def _stove_kettle() -> Iterator[Solid]:
    yield turned("bright", [(0.1, 0.0), (0.11, 0.02), (0.09, 0.1), (0.04, 0.14), (0.035, 0.15)], sides=24, steps=3)
    yield turned("bright", [(0.036, 0.15), (0.03, 0.16), (0.005, 0.165)], sides=16, steps=1)
    yield ball("black", 0.014, (0.0, 0.178, 0.0), 10, 6)
    yield tube("bright", [(0.08, 0.07, 0.0), (0.13, 0.12, 0.0), (0.15, 0.13, 0.0)], [0.022, 0.013, 0.01], 10)
    arch = [(0.085 * np.cos(a), 0.12 + 0.12 * np.sin(a), 0.0) for a in np.linspace(0.15, np.pi - 0.15, 12)]
    yield tube("black", arch, 0.009)


def _swan() -> Iterator[Solid]:
    yield turned("steel", [(0.075, 0.0), (0.09, 0.03), (0.085, 0.1), (0.06, 0.13), (0.01, 0.135)], sides=22, steps=2)
    yield ball("wood", 0.014, (0.0, 0.15, 0.0), 10, 6)
    yield tube(
        "steel",
        spline([(0.08, 0.03, 0.0), (0.13, 0.05, 0.0), (0.13, 0.12, 0.0), (0.17, 0.15, 0.0), (0.2, 0.14, 0.0)], 4),
        0.007,
    )
    yield tube("wood", fillet([(-0.07, 0.12, 0.0), (-0.16, 0.15, 0.0), (-0.15, 0.05, 0.0)], 0.05), 0.011)


def _glass_kettle() -> Iterator[Solid]:
    yield turned("black", [(0.085, 0.0), (0.085, 0.03), (0.075, 0.035)], sides=20, steps=1)
    yield vessel("glass", [(0.075, 0.035), (0.08, 0.1), (0.07, 0.19)], 0.003, (0.0, 0.0, 0.0), 22, 2)
    yield turned("water", [(0.07, 0.04), (0.076, 0.08), (0.075, 0.12)], sides=20, steps=1)
    yield turned("black", [(0.072, 0.19), (0.07, 0.21), (0.03, 0.22)], sides=20, steps=1)
    yield tube(
        "black",
        fillet([(-0.06, 0.205, 0.0), (-0.13, 0.2, 0.0), (-0.13, 0.05, 0.0), (-0.075, 0.045, 0.0)], 0.03),
        0.012,
    )


def _iron_kettle() -> Iterator[Solid]:
    yield turned("iron", [(0.06, 0.0), (0.09, 0.03), (0.088, 0.06), (0.05, 0.1), (0.04, 0.105)], sides=24, steps=3)
    for i in range(24):
        a = 2 * np.pi * i / 24
        yield ball("iron", 0.007, (0.09 * np.cos(a), 0.05, 0.09 * np.sin(a)), 6, 4)
    yield turned("iron", [(0.04, 0.104), (0.02, 0.112), (0.006, 0.115)], sides=14, steps=1)
    yield ball("iron", 0.01, (0.0, 0.123, 0.0), 8, 6)
    yield tube("iron", [(0.08, 0.05, 0.0), (0.12, 0.09, 0.0)], [0.016, 0.01], 8)
    yield tube("iron", [(0.06 * np.cos(a), 0.09 + 0.1 * np.sin(a), 0.0) for a in np.linspace(0, np.pi, 11)], 0.006)


_KETTLE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "electric": _electric_kettle,
    "stove": _stove_kettle,
    "swan": _swan,
    "glass": _glass_kettle,
    "iron": _iron_kettle,
}


def kettle(kind: str = "electric") -> Iterator[Solid]:
    """A kettle: electric, whistling or with a swan's neck."""
    yield from _KETTLE_KINDS[kind]()


def _blender() -> Iterator[Solid]:
    yield turned("bright", [(0.08, 0.0), (0.082, 0.03), (0.06, 0.12), (0.05, 0.14)], sides=8, steps=1)
    yield disc("black", 0.02, 0.02, (0.0, 0.05, 0.066), 14)
    yield vessel("glass", [(0.05, 0.14), (0.065, 0.22), (0.075, 0.34)], 0.004, sides=16, steps=2)
    yield turned("orange", [(0.046, 0.146), (0.058, 0.21), (0.062, 0.24)], sides=14, steps=1)
    yield turned("black", [(0.078, 0.34), (0.076, 0.365), (0.03, 0.37), (0.03, 0.39)], sides=16, steps=1)
    yield tube(
        "glass", fillet([(0.07, 0.32, 0.0), (0.12, 0.31, 0.0), (0.11, 0.19, 0.0), (0.06, 0.19, 0.0)], 0.03), 0.008
    )


def _mixer() -> Iterator[Solid]:
    yield rounded("bright", (0.18, 0.04, 0.34), (0.0, 0.0, 0.0), 0.018, 2)
    yield rounded("bright", (0.1, 0.22, 0.1), (0.0, 0.03, -0.11), 0.035, 3)
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
    yield rounded("white", (0.2, 0.13, 0.2), (0.0, 0.0, 0.0), 0.03, 2)
    yield disc("gray", 0.03, 0.02, (0.0, 0.065, 0.1), 16)
    yield vessel("glass", [(0.085, 0.13), (0.09, 0.16), (0.09, 0.27)], 0.004, sides=20, steps=1)
    yield turned("white", [(0.094, 0.27), (0.09, 0.29), (0.04, 0.3)], sides=20, steps=1)
    yield turned("glass", [(0.035, 0.3), (0.033, 0.38)], (0.03, 0.0, 0.0), 14, 1)
    yield cylinder("white", 0.038, 0.02, (0.03, 0.38, 0.0), sides=14)
    yield tube(
        "glass", fillet([(0.09, 0.26, 0.0), (0.14, 0.25, 0.0), (0.13, 0.16, 0.0), (0.09, 0.16, 0.0)], 0.03), 0.009
    )


def _juicer() -> Iterator[Solid]:
    yield turned("steel", [(0.09, 0.0), (0.09, 0.1), (0.07, 0.14)], sides=22, steps=2)
    yield vessel("steel", [(0.06, 0.14), (0.09, 0.17), (0.09, 0.19)], 0.004, sides=20, steps=1)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield rod("white", (0.03 * np.cos(a), 0.15, 0.03 * np.sin(a)), (0.0, 0.23, 0.0), 0.008, 0.003, 6)
    yield rod("steel", (0.08, 0.12, 0.0), (0.13, 0.1, 0.0), 0.012, 0.008)


_PROCESSOR_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "blender": _blender,
    "mixer": _mixer,
    "chopper": _chopper,
    "juicer": _juicer,
}


def processor(kind: str = "blender") -> Iterator[Solid]:
    """A blender, a stand mixer, a chopper or a juicer."""
    yield from _PROCESSOR_KINDS[kind]()


def dispenser() -> Iterator[Solid]:
    """A water dispenser with a large bottle upside down."""
    yield rounded("white", (0.31, 0.95, 0.32), (0.0, 0.02, 0.0), 0.025, 2)
    yield rounded("black", (0.22, 0.2, 0.04), (0.0, 0.66, 0.15), 0.015, 1)
    for x, slot in ((-0.05, "blue"), (0.05, "red")):
        yield rounded(slot, (0.025, 0.04, 0.04), (x, 0.78, 0.185), 0.008, 1)
    yield box("gray", (0.2, 0.012, 0.05), (0.0, 0.665, 0.18))
    yield turned(
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
    yield from mirrored(
        [
            cylinder("black", 0.02, 0.025, (0.12, 0.0, 0.1), sides=10),
            cylinder("black", 0.02, 0.025, (0.12, 0.0, -0.1), sides=10),
        ]
    )


def air_fryer() -> Iterator[Solid]:
    """A rounded pot with a drawer and a screen."""
    yield turned("black", [(0.12, 0.0), (0.145, 0.04), (0.15, 0.2), (0.12, 0.29), (0.05, 0.31)], sides=26, steps=3)
    yield rounded("black", (0.2, 0.14, 0.06), (0.0, 0.03, 0.12), 0.025, 2)
    yield rounded("gray", (0.035, 0.05, 0.1), (0.0, 0.08, 0.19), 0.014, 2)
    yield rounded("screen", (0.1, 0.05, 0.02), (0.0, 0.215, 0.138), 0.008, 1)


FRIDGES = (
    design(fridge),
    design(side_by_side),
    design(retro),
    design(french),
    design(mini),
    design(wine_cooler),
    design(fridge, slot="white", split=1.3, height=1.7),
)
KETTLES = tuple(design(kettle, kind=kind) for kind in ("electric", "stove", "swan", "glass", "iron"))
COFFEES = tuple(design(coffee, kind=kind) for kind in ("filter", "espresso", "capsule", "percolator"))
MIXERS = tuple(design(processor, kind=kind) for kind in ("blender", "mixer", "chopper", "juicer"))

FAMILIES = (
    Family("refrigerator", "refrigerator", FRIDGES),
    Family("dishwasher", "dishwasher", (design(dishwasher),)),
    Family("washer", "washer", (design(washer), design(washer, kind="top"), design(washer, kind="black"))),
    Family("dryer", "dryer", (design(washer, kind="black"),)),
    Family(
        "microwave", "microwave", (design(microwave), design(microwave, kind="dials"), design(microwave, kind="retro"))
    ),
    Family("toaster", "toaster", (design(toaster), design(toaster, kind="box"), design(toaster, slots_=4, kind="box"))),
    Family("coffee_machine", "coffee_machine", COFFEES),
    Family("kettle", "kettle", KETTLES),
    Family("food_processor", "food_processor", (*MIXERS, design(air_fryer))),
    Family("water_dispenser", "water_dispenser", (design(dispenser),)),
)
