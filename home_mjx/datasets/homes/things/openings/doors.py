"""Doors, windows, garage doors, arches: placed on a wall's centre-line, they carve its hole by their bounding box."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc, placed_front
from home_mjx.datasets.procedural.primitives.solids import Solid, box, move, rotate

JAMB = 0.05  # [m], width of a door's frame posts
LEAF = 0.04  # [m], thickness of a door's leaf
RAIL = 0.11  # [m], width of the wood around a pane
DEEP = 0.14  # [m], of a frame


def _frame(width: float, height: float, slot: str = "wood", trim: bool = True) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box(slot, (JAMB, height, DEEP), (s * (width - JAMB) / 2, 0.0, 0.0))
        if trim:
            for z in (-1, 1):
                yield box(
                    slot, (JAMB - 0.004, height - 0.002, 0.012), (s * (width - JAMB) / 2, 0.0, z * (DEEP / 2 + 0.004))
                )
    yield box(slot, (width - 2 * JAMB, JAMB, DEEP), (0.0, height - JAMB, 0.0))


def _handles(x: float, kind: str, direction: float) -> Iterator[Solid]:
    """On both sides of a leaf around z = 0, 1 m above its foot."""
    for s in (-1, 1):
        z = s * (LEAF / 2)
        if kind == "lever":
            yield rounded("chrome", (0.035, 0.14, 0.01), (x, 0.93, z + s * 0.005), 0.004, 1)
            yield rod("chrome", (x, 1.02, z), (x, 1.02, z + s * 0.045), 0.008)
            yield rod("chrome", (x, 1.02, z + s * 0.045), (x + direction * 0.12, 1.02, z + s * 0.045), 0.008)
        elif kind == "knob":
            knob = turned(
                "brass", [(0.026, 0.0), (0.012, 0.008), (0.012, 0.03), (0.028, 0.045), (0.02, 0.062)], sides=14, steps=2
            )
            yield from (
                placed_front([knob], (x, 1.02, LEAF / 2))
                if s > 0
                else (rotate(p, 1, np.pi, (x, 1.02, 0.0)) for p in placed_front([knob], (x, 1.02, LEAF / 2)))
            )
        else:
            for y in (0.88, 1.22):
                yield rod("black", (x, y, z), (x, y, z + s * 0.04), 0.008)
            yield rod("black", (x, 0.85, z + s * 0.04), (x, 1.25, z + s * 0.04), 0.01)


def _panelled(columns: int, rows: int, width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF))
    wide = (width - 0.1 * (columns + 1)) / columns
    for i in range(columns):
        for j in range(rows):
            low = 0.14 if j == 0 else 0.14 + 0.4 * height
            high = 0.36 * height if j == 0 and rows > 1 else height - low - 0.12
            x = (i - (columns - 1) / 2) * (wide + 0.1)
            yield rounded("wood_1", (wide, high, LEAF + 0.014), (x, low, 0.0), 0.007, 1)


def _pointed(width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF))
    wide, low = width - 0.1 * 2, 0.14
    high = height - low - 0.12
    outline = [(-wide / 2, low), (wide / 2, low), (wide / 2, low + 0.8 * high), (0.0, low + high)]
    shape = fillet([*outline, (-wide / 2, low + 0.8 * high)], 0.2, 5, True)
    yield prism("wood_1", shape, LEAF + 0.014, (0.0, 0.0, 0.0))


def _glazed(low: float, width: float, height: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("wood_1", (RAIL, height, LEAF), (s * (width - RAIL) / 2, 0.0, 0.0))
    for y, high in ((0.0, low), (height - RAIL, RAIL)):
        yield box("wood_1", (width - 2 * RAIL, high, LEAF), (0.0, y, 0.0))
    yield box("glass", (width - 2 * RAIL, height - low - RAIL, 0.008), (0.0, low, 0.0))


def _half_glazed(width: float, height: float) -> Iterator[Solid]:
    yield from _glazed(0.95, width, height)
    yield rounded("wood_1", (width - 0.3, 0.95 - 0.3, LEAF + 0.014), (0.0, 0.16, 0.0), 0.007, 1)


def _lattice(width: float, height: float) -> Iterator[Solid]:
    low = 0.2
    yield from _glazed(low, width, height)
    inner, tall = width - 2 * RAIL, height - low - RAIL
    for i in range(1, 3):
        yield box("wood_1", (0.022, tall, LEAF - 0.008), ((i / 3 - 0.5) * inner, low, 0.0))
    for j in range(1, 5):
        for i in range(3):
            at = (((i + 0.5) / 3 - 0.5) * inner, low + j * tall / 5, 0.0)
            yield box("wood_1", (inner / 3 - 0.024, 0.022, LEAF - 0.008), at)


def _boards(width: float, height: float) -> Iterator[Solid]:
    for i in range(6):
        at = ((i - 2.5) * width / 6, 0.0, 0.0)
        yield rounded("wood_1", (width / 6 - 0.002, height, LEAF - 0.008), at, 0.005, 1)
    for s in (-1, 1):
        z = s * (LEAF / 2 - 0.001)
        for y in (0.2, height - 0.35):
            yield box("wood_1", (width - 0.06, 0.12, 0.018), (0.0, y, z))
        yield beam("wood_1", (-width / 2 + 0.12, 0.34, z), (width / 2 - 0.12, height - 0.37, z), 0.016, 0.1)


def _flat(width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF))


def _lined(width: float, height: float) -> Iterator[Solid]:
    yield from _flat(width, height)
    for s in (-1, 1):
        for k in range(1, 5):
            yield box("chrome", (width - 0.04, 0.012, 0.004), (0.0, k * height / 5, s * (LEAF / 2 + 0.001)))


def _porthole(width: float, height: float) -> Iterator[Solid]:
    yield from _flat(width, height)
    for s in (-1, 1):
        yield ring("chrome", 0.17, 0.03, (0.0, 1.55, s * LEAF / 2), 2, 24)
        yield disc("glass", 0.165, 0.006, (0.0, 1.55, s * (LEAF / 2 + 0.002) - 0.003), 24)


_LEAVES: dict[str, Callable[[float, float], Iterator[Solid]]] = {
    "panels": partial(_panelled, 1, 2),
    "four": partial(_panelled, 2, 2),
    "arch": _pointed,
    "glazed": partial(_glazed, 0.3),
    "lattice": _lattice,
    "half": _half_glazed,
    "boards": _boards,
    "flat": _flat,
    "lines": _lined,
    "port": _porthole,
}


def leaf(width: float, height: float, style: str) -> Iterator[Solid]:
    """A door's leaf, upright at the origin."""
    yield from _LEAVES[style](width, height)


