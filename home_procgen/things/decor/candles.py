"""Candles and candle holders."""

from collections.abc import Iterator
from functools import partial

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import corners


def _flame(x: float, y: float, z: float) -> Iterator[Solid]:
    yield rod("black", (x, y, z), (x, y + 0.012, z), 0.0015, sides=4)
    yield revolve("bulb", [(0.003, y + 0.01), (0.007, y + 0.02), (0.001, y + 0.04)], (x, 0.0, z), 8, 2)


def _pillar() -> Iterator[Solid]:
    yield vessel("wood", [(0.15, 0.0), (0.155, 0.02)], 0.006, sides=26, steps=1)
    for x, z, h in ((-0.06, 0.02, 0.2), (0.05, 0.045, 0.13), (0.03, -0.055, 0.09)):
        yield revolve("wax", [(0.036, 0.006), (0.036, h), (0.03, h + 0.003)], (x, 0.0, z), 18, 1)
        yield from _flame(x, h, z)


def _sticks(kind: str) -> Iterator[Solid]:
    for i, x in enumerate((0.0,) if kind == "stick" else (-0.1, 0.0, 0.1)):
        h = 0.22 + 0.08 * (i % 2)
        yield revolve(
            "brass",
            [(0.05, 0.0), (0.012, 0.03), (0.02, 0.5 * h), (0.01, 0.7 * h), (0.022, h)],
            (x, 0.0, 0.0),
            16,
            3,
        )
        yield revolve("wax", [(0.011, h), (0.009, h + 0.18)], (x, 0.0, 0.0), 12, 1)
        yield from _flame(x, h + 0.18, 0.0)


def _arms() -> Iterator[Solid]:
    yield revolve("brass", [(0.08, 0.0), (0.02, 0.04), (0.015, 0.3), (0.02, 0.36)], sides=18, steps=2)
    for i in range(5):
        x = (i - 2) * 0.085
        if i != 2:
            yield tube("brass", spline([(0.0, 0.22, 0.0), (0.7 * x, 0.22, 0.0), (x, 0.34, 0.0)], 5), 0.007, 6)
        yield revolve("brass", [(0.012, 0.335), (0.025, 0.35), (0.02, 0.36)], (x, 0.0, 0.0), 12, 1)
        yield revolve("wax", [(0.01, 0.355), (0.008, 0.5)], (x, 0.0, 0.0), 10, 1)
        yield from _flame(x, 0.5, 0.0)


def _jars() -> Iterator[Solid]:
    for x, z, r in ((-0.06, 0.0, 0.04), (0.045, 0.03, 0.034), (0.04, -0.05, 0.03)):
        yield vessel("tint", [(r, 0.0), (1.1 * r, 0.04), (r, 0.09)], 0.003, (x, 0.0, z), 16, 2)
        yield cylinder("wax", 0.85 * r, 0.04, (x, 0.005, z), sides=14)
        yield from _flame(x, 0.045, z)


def _lantern() -> Iterator[Solid]:
    for x, z in corners(0.16, 0.16):
        yield box("iron", (0.012, 0.28, 0.012), (x, 0.02, z))
    yield rounded_box("iron", (0.2, 0.02, 0.2), (0.0, 0.0, 0.0), 0.005, 1)
    yield revolve("iron", [(0.14, 0.3), (0.03, 0.37), (0.02, 0.38)], sides=4, steps=1)
    yield ring("iron", 0.04, 0.008, (0.0, 0.42, 0.0), 2, 16)
    yield from (box("glass", (0.15, 0.26, 0.003), (0.0, 0.03, s * 0.082)) for s in (-1, 1))
    yield revolve("wax", [(0.04, 0.02), (0.04, 0.15)], sides=18, steps=1)
    yield from _flame(0.0, 0.15, 0.0)


_CANDLES_KINDS = {
    "pillar": _pillar,
    "stick": partial(_sticks, "stick"),
    "tapers": partial(_sticks, "tapers"),
    "arms": _arms,
    "jars": _jars,
    "lantern": _lantern,
}


def candles(kind: str = "pillar") -> Iterator[Solid]:
    """Build candles: pillars on a tray, a candlestick, a candelabrum, jars, a lantern or tapers."""
    yield from _CANDLES_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("candle", "candle", design_kinds(candles, "pillar", "stick", "arms", "jars", "lantern", "tapers")),
)
