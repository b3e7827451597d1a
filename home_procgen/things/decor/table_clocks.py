"""Clocks for tables, mantels and floors."""

from collections.abc import Callable, Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.decor.clocks import face, pendulum_clock
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bow_handle, corners, disc


def _alarm() -> Iterator[Solid]:
    yield disc("bright", 0.065, 0.05, (0.0, 0.085, -0.03), 28)
    yield from face(0.055, 0.085, 0.02)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.035, 0.03, -0.005), (s * 0.05, 0.0, 0.0), 0.006)
        yield ball("brass", (0.03, 0.022, 0.03), (s * 0.038, 0.15, -0.005), 12, 6)
    yield tube("chrome", fillet([(-0.03, 0.155, -0.005), (0.0, 0.19, -0.005), (0.03, 0.155, -0.005)], 0.03), 0.004, 6)


def _mantel() -> Iterator[Solid]:
    shape = fillet(
        [(-0.2, 0.0), (0.2, 0.0), (0.19, 0.06), (0.1, 0.1), (0.0, 0.28), (-0.1, 0.1), (-0.19, 0.06)], 0.07, 4, True
    )
    yield prism("wood", shape, 0.11)
    yield rounded_box("wood", (0.44, 0.03, 0.14), (0.0, 0.0, 0.0), 0.008, 1)
    yield from face(0.075, 0.13, 0.056)


def _digital() -> Iterator[Solid]:
    yield rounded_box("black", (0.2, 0.08, 0.06), (0.0, 0.0, 0.0), 0.012, 2)
    yield box("screen", (0.17, 0.055, 0.004), (0.0, 0.012, 0.03))
    for k, x in enumerate((-0.06, -0.025, 0.02, 0.055)):
        for dy, w, h in ((0.0, 0.02, 0.004), (0.018, 0.02, 0.004), (0.036, 0.02, 0.004)):
            yield box("red", (w, h, 0.002), (x, 0.02 + dy, 0.032))
        for s in (-1, 1):
            if (k + s) % 3:
                yield box("red", (0.004, 0.04, 0.002), (x + s * 0.009, 0.02, 0.032))


def _flip() -> Iterator[Solid]:
    """Build a flip clock with numbers on cards."""
    yield rounded_box("bright", (0.22, 0.11, 0.1), (0.0, 0.006, -0.005), 0.03, 3)
    for s in (-1, 1):
        yield rounded_box("black", (0.075, 0.075, 0.012), (s * 0.045, 0.023, 0.042), 0.006, 2)
        for k in (0, 1):
            yield box("cream", (0.062, 0.03, 0.003), (s * 0.045, 0.028 + 0.0325 * k, 0.048))
        for dx in (-0.014, 0.014):
            yield rounded_box("black", (0.016, 0.05, 0.002), (s * 0.045 + dx, 0.036, 0.0495), 0.004, 1)
        yield rod("black", (s * 0.08, 0.0, -0.02), (s * 0.08, 0.012, -0.02), 0.012, sides=10)
    yield disc("chrome", 0.008, 0.01, (0.1, 0.06, 0.044), 12)


def _carriage() -> Iterator[Solid]:
    """Build a carriage clock: a brass frame with glass sides and a handle."""
    for y in (0.0, 0.15):
        yield rounded_box("brass", (0.11, 0.016, 0.1), (0.0, y, 0.0), 0.005, 2)
    for x, z in corners(0.094, 0.084):
        yield revolve(
            "brass", [(0.006, 0.014), (0.008, 0.02), (0.005, 0.08), (0.008, 0.144), (0.006, 0.152)], (x, 0.0, z), 8, 1
        )
    yield box("glass", (0.082, 0.136, 0.002), (0.0, 0.015, 0.04))
    yield box("brass", (0.05, 0.1, 0.05), (0.0, 0.016, -0.01))
    yield from face(0.036, 0.105, 0.015)
    yield bow_handle("brass", 0.04, (0.16, 0.2), 0.0, 0.015, 0.005)


def _dome() -> Iterator[Solid]:
    """Build a clock with turning balls under a glass dome."""
    yield revolve("wood", [(0.1, 0.0), (0.1, 0.015), (0.088, 0.025)], sides=24, steps=1)
    for s in (-1, 1):
        yield rod("brass", (s * 0.035, 0.02, 0.0), (s * 0.035, 0.2, 0.0), 0.005)
    yield from face(0.05, 0.2, 0.01)
    yield ring("brass", 0.052, 0.012, (0.0, 0.2, 0.012), 2, 28)
    yield rod("brass", (0.0, 0.06, 0.0), (0.0, 0.16, 0.0), 0.002, sides=6)
    for a in np.arange(4) * np.pi / 2 + 0.4:
        yield ball("brass", 0.013, (0.03 * np.cos(a), 0.06, 0.03 * np.sin(a)), 10, 6)
        yield rod("brass", (0.0, 0.07, 0.0), (0.03 * np.cos(a), 0.062, 0.03 * np.sin(a)), 0.002, sides=5)
    yield revolve("glass", [(0.085, 0.025), (0.085, 0.22), (0.06, 0.275), (0.02, 0.292)], sides=24, steps=3)


_KINDS: dict[str, Callable[[], Iterator[Solid]]] = {
    "alarm": _alarm, "mantel": _mantel, "digital": _digital, "flip": _flip, "carriage": _carriage, "dome": _dome,
}  # fmt: skip


def clock(kind: str = "alarm") -> Iterator[Solid]:
    """Build a table clock (alarm, mantel, digital, flip, carriage or dome) or a tall clock."""
    yield from pendulum_clock(kind) if kind == "tall" else _KINDS[kind]()


FAMILIES = (
    FurnitureFamily(
        "table_clock", "clock", design_kinds(clock, "alarm", "mantel", "digital", "flip", "carriage", "dome")
    ),
    FurnitureFamily("tall_clock", "clock", design_kinds(clock, "tall")),
)
