"""Pendant lamps."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.revolve import revolve, shade
from home_procgen.shapes.rounded import ball
from home_procgen.shapes.sweep import beam, ring, rod, tube
from home_procgen.shapes.transforms import Piece
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb, corners


def _hang(drop: float, slot: str = "black") -> Iterator[Solid]:
    """Build a ceiling rose at height `drop` and a cord down to 0.2 [m]."""
    yield revolve(slot, [(0.02, drop - 0.035), (0.055, drop - 0.02), (0.055, drop)], sides=18, steps=1)
    yield cylinder(slot, 0.005, drop - 0.22, (0.0, 0.2, 0.0), sides=6)


def _dome() -> Iterator[Piece]:
    yield shade(
        "paint", [(0.22, 0.0), (0.2, 0.07), (0.13, 0.15), (0.03, 0.19), (0.02, 0.23)], (0.0, 0.0, 0.0), 0.005, 28, 3
    )
    yield from bulb(0.07, 60.0, light=0.0)


def _globe() -> Iterator[Piece]:
    yield ball("opal", 0.15, (0.0, 0.15, 0.0), 26, 16)
    yield cylinder("brass", 0.04, 0.03, (0.0, 0.28, 0.0), sides=16)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _drum() -> Iterator[Piece]:
    yield shade("shade", [(0.25, 0.0), (0.25, 0.2)], sides=32)
    yield cylinder("opal", 0.243, 0.008, (0.0, 0.012, 0.0), sides=32)
    yield from (
        rod("black", (0.0, 0.22, 0.0), (0.24 * np.cos(a), 0.195, 0.24 * np.sin(a)), 0.004, sides=5)
        for a in (0.0, 2.1, 4.2)
    )
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _cone() -> Iterator[Piece]:
    yield shade("brass", [(0.14, 0.0), (0.03, 0.26)], (0.0, 0.0, 0.0), 0.004, 26)
    yield from bulb(0.06, 40.0, light=0.0)


def _cage() -> Iterator[Piece]:
    for i in range(8):
        a = 2 * np.pi * i / 8
        c, s = np.cos(a), np.sin(a)
        yield tube(
            "iron",
            [
                (0.03 * c, 0.27, 0.03 * s),
                (0.12 * c, 0.2, 0.12 * s),
                (0.14 * c, 0.1, 0.14 * s),
                (0.06 * c, 0.0, 0.06 * s),
            ],
            0.005,
            6,
        )
    for r, y in ((0.06, 0.0), (0.14, 0.1)):
        yield ring("iron", r, 0.01, (0.0, y, 0.0), 1, 24)
    yield cylinder("brass", 0.025, 0.09, (0.0, 0.18, 0.0), sides=12)
    yield from bulb(0.14, 60.0, radius=0.05, light=0.05)


def _basket() -> Iterator[Piece]:
    for k in range(8):
        y, r = 0.035 * k, 0.28 * np.sqrt(max(1 - (k / 8.2) ** 2, 0))
        yield ring("cane", r, 0.03, (0.0, y + 0.015, 0.0), 1, 26)
    yield from bulb(0.1, 60.0, light=0.0)


def _lantern() -> Iterator[Piece]:
    for x, z in corners(0.22, 0.22):
        yield box("iron", (0.014, 0.3, 0.014), (x, 0.0, z))
    for y in (0.0, 0.29):
        yield from (box("iron", (0.234, 0.014, 0.014), (0.0, y, s * 0.11)) for s in (-1, 1))
        yield from (box("iron", (0.014, 0.014, 0.234), (s * 0.11, y, 0.0)) for s in (-1, 1))
    yield from (box("glass", (0.21, 0.28, 0.004), (0.0, 0.012, s * 0.11)) for s in (-1, 1))
    yield revolve("iron", [(0.155, 0.3), (0.03, 0.4), (0.01, 0.42)], sides=4, steps=1)
    yield from (cylinder("cream", 0.012, 0.1, (x, 0.06, 0.0), sides=10) for x in (-0.04, 0.04))
    yield from bulb(0.19, 60.0, light=-0.03)


def _artichoke() -> Iterator[Piece]:
    for row in range(6):
        for i in range(12):
            a = 2 * np.pi * (i + 0.5 * (row % 2)) / 12
            r, y = 0.06 + 0.16 * np.sin(np.pi * (row + 1) / 7), 0.05 * row + 0.02
            yield beam(
                "brass",
                (r * np.cos(a), y + 0.05, r * np.sin(a)),
                ((r + 0.05) * np.cos(a), y - 0.02, (r + 0.05) * np.sin(a)),
                0.075,
                0.003,
            )
    yield ball("opal", 0.07, (0.0, 0.14, 0.0), 14, 10)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _paper_pendant() -> Iterator[Piece]:
    for k in range(12):
        y = np.linspace(-0.19, 0.19, 12)[k]
        yield ring("opal", np.sqrt(0.2**2 - y**2), 0.034, (0.0, 0.2 + y, 0.0), 1, 26)
    yield cylinder("opal", 0.06, 0.02, (0.0, 0.006, 0.0), sides=18)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _ring() -> Iterator[Piece]:
    yield ring("brass", 0.32, 0.04, (0.0, 0.03, 0.0), 1, 40)
    yield ring("opal", 0.32, 0.03, (0.0, 0.016, 0.0), 1, 40)
    yield from (
        rod("brass", (0.0, 0.4, 0.0), (0.32 * np.cos(a), 0.04, 0.32 * np.sin(a)), 0.003, sides=5)
        for a in (0.5, 2.6, 4.7)
    )
    for a in (0.0, np.pi):
        yield Bulb((0.25 * np.cos(a), -0.03, 0.0), 30.0)


_PENDANT_KINDS = {
    "dome": _dome,
    "globe": _globe,
    "drum": _drum,
    "cone": _cone,
    "cage": _cage,
    "basket": _basket,
    "lantern": _lantern,
    "artichoke": _artichoke,
    "paper": _paper_pendant,
    "ring": _ring,
}


def pendant(kind: str = "dome", drop: float = 0.75) -> Iterator[Piece]:
    """Build a pendant lamp: dome, globe, drum, cone, cage, basket, lantern, artichoke, paper ball or ring."""
    yield from _hang(drop, "brass" if kind in ("globe", "ring", "cage") else "black")
    yield from _PENDANT_KINDS[kind]()


PENDANTS = design_kinds(
    pendant, "dome", "globe", "drum", "cone", "cage", "basket", "lantern", "artichoke", "paper", "ring"
)


FAMILIES = (FurnitureFamily("pendant", "chandelier", PENDANTS),)