def door(
    width: float = 0.9,
    height: float = 2.1,
    angle: float = np.pi / 2,
    style: str = "panels",
    grip: str = "lever",
    entry: bool = False,
) -> Iterator[Solid]:
    """A frame and a leaf hinged at -x that swings to -z.

    Args:
        width: Over the frame [m].
        height: Over the frame [m].
        angle: Of the leaf [rad]; 0 is closed.
        style: Of the leaf.
        grip: Kind of handle.
        entry: A front door, with a letter slot, a knocker and a spy-hole.
    """
    yield from _frame(width, height)
    pivot = (JAMB - width / 2, 0.0, -DEEP / 2)
    wide, high = width - 2 * JAMB - 0.006, height - JAMB - 0.04
    pieces = [*leaf(wide, high, style), *_handles(wide / 2 - 0.06, grip, -1.0)]
    if entry:
        for s in (-1, 1):
            pieces.append(rounded("brass", (0.26, 0.05, 0.01), (0.0, 0.75, s * (LEAF / 2 + 0.01)), 0.004, 1))
            pieces.append(disc("brass", 0.012, 0.012, (0.0, 1.52, s * (LEAF / 2 + 0.004) - 0.006), 12))
    for piece in pieces:
        yield rotate(move(piece, (0.0, 0.035, -DEEP / 2 + LEAF / 2)), 1, angle, pivot)


def double_door(
    width: float = 1.5, height: float = 2.1, angle: float = np.pi / 2, style: str = "lattice"
) -> Iterator[Solid]:
    """Two leaves that swing to -z."""
    yield from _frame(width, height)
    wide, high = (width - 2 * JAMB) / 2 - 0.005, height - JAMB - 0.04
    for s in (-1, 1):
        pivot = (s * (width / 2 - JAMB), 0.0, -DEEP / 2)
        for piece in [*leaf(wide, high, style), *_handles(-s * (wide / 2 - 0.06), "lever", float(s))]:
            shut = move(piece, (s * (wide / 2 + 0.0035), 0.035, -DEEP / 2 + LEAF / 2))
            yield rotate(shut, 1, -s * angle, pivot)


