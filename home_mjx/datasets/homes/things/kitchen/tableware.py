"""Crockery, glasses, pots, food, and what stands on kitchen counters."""

from collections.abc import Callable, Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.sheets import leaf
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def _ear(slot: str, radius: float, low: float, high: float, bar: float = 0.005) -> Solid:
    """A handle on the +x side of a cup."""
    path = fillet(
        [(radius, high, 0.0), (radius + 0.032, high, 0.0), (radius + 0.03, low, 0.0), (radius, low, 0.0)], 0.018, 4
    )
    return tube(slot, path, bar, 8)


def _mug() -> Iterator[Solid]:
    yield vessel("crockery", [(0.038, 0.0), (0.041, 0.006), (0.041, 0.09), (0.042, 0.095)], 0.004, sides=20, steps=1)
    yield cylinder("brown", 0.036, 0.002, (0.0, 0.08, 0.0), sides=18)
    yield _ear("crockery", 0.04, 0.022, 0.076, 0.006)


def _tea() -> Iterator[Solid]:
    yield vessel("crockery", [(0.035, 0.0), (0.05, 0.006), (0.076, 0.018)], 0.003, sides=24, steps=2)
    yield vessel(
        "crockery", [(0.02, 0.0), (0.022, 0.008), (0.04, 0.03), (0.047, 0.065)], 0.003, (0.0, 0.005, 0.0), 20, 3
    )
    yield _ear("crockery", 0.042, 0.03, 0.058, 0.004)
    yield cylinder("brown", 0.04, 0.002, (0.0, 0.052, 0.0), sides=18)


def _enamel() -> Iterator[Solid]:
    yield vessel("white", [(0.04, 0.0), (0.042, 0.08)], 0.003, sides=20, steps=1)
    yield ring("blue", 0.0415, 0.004, (0.0, 0.08, 0.0), 1, 20)
    yield _ear("white", 0.041, 0.015, 0.065, 0.004)


def _bowl() -> Iterator[Solid]:
    yield vessel("glaze", [(0.03, 0.0), (0.032, 0.008), (0.06, 0.03), (0.068, 0.06)], 0.004, sides=22, steps=3)
    for s in (-1, 1):
        yield rounded("glaze", (0.03, 0.012, 0.03), (s * 0.075, 0.045, 0.0), 0.005, 2)


def _footed() -> Iterator[Solid]:
    yield vessel(
        "glaze", [(0.03, 0.0), (0.02, 0.01), (0.014, 0.02), (0.035, 0.04), (0.04, 0.1)], 0.004, sides=20, steps=3
    )
    yield _ear("glaze", 0.038, 0.045, 0.09, 0.005)


def _travel() -> Iterator[Solid]:
    yield turned("bright", [(0.032, 0.0), (0.035, 0.01), (0.042, 0.15)], sides=20, steps=1)
    yield turned("black", [(0.043, 0.15), (0.043, 0.165), (0.036, 0.178)], sides=20, steps=1)
    yield turned("rubber", [(0.0395, 0.06), (0.042, 0.1)], sides=20, steps=1)


def _espresso() -> Iterator[Solid]:
    yield vessel("crockery", [(0.028, 0.0), (0.05, 0.01)], 0.003, sides=22, steps=1)
    yield vessel("crockery_1", [(0.018, 0.0), (0.028, 0.02), (0.03, 0.05)], 0.003, (0.0, 0.004, 0.0), 18, 2)
    yield _ear("crockery_1", 0.027, 0.02, 0.042, 0.004)
    yield rod("chrome", (-0.03, 0.012, 0.035), (0.03, 0.014, 0.035), 0.0025, sides=6)


def _stack() -> Iterator[Solid]:
    for i in range(3):
        yield vessel(
            f"crockery_{i}", [(0.026, 0.0), (0.04, 0.03), (0.042, 0.055)], 0.003, (0.003 * i, 0.028 * i, 0.0), 18, 2
        )
        yield move(_ear(f"crockery_{i}", 0.038, 0.015, 0.045, 0.004), (0.003 * i, 0.028 * i, 0.0))


def _hex() -> Iterator[Solid]:
    yield vessel("glaze", [(0.036, 0.0), (0.044, 0.03), (0.044, 0.09)], 0.005, sides=6, steps=1)
    yield _ear("glaze", 0.038, 0.025, 0.075, 0.007)
    yield cylinder("cream", 0.034, 0.002, (0.0, 0.078, 0.0), sides=12)
    yield ring("brass", 0.041, 0.003, (0.0, 0.09, 0.0), 1, 6)


def _pens() -> Iterator[Solid]:
    yield vessel("glaze", [(0.03, 0.0), (0.036, 0.02), (0.034, 0.06), (0.038, 0.1)], 0.004, sides=20, steps=3)
    for i in range(5):
        yield rod("wood", (0.01 * (i - 2), 0.02, 0.0), (0.022 * (i - 2), 0.17, 0.012 * (-1) ** i), 0.003, sides=6)


