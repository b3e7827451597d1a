"""Floor lamps."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import box, cylinder
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve, shade, vessel
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import ring, rod, tube
from home_procgen.shapes.transforms import Piece, repeat_around, rotate_pieces, translate
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb, foot_plate


def _shaded_pole(kind: str) -> Iterator[Piece]:
    yield foot_plate("brass" if kind != "basket" else "black", 0.15, 0.025)
    yield cylinder("brass" if kind != "basket" else "black", 0.012, 1.35, (0.0, 0.02, 0.0), sides=10)
    if kind == "basket":
        for i in range(5):
            yield ring("cane", 0.2 - 0.035 * abs(i - 1.2), 0.022, (0.0, 1.2 + 0.085 * i, 0.0), 1, 22)
        for i in range(18):
            a = 2 * np.pi * i / 18
            yield tube(
                "cane",
                [
                    (
                        (0.2 - 0.035 * abs(k - 1.2)) * np.cos(a),
                        1.2 + 0.085 * k,
                        (0.2 - 0.035 * abs(k - 1.2)) * np.sin(a),
                    )
                    for k in range(5)
                ],
                0.005,
                5,
            )
    else:
        yield shade("shade", [(0.22, 0.0), (0.15 if kind == "pole" else 0.22, 0.28)], (0.0, 1.25, 0.0), sides=28)
    if kind == "tray":
        yield cylinder("wood", 0.19, 0.02, (0.0, 0.55, 0.0), sides=26)
    yield from bulb(1.38, 40.0)


def _tripod() -> Iterator[Piece]:
    yield from repeat_around([rod("wood", (0.0, 0.0, 0.34), (0.0, 1.2, 0.03), 0.02, 0.015, 10)], 3)
    yield cylinder("brass", 0.05, 0.06, (0.0, 1.17, 0.0), sides=16)
    yield from repeat_around([rod("brass", (0.0, 0.55, 0.2), (0.0, 0.55, 0.0), 0.005, sides=6)], 3)
    yield shade("shade", [(0.26, 0.0), (0.24, 0.3)], (0.0, 1.2, 0.0), sides=28)
    yield from bulb(1.35, 40.0)


def _arc() -> Iterator[Piece]:
    yield rounded_box("marble", (0.3, 0.1, 0.2), (0.0, 0.0, -0.7), 0.02, 1)
    yield tube(
        "chrome",
        spline([(0.0, 0.08, -0.7), (0.0, 1.2, -0.75), (0.0, 1.85, -0.4), (0.0, 1.95, 0.1), (0.0, 1.75, 0.5)], 6),
        0.012,
    )
    yield from translate(
        [
            revolve("chrome", [(0.19, 0.0), (0.17, 0.08), (0.1, 0.15), (0.02, 0.17), (0.02, 0.19)], sides=26, steps=2),
            *bulb(-0.005, 40.0, light=-0.06),
        ],
        0.0,
        1.6,
        0.5,
    )


def _torch() -> Iterator[Piece]:
    yield foot_plate("black", 0.15, 0.03)
    yield cylinder("black", 0.014, 1.65, (0.0, 0.02, 0.0), sides=10)
    yield vessel("opal", [(0.03, 0.0), (0.1, 0.04), (0.16, 0.12)], 0.005, (0.0, 1.64, 0.0), 26, 3)
    yield from bulb(1.72, 60.0, light=1.82)
    yield tube("black", fillet([(0.0, 1.2, 0.0), (0.0, 1.2, 0.12), (0.0, 1.12, 0.22)], 0.06), 0.007)
    yield shade("opal", [(0.07, 0.0), (0.03, 0.09)], (0.0, 1.03, 0.24), 0.004, 18)


def _paper() -> Iterator[Piece]:
    for s in (-1, 1):
        for t in (-1, 1):
            yield box("wood", (0.02, 1.2, 0.02), (s * 0.12, 0.0, t * 0.12))
    for y in (0.04, 0.6, 1.16):
        for s in (-1, 1):
            yield box("wood", (0.24, 0.015, 0.015), (0.0, y, s * 0.12))
            yield box("wood", (0.015, 0.015, 0.24), (s * 0.12, y, 0.0))
    yield rounded_box("opal", (0.22, 1.1, 0.22), (0.0, 0.06, 0.0), 0.02, 2)
    yield Bulb((0.0, 1.26, 0.0), 40.0)


def _spots() -> Iterator[Piece]:
    yield foot_plate("white", 0.15, 0.025)
    yield cylinder("chrome", 0.014, 1.6, (0.0, 0.02, 0.0), sides=10)
    for i, turn in enumerate((0.4, 2.6, 4.6)):
        spot = [
            shade("paint", [(0.07, -0.02), (0.06, 0.08), (0.02, 0.13)], (0.0, 0.0, 0.1), 0.004, 18, 2),
            rod("chrome", (0.0, 0.06, 0.0), (0.0, 0.08, 0.09), 0.006),
            *bulb(0.02, 20.0, 0.0, 0.1, light=-0.05),
        ]
        yield from translate(rotate_pieces(spot, 1, turn), 0.0, 1.1 + 0.2 * i, 0.0)


def _reading() -> Iterator[Piece]:
    yield foot_plate("brass", 0.13, 0.02)
    yield cylinder("brass", 0.01, 1.1, (0.0, 0.02, 0.0), sides=10)
    yield tube("brass", fillet([(0.0, 1.1, 0.0), (0.0, 1.3, 0.02), (0.0, 1.3, 0.2), (0.0, 1.2, 0.26)], 0.1, 5), 0.008)
    yield from translate(
        [
            shade("brass", [(0.09, 0.0), (0.08, 0.04), (0.03, 0.1)], (0.0, 0.0, 0.0), 0.004, 22, 2),
            *bulb(0.03, 25.0, light=-0.04),
        ],
        0.0,
        1.11,
        0.28,
    )


def _cones() -> Iterator[Piece]:
    yield foot_plate("black", 0.16, 0.02)
    for i in range(3):
        a = 2 * np.pi * i / 3
        x, z, y = 0.12 * np.cos(a), 0.12 * np.sin(a), 1.1 + 0.2 * i
        yield tube(
            "brass",
            spline([(0.03 * np.cos(a), 0.02, 0.03 * np.sin(a)), (0.3 * x, 0.7, 0.3 * z), (x, y - 0.06, z)], 4),
            0.006,
            6,
        )
        yield ball("opal", 0.085, (x, y + 0.02, z), 18, 12)
        yield Bulb((x, y + 0.13, z), 15.0)


def _urn() -> Iterator[Piece]:
    yield revolve(
        "glaze",
        [(0.16, 0.0), (0.18, 0.03), (0.1, 0.12), (0.16, 0.4), (0.06, 0.62), (0.03, 0.66)],
        sides=24,
        steps=3,
    )
    yield cylinder("brass", 0.012, 0.42, (0.0, 0.64, 0.0), sides=10)
    yield shade("shade", [(0.28, 0.0), (0.22, 0.1), (0.17, 0.3)], (0.0, 0.95, 0.0), sides=28, steps=2)
    yield from bulb(1.1, 40.0)


_FLOOR_LAMP_KINDS = {
    "pole": partial(_shaded_pole, "pole"),
    "tray": partial(_shaded_pole, "tray"),
    "basket": partial(_shaded_pole, "basket"),
    "tripod": _tripod,
    "arc": _arc,
    "torch": _torch,
    "paper": _paper,
    "spots": _spots,
    "reading": _reading,
    "cones": _cones,
    "urn": _urn,
}


def floor_lamp(kind: str = "pole") -> Iterator[Piece]:
    """Build a floor lamp: pole, tripod, arc, torch, tray, paper column, spots, reading arm, balls, basket or urn."""
    yield from _FLOOR_LAMP_KINDS[kind]()


FLOOR = design_kinds(
    floor_lamp, "pole", "tripod", "arc", "torch", "tray", "paper", "spots", "reading", "cones", "basket", "urn"
)


FAMILIES = (FurnitureFamily("floor_lamp", "floor_lamp", FLOOR),)
