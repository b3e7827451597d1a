"""Showers."""

from collections.abc import Callable, Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.things.bath.bathtubs import tub
from home_procgen.things.family import FurnitureFamily, design


def _head(x: float, z: float, top: float, rain: bool = False) -> Iterator[Solid]:
    """Build a pole with a shower head in the corner at (x, z)."""
    sx, sz = -np.sign(x), -np.sign(z)
    yield rod("chrome", (x, 0.9, z), (x, top, z), 0.011)
    for y in (0.95, top - 0.05):
        yield rounded_box("chrome", (0.03, 0.03, 0.05), (x, y, z - sz * 0.03), 0.008, 1)
    yield tube(
        "chrome",
        fillet(
            [(x, top - 0.02, z), (x + sx * 0.1, top, z + sz * 0.1), (x + sx * 0.22, top - 0.03, z + sz * 0.22)], 0.05
        ),
        0.01,
    )
    yield revolve(
        "chrome",
        [(0.1 if rain else 0.05, 0.0), (0.1 if rain else 0.055, 0.015), (0.02, 0.035), (0.01, 0.05)],
        (x + sx * 0.22, top - 0.08, z + sz * 0.22),
        22,
        1,
    )
    yield tube(
        "chrome",
        fillet(
            [
                (x, 1.0, z),
                (x + sx * 0.08, 0.7, z + sz * 0.02),
                (x + sx * 0.1, 1.1, z + sz * 0.03),
                (x + sx * 0.02, 1.5, z),
            ],
            0.2,
            5,
        ),
        0.006,
        6,
    )


_CABIN_HEIGHT = 2.0  # [m], height of a cabin's walls


def _tray(size: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.0, size, size, 0.0), (0.1, size, size, 0.0)], 0.05, 30.0, 32)
    yield box("ceramic", (size - 0.08, 0.05, size - 0.08), (0.0, 0.02, 0.0))


def _round_cabin(size: float) -> Iterator[Solid]:
    half = size / 2
    arc = [(-half + size * np.cos(a), -half + size * np.sin(a)) for a in np.linspace(0, np.pi / 2, 14)]
    outline = np.array([(-half, -half), *arc])
    yield prism("ceramic", outline, 0.1, (0.0, 0.0, 0.0), "top")

    def pane(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        a = 0.06 + 1.45 * u
        return -half + 0.98 * size * np.cos(a), 0.1 + 1.88 * v, -half + 0.98 * size * np.sin(a)

    yield surface("glass", pane, 14, 1, 0.008)
    for y in (0.11, _CABIN_HEIGHT - 0.03):
        yield tube(
            "chrome",
            [
                (-half + 0.98 * size * np.cos(a), y, -half + 0.98 * size * np.sin(a))
                for a in np.linspace(0.02, 1.55, 14)
            ],
            0.014,
        )


def _square_cabin(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    for x in (-half + 0.012, half - 0.012):
        yield rounded_box("chrome", (0.024, _CABIN_HEIGHT - 0.1, 0.024), (x, 0.1, half - 0.012), 0.004, 1)
    yield rounded_box("chrome", (0.024, _CABIN_HEIGHT - 0.1, 0.024), (half - 0.012, 0.1, -half + 0.012), 0.004, 1)
    yield box("glass", (size - 0.05, _CABIN_HEIGHT - 0.14, 0.008), (0.0, 0.12, half - 0.012))
    yield box("glass", (0.008, _CABIN_HEIGHT - 0.14, size - 0.05), (half - 0.012, 0.12, 0.0))
    yield rounded_box("chrome", (size, 0.03, 0.024), (0.0, _CABIN_HEIGHT - 0.03, half - 0.012), 0.004, 1)
    yield rounded_box("chrome", (0.024, 0.03, size), (half - 0.012, _CABIN_HEIGHT - 0.03, 0.0), 0.004, 1)
    yield rod("chrome", (0.05, 0.9, half + 0.02), (0.05, 1.2, half + 0.02), 0.008)


def _screen(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    yield box("glass", (0.01, _CABIN_HEIGHT - 0.1, size - 0.02), (half - 0.02, 0.1, 0.0))
    yield rod("chrome", (half - 0.02, _CABIN_HEIGHT, half - 0.05), (-half + 0.02, _CABIN_HEIGHT, half - 0.05), 0.009)
    yield rounded_box("chrome", (0.02, 0.02, size), (half - 0.02, 0.1, 0.0), 0.004, 1)


def _curtained(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    yield tube(
        "chrome",
        fillet(
            [
                (-half + 0.02, _CABIN_HEIGHT, half - 0.04),
                (half - 0.04, _CABIN_HEIGHT, half - 0.04),
                (half - 0.04, _CABIN_HEIGHT, -half + 0.02),
            ],
            0.12,
            5,
        ),
        0.011,
    )
    yield surface(
        "patterned",
        lambda u, v: ((u - 0.5) * (size - 0.1), 0.16 + 1.82 * v, half - 0.04 + 0.03 * np.sin(30 * u)),
        60,
        3,
        0.004,
    )
    yield surface(
        "patterned",
        lambda u, v: (half - 0.04 + 0.03 * np.sin(16 * u), 0.16 + 1.82 * v, half - 0.08 - u * 0.4),
        30,
        3,
        0.004,
    )


def _glass_blocks(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    for i in range(9):
        for j in range(4):
            yield rounded_box(
                "glass", (0.08, 0.2, 0.2), (half - 0.04, 0.1 + 0.205 * i, -half + 0.12 + 0.205 * j), 0.02, 1
            )


# kind -> walls, whether the head is a rain head, height of the head [m]
_SHOWERS: dict[str, tuple[Callable[[float], Iterator[Solid]], bool, float]] = {
    "square": (_square_cabin, False, 2.05),
    "round": (_round_cabin, True, 2.05),
    "screen": (_screen, True, 2.1),
    "curtain": (_curtained, False, 2.05),
    "blocks": (_glass_blocks, True, 2.05),
}


def shower(kind: str = "square", size: float = 0.9) -> Iterator[Solid]:
    """Build a shower: `square`, `round` (a quarter), walk-in `screen`, `curtain`, or `blocks` (a glass-block wall)."""
    walls, rain, high = _SHOWERS[kind]
    yield from walls(size)
    yield from _head(-size / 2 + 0.06, -size / 2 + 0.06, high, rain)


SHOWERS = tuple(design(shower, kind=kind) for kind in ("square", "round", "screen", "curtain", "blocks"))


FAMILIES = (FurnitureFamily("shower", "shower", SHOWERS),)