_CUP_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "mug": _mug,
    "tea": _tea,
    "enamel": _enamel,
    "bowl": _bowl,
    "footed": _footed,
    "travel": _travel,
    "espresso": _espresso,
    "stack": _stack,
    "hex": _hex,
    "pens": _pens,
}


def cup(kind: str = "mug") -> Iterator[Solid]:
    """A mug, a tea cup with its saucer, an enamel beaker, a bowl-shaped or a footed cup."""
    yield from _CUP_KINDS[kind]()


def _stack_plates() -> Iterator[Solid]:
    for i in range(6):
        yield vessel(
            "crockery",
            [(0.06, 0.0), (0.09, 0.004), (0.13, 0.02)],
            0.004,
            (0.002 * (-1) ** i, 0.0085 * i, 0.0),
            24,
            1,
        )


def _bowls() -> Iterator[Solid]:
    for i in range(4):
        yield vessel(
            "glaze",
            [(0.035, 0.0), (0.04, 0.008), (0.07, 0.03), (0.08, 0.055)],
            0.004,
            (0.0, 0.018 * i, 0.002 * (-1) ** i),
            22,
            2,
        )


def _rack() -> Iterator[Solid]:
    for s in (-1, 1):
        yield tube("chrome", fillet([(-0.17, 0.006, s * 0.08), (0.17, 0.006, s * 0.08)], 0.01), 0.005, 6)
    for i in range(8):
        x = -0.15 + 0.043 * i
        yield tube(
            "chrome", fillet([(x, 0.006, -0.08), (x, 0.1, -0.02), (x, 0.1, 0.02), (x, 0.006, 0.08)], 0.03), 0.003, 5
        )
        if i in (0, 1, 2, 4, 5):
            plate = rotate(
                vessel("crockery", [(0.05, 0.0), (0.075, 0.004), (0.105, 0.016)], 0.004, sides=22, steps=1),
                2,
                -1.42,
            )
            yield move(plate, (x + 0.01, 0.112, 0.0))


def _platter() -> Iterator[Solid]:
    yield vessel("crockery", [(0.08, 0.0), (0.11, 0.005), (0.15, 0.022)], 0.004, sides=28, steps=2, stretch=0.66)
    for i in range(5):
        yield ball("red" if i % 2 else "green", 0.026, (-0.07 + 0.035 * i, 0.03, 0.015 * (-1) ** i), 10, 6)


def _plate_set() -> Iterator[Solid]:
    yield vessel("crockery", [(0.06, 0.0), (0.09, 0.004), (0.13, 0.016)], 0.004, sides=26, steps=1)
    yield vessel("crockery", [(0.05, 0.0), (0.07, 0.004), (0.1, 0.014)], 0.004, (0.0, 0.006, 0.0), 24, 1)
    yield from _cutlery(-0.16, 0.17)


_PLATES_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "stack": _stack_plates,
    "bowls": _bowls,
    "rack": _rack,
    "platter": _platter,
    "set": _plate_set,
}


def plates(kind: str = "stack") -> Iterator[Solid]:
    """A pile of plates, a laid place, bowls, a plate in a rack, a platter."""
    yield from _PLATES_KINDS[kind]()


def _cutlery(left: float, right: float) -> Iterator[Solid]:
    """A fork to the left, a knife and a spoon to the right."""
    yield rounded("steel", (0.011, 0.003, 0.12), (left, 0.0, 0.03), 0.001, 1)
    yield rounded("steel", (0.024, 0.003, 0.03), (left, 0.0, -0.045), 0.001, 1)
    for i in range(4):
        yield box("steel", (0.003, 0.002, 0.04), (left - 0.0095 + 0.0063 * i, 0.0005, -0.078))
    yield rounded("steel", (0.014, 0.005, 0.1), (right, 0.0, 0.05), 0.002, 1)
    yield prism(
        "steel",
        [(right - 0.008, 0.0), (right + 0.008, 0.0), (right + 0.008, -0.08), (right, -0.11), (right - 0.006, -0.09)],
        0.002,
        plane="top",
    )
    yield rounded("steel", (0.01, 0.003, 0.12), (right + 0.035, 0.0, 0.03), 0.001, 1)
    yield ball("steel", (0.019, 0.004, 0.03), (right + 0.035, 0.004, -0.055), 12, 6)


