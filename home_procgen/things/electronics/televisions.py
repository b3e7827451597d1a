"""Televisions."""

from collections.abc import Callable, Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import bow_handle, disc

SCREEN_CLEARANCE = 0.08  # [m], height of a screen above its support


def _panel(width: float, low: float) -> Iterator[Solid]:
    """Build a flat screen with its rim, back, vents and indicator light."""
    high = width * 9 / 16
    yield rounded_box("black", (width, high, 0.03), (0.0, low, 0.0), 0.008, 2)
    yield box("screen", (width - 0.02, high - 0.02, 0.004), (0.0, low + 0.01, 0.014))
    yield rounded_box("black", (0.6 * width, 0.5 * high, 0.04), (0.0, low + 0.1 * high, -0.025), 0.012, 1)
    for i in range(6):
        yield box("gray", (0.4 * width, 0.006, 0.002), (0.0, low + (0.2 + 0.05 * i) * high, -0.0455))
    yield box("red", (0.008, 0.003, 0.002), (0.0, low + 0.004, 0.0155))


def _feet(width: float) -> Iterator[Solid]:
    yield from _panel(width, SCREEN_CLEARANCE)
    for s in (-1, 1):
        yield beam("black", (s * 0.34 * width, 0.012, -0.11), (s * 0.34 * width, 0.012, 0.11), 0.022, 0.02)
        yield beam("black", (s * 0.34 * width, 0.015, 0.0), (s * 0.34 * width, SCREEN_CLEARANCE + 0.02, 0.0), 0.022)


def _plate(width: float) -> Iterator[Solid]:
    yield from _panel(width, SCREEN_CLEARANCE)
    yield rounded_box("chrome", (0.42 * width, 0.014, 0.24), (0.0, 0.0, 0.0), 0.005, 1)
    yield rounded_box("chrome", (0.07, 0.1, 0.03), (0.0, 0.01, -0.015), 0.008, 1)


def _splayed(width: float) -> Iterator[Solid]:
    yield from _panel(width, SCREEN_CLEARANCE)
    for s in (-1, 1):
        for z in (-0.12, 0.12):
            yield rod("chrome", (s * 0.3 * width, SCREEN_CLEARANCE + 0.01, 0.0), (s * 0.36 * width, 0.006, z), 0.008)


def _curved(width: float) -> Iterator[Solid]:
    high, bend = width * 9 / 16, 0.09
    for slot, share, z, thick in (("black", 1.0, 0.0, 0.03), ("screen", 0.97, 0.014, 0.006)):
        yield surface(
            slot,
            lambda u, v, k=share, z=z: (
                k * (u - 0.5) * width,
                SCREEN_CLEARANCE + (0.5 + k * (v - 0.5)) * high,
                z + bend * (2 * u - 1) ** 2,
            ),
            16,
            1,
            thick,
        )
    arc = [(s * 0.28 * width, 0.012, 0.1 - 0.16 * (1 - s**2)) for s in np.linspace(-1, 1, 9)]
    yield tube("chrome", arc, 0.012)
    yield beam("chrome", (0.0, 0.012, -0.06), (0.0, SCREEN_CLEARANCE + 0.1, -0.02), 0.06, 0.015)


def _sound_foot(width: float) -> Iterator[Solid]:
    yield from _panel(width, 0.1)
    yield rounded_box("black", (0.9 * width, 0.08, 0.12), (0.0, 0.0, 0.01), 0.025, 3)
    for i in range(24):
        yield box("gray", (0.004, 0.055, 0.003), ((i - 11.5) * 0.034 * width, 0.012, 0.071))
    yield rounded_box("black", (0.2, 0.06, 0.03), (0.0, 0.07, -0.01), 0.006, 1)


def _tube_set(width: float) -> Iterator[Solid]:
    yield rounded_box("black", (0.6, 0.48, 0.16), (0.0, 0.02, 0.14), 0.03, 2)
    yield prism("black", [(0.08, 0.04), (0.08, 0.48), (-0.22, 0.4), (-0.22, 0.08)], 0.5, (0.0, 0.0, 0.0), "side")
    yield padded_block("screen", (0.48, 0.36, 0.03), (0.0, 0.1, 0.205), 8.0, 5)
    for i in range(4):
        yield disc("gray", 0.012, 0.01, (0.12 + 0.035 * i, 0.055, 0.219), 12)
    for s in (-1, 1):
        yield rod("chrome", (0.0, 0.48, 0.0), (s * 0.22, 0.85, -0.05), 0.003, sides=5)
    yield rounded_box("black", (0.1, 0.03, 0.08), (0.0, 0.49, 0.0), 0.012, 1)


