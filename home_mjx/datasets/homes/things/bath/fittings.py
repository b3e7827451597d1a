"""Toilets, basins, tubs, showers."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, loop
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, between_loops, rounded, soft
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import doors, drawers, legs
from home_mjx.datasets.homes.things.kitchen.units import tap
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def tub(
    slot: str, levels: list[tuple[float, float, float, float]], wall: float = 0.035, power: float = 4.0, sides: int = 36
) -> Solid:
    """An open hollow of oval plan.

    Args:
        slot: Slot name.
        levels: Height, width (x), depth (z), shift along x of the outside, from the bottom up [m].
        wall: Thickness [m].
        power: Squareness of the plan, 2 is an ellipse.
        sides: Facets around.
    """
    outer = [np.insert(loop(w, d, sides, power) + np.array([x, 0.0]), 1, y, axis=1) for y, w, d, x in levels]
    inner = [
        np.insert(
            loop(w - 2 * wall, d - 2 * wall, sides, power) + np.array([x, 0.0]), 1, max(y, levels[0][0] + wall), axis=1
        )
        for y, w, d, x in levels
    ]
    return between_loops(slot, [*outer, *inner[::-1]])


def _seat(y: float, z: float, lid: str = "up") -> Iterator[Solid]:
    outer = [np.insert(loop(0.36, 0.42, 28, 2.3) + np.array([0.0, z]), 1, h, axis=1) for h in (y, y + 0.02)]
    inner = [np.insert(loop(0.23, 0.28, 28, 2.2) + np.array([0.0, z + 0.01]), 1, h, axis=1) for h in (y, y + 0.02)]
    if lid == "down":
        yield prism("ceramic", loop(0.37, 0.43, 28, 2.3), 0.026, (0.0, y, z), "top")
        return
    yield between_loops("ceramic", [outer[0], outer[1], inner[1], inner[0]], closed=True)
    upright = rotate(prism("ceramic", loop(0.36, 0.42, 28, 2.3), 0.018, (0.0, 0.0, 0.2), "top"), 0, -np.pi / 2 - 0.12)
    yield move(upright, (0.0, y + 0.02, z - 0.215))


def toilet(kind: str = "tank") -> Iterator[Solid]:
    """With a tank on it, hung from a wall, with a high tank and chain, or all of one piece."""
    if kind == "hung":
        yield tub("ceramic", [(0.08, 0.22, 0.34, 0.0), (0.2, 0.3, 0.48, 0.0), (0.39, 0.36, 0.53, 0.0)], 0.03, 2.4)
        yield from _seat(0.39, 0.02, "down")
        yield box("ceramic", (0.34, 0.3, 0.05), (0.0, 0.1, -0.255))
        yield rounded("white", (0.5, 1.1, 0.12), (0.0, 0.0, -0.34), 0.01, 1)
        yield rounded("chrome", (0.24, 0.15, 0.012), (0.0, 0.86, -0.278), 0.005, 1)
        return
    yield tub(
        "ceramic",
        [(0.0, 0.2, 0.36, 0.0), (0.14, 0.2, 0.34, 0.0), (0.28, 0.3, 0.42, 0.0), (0.4, 0.36, 0.46, 0.0)],
        0.035,
        2.6,
    )
    yield from _seat(0.4, 0.0, "down" if kind == "one" else "up")
    if kind == "high":
        yield rounded("wood", (0.46, 0.26, 0.2), (0.0, 1.75, -0.28), 0.012, 1)
        yield rod("brass", (0.0, 0.36, -0.3), (0.0, 1.76, -0.3), 0.018)
        yield rod("brass", (0.18, 1.3, -0.2), (0.18, 1.76, -0.2), 0.003, sides=5)
        yield turned("wood", [(0.006, 0.0), (0.016, 0.03), (0.01, 0.09), (0.006, 0.1)], (0.18, 1.21, -0.2), 10, 2)
        yield rounded("ceramic", (0.18, 0.36, 0.16), (0.0, 0.0, -0.24), 0.02, 2)
        return
    yield rounded("ceramic", (0.24, 0.4, 0.16), (0.0, 0.0, -0.2), 0.03, 2)
    high = 0.34 if kind == "tank" else 0.22
    yield rounded("ceramic", (0.4, high, 0.17), (0.0, 0.39, -0.28), 0.035, 3)
    yield rounded("ceramic", (0.42, 0.035, 0.19), (0.0, 0.39 + high - 0.01, -0.28), 0.014, 2)
    if kind == "tank":
        yield rounded("chrome", (0.06, 0.02, 0.03), (-0.13, 0.66, -0.19), 0.008, 1)
    else:
        yield turned("chrome", [(0.03, 0.0), (0.03, 0.008), (0.02, 0.012)], (0.0, 0.412 + high, -0.28), 18, 1)


def bidet() -> Iterator[Solid]:
    """A low bowl with a tap."""
    yield tub("ceramic", [(0.0, 0.2, 0.34, 0.0), (0.16, 0.22, 0.36, 0.0), (0.38, 0.37, 0.54, 0.0)], 0.05, 2.4)
    yield from (move(p, (0.0, 0.0, 0.0)) for p in tap(0.0, 0.385, -0.22, "lever"))


def _pedestal(width: float) -> Iterator[Solid]:
    yield turned("ceramic", [(0.13, 0.0), (0.09, 0.1), (0.08, 0.5), (0.12, 0.68)], (0.0, 0.0, -0.06), 24, 3)
    yield tub("ceramic", [(0.66, 0.26, 0.22, 0.0), (0.74, 0.5, 0.4, 0.0), (0.84, width, 0.46, 0.0)], 0.05, 3.0)
    yield box("ceramic", (width - 0.06, 0.12, 0.08), (0.0, 0.72, -0.19))
    yield from tap(0.0, 0.835, -0.18, "lever")


def _bowl(width: float) -> Iterator[Solid]:
    yield from legs("wood", 0.9, 0.46, 0.76, "square", 0.05)
    yield rounded("wood", (0.96, 0.05, 0.5), (0.0, 0.74, 0.0), 0.01, 1)
    yield box("wood", (0.86, 0.022, 0.44), (0.0, 0.2, 0.0))
    for i in range(3):
        yield soft("towel", (0.32, 0.07, 0.3), (-0.2, 0.222 + 0.06 * i, 0.0), 5.0, 4)
    yield rounded("cane", (0.3, 0.2, 0.3), (0.2, 0.222, 0.0), 0.03, 1)
    yield vessel("ceramic", [(0.1, 0.0), (0.17, 0.04), (0.21, 0.13)], 0.012, (0.0, 0.79, 0.03), 32, 3)
    yield from tap(0.0, 0.79, -0.2, "arc")


def _vanity(kind: str, width: float) -> Iterator[Solid]:
    wide = 0.8 if kind == "vanity" else 1.3
    yield box("black", (wide - 0.08, 0.08, 0.4), (0.0, 0.0, -0.03))
    yield rounded("paint", (wide - 0.01, 0.7, 0.46), (0.0, 0.08, -0.02), 0.004, 1)
    count = 1 if kind == "vanity" else 2
    if kind == "vanity":
        yield from doors("paint", wide - 0.02, 0.66, (0.01 - wide / 2, 0.1, 0.21), 2, "shaker", ("brass", "knob"), 0.85)
    else:
        yield from drawers("paint", wide - 0.02, 0.66, (0.01 - wide / 2, 0.1, 0.21), 2, 2, "flat", ("black", "bar"))
    for i in range(count):
        x = (i - (count - 1) / 2) * wide / count
        yield tub("ceramic", [(0.76, wide / count, 0.48, x), (0.86, wide / count, 0.48, x)], 0.06, 9.0)
        yield from tap(x, 0.86, -0.2, "lever")


def _hung(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.72, 0.3, 0.24, 0.0), (0.78, 0.44, 0.36, 0.0), (0.86, 0.5, 0.4, 0.0)], 0.04, 5.0)
    yield from tap(0.0, 0.855, -0.15, "lever")
    yield rod("chrome", (0.0, 0.0, -0.1), (0.0, 0.74, -0.1), 0.022, sides=12)
    yield turned("chrome", [(0.05, 0.0), (0.045, 0.012), (0.02, 0.03)], (0.0, 0.0, -0.1), 16, 1)
    yield turned("chrome", [(0.02, 0.45), (0.04, 0.48), (0.04, 0.58), (0.02, 0.62)], (0.0, 0.0, -0.1), 16, 2)
    yield box("ceramic", (0.42, 0.2, 0.04), (0.0, 0.66, -0.18))


def _slab(width: float) -> Iterator[Solid]:
    yield box("wood", (0.9, 0.32, 0.44), (0.0, 0.5, 0.0))
    yield from drawers("wood_1", 0.88, 0.3, (-0.44, 0.51, 0.21), 1, 1, "flat", ("black", "slot"))
    yield tub("stone", [(0.82, 0.9, 0.46, 0.0), (0.94, 0.9, 0.46, 0.0)], 0.05, 10.0)
    yield from tap(0.0, 0.94, -0.19, "bridge")
    yield rounded("wood", (0.86, 0.5, 0.03), (0.0, 0.0, -0.2), 0.008, 1)


_BASIN_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "pedestal": _pedestal,
    "bowl": _bowl,
    "vanity": partial(_vanity, "vanity"),
    "double": partial(_vanity, "double"),
    "hung": _hung,
    "slab": _slab,
}


def basin(kind: str = "pedestal", width: float = 0.58) -> Iterator[Solid]:
    """A wash basin: on a column, a bowl on a board, in a cabinet, hung, or two in a row."""
    yield from _BASIN_KINDS[kind](width)


def _builtin(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.0, width, 0.75, 0.0), (0.56, width, 0.75, 0.0)], 0.07, 14.0, 44)
    yield prism("ceramic", [(width / 2 - 0.08, 0.05), (width / 2 - 0.08, 0.5), (width / 2 - 0.3, 0.05)], 0.6)
    yield from (rotate(p, 1, -np.pi / 2) for p in tap(0.0, 0.56, 0.04 - width / 2, "lever"))


def _free(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.0, 1.3, 0.56, 0.0), (0.08, 1.38, 0.62, 0.0), (0.58, width, 0.8, 0.0)], 0.035, 2.5, 44)
    yield tube(
        "chrome",
        fillet([(0.0, 0.0, -0.48), (0.0, 0.95, -0.48), (0.0, 0.95, -0.22), (0.0, 0.82, -0.2)], 0.1, 5),
        0.018,
    )
    yield rod("chrome", (0.0, 0.72, -0.48), (0.1, 0.76, -0.46), 0.01)


def _claw(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.14, 1.0, 0.46, 0.0), (0.24, 1.3, 0.62, 0.0), (0.6, 1.6, 0.76, 0.0)], 0.03, 2.6, 40)
    yield tube("ceramic", np.insert(loop(1.6, 0.76, 40, 2.6), 1, 0.605, axis=1), 0.025, 8, closed=True)
    for x, z in ((-0.45, -0.2), (0.45, -0.2), (-0.45, 0.2), (0.45, 0.2)):
        yield tube(
            "brass", [(x, 0.22, z), (1.16 * x, 0.12, 1.3 * z), (1.1 * x, 0.03, 1.3 * z)], [0.035, 0.025, 0.02], 10
        )
        yield ball("brass", 0.03, (1.12 * x, 0.03, 1.35 * z), 10, 6)
    for z in (-0.06, 0.06):
        yield rod("brass", (0.72, 0.0, z), (0.72, 0.7, z), 0.012)
    yield from (move(rotate(p, 1, -np.pi / 2), (0.8, 0.08, 0.0)) for p in tap(0.0, 0.6, 0.06, "bridge"))


def _corner_tub(width: float) -> Iterator[Solid]:
    curve = [(0.75 - 1.5 * (1 - np.cos(a)) * 0.98, -0.75 + 1.48 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 14)]
    outline = np.array([(-0.75, -0.75), *[(x, z) for x, z in curve]])
    levels = [np.insert(outline * k, 1, y, axis=1) for k, y in ((1.0, 0.0), (1.0, 0.55), (0.86, 0.55), (0.72, 0.16))]
    yield between_loops("ceramic", levels)
    yield from (move(rotate(p, 1, np.pi / 4), (0.0, 0.0, 0.0)) for p in tap(0.0, 0.55, -0.86, "lever"))
    for i in range(4):
        yield cylinder("chrome", 0.025, 0.02, (-0.3 + 0.2 * i, 0.15, -0.2), sides=12)


def _barrel(width: float) -> Iterator[Solid]:
    for i in range(26):
        a = 2 * np.pi * i / 26
        x, z = 0.62 * np.cos(a), 0.62 * np.sin(a)
        yield rod("wood", (0.92 * x, 0.0, 0.92 * z), (x, 0.74, z), 0.082, sides=4)
    for y in (0.15, 0.58):
        yield ring("iron", 0.645 + 0.05 * y, 0.018, (0.0, y, 0.0), 1, 30)
    yield cylinder("wood", 0.55, 0.04, (0.0, 0.06, 0.0), sides=28)
    yield cylinder("water", 0.55, 0.01, (0.0, 0.6, 0.0), sides=28)


_BATHTUB_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "builtin": _builtin,
    "free": _free,
    "claw": _claw,
    "corner": _corner_tub,
    "barrel": _barrel,
}


def bathtub(kind: str = "builtin", width: float = 1.7) -> Iterator[Solid]:
    """Built in, freestanding, on claw feet, for a corner, a wooden barrel."""
    yield from _BATHTUB_KINDS[kind](width)


def _head(x: float, z: float, top: float, rain: bool = False) -> Iterator[Solid]:
    """A pole with a shower head in a corner at (x, z)."""
    sx, sz = -np.sign(x), -np.sign(z)
    yield rod("chrome", (x, 0.9, z), (x, top, z), 0.011)
    for y in (0.95, top - 0.05):
        yield rounded("chrome", (0.03, 0.03, 0.05), (x, y, z - sz * 0.03), 0.008, 1)
    yield tube(
        "chrome",
        fillet(
            [(x, top - 0.02, z), (x + sx * 0.1, top, z + sz * 0.1), (x + sx * 0.22, top - 0.03, z + sz * 0.22)], 0.05
        ),
        0.01,
    )
    yield turned(
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


_TOP = 2.0  # [m], of a cabin


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
    for y in (0.11, _TOP - 0.03):
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
        yield rounded("chrome", (0.024, _TOP - 0.1, 0.024), (x, 0.1, half - 0.012), 0.004, 1)
    yield rounded("chrome", (0.024, _TOP - 0.1, 0.024), (half - 0.012, 0.1, -half + 0.012), 0.004, 1)
    yield box("glass", (size - 0.05, _TOP - 0.14, 0.008), (0.0, 0.12, half - 0.012))
    yield box("glass", (0.008, _TOP - 0.14, size - 0.05), (half - 0.012, 0.12, 0.0))
    yield rounded("chrome", (size, 0.03, 0.024), (0.0, _TOP - 0.03, half - 0.012), 0.004, 1)
    yield rounded("chrome", (0.024, 0.03, size), (half - 0.012, _TOP - 0.03, 0.0), 0.004, 1)
    yield rod("chrome", (0.05, 0.9, half + 0.02), (0.05, 1.2, half + 0.02), 0.008)


def _screen(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    yield box("glass", (0.01, _TOP - 0.1, size - 0.02), (half - 0.02, 0.1, 0.0))
    yield rod("chrome", (half - 0.02, _TOP, half - 0.05), (-half + 0.02, _TOP, half - 0.05), 0.009)
    yield rounded("chrome", (0.02, 0.02, size), (half - 0.02, 0.1, 0.0), 0.004, 1)


def _curtained(size: float) -> Iterator[Solid]:
    half = size / 2
    yield from _tray(size)
    yield tube(
        "chrome",
        fillet(
            [(-half + 0.02, _TOP, half - 0.04), (half - 0.04, _TOP, half - 0.04), (half - 0.04, _TOP, -half + 0.02)],
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
            yield rounded("glass", (0.08, 0.2, 0.2), (half - 0.04, 0.1 + 0.205 * i, -half + 0.12 + 0.205 * j), 0.02, 1)


# Its walls; whether its head is a wide one; the height of that [m].
_SHOWERS: dict[str, tuple[Callable[[float], Iterator[Solid]], bool, float]] = {
    "square": (_square_cabin, False, 2.05),
    "round": (_round_cabin, True, 2.05),
    "screen": (_screen, True, 2.1),
    "curtain": (_curtained, False, 2.05),
    "blocks": (_glass_blocks, True, 2.05),
}


def shower(kind: str = "square", size: float = 0.9) -> Iterator[Solid]:
    """A cabin: square, a quarter circle, a walk-in screen, with a curtain, or between walls of glass blocks."""
    walls, rain, high = _SHOWERS[kind]
    yield from walls(size)
    yield from _head(-size / 2 + 0.06, -size / 2 + 0.06, high, rain)


TOILETS = (*(design(toilet, kind=kind) for kind in ("tank", "hung", "high", "one")), design(bidet))
BASINS = tuple(design(basin, kind=kind) for kind in ("pedestal", "bowl", "vanity", "double", "hung", "slab"))
TUBS = (
    *(design(bathtub, kind=kind) for kind in ("builtin", "free", "claw", "corner", "barrel")),
    design(bathtub, width=1.5),
)
SHOWERS = tuple(design(shower, kind=kind) for kind in ("square", "round", "screen", "curtain", "blocks"))

FAMILIES = (
    Family("toilet", "toilet", TOILETS),
    Family("basin", "sink", BASINS),
    Family("bathtub", "bathtub", TUBS),
    Family("shower", "shower", SHOWERS),
)