def setting(mat: str = "round") -> Iterator[Solid]:
    """A mat with plates, cutlery, a glass and a napkin."""
    if mat == "round":
        yield cylinder("cane", 0.19, 0.004, sides=30)
    else:
        yield rounded("textile", (0.44, 0.004, 0.32), (0.0, 0.0, 0.0), 0.002, 1)
    yield from (move(p, (0.0, 0.004, 0.0)) for p in plates("set"))
    yield vessel("glass", [(0.028, 0.0), (0.032, 0.04), (0.036, 0.11)], 0.002, (0.14, 0.004, -0.13), 16, 1)
    yield (
        rounded("linen", (0.07, 0.008, 0.16), (-0.03, 0.024, 0.0), 0.003, 1)
        if mat == "round"
        else soft("textile_1", (0.09, 0.016, 0.09), (0.0, 0.024, 0.0), 3.0, 3)
    )


def glass(kind: str = "wine") -> Iterator[Solid]:
    """A drinking glass: for wine, water, champagne, beer."""
    shapes = {
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
        "goblet": [(0.036, 0.0), (0.02, 0.01), (0.009, 0.025), (0.012, 0.045), (0.036, 0.07), (0.043, 0.13)],
    }
    yield vessel("glass" if kind != "goblet" else "tint", shapes[kind], 0.002, sides=22, steps=3)
    if kind == "highball":
        yield cylinder("orange", 0.031, 0.1, (0.0, 0.006, 0.0), sides=18)
        yield rod("red", (-0.02, 0.02, 0.0), (0.035, 0.2, 0.0), 0.003, sides=6)
        yield move(rotate(cylinder("yellow", 0.026, 0.005, sides=16), 2, 1.5), (0.036, 0.15, 0.0))
    elif kind == "wine":
        yield turned("red", [(0.006, 0.102), (0.03, 0.118), (0.036, 0.14)], sides=18, steps=2)
    elif kind == "tumbler":
        for i, (x, z) in enumerate(((0.008, 0.006), (-0.012, -0.004))):
            yield rotate(rounded("water", (0.024, 0.024, 0.024), (x, 0.02 + 0.026 * i, z), 0.004, 1), 1, 0.6 * i)


def _wine_bottle() -> Iterator[Solid]:
    yield turned(
        "green",
        [(0.034, 0.0), (0.038, 0.006), (0.038, 0.17), (0.03, 0.21), (0.014, 0.235), (0.013, 0.3)],
        sides=18,
        steps=1,
    )
    yield turned("red", [(0.0145, 0.27), (0.0145, 0.302)], sides=14, steps=1)
    yield turned("cream", [(0.0385, 0.05), (0.0385, 0.13)], sides=18, steps=1)


def _water_bottle() -> Iterator[Solid]:
    yield turned(
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
    yield turned("blue", [(0.0345, 0.105), (0.0345, 0.15)], sides=18, steps=1)


def _oil_bottle() -> Iterator[Solid]:
    yield turned("tint", [(0.035, 0.0), (0.038, 0.02), (0.034, 0.15), (0.012, 0.2), (0.011, 0.25)], sides=4, steps=2)
    yield tube("chrome", [(0.0, 0.25, 0.0), (0.0, 0.28, 0.0), (0.02, 0.3, 0.0)], [0.008, 0.006, 0.003])
    yield rounded("cream", (0.03, 0.06, 0.002), (0.0, 0.05, 0.029), 0.001, 1)


def _milk_bottle() -> Iterator[Solid]:
    yield turned(
        "white",
        [(0.038, 0.0), (0.042, 0.01), (0.042, 0.14), (0.022, 0.19), (0.02, 0.22), (0.024, 0.225)],
        sides=20,
        steps=2,
    )
    yield turned("red", [(0.025, 0.222), (0.024, 0.235)], sides=16, steps=1)


def _jar_bottle() -> Iterator[Solid]:
    yield turned("tint", [(0.04, 0.0), (0.044, 0.012), (0.044, 0.1), (0.036, 0.115)], sides=20, steps=1)
    yield turned("red", [(0.039, 0.115), (0.039, 0.13)], sides=20, steps=1)
    yield turned("paper", [(0.0445, 0.03), (0.0445, 0.085)], sides=20, steps=1)


_BOTTLE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "wine": _wine_bottle,
    "water": _water_bottle,
    "oil": _oil_bottle,
    "milk": _milk_bottle,
    "jar": _jar_bottle,
}


def bottle(kind: str = "wine") -> Iterator[Solid]:
    """A bottle of wine, water, oil, milk, or a jar."""
    yield from _BOTTLE_KINDS[kind]()


