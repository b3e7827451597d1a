"""Figurines for shelves."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import corners


def _cat() -> Iterator[Solid]:
    yield revolve("glaze", [(0.06, 0.0), (0.07, 0.05), (0.045, 0.14), (0.03, 0.17)], sides=18, steps=3)
    yield ball("glaze", (0.045, 0.04, 0.045), (0.0, 0.2, 0.01), 16, 10)
    for s in (-1, 1):
        yield revolve("glaze", [(0.016, 0.0), (0.002, 0.035)], (s * 0.024, 0.225, 0.005), 8, 1)
        yield ball("black", 0.006, (s * 0.016, 0.205, 0.05), 8, 4)
        yield ball("glaze", (0.016, 0.012, 0.026), (s * 0.025, 0.012, 0.06), 10, 6)
    yield tube("glaze", spline([(0.05, 0.02, -0.03), (0.09, 0.03, 0.01), (0.06, 0.03, 0.07)], 4), 0.012, 8)


def _bust() -> Iterator[Solid]:
    yield revolve("marble", [(0.07, 0.0), (0.07, 0.02), (0.03, 0.04), (0.03, 0.07)], sides=20, steps=1)
    yield padded_block("white", (0.22, 0.1, 0.12), (0.0, 0.07, 0.0), 3.0, 6)
    yield tube("white", [(0.0, 0.14, 0.0), (0.0, 0.22, 0.005)], 0.034, 12)
    yield ball("white", (0.05, 0.068, 0.058), (0.0, 0.27, 0.01), 18, 12)
    yield ball("white", (0.054, 0.045, 0.062), (0.0, 0.305, -0.006), 18, 10)
    yield prism("white", [(0.058, 0.285), (0.058, 0.25), (0.082, 0.255)], 0.018, (0.0, 0.0, 0.0), "side")


def _beast(kind: str) -> Iterator[Solid]:
    slot, big = ("wood", 1.0) if kind == "horse" else ("gray", 1.2)
    yield ball(slot, (0.04 * big, 0.045 * big, 0.09), (0.0, 0.15, 0.0), 16, 10)
    for x, z in corners(0.044, 0.11):
        yield rod(slot, (x, 0.0, z), (x, 0.14, z), 0.011 * big, 0.017 * big)
    if kind == "horse":
        yield tube(slot, [(0.0, 0.16, 0.07), (0.0, 0.24, 0.11), (0.0, 0.25, 0.13)], [0.032, 0.022, 0.02], 10)
        yield tube(slot, [(0.0, 0.26, 0.11), (0.0, 0.23, 0.18)], [0.022, 0.013], 10)
        yield tube("black", [(0.0, 0.18, -0.085), (0.0, 0.13, -0.12), (0.0, 0.06, -0.12)], [0.008, 0.014, 0.004], 8)
        yield prism("black", [(0.06, 0.2), (0.1, 0.28), (0.08, 0.28), (0.035, 0.2)], 0.01, (0.0, 0.0, 0.0), "side")
    else:
        yield ball(slot, (0.042, 0.045, 0.042), (0.0, 0.2, 0.1), 16, 10)
        yield tube(
            slot,
            spline([(0.0, 0.19, 0.13), (0.0, 0.12, 0.17), (0.0, 0.06, 0.16), (0.0, 0.05, 0.19)], 3),
            np.linspace(0.018, 0.008, 10),
            8,
        )
        for s in (-1, 1):
            yield ball(slot, (0.012, 0.05, 0.038), (s * 0.05, 0.2, 0.09), 12, 8)
            yield tube("cream", [(s * 0.02, 0.16, 0.13), (s * 0.026, 0.14, 0.18)], [0.006, 0.002], 6)


def _obelisk() -> Iterator[Solid]:
    yield rounded_box("marble", (0.1, 0.04, 0.1), (0.0, 0.0, 0.0), 0.006, 1)
    yield revolve("marble", [(0.05, 0.04), (0.032, 0.3), (0.002, 0.34)], sides=4, steps=1)
    yield rounded_box("brass", (0.08, 0.012, 0.08), (0.0, 0.035, 0.0), 0.004, 1)
    yield revolve("brass", [(0.051, 0.05), (0.0495, 0.07)], sides=4, steps=1)
    yield ball("brass", 0.012, (0.0, 0.348, 0.0), 12, 8)


def _seated() -> Iterator[Solid]:
    yield rounded_box("wood", (0.2, 0.03, 0.14), (0.0, 0.0, 0.0), 0.008, 1)
    yield ball("gold", (0.09, 0.03, 0.055), (0.0, 0.055, 0.01), 18, 8)
    yield revolve("gold", [(0.06, 0.05), (0.055, 0.1), (0.06, 0.14), (0.03, 0.17)], (0.0, 0.0, -0.01), 18, 3)
    yield ball("gold", (0.034, 0.042, 0.036), (0.0, 0.21, -0.005), 16, 10)
    yield ball("gold", 0.016, (0.0, 0.255, -0.008), 10, 6)
    for s in (-1, 1):
        yield tube(
            "gold", spline([(s * 0.055, 0.15, -0.01), (s * 0.08, 0.1, 0.01), (s * 0.02, 0.085, 0.06)], 3), 0.014, 8
        )


def _rings() -> Iterator[Solid]:
    yield rounded_box("black", (0.16, 0.025, 0.08), (0.0, 0.0, 0.0), 0.005, 1)
    yield ring("brass", 0.12, 0.034, (0.0, 0.16, 0.0), 2, 30)
    yield ring("brass", 0.07, 0.026, (0.0, 0.17, 0.0), 0, 26)


def _bird() -> Iterator[Solid]:
    yield base_plate(0.05)
    yield rod("brass", (0.0, 0.01, 0.0), (0.0, 0.12, 0.0), 0.004, sides=6)
    yield tube(
        "glaze",
        spline([(0.0, 0.16, -0.13), (0.0, 0.14, -0.06), (0.0, 0.15, 0.02), (0.0, 0.19, 0.06)], 4),
        [0.004, 0.008, 0.014, 0.022, 0.03, 0.036, 0.04, 0.04, 0.037, 0.034, 0.032, 0.03, 0.026],
        12,
    )
    yield ball("glaze", 0.028, (0.0, 0.205, 0.07), 14, 8)
    yield tube("yellow", [(0.0, 0.205, 0.095), (0.0, 0.2, 0.12)], [0.007, 0.001], 8)
    for s in (-1, 1):
        yield leaf("glaze", 0.13, 0.05, (s * 0.034, 0.17, 0.03), np.pi + 0.15 * s, 0.05, -0.2, pieces=4)
        yield ball("black", 0.004, (s * 0.022, 0.212, 0.085), 8, 4)


def _dancers() -> Iterator[Solid]:
    yield base_plate(0.08)
    for s in (-1, 1):
        yield tube(
            "iron",
            spline([(s * 0.03, 0.01, 0.0), (s * 0.05, 0.14, 0.0), (s * 0.02, 0.24, 0.0), (s * 0.05, 0.32, 0.0)], 4),
            np.concatenate([np.linspace(0.008, 0.022, 9), np.linspace(0.024, 0.01, 4)]),
            8,
        )
        yield ball("iron", 0.022, (s * 0.055, 0.35, 0.0), 12, 8)
        yield tube("iron", spline([(s * 0.04, 0.29, 0.0), (s * 0.0, 0.36, 0.04), (s * -0.04, 0.42, 0.02)], 4), 0.007, 6)


def _globe() -> Iterator[Solid]:
    yield revolve("wood", [(0.09, 0.0), (0.08, 0.02), (0.02, 0.04), (0.015, 0.09)], sides=20, steps=2)
    yield ball("blue", 0.11, (0.0, 0.22, 0.0), 26, 16)
    for i in range(7):
        a, t = 2.4 * i, 0.6 * np.sin(1.7 * i)
        spot = [0.112 * np.cos(t) * np.cos(a), 0.22 + 0.112 * np.sin(t), 0.112 * np.cos(t) * np.sin(a)]
        yield ball(
            "green", (0.03, 0.024, 0.03), (0.82 * spot[0], 0.22 + 0.82 * (spot[1] - 0.22), 0.82 * spot[2]), 10, 6
        )
    yield tube(
        "brass",
        [(0.128 * np.sin(a), 0.22 + 0.128 * np.cos(a), 0.0) for a in np.linspace(0.2, np.pi + 0.2, 14)],
        0.006,
        6,
    )


def _ship() -> Iterator[Solid]:
    yield rounded_box("wood", (0.3, 0.02, 0.1), (0.0, 0.0, 0.0), 0.005, 1)
    hull = [(-0.15, 0.07), (0.16, 0.07), (0.12, 0.03), (-0.11, 0.03)]
    yield prism("wood", hull, 0.05)
    for x, h in ((-0.06, 0.24), (0.05, 0.28)):
        yield rod("wood", (x, 0.06, 0.0), (x, h, 0.0), 0.004, sides=6)
        yield prism("cream", fillet([(x - 0.005, 0.09), (x + 0.075, 0.1), (x, h - 0.01)], 0.02, 3, True), 0.004)
    yield prism("cream", [(0.06, 0.1), (0.14, 0.085), (0.06, 0.24)], 0.003)


_FIGURE_KINDS = {
    "cat": _cat,
    "bust": _bust,
    "horse": partial(_beast, "horse"),
    "elephant": partial(_beast, "elephant"),
    "obelisk": _obelisk,
    "seated": _seated,
    "ring": _rings,
    "bird": _bird,
    "dancers": _dancers,
    "globe": _globe,
    "ship": _ship,
}


def figure(kind: str = "cat") -> Iterator[Solid]:
    """Build a figurine: a person, an animal, an obelisk, rings, a globe or a ship."""
    yield from _FIGURE_KINDS[kind]()


def base_plate(radius: float) -> Solid:
    """Build a round base plate for an ornament."""
    return revolve("black", [(radius, 0.0), (radius, 0.012), (0.8 * radius, 0.018)], sides=20, steps=1)


FIGURES = design_kinds(
    figure, "cat", "bust", "horse", "elephant", "obelisk", "seated", "ring", "bird", "dancers", "globe", "ship"
)


FAMILIES = (FurnitureFamily("figure", "trinket", FIGURES),)