def window(
    width: float = 1.4, height: float = 1.4, sashes: int = 2, style: str = "plain", slot: str = "color"
) -> Iterator[Solid]:
    """A frame with glazed sashes: plain, with glazing bars, with a transom, arched bars, sliding, or to the floor."""
    rim, deep = 0.06, 0.12
    yield box(slot, (width, rim, deep))
    yield box(slot, (width, rim, deep), (0.0, height - rim, 0.0))
    for s in (-1, 1):
        yield box(slot, (rim, height - 2 * rim, deep), (s * (width - rim) / 2, rim, 0.0))
    top = height - rim - (0.36 * height if style == "transom" else 0.0)
    if style == "transom":
        yield box(slot, (width - 2 * rim, rim, 0.08), (0.0, top, 0.0))
        yield box("color_1", (width - 2 * rim, height - rim - top - rim, 0.012), (0.0, top + rim, 0.0))
    if style == "sash":
        yield from _sliding(width - 2 * rim, height - 2 * rim, rim, slot)
    else:
        pitch = (width - 2 * rim) / sashes
        for i in range(sashes):
            yield from _sash(pitch, top - rim, ((i + 0.5) * pitch - (width - 2 * rim) / 2, rim, 0.0), style, slot)
    yield box(slot, (width, 0.025, 0.03), (0.0, 0.02, deep / 2 + 0.008))


def _sash(
    width: float, height: float, at: tuple[float, float, float], style: str, slot: str, z: float = 0.0
) -> Iterator[Solid]:
    """A glazed sash with its lower middle at `at`."""
    rail, (x, y, _) = 0.045, at
    for s in (-1, 1):
        yield box(slot, (rail, height, 0.06), (x + s * (width - rail) / 2, y, z))
        yield box(slot, (width - 2 * rail, rail, 0.06), (x, y + (height - rail) * (s + 1) / 2, z))
    inner, tall = width - 2 * rail, height - 2 * rail
    yield box("color_1", (inner, tall, 0.012), (x, y + rail, z))
    if style == "bars":
        yield box(slot, (0.02, tall, 0.03), (x, y + rail, z))
        for k in (1, 2):
            for s in (-1, 1):
                yield box(
                    slot, (inner / 2 - 0.012, 0.02, 0.03), (x + s * (inner / 4 + 0.005), y + rail + k * tall / 3, z)
                )
    elif style == "diamond":
        for s in (-1, 1):
            yield beam("black", (x - s * inner / 2, y + rail, z), (x + s * inner / 2, y + rail + tall, z), 0.02, 0.012)
            yield beam(
                "black",
                (x - s * inner / 2, y + rail + tall / 2, z),
                (x, y + rail + (tall if s > 0 else 0.0), z),
                0.02,
                0.012,
            )
            yield beam(
                "black",
                (x + s * inner / 2, y + rail + tall / 2, z),
                (x, y + rail + (0.0 if s > 0 else tall), z),
                0.02,
                0.012,
            )
    yield rounded("chrome", (0.02, 0.1, 0.03), (x + width / 2 - 0.022, y + 0.45 * height, z + 0.04), 0.006, 1)


def _sliding(width: float, height: float, y: float, slot: str) -> Iterator[Solid]:
    """Two sashes, one above the other, in tracks of their own."""
    for i, z in ((0, 0.031), (1, -0.031)):
        for piece in _sash(
            width, height / 2 + 0.02, (0.0, y + i * (height / 2 - 0.02), 0.0), "bars" if i else "plain", slot, z
        ):
            if piece.material != "chrome":
                yield piece
    yield rounded("brass", (0.06, 0.02, 0.03), (0.0, y + height / 2 - 0.005, 0.07), 0.006, 1)


def arched_window(width: float = 1.0, height: float = 1.5) -> Iterator[Solid]:
    """A rectangular frame filled in above a round arch of glass."""
    yield from window(width, height, 1, "plain", "color")
    inner, spring = width - 0.21, height - width / 2 - 0.06
    for s in (-1, 1):
        corner = [
            (s * inner / 2, height - 0.1),
            (s * inner / 2, spring),
            *[(s * inner / 2 * np.cos(a), spring + inner / 2 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 9)],
            (0.0, height - 0.1),
        ]
        yield prism("color", corner, 0.05)
    for a in (0.25, 0.5, 0.75):
        yield beam(
            "color",
            (0.0, spring, 0.0),
            (inner / 2 * np.cos(np.pi * a), spring + inner / 2 * np.sin(np.pi * a), 0.0),
            0.022,
            0.03,
        )
    yield box("color", (inner, 0.022, 0.03), (0.0, spring, 0.0))