def fruit(kind: str = "bowl") -> Iterator[Solid]:
    """Apples, oranges, pears, bananas in a bowl, a basket, on a stand, in a wire bowl."""
    low = {"bowl": 0.02, "basket": 0.03, "stand": 0.17, "wire": 0.03}[kind]
    if kind == "bowl":
        yield vessel("glaze", [(0.06, 0.0), (0.065, 0.01), (0.12, 0.04), (0.15, 0.085)], 0.006, sides=28, steps=3)
    elif kind == "basket":
        yield vessel("cane", [(0.1, 0.0), (0.13, 0.04), (0.15, 0.09)], 0.01, sides=24, steps=2)
        yield tube(
            "cane", [(0.145 * np.cos(a), 0.08 + 0.16 * np.sin(a), 0.0) for a in np.linspace(0, np.pi, 13)], 0.008
        )
    elif kind == "stand":
        yield turned("wood", [(0.09, 0.0), (0.03, 0.02), (0.02, 0.08), (0.04, 0.15)], sides=20, steps=3)
        yield vessel("wood", [(0.05, 0.145), (0.14, 0.16), (0.16, 0.19)], 0.008, sides=28, steps=2)
    else:
        for y, r in ((0.005, 0.07), (0.04, 0.12), (0.085, 0.15)):
            yield ring("iron", r, 0.008, (0.0, y, 0.0), 1, 24)
        for i in range(14):
            a = 2 * np.pi * i / 14
            c, s = np.cos(a), np.sin(a)
            yield tube("iron", [(r * c, y, r * s) for y, r in ((0.005, 0.07), (0.04, 0.12), (0.085, 0.15))], 0.003, 5)
        yield cylinder("iron", 0.07, 0.006, (0.0, 0.002, 0.0), sides=24)
    spots = (
        (0.0, 0.0, "red"),
        (0.075, 0.02, "orange"),
        (-0.07, 0.03, "orange"),
        (0.01, -0.075, "green"),
        (0.0, 0.08, "red"),
    )
    for i, (x, z, slot) in enumerate(spots):
        yield ball(slot, (0.04, 0.038, 0.04), (x, low + 0.042 + 0.5 * abs(x), z), 14, 8)
        yield rod(
            "brown", (x, low + 0.076 + 0.5 * abs(x), z), (x + 0.005, low + 0.092 + 0.5 * abs(x), z), 0.002, sides=5
        )
        if i < 2:
            yield ball(slot if i else "green", 0.037, (0.03 - 0.06 * i, low + 0.1, 0.03 - 0.05 * i), 14, 8)
    for i in range(3):
        path = [
            (0.1 * np.cos(a) - 0.03, low + 0.09 + 0.012 * i + 0.02 * np.sin(3 * a), 0.1 * np.sin(a) - 0.02 + 0.02 * i)
            for a in np.linspace(0.5, 2.2, 7)
        ]
        yield tube("yellow", path, [0.006, 0.015, 0.018, 0.018, 0.018, 0.014, 0.005], 8)


def knives(kind: str = "block") -> Iterator[Solid]:
    """A block of knives, a magnet bar, or a fan of knives in a stand."""
    if kind == "bar":
        yield rounded("wood", (0.42, 0.05, 0.02), (0.0, 0.2, -0.02), 0.005, 1)
        for i in range(5):
            x, long = -0.16 + 0.08 * i, 0.2 - 0.025 * i
            yield prism(
                "steel",
                [(x - 0.018, 0.25), (x + 0.014, 0.25), (x + 0.012, 0.25 - 0.6 * long), (x - 0.016, 0.25 - long)],
                0.003,
                (0.0, 0.0, -0.008),
            )
            yield rounded("black", (0.024, 0.11, 0.016), (x, 0.25, -0.008), 0.006, 2)
        return
    if kind == "block":
        yield prism(
            "wood", [(-0.1, 0.0), (0.1, 0.0), (0.1, 0.05), (-0.02, 0.23), (-0.1, 0.18)], 0.11, (0.0, 0.0, 0.0), "side"
        )
    else:
        yield rounded("bright", (0.16, 0.2, 0.09), (0.0, 0.0, 0.0), 0.02, 3)
    for row in range(2):
        for i in range(3):
            x, z, y = (i - 1) * 0.034, 0.02 - 0.055 * row, 0.19 - 0.03 * row
            grip = [
                rounded("black", (0.018, 0.12, 0.024), (x, y, z), 0.007, 2),
                box("steel", (0.02, 0.02, 0.026), (x, y - 0.01, z)),
            ]
            yield from (rotate(p, 0, 0.72 if kind == "block" else 0.0, (x, 0.1, 0.0)) for p in grip)


