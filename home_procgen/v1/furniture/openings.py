"""Doors and windows: placed on a wall's centre-line, they carve its hole by their bounding box."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, cushion, move, rotate

JAMB = 0.05  # [m], width of a door's frame posts
LEAF = 0.04  # [m], thickness of a door's leaf


def door(width: float, height: float, angle: float, panels: int = 0, glazed: bool = False) -> Iterator[Solid]:
    """A frame and a leaf hinged at -x that swings to -z.

    Args:
        width: Over the frame [m].
        height: Over the frame [m].
        angle: Of the leaf [rad]; 0 is closed.
        panels: Raised panels on each side of the leaf.
        glazed: A glass pane instead of a full leaf.
    """
    for side in (-1, 1):
        yield box("wood", (JAMB, height, 0.14), (side * (width - JAMB) / 2, 0.0, 0.0))
    yield box("wood", (width - 2 * JAMB, JAMB, 0.14), (0.0, height - JAMB, 0.0))
    pivot = (JAMB - width / 2, 0.0, -0.07)
    leaf = _leaf(width - 2 * JAMB - 0.006, height - JAMB - 0.04, panels, glazed)
    for piece in leaf:
        shut = move(piece, (0.0, 0.035, -0.07 + LEAF / 2))
        yield rotate(shut, 1, angle, pivot)


def _leaf(width: float, height: float, panels: int, glazed: bool) -> Iterator[Solid]:
    """The leaf, upright at the origin."""
    if glazed:
        rail = 0.11
        for side in (-1, 1):
            yield box("wood_1", (rail, height, LEAF), (side * (width - rail) / 2, 0.0, 0.0))
        for y, high in ((0.0, 0.3), (height - rail, rail)):
            yield box("wood_1", (width - 2 * rail, high, LEAF), (0.0, y, 0.0))
        yield box("glass", (width - 2 * rail, height - 0.3 - rail, 0.008), (0.0, 0.3, 0.0))
    else:
        yield box("wood_1", (width, height, LEAF))
    for i in range(panels):
        high = (height - 0.12 * (panels + 1)) / panels
        at = (0.0, 0.12 + i * (high + 0.12), 0.0)
        yield cushion("wood_1", (width - 0.24, high, LEAF + 0.012), at, 0.005)
    for side in (-1, 1):
        yield box("chrome", (0.12, 0.02, 0.02), (width / 2 - 0.1, 1.0, side * 0.045))
        yield box("chrome", (0.02, 0.02, 0.03), (width / 2 - 0.05, 1.0, side * 0.033))


def window(width: float, height: float, sashes: int) -> Iterator[Solid]:
    """A frame with glazed sashes and an inner sill.

    Args:
        width: Over the frame [m].
        height: Over the frame [m].
        sashes: Side by side.
    """
    rim, deep = 0.06, 0.12
    yield box("color", (width, rim, deep))
    yield box("color", (width, rim, deep), (0.0, height - rim, 0.0))
    pitch = (width - rim) / sashes
    for i in range(sashes + 1):
        yield box(
            "color",
            (rim, height - 2 * rim, deep if i in (0, sashes) else 0.07),
            (i * pitch - (width - rim) / 2, rim, 0.0),
        )
    for i in range(sashes):
        at = ((i + 0.5) * pitch - (width - rim) / 2, rim, 0.0)
        yield box("color_1", (pitch - rim, height - 2 * rim, 0.012), at)
    yield box("color", (width, 0.025, 0.02), (0.0, 0.02, deep / 2 + 0.005))


FAMILIES = (
    VariantFamily(
        "door",
        "door",
        door,
        make_slots("wood", "wood_1", "chrome", "glass"),
        (
            make_variant(width=0.9, height=2.1, angle=np.pi / 2, panels=2),
            make_variant(width=0.9, height=2.12, angle=np.pi / 2),
            make_variant(width=0.86, height=2.08, angle=np.pi / 2, glazed=True),
        ),
        closed=make_variant(angle=0.0),
        centred=False,
    ),
    VariantFamily(
        "window",
        "window",
        window,
        {"color": "color", "color_1": "glass"},
        (
            make_variant(width=0.7, height=0.8, sashes=1),
            make_variant(width=1.0, height=1.4, sashes=1),
            make_variant(width=1.4, height=1.4, sashes=2),
            make_variant(width=2.0, height=1.4, sashes=3),
        ),
        centred=False,
    ),
)
