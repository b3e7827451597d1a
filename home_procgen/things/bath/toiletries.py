"""Toiletries, toilet brushes, scales and hair dryers."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import corners


def _bottles() -> Iterator[Solid]:
    for i, (r, h) in enumerate(((0.03, 0.2), (0.034, 0.17), (0.025, 0.13))):
        yield revolve(
            f"bright_{i}", [(r, 0.0), (r, 0.8 * h), (0.5 * r, 0.86 * h)], (-0.075 + 0.075 * i, 0.0, 0.0), 16, 1
        )
        yield revolve("white", [(0.55 * r, 0.85 * h), (0.5 * r, h)], (-0.075 + 0.075 * i, 0.0, 0.0), 14, 1)
    yield rounded_box("white", (0.035, 0.13, 0.02), (0.03, 0.0, 0.05), 0.009, 2)


def _brushes() -> Iterator[Solid]:
    yield vessel("glaze", [(0.035, 0.0), (0.038, 0.1)], 0.004, sides=20, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3 + 0.4
        foot, tip = (0.0, 0.012, 0.0), (0.045 * np.cos(a), 0.18, 0.045 * np.sin(a))
        yield rod(f"bright_{i}", foot, tip, 0.0045, 0.0035, 6)
        yield move(rounded_box("white", (0.012, 0.024, 0.02), (0.0, -0.012, 0.0), 0.003, 1), tip)
    yield rounded_box("blue", (0.035, 0.012, 0.13), (0.085, 0.0, 0.0), 0.005, 2)


def _tray() -> Iterator[Solid]:
    yield vessel("brass", [(0.13, 0.0), (0.135, 0.02)], 0.004, sides=28, steps=1, stretch=0.6)
    yield rounded_box("tint", (0.05, 0.06, 0.03), (-0.05, 0.005, 0.0), 0.006, 2)
    yield revolve("gold", [(0.012, 0.065), (0.014, 0.09)], (-0.05, 0.0, 0.0), 12, 1)
    yield revolve("glass", [(0.02, 0.005), (0.03, 0.03), (0.012, 0.06)], (0.03, 0.0, 0.01), 16, 2)
    yield ball("gold", 0.014, (0.03, 0.075, 0.01), 10, 6)
    yield revolve("bright", [(0.012, 0.005), (0.012, 0.06)], (0.08, 0.0, -0.01), 12, 1)


def _caddy() -> Iterator[Solid]:
    for y in (0.0, 0.3):
        yield rounded_box("chrome", (0.26, 0.008, 0.1), (0.0, y, 0.0), 0.003, 1)
        for z in (-0.05, 0.05):
            yield rod("chrome", (-0.13, y + 0.06, z), (0.13, y + 0.06, z), 0.004, sides=6)
    for s in (-1, 1):
        yield tube(
            "chrome",
            fillet([(s * 0.13, 0.0, -0.045), (s * 0.13, 0.55, -0.045), (0.0, 0.62, -0.045)], 0.06),
            0.005,
            6,
        )
    for i in range(4):
        yield revolve(
            f"bright_{i}",
            [(0.025, 0.0), (0.026, 0.13), (0.012, 0.15), (0.012, 0.18)],
            (-0.08 + 0.055 * i, 0.308 if i % 2 else 0.008, 0.0),
            14,
            1,
        )


_TOILETRIES_KINDS = {
    "bottles": _bottles,
    "brushes": _brushes,
    "tray": _tray,
    "caddy": _caddy,
}


def toiletries(kind: str = "bottles") -> Iterator[Solid]:
    """Build toiletries: bottles, tooth brushes in a cup, a perfume tray or a caddy."""
    yield from _TOILETRIES_KINDS[kind]()


def plunger(kind: str = "plunger") -> Iterator[Solid]:
    """Build a rubber plunger, or a toilet brush in its holder."""
    if kind == "round":
        yield vessel("ceramic", [(0.03, 0.0), (0.065, 0.04), (0.06, 0.1), (0.03, 0.13)], 0.005, sides=24, steps=3)
        yield rod("wood", (0.0, 0.05, 0.0), (0.0, 0.4, 0.0), 0.009, 0.011, 10)
        yield ball("wood", 0.016, (0.0, 0.41, 0.0), 12, 8)
    elif kind == "plunger":
        yield revolve("red", [(0.075, 0.0), (0.08, 0.02), (0.06, 0.06), (0.02, 0.09), (0.018, 0.11)], sides=22, steps=2)
        yield rod("wood", (0.0, 0.1, 0.0), (0.0, 0.5, 0.0), 0.012, sides=10)
    else:
        yield vessel("chrome", [(0.05, 0.0), (0.052, 0.3)], 0.004, sides=22, steps=1)
        yield rod("chrome", (0.0, 0.05, 0.0), (0.0, 0.42, 0.0), 0.008)
        yield cylinder("chrome", 0.045, 0.01, (0.0, 0.31, 0.0), sides=20)
        yield ball("black", 0.014, (0.0, 0.425, 0.0), 10, 6)


def scale() -> Iterator[Solid]:
    """Build a flat weight scale with a display."""
    yield rounded_box("glass", (0.31, 0.02, 0.31), (0.0, 0.014, 0.0), 0.01, 2)
    for x, z in corners(0.24, 0.24):
        yield cylinder("chrome", 0.02, 0.016, (x, 0.0, z), sides=14)
    yield rounded_box("black", (0.1, 0.006, 0.05), (0.0, 0.032, -0.09), 0.002, 1)
    yield cylinder("chrome", 0.04, 0.003, (-0.07, 0.034, 0.03), sides=18)
    yield cylinder("chrome", 0.04, 0.003, (0.07, 0.034, 0.03), sides=18)


def bathroom_scale(kind: str = "round") -> Iterator[Solid]:
    """Build a round wooden weight scale, or an old one with a dial."""
    if kind == "round":
        yield cylinder("wood", 0.16, 0.022, (0.0, 0.012, 0.0), sides=36)
        yield cylinder("black", 0.15, 0.012, sides=30)
        yield rounded_box("screen", (0.08, 0.003, 0.035), (0.0, 0.0335, -0.1), 0.001, 1)
        return
    yield rounded_box("bright", (0.27, 0.05, 0.3), (0.0, 0.0, 0.0), 0.02, 3)
    yield rounded_box("black", (0.25, 0.006, 0.2), (0.0, 0.048, 0.03), 0.002, 1)
    yield cylinder("chrome", 0.045, 0.006, (0.0, 0.048, -0.105), sides=24)
    yield cylinder("face", 0.038, 0.002, (0.0, 0.053, -0.105), sides=24)
    yield rounded_box("red", (0.003, 0.002, 0.03), (0.0, 0.0545, -0.095), 0.0008, 1)


def styler(kind: str = "brush") -> Iterator[Solid]:
    """Build a round hot-air brush, or a small folded hair dryer."""
    if kind == "brush":
        yield tube("black", [(-0.16, 0.025, 0.0), (-0.02, 0.025, 0.0)], [0.016, 0.02], 14)
        yield tube("bright", [(-0.02, 0.025, 0.0), (0.13, 0.025, 0.0)], 0.022, 16)
        for i in range(9):
            for k in range(6):
                a, x = np.pi * k / 3 + 0.3 * (i % 2), -0.005 + 0.015 * i
                foot, tip = ((x, 0.025 + r * np.cos(a), r * np.sin(a)) for r in (0.02, 0.03))
                yield rod("black", foot, tip, 0.002, sides=4)
        return
    yield tube("gray", [(-0.07, 0.04, 0.0), (-0.04, 0.04, 0.0), (0.08, 0.04, 0.0)], [0.03, 0.04, 0.034], 16)
    yield tube("black", [(0.08, 0.04, 0.0), (0.11, 0.04, 0.0)], [0.036, 0.036], 16)
    yield tube("gray", [(-0.02, 0.035, 0.035), (0.1, 0.02, 0.06)], [0.02, 0.018], 12)


def dryer() -> Iterator[Solid]:
    """Build a hair dryer lying on its side."""
    yield tube(
        "bright",
        [(-0.09, 0.045, 0.0), (-0.06, 0.045, 0.0), (0.02, 0.045, 0.0), (0.1, 0.045, 0.0), (0.14, 0.045, 0.0)],
        [0.035, 0.045, 0.043, 0.032, 0.03],
        14,
    )
    yield tube("black", [(0.14, 0.045, 0.0), (0.17, 0.045, 0.0)], [0.033, 0.022], 14)
    yield tube("bright", [(-0.03, 0.04, 0.03), (-0.01, 0.026, 0.1), (0.0, 0.022, 0.17)], [0.022, 0.02, 0.018], 12)
    yield tube("black", [(0.0, 0.022, 0.17), (0.0, 0.006, 0.24), (-0.08, 0.006, 0.28), (-0.16, 0.006, 0.24)], 0.005, 6)


FAMILIES = (
    FurnitureFamily("toiletries", "toiletries", design_kinds(toiletries, "bottles", "brushes", "tray", "caddy")),
    FurnitureFamily("plunger", "toilet_plunger", design_kinds(plunger, "plunger", "brush", "round")),
    FurnitureFamily("scale", "weight_scale", (design(scale), *design_kinds(bathroom_scale, "round", "dial"))),
    FurnitureFamily("hair_dryer", "hair_dryer", (design(dryer), *design_kinds(styler, "brush", "small"))),
)