def board(kind: str = "plain") -> Iterator[Solid]:
    """A chopping board with bread, with vegetables, or boards on edge in a stand."""
    if kind == "stand":
        for i in range(3):
            piece = rounded(
                ("wood", "bright", "white")[i],
                (0.32 - 0.03 * i, 0.24 - 0.02 * i, 0.016),
                (0.0, 0.012, -0.04 + 0.035 * i),
                0.007,
                2,
            )
            yield rotate(piece, 0, -0.12, (0.0, 0.012, -0.04 + 0.035 * i))
        yield rounded("black", (0.2, 0.014, 0.14), (0.0, 0.0, -0.01), 0.005, 1)
        return
    yield rounded("wood", (0.38, 0.022, 0.25), (0.0, 0.0, 0.0), 0.009, 2)
    if kind == "plain":
        yield ring("black", 0.022, 0.008, (0.16, 0.022, 0.0), 1, 16)
        yield soft("crust", (0.22, 0.1, 0.11), (-0.06, 0.022, 0.0), 2.6, 6)
        for i in range(2):
            yield rotate(
                soft("cream", (0.016, 0.09, 0.1), (0.07 + 0.025 * i, 0.024, 0.0), 3.0, 4),
                2,
                -0.3 - 0.5 * i,
                (0.07 + 0.025 * i, 0.024, 0.0),
            )
    else:
        yield tube(
            "orange", [(-0.14, 0.036, -0.06), (-0.06, 0.036, -0.05), (0.0, 0.036, -0.045)], [0.004, 0.012, 0.014], 10
        )
        for i in range(4):
            yield cylinder("red", 0.028, 0.008, (0.02 + 0.03 * i, 0.022 + 0.004 * (i % 2), 0.04), sides=16)
        yield ball("green", (0.035, 0.03, 0.035), (-0.1, 0.05, 0.05), 12, 8)
        yield prism(
            "steel", [(0.0, -0.1), (0.15, -0.1), (0.15, -0.07), (0.02, -0.075)], 0.003, (0.0, 0.022, 0.0), "top"
        )
        yield rounded("black", (0.11, 0.016, 0.024), (0.2, 0.018, -0.085), 0.007, 2)


def utensils(kind: str = "jar") -> Iterator[Solid]:
    """Spoons, a whisk and a spatula in a jar, or hanging from a rail."""
    base = 0.16 if kind == "jar" else 0.02
    if kind == "jar":
        yield vessel("glaze", [(0.05, 0.0), (0.058, 0.02), (0.055, 0.1), (0.06, 0.15)], 0.005, sides=20, steps=2)
    else:
        yield rod("chrome", (-0.22, 0.3, -0.03), (0.22, 0.3, -0.03), 0.007)
        for s in (-1, 1):
            yield rounded("chrome", (0.03, 0.03, 0.02), (s * 0.2, 0.285, -0.045), 0.006, 1)
    for i in range(5):
        if kind == "jar":
            a = 2 * np.pi * i / 5
            foot, tip = (0.01 * np.cos(a), 0.02, 0.01 * np.sin(a)), (0.06 * np.cos(a), base + 0.1, 0.06 * np.sin(a))
        else:
            x = -0.16 + 0.08 * i
            foot, tip = (x, 0.3, -0.02), (x, base + 0.09, -0.02)
        yield rod(("wood", "steel", "black", "wood", "steel")[i], foot, tip, 0.005)
        x, y, z = tip
        if i == 0:
            yield ball("wood", (0.022, 0.032, 0.009), (x, y + 0.02, z), 12, 6)
        elif i == 1:
            for k in range(3):
                c, s = np.cos(k * np.pi / 3), np.sin(k * np.pi / 3)
                yield tube(
                    "steel",
                    [
                        (x, y - 0.02, z),
                        (x + 0.02 * c, y + 0.03, z + 0.02 * s),
                        (x, y + 0.06, z),
                        (x - 0.02 * c, y + 0.03, z - 0.02 * s),
                        (x, y - 0.02, z + 1e-4),
                    ],
                    0.002,
                    5,
                )
        elif i == 2:
            yield rounded("black", (0.06, 0.07, 0.006), (x, y - 0.01, z), 0.003, 1)
        elif i == 3:
            yield rounded("wood", (0.045, 0.075, 0.008), (x, y - 0.01, z), 0.004, 2)
        else:
            yield vessel("steel", [(0.012, 0.0), (0.03, 0.01), (0.034, 0.03)], 0.003, (x, y - 0.01, z), 16, 2)


def _frying_pan() -> Iterator[Solid]:
    yield vessel("iron", [(0.11, 0.0), (0.13, 0.01), (0.14, 0.045)], 0.004, sides=28, steps=2)
    yield tube("black", [(0.135, 0.04, 0.0), (0.2, 0.055, 0.0), (0.33, 0.065, 0.0)], [0.008, 0.011, 0.012], 8)


def _cooking_pot() -> Iterator[Solid]:
    yield vessel("steel", [(0.11, 0.0), (0.115, 0.01), (0.115, 0.14)], 0.004, sides=28, steps=1)
    yield turned("steel", [(0.118, 0.14), (0.11, 0.15), (0.03, 0.168), (0.012, 0.17)], sides=28, steps=1)
    yield turned("black", [(0.01, 0.17), (0.01, 0.18), (0.022, 0.19), (0.012, 0.2)], sides=14, steps=1)
    for s in (-1, 1):
        yield tube(
            "black",
            fillet(
                [
                    (s * 0.113, 0.11, -0.035),
                    (s * 0.155, 0.115, -0.03),
                    (s * 0.155, 0.115, 0.03),
                    (s * 0.113, 0.11, 0.035),
                ],
                0.02,
            ),
            0.007,
        )


