"""Bowls, caskets, wreaths and other ornaments."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import beam, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import corners, disc


def _bowl() -> Iterator[Solid]:
    yield vessel("wood", [(0.06, 0.0), (0.13, 0.03), (0.16, 0.07)], 0.007, sides=26, steps=2)
    for i in range(6):
        a = 2 * np.pi * i / 5
        r = 0.075 if i < 5 else 0.0
        yield ball(
            ("cane", "bark", "cream")[i % 3], 0.042, (r * np.cos(a), 0.075 + 0.03 * (i == 5), r * np.sin(a)), 14, 8
        )


def _wreath() -> Iterator[Solid]:
    yield ring("bark", 0.15, 0.04, (0.0, 0.2, 0.0), 2, 24)
    for i in range(54):
        a = 2 * np.pi * i / 54
        at = ((0.15 + 0.015 * np.sin(5 * i)) * np.cos(a), 0.2 + (0.15 + 0.015 * np.sin(5 * i)) * np.sin(a), 0.012)
        blade = leaf("leaf", 0.08, 0.03, (0.0, 0.0, 0.0), 0.0, 0.5, 0.4, pieces=2)
        yield move(rotate(rotate(blade, 1, np.pi / 2 * (-1) ** i), 2, a + 0.5), at)
    for i in range(8):
        a = 2 * np.pi * i / 8
        yield ball("red", 0.012, (0.15 * np.cos(a), 0.2 + 0.15 * np.sin(a), 0.03), 8, 6)


def _casket() -> Iterator[Solid]:
    yield rounded_box("wood", (0.22, 0.08, 0.14), (0.0, 0.0, 0.0), 0.006, 1)
    yield rounded_box("wood", (0.23, 0.035, 0.15), (0.0, 0.08, 0.0), 0.012, 2)
    yield rounded_box("brass", (0.03, 0.04, 0.008), (0.0, 0.065, 0.073), 0.003, 1)
    for x, z in corners(0.21, 0.13):
        yield rounded_box("brass", (0.025, 0.025, 0.025), (x, 0.0, z), 0.004, 1)


def _jar() -> Iterator[Solid]:
    yield vessel(
        "glass", [(0.07, 0.0), (0.085, 0.03), (0.085, 0.15), (0.06, 0.19), (0.065, 0.2)], 0.003, sides=22, steps=2
    )
    for i in range(16):
        a = 2.4 * i
        r = 0.045 * ((i % 4) / 3)
        yield ball(
            ("cream", "terracotta", "white")[i % 3],
            (0.022, 0.015, 0.018),
            (r * np.cos(a), 0.02 + 0.006 * i, r * np.sin(a)),
            8,
            6,
        )
    yield revolve("wood", [(0.062, 0.2), (0.062, 0.215), (0.05, 0.225)], sides=20, steps=1)


def _trophy() -> Iterator[Solid]:
    yield rounded_box("black", (0.1, 0.06, 0.1), (0.0, 0.0, 0.0), 0.006, 1)
    yield vessel(
        "gold", [(0.04, 0.06), (0.012, 0.08), (0.012, 0.13), (0.06, 0.19), (0.065, 0.27)], 0.004, sides=20, steps=3
    )
    for s in (-1, 1):
        yield tube(
            "gold",
            fillet([(s * 0.06, 0.25, 0.0), (s * 0.11, 0.25, 0.0), (s * 0.09, 0.18, 0.0), (s * 0.045, 0.17, 0.0)], 0.03),
            0.006,
            6,
        )
    yield box("gold", (0.06, 0.03, 0.004), (0.0, 0.015, 0.05))


def _plates() -> Iterator[Solid]:
    for i, (x, y, r) in enumerate(
        ((0.0, 0.32, 0.15), (-0.27, 0.18, 0.11), (0.26, 0.2, 0.12), (-0.1, 0.05, 0.09), (0.14, 0.02, 0.08))
    ):
        plate = vessel(f"crockery_{i}", [(0.5 * r, 0.0), (0.6 * r, 0.004), (r, 0.02)], 0.004, sides=24, steps=1)
        yield move(rotate(plate, 0, np.pi / 2), (x, y + 0.1, -0.01))
        yield disc(f"glaze_{i}", 0.4 * r, 0.006, (x, y + 0.1, -0.006), 18)


def _lantern() -> Iterator[Solid]:
    for y in (0.0, 0.24):
        yield rounded_box("iron", (0.15, 0.014, 0.15), (0.0, y, 0.0), 0.004, 1)
    for x, z in corners(0.13, 0.13):
        yield rod("iron", (x, 0.0, z), (x, 0.25, z), 0.005, sides=6)
    for s in (-1, 1):
        yield box("glass", (0.12, 0.22, 0.002), (0.0, 0.016, s * 0.062))
        yield box("glass", (0.002, 0.22, 0.12), (s * 0.062, 0.016, 0.0))
    yield revolve("wax", [(0.03, 0.014), (0.03, 0.11), (0.026, 0.112)], sides=18, steps=1)
    yield revolve("iron", [(0.075, 0.25), (0.04, 0.3), (0.02, 0.31)], sides=4, steps=1)
    yield ring("iron", 0.03, 0.005, (0.0, 0.335, 0.0), 2, 18)


def _globe() -> Iterator[Solid]:
    yield revolve("wood", [(0.09, 0.0), (0.085, 0.015), (0.02, 0.03), (0.015, 0.07)], sides=20, steps=2)
    yield ball("blue", 0.11, (0.0, 0.21, 0.0), 24, 16)
    for a, b, size in ((0.3, 0.4, 0.06), (1.4, -0.2, 0.05), (2.6, 0.5, 0.07), (4.0, 0.0, 0.055), (5.2, -0.5, 0.04)):
        at = (0.085 * np.cos(a) * np.cos(b), 0.21 + 0.085 * np.sin(b), 0.085 * np.sin(a) * np.cos(b))
        yield ball(("green", "brown", "cream")[int(10 * size) % 3], size * 0.55, at, 10, 8)
    arc = [(0.122 * np.cos(t), 0.21 + 0.122 * np.sin(t), 0.0) for t in np.linspace(-1.9, 1.2, 13)]
    yield tube("brass", arc, 0.005, 6)


def _hourglass() -> Iterator[Solid]:
    for y in (0.0, 0.2):
        yield revolve("wood", [(0.06, y), (0.06, y + 0.016)], sides=20, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3
        yield rod(
            "wood", (0.048 * np.cos(a), 0.01, 0.048 * np.sin(a)), (0.048 * np.cos(a), 0.206, 0.048 * np.sin(a)), 0.006
        )
    bulbs = [(0.02, 0.016), (0.036, 0.04), (0.03, 0.08), (0.005, 0.108), (0.03, 0.136), (0.036, 0.176), (0.02, 0.2)]
    yield revolve("glass", bulbs, sides=20, steps=2)
    yield revolve("cream", [(0.018, 0.018), (0.031, 0.034), (0.02, 0.05), (0.004, 0.06)], sides=16, steps=1)


def _letters() -> Iterator[Solid]:
    """Build wooden letters that read HOME."""
    strokes = {
        -0.21: [(-0.05, 0.0, -0.05, 0.14), (0.05, 0.0, 0.05, 0.14), (-0.05, 0.07, 0.05, 0.07)],
        0.08: [(-0.06, 0.0, -0.06, 0.14), (0.06, 0.0, 0.06, 0.14), (-0.06, 0.13, 0.0, 0.05), (0.06, 0.13, 0.0, 0.05)],
        0.23: [
            (-0.04, 0.0, -0.04, 0.14),
            (-0.04, 0.012, 0.05, 0.012),
            (-0.04, 0.07, 0.04, 0.07),
            (-0.04, 0.128, 0.05, 0.128),
        ],
    }
    for x, lines in strokes.items():
        for x0, y0, x1, y1 in lines:
            yield beam("paint", (x + x0, y0, 0.0), (x + x1, y1, 0.0), 0.026, 0.035)
    yield ring("paint", 0.058, 0.026, (-0.07, 0.071, 0.0), 2, 26)


_ORNAMENT_KINDS = {
    "bowl": _bowl,
    "wreath": _wreath,
    "box": _casket,
    "jar": _jar,
    "trophy": _trophy,
    "plates": _plates,
    "lantern": _lantern,
    "globe": _globe,
    "hourglass": _hourglass,
    "letters": _letters,
}


def ornament(kind: str = "bowl") -> Iterator[Solid]:
    """Build an ornament: a bowl, wreath, box, jar, trophy, wall plates, lantern, globe, hourglass or letters."""
    yield from _ORNAMENT_KINDS[kind]()


STANDING = ("bowl", "box", "jar", "trophy", "lantern", "globe", "hourglass", "letters")

FAMILIES = (
    FurnitureFamily("ornament", "decoration", design_kinds(ornament, *STANDING)),
    FurnitureFamily("wall_ornament", "decoration", design_kinds(ornament, "wreath", "plates")),
)