def garage(width: float = 2.5, height: float = 2.15, lift: float = 1.0, style: str = "panels") -> Iterator[Solid]:
    """A frame and a door of sections; `lift` 0 is closed, 1 is open: flat below the ceiling, towards -z."""
    for s in (-1, 1):
        yield box("white", (0.06, height, DEEP), (s * (width - 0.06) / 2, 0.0, 0.0))
    yield box("white", (width - 0.12, 0.06, DEEP), (0.0, height - 0.06, 0.0))
    pivot = (0.0, height - 0.1, -0.08)
    for piece in _sections(width - 0.14, height - 0.12, style):
        yield rotate(piece, 0, lift * np.pi / 2, pivot)


def _sections(width: float, height: float, style: str) -> Iterator[Solid]:
    """Four rows of panels, one of them glazed perhaps."""
    high = height / 4
    for i in range(4):
        y = 0.01 + i * high
        yield rounded("paint", (width, high - 0.006, 0.035), (0.0, y, -0.05), 0.006, 1)
        for k in range(4):
            x, glazed = (k - 1.5) * width / 4, style == "glass" and i == 2
            slot = "glass" if glazed else "paint"
            yield rounded(slot, (width / 4 - 0.12, high - 0.16, 0.047), (x, y + 0.08, -0.05), 0.006, 1)
    yield rounded("black", (0.16, 0.03, 0.03), (0.0, 0.5, -0.02), 0.01, 1)


def arch(width: float = 1.2, height: float = 2.2, kind: str = "round") -> Iterator[Solid]:
    """A lined opening without a door: round-headed or square with pilasters."""
    post = 0.09
    for s in (-1, 1):
        yield rounded(
            "white",
            (post, height - 0.02 if kind == "square" else height - width / 2, 0.16),
            (s * (width - post) / 2, 0.0, 0.0),
            0.01,
            1,
        )
        yield rounded("white", (post + 0.02, 0.14, 0.18), (s * (width - post) / 2, 0.0, 0.0), 0.008, 1)
    if kind == "square":
        yield rounded("white", (width, 0.12, 0.16), (0.0, height - 0.12, 0.0), 0.01, 1)
        yield rounded("white", (width + 0.04, 0.04, 0.19), (0.0, height - 0.03, 0.0), 0.01, 1)
    else:
        spring = height - width / 2
        outer = [(width / 2 * np.cos(a), spring + (width / 2) * np.sin(a)) for a in np.linspace(0, np.pi, 21)]
        inner = [
            ((width / 2 - post) * np.cos(a), spring + (width / 2 - post) * np.sin(a)) for a in np.linspace(np.pi, 0, 21)
        ]
        yield prism("white", [*outer, *inner], 0.16)
        for s in (-1, 1):
            corner = [
                (s * width / 2, spring),
                *[(s * width / 2 * np.cos(a), spring + width / 2 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 11)],
                (s * width / 2, height),
            ]
            yield prism("white", corner, 0.12)


DOORS = (
    design(door), design(door, style="flat", height=2.12), design(door, style="glazed", width=0.86, height=2.08),
    design(door, style="four", grip="knob"), design(door, style="boards", grip="bar"), design(door, style="lattice"),
    design(door, style="arch", grip="knob"), design(door, style="lines", grip="bar"), design(door, style="port"),
)  # fmt: skip
ENTRIES = (
    design(door, style="panels", width=1.0, entry=True, grip="knob"),
    design(door, style="half", width=1.0, entry=True),
    design(door, style="arch", width=1.0, entry=True, grip="bar"),
)
WINDOWS = (
    design(window, width=0.7, height=0.8, sashes=1), design(window, width=1.0, height=1.4, sashes=1, style="bars"),
    design(window), design(window, width=2.0, sashes=3), design(window, width=1.0, height=1.5, style="sash"),
    design(window, style="transom"), design(window, width=1.0, sashes=1, style="diamond", height=1.2),
    design(arched_window), design(window, style="bars", width=1.6),
)  # fmt: skip

_GLASS = {"color": "color", "color_1": "glass"}
FAMILIES = (
    Family("door", "door", DOORS, {"angle": 0.0}, False),
    Family("entry_door", "door", ENTRIES, {"angle": 0.0}, False),
    Family(
        "double_door",
        "door",
        (design(double_door), design(double_door, style="glazed", width=1.6), design(double_door, style="panels")),
        {"angle": 0.0},
        False,
    ),
    Family("window", "window", WINDOWS, None, False, _GLASS),
    Family(
        "garage_door", "garage_door", (design(garage), design(garage, style="glass", width=2.6)), {"lift": 0.0}, False
    ),
    Family("arch", "arch", (design(arch), design(arch, kind="square")), None, False),
)