def _wok() -> Iterator[Solid]:
    yield vessel("iron", [(0.04, 0.0), (0.1, 0.02), (0.16, 0.09)], 0.004, sides=28, steps=3)
    yield tube("wood", [(0.155, 0.085, 0.0), (0.2, 0.1, 0.0), (0.31, 0.12, 0.0)], [0.008, 0.012, 0.013], 8)
    yield tube(
        "iron",
        fillet([(-0.155, 0.085, -0.03), (-0.19, 0.1, -0.025), (-0.19, 0.1, 0.025), (-0.155, 0.085, 0.03)], 0.02),
        0.005,
    )


def _casserole() -> Iterator[Solid]:
    yield turned("bright", [(0.11, 0.0), (0.125, 0.02), (0.13, 0.11)], sides=28, steps=2, stretch=0.8)
    yield turned("bright", [(0.135, 0.11), (0.13, 0.125), (0.06, 0.145), (0.015, 0.15)], sides=28, steps=2, stretch=0.8)
    yield turned("brass", [(0.01, 0.148), (0.01, 0.16), (0.02, 0.17), (0.01, 0.178)], sides=14, steps=1)
    for s in (-1, 1):
        yield rounded("bright", (0.045, 0.018, 0.08), (s * 0.14, 0.085, 0.0), 0.008, 2)


_PAN_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "frying": _frying_pan,
    "pot": _cooking_pot,
    "wok": _wok,
    "casserole": _casserole,
}


def pan(kind: str = "frying") -> Iterator[Solid]:
    """A frying pan, a pot with a lid, a wok, a casserole."""
    yield from _PAN_KINDS[kind]()


def _pitcher() -> Iterator[Solid]:
    yield vessel(
        "glaze", [(0.05, 0.0), (0.075, 0.05), (0.06, 0.14), (0.045, 0.19), (0.055, 0.23)], 0.005, sides=22, steps=3
    )
    yield prism("glaze", [(-0.045, 0.19), (-0.085, 0.232), (-0.045, 0.228)], 0.03)
    yield tube(
        "glaze", fillet([(0.05, 0.2, 0.0), (0.12, 0.2, 0.0), (0.11, 0.08, 0.0), (0.07, 0.06, 0.0)], 0.05, 4), 0.009
    )


def _carafe() -> Iterator[Solid]:
    yield vessel(
        "glass",
        [(0.06, 0.0), (0.075, 0.03), (0.06, 0.1), (0.022, 0.16), (0.024, 0.2), (0.04, 0.23)],
        0.003,
        sides=24,
        steps=3,
    )
    yield turned("water", [(0.057, 0.006), (0.071, 0.03), (0.06, 0.085)], sides=20, steps=2)


def _thermos() -> Iterator[Solid]:
    yield turned("bright", [(0.055, 0.0), (0.06, 0.01), (0.06, 0.18), (0.04, 0.22), (0.038, 0.25)], sides=22, steps=2)
    yield turned("black", [(0.042, 0.25), (0.045, 0.26), (0.03, 0.29), (0.01, 0.295)], sides=18, steps=1)
    yield tube("black", fillet([(0.04, 0.24, 0.0), (0.11, 0.23, 0.0), (0.1, 0.08, 0.0), (0.06, 0.07, 0.0)], 0.04), 0.01)


_JUG_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "pitcher": _pitcher,
    "carafe": _carafe,
    "thermos": _thermos,
}


def jug(kind: str = "pitcher") -> Iterator[Solid]:
    """A pitcher, a carafe, a milk can, a thermos."""
    yield from _JUG_KINDS[kind]()


def teapot(kind: str = "round") -> Iterator[Solid]:
    """A round, a tall or a glass teapot."""
    slot = "tint" if kind == "glass" else "glaze"
    body = (
        [(0.05, 0.0), (0.085, 0.05), (0.07, 0.1), (0.035, 0.118)]
        if kind != "tall"
        else [(0.05, 0.0), (0.055, 0.02), (0.05, 0.13), (0.035, 0.16)]
    )
    top = body[-1][1]
    yield turned(slot, body, sides=24, steps=3)
    yield turned(
        "glaze",
        [(0.037, top - 0.003), (0.03, top + 0.008), (0.01, top + 0.014), (0.012, top + 0.026), (0.004, top + 0.032)],
        sides=16,
        steps=2,
    )
    yield tube(
        slot,
        spline([(0.07, 0.035, 0.0), (0.105, 0.06, 0.0), (0.12, top - 0.01, 0.0), (0.14, top, 0.0)], 3),
        [0.016, 0.014, 0.012, 0.011, 0.01, 0.009, 0.008, 0.007, 0.006, 0.006],
    )
    yield tube(
        slot,
        fillet(
            [(-0.06, 0.85 * top, 0.0), (-0.125, 0.9 * top, 0.0), (-0.12, 0.3 * top, 0.0), (-0.07, 0.3 * top, 0.0)],
            0.04,
            4,
        ),
        0.008,
    )


