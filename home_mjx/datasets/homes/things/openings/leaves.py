"""Leaves of doors."""

from collections.abc import Callable, Iterator
from functools import partial

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box

LEAF = 0.04  # [m], thickness of a door's leaf

RAIL = 0.11  # [m], width of the wood around a pane


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
