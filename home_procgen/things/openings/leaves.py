"""Door leaves, and frames of doors and windows."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.curves import fillet, loop
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, tube
from home_procgen.things.joinery import disc

LEAF_THICKNESS = 0.04  # [m], thickness of a door's leaf

RAIL_WIDTH = 0.11  # [m], width of the rails around a pane

JAMB_WIDTH = 0.05  # [m], width of a door's frame posts
FRAME_DEPTH = 0.14  # [m], depth of a frame


def frame(width: float, height: float, slot: str = "wood", trim: bool = True) -> Iterator[Solid]:
    """Build posts and a lintel around an opening."""
    for s in (-1, 1):
        yield box(slot, (JAMB_WIDTH, height, FRAME_DEPTH), (s * (width - JAMB_WIDTH) / 2, 0.0, 0.0))
        if trim:
            for z in (-1, 1):
                yield box(
                    slot,
                    (JAMB_WIDTH - 0.004, height - 0.002, 0.012),
                    (s * (width - JAMB_WIDTH) / 2, 0.0, z * (FRAME_DEPTH / 2 + 0.004)),
                )
    yield box(slot, (width - 2 * JAMB_WIDTH, JAMB_WIDTH, FRAME_DEPTH), (0.0, height - JAMB_WIDTH, 0.0))


def _panelled(columns: int, rows: int, width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF_THICKNESS))
    wide = (width - 0.1 * (columns + 1)) / columns
    for i in range(columns):
        for j in range(rows):
            low = 0.14 if j == 0 else 0.14 + 0.4 * height
            high = 0.36 * height if j == 0 and rows > 1 else height - low - 0.12
            x = (i - (columns - 1) / 2) * (wide + 0.1)
            yield rounded_box("wood_1", (wide, high, LEAF_THICKNESS + 0.014), (x, low, 0.0), 0.007, 1)


def _pointed(width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF_THICKNESS))
    wide, low = width - 0.1 * 2, 0.14
    high = height - low - 0.12
    outline = [(-wide / 2, low), (wide / 2, low), (wide / 2, low + 0.8 * high), (0.0, low + high)]
    shape = fillet([*outline, (-wide / 2, low + 0.8 * high)], 0.2, 5, True)
    yield prism("wood_1", shape, LEAF_THICKNESS + 0.014, (0.0, 0.0, 0.0))


def _glazed(low: float, width: float, height: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("wood_1", (RAIL_WIDTH, height, LEAF_THICKNESS), (s * (width - RAIL_WIDTH) / 2, 0.0, 0.0))
    for y, high in ((0.0, low), (height - RAIL_WIDTH, RAIL_WIDTH)):
        yield box("wood_1", (width - 2 * RAIL_WIDTH, high, LEAF_THICKNESS), (0.0, y, 0.0))
    yield box("glass", (width - 2 * RAIL_WIDTH, height - low - RAIL_WIDTH, 0.008), (0.0, low, 0.0))


def _half_glazed(width: float, height: float) -> Iterator[Solid]:
    yield from _glazed(0.95, width, height)
    yield rounded_box("wood_1", (width - 0.3, 0.95 - 0.3, LEAF_THICKNESS + 0.014), (0.0, 0.16, 0.0), 0.007, 1)


def _lattice(width: float, height: float) -> Iterator[Solid]:
    low = 0.2
    yield from _glazed(low, width, height)
    inner, tall = width - 2 * RAIL_WIDTH, height - low - RAIL_WIDTH
    for i in range(1, 3):
        yield box("wood_1", (0.022, tall, LEAF_THICKNESS - 0.008), ((i / 3 - 0.5) * inner, low, 0.0))
    for j in range(1, 5):
        for i in range(3):
            at = (((i + 0.5) / 3 - 0.5) * inner, low + j * tall / 5, 0.0)
            yield box("wood_1", (inner / 3 - 0.024, 0.022, LEAF_THICKNESS - 0.008), at)


def _boards(width: float, height: float) -> Iterator[Solid]:
    for i in range(6):
        at = ((i - 2.5) * width / 6, 0.0, 0.0)
        yield rounded_box("wood_1", (width / 6 - 0.002, height, LEAF_THICKNESS - 0.008), at, 0.005, 1)
    for s in (-1, 1):
        z = s * (LEAF_THICKNESS / 2 - 0.001)
        for y in (0.2, height - 0.35):
            yield box("wood_1", (width - 0.06, 0.12, 0.018), (0.0, y, z))
        yield beam("wood_1", (-width / 2 + 0.12, 0.34, z), (width / 2 - 0.12, height - 0.37, z), 0.016, 0.1)


def _flat(width: float, height: float) -> Iterator[Solid]:
    yield box("wood_1", (width, height, LEAF_THICKNESS))


def _lined(width: float, height: float) -> Iterator[Solid]:
    yield from _flat(width, height)
    for s in (-1, 1):
        for k in range(1, 5):
            yield box("chrome", (width - 0.04, 0.012, 0.004), (0.0, k * height / 5, s * (LEAF_THICKNESS / 2 + 0.001)))


def _porthole(width: float, height: float) -> Iterator[Solid]:
    yield from _flat(width, height)
    for s in (-1, 1):
        yield ring("chrome", 0.17, 0.03, (0.0, 1.55, s * LEAF_THICKNESS / 2), 2, 24)
        yield disc("glass", 0.165, 0.006, (0.0, 1.55, s * (LEAF_THICKNESS / 2 + 0.002) - 0.003), 24)


def _louvred(width: float, height: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("wood_1", (RAIL_WIDTH, height, LEAF_THICKNESS), (s * (width - RAIL_WIDTH) / 2, 0.0, 0.0))
    for y, high in ((0.0, 0.2), (0.95, RAIL_WIDTH), (height - RAIL_WIDTH, RAIL_WIDTH)):
        yield box("wood_1", (width - 2 * RAIL_WIDTH, high, LEAF_THICKNESS), (0.0, y, 0.0))
    for low, top in ((0.2, 0.95), (0.95 + RAIL_WIDTH, height - RAIL_WIDTH)):
        for k in range(int((top - low) / 0.045)):
            y = low + 0.008 + 0.045 * k
            yield rotate(
                box("wood_1", (width - 2 * RAIL_WIDTH, 0.04, 0.008), (0.0, y, 0.0)), 0, 0.5, (0.0, y + 0.02, 0.0)
            )


def _ladder(width: float, height: float) -> Iterator[Solid]:
    """Build a leaf with five panels, one above the other."""
    yield box("wood_1", (width, height, LEAF_THICKNESS))
    high = (height - 0.2 - 0.09 * 5) / 5
    for k in range(5):
        yield rounded_box(
            "wood_1", (width - 0.2, high, LEAF_THICKNESS + 0.014), (0.0, 0.16 + k * (high + 0.09), 0.0), 0.012, 2
        )


def _oval(width: float, height: float) -> Iterator[Solid]:
    """Build a leaf with an oval pane in a moulded rim above a panel."""
    yield box("wood_1", (width, height, LEAF_THICKNESS))
    yield rounded_box("wood_1", (width - 0.24, 0.5, LEAF_THICKNESS + 0.014), (0.0, 0.14, 0.0), 0.012, 2)
    outline = loop(0.36, 0.9, 28)
    for s in (-1, 1):
        z = s * (LEAF_THICKNESS / 2 + 0.002)
        path = np.insert(outline + np.array([0.0, 1.35]), 2, z, axis=1)
        yield tube("wood_1", path, 0.016, 8, closed=True)
        yield prism("glass", outline, 0.004, (0.0, 1.35, z))


def _chevron(width: float, height: float) -> Iterator[Solid]:
    """Build a leaf of boards that meet at an angle along the centre line, within a rim."""
    yield box("wood_1", (width, height, LEAF_THICKNESS - 0.012))
    rim, pitch, rise, gap = 0.05, 0.16, 0.2, 0.006
    high, wide = height - 2 * rim, width / 2 - rim
    for x in (-1, 1):
        yield box("wood_1", (rim - gap, height, LEAF_THICKNESS), (x * (width - rim + gap) / 2, 0.0, 0.0))
    for y in (0.0, height - rim + gap):
        yield box("wood_1", (width - 2 * rim + 2 * gap, rim - gap, LEAF_THICKNESS), (0.0, y, 0.0))
    for k in range(-int(rise / pitch) - 1, int(high / pitch) + 1):
        board = _between(k * pitch, (k + 1) * pitch - gap, rise / wide, wide - gap / 2, high)
        for side in (-1, 1) if len(board) > 2 else ():
            outline = [(side * (x + gap / 2), y + rim) for x, y in board]
            yield prism("wood_1", outline, LEAF_THICKNESS, (0.0, 0.0, 0.0))


def _between(lower: float, upper: float, slope: float, wide: float, high: float) -> list[tuple[float, float]]:
    """Return the part of a strip between two parallel lines, given at x = 0, that is in 0..`wide` x 0..`high` [m]."""
    start, end = max(0.0, -upper / slope), min(wide, (high - lower) / slope)
    found: list[tuple[float, float]] = []
    for line, way in ((lower, 1), (upper, -1)):
        crossings = [x for y in (0.0, high) if start < (x := (y - line) / slope) < end]
        xs = sorted((start, *crossings, end))[::way]
        found += [(x, min(max(line + slope * x, 0.0), high)) for x in xs]
    return [point for i, point in enumerate(found) if np.hypot(*np.subtract(point, found[i - 1])) > 1e-6]


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
    "louvres": _louvred,
    "ladder": _ladder,
    "oval": _oval,
    "chevron": _chevron,
}


def leaf(width: float, height: float, style: str) -> Iterator[Solid]:
    """Build an upright door leaf at the origin."""
    yield from _LEAVES[style](width, height)