def _jars() -> Iterator[Solid]:
    for i, high in enumerate((0.18, 0.145, 0.11)):
        x = (-0.11, 0.0, 0.1)[i]
        yield turned(
            "glaze",
            [(0.044, 0.0), (0.048, 0.008), (0.048, high - 0.02), (0.042, high - 0.01)],
            (x, 0.0, 0.0),
            18,
            1,
        )
        yield turned(
            "wood",
            [(0.048, high - 0.01), (0.048, high + 0.008), (0.012, high + 0.012), (0.014, high + 0.026)],
            (x, 0.0, 0.0),
            18,
            1,
        )


def _tins() -> Iterator[Solid]:
    for i in range(3):
        yield turned(f"bright_{i}", [(0.05, 0.0), (0.05, 0.13)], (-0.11 + 0.11 * i, 0.0, 0.0), 20, 1)
        yield turned("chrome", [(0.052, 0.128), (0.052, 0.145), (0.045, 0.15)], (-0.11 + 0.11 * i, 0.0, 0.0), 20, 1)


def _spices() -> Iterator[Solid]:
    yield from (box("wood", (0.36, 0.012, 0.08), (0.0, y, 0.0)) for y in (0.0, 0.13))
    yield from (box("wood", (0.012, 0.26, 0.08), (s * 0.18, 0.0, 0.0)) for s in (-1, 1))
    for row in range(2):
        for i in range(6):
            at = (-0.14 + 0.056 * i, 0.012 + 0.13 * row, 0.0)
            yield turned(
                ("orange", "red", "green", "brown", "yellow", "cream")[(i + row) % 6],
                [(0.02, 0.0), (0.02, 0.06)],
                at,
                12,
                1,
            )
            yield turned("black", [(0.021, 0.06), (0.021, 0.078)], at, 12, 1)


def _bread_box() -> Iterator[Solid]:
    half = [
        (-0.12, 0.0),
        (0.12, 0.0),
        *[(0.12 * np.cos(a), 0.03 + 0.16 * np.sin(a)) for a in np.linspace(0, np.pi, 11)],
    ]
    yield prism("bright", half, 0.36, (0.0, 0.0, 0.0), "side")
    yield rounded("chrome", (0.1, 0.014, 0.02), (0.0, 0.05, 0.125), 0.005, 1)


_CONTAINERS_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "jars": _jars,
    "tins": _tins,
    "spices": _spices,
    "bread": _bread_box,
}


def containers(kind: str = "jars") -> Iterator[Solid]:
    """Three jars with lids, tins, or boxes for bread."""
    yield from _CONTAINERS_KINDS[kind]()


def cake(kind: str = "whole") -> Iterator[Solid]:
    """A cake on a stand, muffins on a plate, or a cake under a glass bell."""
    yield turned(
        "crockery",
        [(0.06, 0.0), (0.02, 0.015), (0.018, 0.06), (0.04, 0.075), (0.14, 0.08), (0.145, 0.09)],
        sides=28,
        steps=1,
    )
    if kind == "muffins":
        for i in range(5):
            a = 2 * np.pi * i / 5
            x, z = 0.085 * np.cos(a), 0.085 * np.sin(a)
            yield turned("paper", [(0.024, 0.09), (0.032, 0.125)], (x, 0.0, z), 12, 1)
            yield ball("crust", (0.036, 0.024, 0.036), (x, 0.128, z), 12, 6)
        return
    yield turned("cream", [(0.11, 0.09), (0.11, 0.17), (0.1, 0.175)], sides=28, steps=1)
    yield turned("brown", [(0.1112, 0.12), (0.1112, 0.135)], sides=28, steps=1)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield ball("red", 0.013, (0.085 * np.cos(a), 0.186, 0.085 * np.sin(a)), 10, 6)
    if kind == "bell":
        yield vessel("glass", [(0.13, 0.0), (0.13, 0.1), (0.07, 0.16), (0.012, 0.17)], 0.003, (0.0, 0.09, 0.0), 26, 2)
        yield ball("glass", 0.014, (0.0, 0.275, 0.0), 10, 6)