def _portable(width: float) -> Iterator[Solid]:
    """Build a 1970s portable television: a bright case with two dials, a grille and a handle."""
    yield padded_block("bright", (0.5, 0.36, 0.32), (0.0, 0.03, 0.0), 7.0, 6)
    yield rounded_box("cream", (0.46, 0.3, 0.02), (0.0, 0.06, 0.148), 0.02, 2)
    yield padded_block("screen", (0.3, 0.25, 0.03), (-0.06, 0.085, 0.15), 8.0, 5)
    for y in (0.29, 0.22):
        yield disc("chrome", 0.025, 0.022, (0.16, y, 0.157), 18)
        yield box("black", (0.004, 0.04, 0.006), (0.16, y - 0.02, 0.179))
    for i in range(6):
        yield box("black", (0.07, 0.005, 0.003), (0.16, 0.09 + 0.016 * i, 0.158))
    yield bow_handle("chrome", 0.16, (0.37, 0.45), 0.0, 0.04, 0.008)
    for x in (-0.18, 0.18):
        yield cylinder("black", 0.02, 0.05, (x, 0.0, 0.06), sides=12)
        yield cylinder("black", 0.02, 0.05, (x, 0.0, -0.06), sides=12)
    yield rod("chrome", (0.18, 0.36, -0.1), (0.3, 0.72, -0.12), 0.003, sides=6)


def _on_wall(width: float) -> Iterator[Solid]:
    yield from _panel(width, 0.0)
    yield box("iron", (0.3, 0.3, 0.02), (0.0, 0.3 * width * 9 / 16, -0.055))


def _framed(width: float) -> Iterator[Solid]:
    """Build a wall-hung television in a wooden frame with a mount."""
    high = width * 9 / 16
    yield box("black", (width, high, 0.02), (0.0, 0.0, -0.01))
    yield box("paper", (width - 0.03, high - 0.03, 0.004), (0.0, 0.015, 0.001))
    yield box("screen", (width - 0.14, high - 0.14, 0.004), (0.0, 0.07, 0.004))
    for s in (-1, 1):
        yield rounded_box("wood", (0.022, high, 0.045), (s * (width - 0.022) / 2, 0.0, 0.002), 0.004, 2)
        yield rounded_box("wood", (width - 0.044, 0.022, 0.045), (0.0, (high - 0.022) * (s + 1) / 2, 0.002), 0.004, 2)


def _on_arm(width: float) -> Iterator[Solid]:
    """Build a television on a folded wall arm, tilted downwards."""
    for piece in _panel(width, 0.0):
        yield rotate(move(piece, (0.0, 0.0, 0.12)), 0, 0.12, (0.0, width * 9 / 32, 0.12))
    y = 0.3 * width
    yield rounded_box("iron", (0.1, 0.3, 0.014), (0.0, y - 0.15, -0.1), 0.004, 1)
    for a, b in (((0.0, -0.09), (0.2, -0.04)), ((0.2, -0.04), (0.0, 0.07))):
        yield beam("iron", (a[0], y, a[1]), (b[0], y, b[1]), 0.03, 0.045)
    for x, z in ((0.0, -0.09), (0.2, -0.04), (0.0, 0.06)):
        yield cylinder("iron", 0.022, 0.06, (x, y - 0.03, z), sides=12)
    yield tube(
        "black", fillet([(0.03, y + 0.02, 0.06), (0.12, y - 0.08, 0.0), (0.02, y - 0.14, -0.09)], 0.04), 0.005, 6
    )


_KINDS: dict[str, Callable[[float], Iterator[Solid]]] = {
    "feet": _feet, "plate": _plate, "tube": _tube_set, "splayed": _splayed, "curved": _curved, "bar": _sound_foot,
    "portable": _portable, "wall": _on_wall, "framed": _framed, "arm": _on_arm,
}  # fmt: skip


def television(width: float = 1.1, kind: str = "feet") -> Iterator[Solid]:
    """Build a television: flat on a foot, flat for a wall, a tube set or a portable set."""
    yield from _KINDS[kind](width)


STANDING_TELEVISIONS = (
    design(television), design(television, kind="plate", width=0.95), design(television, kind="tube"),
    design(television, kind="splayed", width=1.2), design(television, kind="curved", width=1.15),
    design(television, kind="bar", width=1.0), design(television, kind="portable"),
)  # fmt: skip
WALL_TELEVISIONS = (
    design(television, kind="wall"), design(television, kind="wall", width=1.4),
    design(television, kind="framed", width=1.2), design(television, kind="arm", width=1.0),
)  # fmt: skip

FAMILIES = (
    FurnitureFamily("television", "television", STANDING_TELEVISIONS),
    FurnitureFamily("wall_television", "television", WALL_TELEVISIONS),
)
