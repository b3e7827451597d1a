"""Radiators, fireplaces, screens, fences, switches, coolers: what stands at walls or in place of them."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.groups import around
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import corners, disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def _panels(kind: str, width: float, height: float) -> Iterator[Solid]:
    for z in (0.03,) if kind == "panel" else (0.04, -0.02):
        yield rounded("white", (width, height - 0.1, 0.02), (0.0, 0.1, z), 0.006, 1)
        for i in range(int(width / 0.05)):
            yield rounded(
                "white", (0.024, height - 0.16, 0.012), ((i + 0.5) * 0.05 - width / 2, 0.13, z + 0.01), 0.005, 1
            )
    yield box("white", (width, 0.012, 0.1), (0.0, height - 0.012, 0.0))


def _columns(width: float, height: float) -> Iterator[Solid]:
    for i in range(int(width / 0.07)):
        x = (i + 0.5) * 0.07 - width / 2
        for z in (-0.045, 0.045):
            yield tube("white", [(x, 0.1, z), (x, height - 0.03, z)], 0.02, 8)
        for y in (0.12, height - 0.05):
            yield ball("white", (0.034, 0.035, 0.07), (x, y, 0.0), 8, 6)


def _convector(width: float, height: float) -> Iterator[Solid]:
    yield rounded("wood", (width, height - 0.12, 0.16), (0.0, 0.12, 0.0), 0.008, 1)
    for i in range(8):
        yield box("black", (width - 0.1, 0.012, 0.006), (0.0, 0.17 + 0.04 * i, 0.08))
    for s in (-1, 1):
        yield rounded("wood", (0.08, 0.12, 0.16), (s * (width / 2 - 0.1), 0.0, 0.0), 0.006, 1)


def _oil(width: float, height: float) -> Iterator[Solid]:
    for i in range(9):
        yield rounded("white", (0.05, 0.5, 0.16), ((i - 4) * 0.062, 0.08, 0.0), 0.022, 2)
    yield rounded("gray", (0.07, 0.42, 0.15), (0.3, 0.1, 0.0), 0.015, 2)
    yield from (rotate(disc("black", 0.024, 0.02, (0.0, y, 0.336), 14), 1, np.pi / 2) for y in (0.4, 0.3))
    for x in (-0.22, 0.22):
        for z in (-0.1, 0.1):
            yield ball("black", 0.03, (x, 0.03, z), 10, 6)
        yield box("gray", (0.04, 0.03, 0.22), (x, 0.05, 0.0))


_RADIATOR_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "panel": partial(_panels, "panel"),
    "double": partial(_panels, "double"),
    "columns": _columns,
    "convector": _convector,
    "oil": _oil,
}


def radiator(kind: str = "panel", width: float = 1.0, height: float = 0.6) -> Iterator[Solid]:
    """A ribbed panel, cast columns, a towel-like ladder, a convector, a portable oil heater."""
    yield from _RADIATOR_KINDS[kind](width, height)
    if kind not in ("convector", "oil"):
        for s in (-1, 1):
            yield rod("chrome", (s * (width / 2 - 0.06), 0.0, 0.0), (s * (width / 2 - 0.06), 0.16, 0.0), 0.01)
        yield cylinder("white", 0.022, 0.07, (width / 2 - 0.06, 0.03, 0.0), sides=14)


def fireplace(kind: str = "mantel") -> Iterator[Solid]:
    """A mantelpiece, a brick hearth, an iron stove, a modern slot."""
    if kind == "stove":
        for x, z in corners(0.42, 0.34):
            yield tube("iron", [(1.15 * x, 0.0, 1.15 * z), (x, 0.14, z)], [0.02, 0.03], 8)
        yield rounded("iron", (0.52, 0.6, 0.44), (0.0, 0.13, 0.0), 0.03, 2)
        yield rounded("iron", (0.58, 0.04, 0.5), (0.0, 0.72, 0.0), 0.015, 2)
        yield rounded("iron", (0.38, 0.38, 0.03), (0.0, 0.26, 0.222), 0.02, 2)
        yield box("orange", (0.28, 0.22, 0.01), (0.0, 0.34, 0.236))
        yield rod("brass", (0.16, 0.4, 0.26), (0.16, 0.5, 0.26), 0.008)
        yield cylinder("iron", 0.075, 1.5, (0.0, 0.75, -0.08), sides=18)
        yield rounded("stone", (0.9, 0.03, 0.8), (0.0, 0.0, 0.06), 0.008, 1)
        return
    slot = {"mantel": "white", "brick": "masonry", "slot": "concrete"}[kind]
    wide, high, hole = (1.4, 1.15, 0.72) if kind != "slot" else (1.6, 1.1, 1.2)
    side = (wide - hole) / 2
    low, mouth = (0.05, 0.7) if kind != "slot" else (0.4, 0.36)
    for s in (-1, 1):
        yield box(slot, (side, high - 0.06, 0.32), (s * (hole + side) / 2, 0.0, 0.0))
    yield box(slot, (hole, high - 0.06 - low - mouth, 0.32), (0.0, low + mouth, 0.0))
    yield box(slot, (hole, low, 0.32), (0.0, 0.0, 0.0))
    yield box("black", (hole, mouth, 0.03), (0.0, low, -0.14))
    yield rounded("wood" if kind == "brick" else slot, (wide + 0.14, 0.07, 0.42), (0.0, high - 0.07, 0.03), 0.015, 2)
    if kind != "slot":
        yield rounded("stone", (wide + 0.1, 0.05, 0.7), (0.0, 0.0, 0.2), 0.01, 1)
        for i in range(4):
            yield rod(
                "bark",
                (-0.2 + 0.02 * i, 0.1 + 0.045 * (i // 2), -0.06 + 0.08 * (i % 2)),
                (0.2 - 0.03 * i, 0.11 + 0.05 * (i // 2), 0.02 - 0.08 * (i % 2)),
                0.035,
                sides=8,
            )
    if kind == "mantel":
        for s in (-1, 1):
            yield rounded("white", (0.16, 0.72, 0.04), (s * (hole / 2 + 0.17), 0.14, 0.16), 0.012, 1)
            yield rounded("white", (0.2, 0.1, 0.06), (s * (hole / 2 + 0.17), 0.05, 0.17), 0.01, 1)
            yield soft("white", (0.2, 0.12, 0.06), (s * (hole / 2 + 0.17), 0.86, 0.17), 4.0, 4)
        yield rounded("white", (hole - 0.1, 0.16, 0.03), (0.0, 0.82, 0.16), 0.01, 1)
    for i in range(7 if kind == "slot" else 5):
        x = (i - 3) * 0.15 if kind == "slot" else (i - 2) * 0.07
        h = 0.14 + 0.05 * (i % 3)
        yield turned(
            "orange" if i % 2 else "yellow",
            [(0.02, 0.0), (0.035, 0.3 * h), (0.018, 0.7 * h), (0.001, h)],
            (x, low + (0.02 if kind == "slot" else 0.14), -0.03),
            8,
            2,
        )


def _folding_screen(kind: str) -> Iterator[Solid]:
    wide = 0.48
    for i in range(4 if kind != "cane" else 3):
        turn = 0.5 * (-1) ** i
        count = 4 if kind != "cane" else 3
        x = (i - (count - 1) / 2) * wide * np.cos(0.5)
        fill = {"folding": "patterned", "paper": "paper", "cane": "cane"}[kind]
        parts = [box(fill, (wide - 0.07, 1.6, 0.012), (0.0, 0.12, 0.0))]
        for s in (-1, 1):
            parts.append(box("wood", (0.035, 1.78, 0.028), (s * (wide - 0.04) / 2, 0.0, 0.0)))
            parts.append(box("wood", (wide - 0.07, 0.035, 0.028), (0.0, 0.09 + 1.66 * (s + 1) / 2, 0.0)))
        if kind == "paper":
            parts += [box("wood", (0.014, 1.6, 0.02), ((k - 1) * 0.14, 0.12, 0.0)) for k in range(3)]
            parts += [box("wood", (wide - 0.07, 0.014, 0.021), (0.0, 0.12 + 0.27 * k, 0.0)) for k in range(1, 6)]
        yield from (p for p in (move(rotate(q, 1, turn), (x, 0.0, 0.0)) for q in parts))


def _slats() -> Iterator[Solid]:
    for y in (0.0, 2.2):
        yield rounded("wood", (1.5, 0.06, 0.08), (0.0, y, 0.0), 0.01, 1)
    for i in range(16):
        yield rotate(
            rounded("wood", (0.02, 2.16, 0.07), ((i - 7.5) * 0.092, 0.05, 0.0), 0.004, 1),
            1,
            0.35,
            ((i - 7.5) * 0.092, 0.0, 0.0),
        )


def _rings() -> Iterator[Solid]:
    for i in range(4):
        for j in range(4):
            x, y = (i - 1.5) * 0.38, 0.05 + 0.42 * j
            yield ring("wood", 0.19, 0.035, (x, y + 0.2, 0.0), 2, 20)
    for s in (-1, 1):
        yield rounded("wood", (0.05, 1.78, 0.06), (s * 0.775, 0.0, 0.0), 0.01, 1)
        yield rounded("wood", (1.5, 0.05, 0.06), (0.0, 1.73 * (s + 1) / 2, 0.0), 0.01, 1)
        yield rounded("wood", (0.08, 0.04, 0.36), (s * 0.775, 0.0, 0.0), 0.012, 1)


_SCREEN_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "folding": partial(_folding_screen, "folding"),
    "paper": partial(_folding_screen, "paper"),
    "cane": partial(_folding_screen, "cane"),
    "slats": _slats,
    "rings": _rings,
}


def screen(kind: str = "folding") -> Iterator[Solid]:
    """A room divider: folding panels, slats, an open shelf, paper panels, beads."""
    yield from _SCREEN_KINDS[kind]()


HIGH = 1.0  # [m], of a rail


def _planks(kind: str, width: float) -> Iterator[Solid]:
    high = 1.0 if kind == "pickets" else 1.6
    for x in (-width / 2 + 0.04, width / 2 - 0.04):
        yield rounded("wood", (0.08, high, 0.08), (x, 0.0, -0.03), 0.01, 1)
    for y in (0.2, high - 0.3):
        yield box("wood", (width, 0.08, 0.03), (0.0, y, 0.0))
    count = int(width / (0.13 if kind == "pickets" else 0.11))
    for i in range(count):
        x = (i + 0.5) / count * width - width / 2
        tip = high + 0.06 if kind == "pickets" else high
        yield prism(
            "wood",
            [(x - 0.045, 0.05), (x + 0.045, 0.05), (x + 0.045, high - 0.02), (x, tip), (x - 0.045, high - 0.02)],
            0.02,
            (0.0, 0.0, 0.025),
        )


def _balusters(width: float) -> Iterator[Solid]:
    yield box("wood", (width, 0.04, 0.08), (0.0, 0.06, 0.0))
    for i in range(int(width / 0.14)):
        x = (i + 0.5) / int(width / 0.14) * (width - 0.16) - (width - 0.16) / 2
        yield turned(
            "wood",
            [(0.02, 0.1), (0.03, 0.2), (0.016, 0.3), (0.032, 0.5), (0.016, 0.78), (0.02, 0.98)],
            (x, 0.0, 0.0),
            10,
            2,
        )


def _bars(width: float) -> Iterator[Solid]:
    yield box("iron", (width, 0.03, 0.03), (0.0, 0.08, 0.0))
    for i in range(int(width / 0.11)):
        x = (i + 0.5) / int(width / 0.11) * (width - 0.1) - (width - 0.1) / 2
        yield rod("iron", (x, 0.1, 0.0), (x, 0.98, 0.0), 0.008, sides=6)
        if i % 3 == 1:
            yield ring("iron", 0.045, 0.012, (x, 0.88, 0.0), 2, 12)


def _panes(width: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("glass", (width / 2 - 0.07, 0.8, 0.012), (s * (width / 4 - 0.0), 0.1, 0.0))
    yield rounded("chrome", (0.045, HIGH, 0.045), (0.0, 0.0, 0.0), 0.006, 1)


def _ropes(width: float) -> Iterator[Solid]:
    for k in range(7):
        yield rod(
            "chrome",
            (-width / 2 + 0.03, 0.13 + 0.12 * k, 0.0),
            (width / 2 - 0.03, 0.13 + 0.12 * k, 0.0),
            0.004,
            sides=6,
        )


_BETWEEN_POSTS = {"balusters": _balusters, "bars": _bars, "glass": _panes, "ropes": _ropes}


def _railing(kind: str, width: float) -> Iterator[Solid]:
    for x in (-width / 2 + 0.03, width / 2 - 0.03):
        if kind == "balusters":
            yield rounded("wood", (0.09, HIGH + 0.06, 0.09), (x, 0.0, 0.0), 0.012, 1)
            yield ball("wood", 0.055, (x, HIGH + 0.1, 0.0), 14, 8)
        else:
            yield rounded("chrome" if kind != "bars" else "iron", (0.045, HIGH, 0.045), (x, 0.0, 0.0), 0.006, 1)
    rail = "wood" if kind in ("balusters", "ropes") else "chrome" if kind == "glass" else "iron"
    yield tube(rail, [(-width / 2, HIGH, 0.0), (width / 2, HIGH, 0.0)], 0.028, 12)
    yield from _BETWEEN_POSTS[kind](width)


def fence(kind: str = "pickets", width: float = 2.0) -> Iterator[Solid]:
    """Rails and fences: pickets, iron bars, glass, ropes of steel, turned balusters, boards."""
    yield from (_railing if kind in _BETWEEN_POSTS else _planks)(kind, width)


def column(kind: str = "round", height: float = 2.6) -> Iterator[Solid]:
    """A post that carries a ceiling: round with a capital, fluted, or square."""
    yield rounded("white", (0.36, 0.12, 0.36), (0.0, 0.0, 0.0), 0.01, 1)
    yield rounded("white", (0.36, 0.1, 0.36), (0.0, height - 0.1, 0.0), 0.01, 1)
    if kind == "square":
        yield rounded("masonry", (0.28, height - 0.2, 0.28), (0.0, 0.1, 0.0), 0.006, 1)
        yield rounded("white", (0.32, 0.05, 0.32), (0.0, height - 0.18, 0.0), 0.01, 1)
        return
    yield turned(
        "white",
        [
            (0.16, 0.12),
            (0.16, 0.16),
            (0.13, 0.2),
            (0.135, 0.9),
            (0.11, height - 0.25),
            (0.15, height - 0.14),
            (0.15, height - 0.1),
        ],
        sides=24,
        steps=2,
    )
    if kind == "fluted":
        for i in range(16):
            a = 2 * np.pi * i / 16
            yield rod(
                "white",
                (0.132 * np.cos(a), 0.24, 0.132 * np.sin(a)),
                (0.112 * np.cos(a), height - 0.3, 0.112 * np.sin(a)),
                0.014,
                sides=6,
            )


def switch(kind: str = "switch") -> Iterator[Solid]:
    """A light switch, a double one, a socket, two sockets, a dimmer, a thermostat."""
    wide = 0.15 if kind in ("double", "sockets") else 0.082
    yield rounded("white", (wide, 0.082, 0.01), (0.0, 0.0, -0.003), 0.004, 2)
    for x in (0.0,) if wide < 0.1 else (-0.036, 0.036):
        if kind in ("switch", "double"):
            yield rotate(
                rounded("white", (0.05, 0.056, 0.008), (x, 0.013, 0.003), 0.002, 1), 0, 0.06, (x, 0.041, 0.003)
            )
        elif kind in ("socket", "sockets"):
            yield ring("white", 0.024, 0.005, (x, 0.041, 0.002), 2, 22)
            yield disc("gray", 0.022, 0.001, (x, 0.041, 0.002), 20)
            for s in (-1, 1):
                yield disc("black", 0.0035, 0.002, (x + s * 0.0095, 0.041, 0.0025), 10)
        elif kind == "dimmer":
            yield disc("white", 0.024, 0.02, (0.0, 0.041, 0.001), 26)
            yield box("gray", (0.002, 0.014, 0.001), (0.0, 0.046, 0.021))
        else:
            yield disc("gray", 0.034, 0.018, (0.0, 0.041, 0.001), 28)
            yield disc("screen", 0.028, 0.002, (0.0, 0.041, 0.018), 26)
            yield box("orange", (0.02, 0.008, 0.001), (0.0, 0.037, 0.02))


def _split() -> Iterator[Solid]:
    side = fillet([(-0.1, 0.0), (0.06, 0.0), (0.1, 0.08), (0.1, 0.26), (0.06, 0.29), (-0.1, 0.29)], 0.04, 4, True)
    yield prism("white", side, 0.84, (0.0, 0.0, 0.0), "side")
    yield rotate(rounded("white", (0.76, 0.01, 0.09), (0.0, 0.02, 0.085), 0.004, 1), 0, 0.5, (0.0, 0.02, 0.085))
    yield box("black", (0.74, 0.03, 0.01), (0.0, 0.012, 0.066))
    for i in range(10):
        yield box("gray", (0.76, 0.004, 0.01), (0.0, 0.289, -0.085 + 0.014 * i))
    yield box("screen", (0.07, 0.025, 0.004), (0.3, 0.12, 0.1))
    yield box("green", (0.006, 0.006, 0.004), (0.24, 0.13, 0.101))


def _window() -> Iterator[Solid]:
    yield rounded("white", (0.6, 0.4, 0.5), (0.0, 0.0, -0.1), 0.012, 1)
    yield rounded("cream", (0.62, 0.42, 0.06), (0.0, -0.01, 0.16), 0.015, 2)
    for i in range(14):
        yield box("gray", (0.4, 0.008, 0.01), (-0.07, 0.03 + 0.025 * i, 0.188))
    for y in (0.28, 0.18):
        yield disc("black", 0.03, 0.02, (0.22, y, 0.185), 18)


def _mobile() -> Iterator[Solid]:
    yield rounded("white", (0.36, 0.68, 0.34), (0.0, 0.05, 0.0), 0.05, 3)
    for x, z in corners(0.26, 0.24):
        yield ball("black", 0.028, (x, 0.028, z), 10, 6)
    for i in range(6):
        yield box("gray", (0.26, 0.01, 0.012), (0.0, 0.5 + 0.028 * i, 0.165))
    yield box("screen", (0.16, 0.004, 0.08), (0.0, 0.729, 0.06))
    yield tube(
        "white", spline([(0.0, 0.6, -0.16), (0.0, 0.62, -0.32), (0.1, 0.9, -0.4), (0.1, 1.1, -0.38)], 5), 0.06, 12
    )


_COOLER_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "split": _split,
    "window": _window,
    "mobile": _mobile,
}


def cooler(kind: str = "split") -> Iterator[Solid]:
    """An air conditioner on a wall, in a window, or on wheels."""
    yield from _COOLER_KINDS[kind]()


def _under_ceiling(wood: bool) -> Iterator[Solid]:
    yield turned("brass", [(0.06, 0.46), (0.06, 0.5)], sides=18, steps=1)
    yield cylinder("brass", 0.012, 0.34, (0.0, 0.14, 0.0), sides=10)
    yield turned(
        "brass" if wood else "white",
        [(0.05, 0.04), (0.11, 0.07), (0.11, 0.13), (0.05, 0.16)],
        sides=24,
        steps=2,
    )
    count = 5 if wood else 3
    blade = rotate(
        prism(
            "wood" if wood else "white",
            fillet([(-0.05, 0.12), (0.05, 0.12), (0.075, 0.58), (-0.075, 0.58)], 0.04, 3, True),
            0.008,
            (0.0, 0.1, 0.0),
            "top",
        ),
        2,
        0.16,
        (0.0, 0.1, 0.0),
    )
    yield from around([blade], count)
    yield ball("opal", (0.1, 0.06, 0.1), (0.0, 0.045, 0.0), 18, 10)


def _on_foot(y: float, foot: float, rim: float, size: float) -> Iterator[Solid]:
    yield turned(
        "white",
        [(foot, 0.0), (rim, 0.02), (0.04, 0.05)],
        sides=24,
        steps=1,
    )
    yield rod("chrome", (0.0, 0.04, 0.0), (0.0, y - 0.03, 0.0), 0.012)
    yield tube("white", [(0.0, y, -0.1), (0.0, y, 0.02)], [0.04, 0.06], 14)
    yield from _cage(y, size)
    for i in range(4):
        blade = prism(
            "blue",
            fillet(
                [(-0.02, 0.02), (0.02, 0.02), (0.07 * size / 0.2, 0.85 * size), (-0.05 * size / 0.2, 0.85 * size)],
                0.03,
                3,
                True,
            ),
            0.004,
        )
        yield move(rotate(rotate(blade, 1, 0.35), 2, i * np.pi / 2), (0.0, y, 0.06))
    yield disc("white", 0.04, 0.03, (0.0, y, 0.05), 16)


def _cage(y: float, size: float) -> Iterator[Solid]:
    for z in (0.02, 0.1):
        for r in (size, 0.66 * size, 0.33 * size):
            yield ring("white", r, 0.006, (0.0, y, z + 0.03 * (1 - r / size) * (1 if z > 0.05 else -1)), 2, 22)
    for i in range(16):
        a = 2 * np.pi * i / 16
        c, s = size * np.cos(a), size * np.sin(a)
        yield tube("white", [(0.1 * c, y + 0.1 * s, 0.125), (c, y + s, 0.1), (c, y + s, 0.02)], 0.002, 4)


_FAN_KINDS: dict[str, Callable[[], Iterator[Solid]]] = {
    "ceiling": partial(_under_ceiling, False),
    "ceiling_wood": partial(_under_ceiling, True),
    "stand": partial(_on_foot, 1.15, 0.2, 0.19, 0.2),
    "table": partial(_on_foot, 0.28, 0.1, 0.1, 0.14),
}


def fan(kind: str = "ceiling") -> Iterator[Solid]:
    """A fan under a ceiling, on a tall stand, or on a table."""
    yield from _FAN_KINDS[kind]()


def whiteboard() -> Iterator[Solid]:
    """A board with a tray of pens and some writing."""
    yield rounded("white", (1.2, 0.8, 0.018), (0.0, 0.05, -0.006), 0.004, 1)
    for s in (-1, 1):
        yield box("gray", (0.02, 0.84, 0.026), (s * 0.61, 0.03, -0.004))
        yield box("gray", (1.2, 0.02, 0.026), (0.0, 0.03 + 0.82 * (s + 1) / 2, -0.004))
    yield box("gray", (0.5, 0.01, 0.06), (0.0, 0.03, 0.03))
    for i, slot in enumerate(("red", "blue", "black")):
        yield rod(slot, (-0.18 + 0.14 * i, 0.048, 0.04), (-0.07 + 0.14 * i, 0.048, 0.04), 0.008)
    for i, (x, y, w) in enumerate(((-0.3, 0.68, 0.4), (-0.32, 0.6, 0.34), (-0.28, 0.52, 0.44), (0.25, 0.6, 0.3))):
        yield box(("blue", "black", "black", "red")[i], (w, 0.014, 0.002), (x, y, 0.004))


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


FAMILIES = (
    Family(
        "radiator",
        "heater",
        (
            *_of(radiator, "panel", "columns", "double", "convector"),
            design(radiator, width=0.6),
            design(radiator, kind="columns", width=0.6, height=0.8),
        ),
    ),
    Family("oil_heater", "heater", _of(radiator, "oil")),
    Family("fireplace", "fireplace", _of(fireplace, "mantel", "brick", "stove", "slot")),
    Family("screen", "partition", _of(screen, "folding", "slats", "paper", "rings", "cane")),
    Family("fence", "fence", _of(fence, "balusters", "bars", "glass", "ropes", "pickets", "boards")),
    Family("column", "column", _of(column, "round", "fluted", "square")),
    Family("switch", "switch", _of(switch, "switch", "double", "dimmer", "thermostat")),
    Family("socket", "switch", _of(switch, "socket", "sockets")),
    Family("air_conditioner", "air_conditioner", _of(cooler, "split", "mobile")),
    Family("window_cooler", "air_conditioner", _of(cooler, "window")),
    Family("ceiling_fan", "ceiling_fan", _of(fan, "ceiling", "ceiling_wood")),
    Family("stand_fan", "pedestal_fan", _of(fan, "stand", "table")),
    Family("whiteboard", "whiteboard", (design(whiteboard),)),
)