def bread(kind: str = "loaf") -> Iterator[Solid]:
    """A loaf, baguettes in a basket, rolls."""
    if kind == "loaf":
        yield soft("crust", (0.28, 0.11, 0.13), (0.0, 0.0, 0.0), 2.8, 7)
        for i in range(4):
            yield rotate(
                soft("cream", (0.014, 0.008, 0.09), (-0.08 + 0.055 * i, 0.105, 0.0), 2.5, 3),
                1,
                0.5,
                (-0.08 + 0.055 * i, 0.1, 0.0),
            )
    else:
        yield vessel("cane", [(0.1, 0.0), (0.13, 0.03), (0.14, 0.08)], 0.008, sides=24, steps=2, stretch=0.7)
        for i in range(6):
            yield ball(
                "crust",
                (0.045, 0.035, 0.038),
                ((i % 3 - 1) * 0.07, 0.06 + 0.04 * (i // 4), (i // 3 - 0.5) * 0.06),
                12,
                8,
            )


def _pizza() -> Iterator[Solid]:
    yield cylinder("wood", 0.17, 0.012, sides=30)
    yield turned("crust", [(0.15, 0.012), (0.155, 0.02), (0.145, 0.028), (0.13, 0.02)], sides=30, steps=2)
    yield cylinder("yellow", 0.132, 0.004, (0.0, 0.019, 0.0), sides=30)
    for i in range(9):
        a = 2.4 * i
        yield cylinder(
            "red", 0.018, 0.004, (0.038 * np.sqrt(i) * np.cos(a), 0.0225, 0.038 * np.sqrt(i) * np.sin(a)), sides=12
        )


def _salad() -> Iterator[Solid]:
    yield vessel("wood", [(0.06, 0.0), (0.11, 0.03), (0.13, 0.09)], 0.007, sides=26, steps=2)
    for i in range(22):
        yield leaf(
            "leaf",
            0.1,
            0.06,
            (0.05 * np.cos(2.4 * i), 0.05 + 0.0015 * i, 0.05 * np.sin(2.4 * i)),
            1.3 * i,
            0.7,
            1.2,
            pieces=3,
        )
    for i in range(5):
        yield ball("red", 0.016, (0.06 * np.cos(1.3 * i), 0.1, 0.06 * np.sin(1.3 * i)), 10, 6)


def _sushi() -> Iterator[Solid]:
    yield rounded("black", (0.3, 0.014, 0.16), (0.0, 0.0, 0.0), 0.006, 1)
    for i in range(6):
        x, z = -0.1 + 0.1 * (i % 3), -0.035 + 0.07 * (i // 3)
        yield soft("white", (0.06, 0.026, 0.032), (x, 0.014, z), 3.0, 4)
        yield soft(("orange", "red")[i % 2], (0.066, 0.012, 0.036), (x, 0.038, z), 3.0, 4)


_MEAL_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "pizza": _pizza,
    "salad": _salad,
    "sushi": _sushi,
}


def meal(kind: str = "pizza") -> Iterator[Solid]:
    """A pizza, a salad, or a tray of sushi."""
    yield from _MEAL_KINDS[kind]()


def mortar() -> Iterator[Solid]:
    """A stone mortar with its pestle."""
    yield vessel(
        "stone", [(0.05, 0.0), (0.055, 0.015), (0.045, 0.03), (0.07, 0.06), (0.075, 0.1)], 0.014, sides=24, steps=2
    )
    yield tube("stone", [(0.0, 0.045, 0.0), (0.03, 0.09, 0.01), (0.075, 0.15, 0.02)], [0.02, 0.013, 0.018], 10)


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


FAMILIES = (
    Family(
        "cup", "cup", _of(cup, "mug", "tea", "enamel", "bowl", "footed", "travel", "espresso", "stack", "hex", "pens")
    ),
    Family("plates", "plates", _of(plates, "stack", "bowls", "rack", "platter", "set")),
    Family("place_setting", "place_setting", (design(setting), design(setting, mat="cloth"))),
    Family("glass", "glass", _of(glass, "wine", "flute", "tumbler", "highball", "goblet")),
    Family("bottle", "bottle", _of(bottle, "wine", "water", "oil", "milk", "jar")),
    Family("fruit_bowl", "fruit_bowl", _of(fruit, "bowl", "basket", "stand", "wire")),
    Family("knife_rack", "knife_rack", _of(knives, "block", "holder", "bar")),
    Family("cutting_board", "cutting_board", _of(board, "plain", "vegetables", "stand")),
    Family("utensil_holder", "utensil_holder", _of(utensils, "jar", "rail")),
    Family("pan", "pan", _of(pan, "frying", "pot", "wok", "casserole")),
    Family("jug", "jug", _of(jug, "pitcher", "carafe", "thermos")),
    Family("teapot", "teapot", _of(teapot, "round", "tall", "glass")),
    Family("containers", "containers", _of(containers, "jars", "tins", "spices", "bread")),
    Family("cake", "cake", _of(cake, "whole", "muffins", "bell")),
    Family("bread", "bread", _of(bread, "loaf", "rolls")),
    Family("food", "food", _of(meal, "pizza", "salad", "sushi")),
    Family("mortar", "mortar_and_pestle", (design(mortar),)),
)
