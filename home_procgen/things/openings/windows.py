"""Windows."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism
from home_procgen.things.family import FurnitureFamily, design


def window(
    width: float = 1.4, height: float = 1.4, sashes: int = 2, style: str = "plain", slot: str = "color"
) -> Iterator[Solid]:
    """Build a window with glazed sashes: plain, barred, diamond, sliding, or with a transom."""
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
        pitch = (width - 2 * rim) / max(sashes, 1)
        for i in range(sashes):
            yield from _sash(pitch, top - rim, ((i + 0.5) * pitch - (width - 2 * rim) / 2, rim, 0.0), style, slot)
    yield box(slot, (width, 0.025, 0.03), (0.0, 0.02, deep / 2 + 0.008))


def _sash(
    width: float, height: float, at: tuple[float, float, float], style: str, slot: str, z: float = 0.0
) -> Iterator[Solid]:
    """Build a glazed sash with a handle.

    Args:
        width: Width [m].
        height: Height [m].
        at: x and y of the bottom centre [m]; its z is ignored.
        style: "bars", "diamond", or any other for one pane.
        slot: Material slot of the frame.
        z: Depth of the track [m].
    """
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
    yield rounded_box("chrome", (0.02, 0.1, 0.03), (x + width / 2 - 0.022, y + 0.45 * height, z + 0.04), 0.006, 1)


def _sliding(width: float, height: float, y: float, slot: str) -> Iterator[Solid]:
    """Build a sliding sash window: an upper and a lower sash in separate tracks."""
    for i, z in ((0, 0.031), (1, -0.031)):
        for piece in _sash(
            width, height / 2 + 0.02, (0.0, y + i * (height / 2 - 0.02), 0.0), "bars" if i else "plain", slot, z
        ):
            if piece.material != "chrome":
                yield piece
    yield rounded_box("brass", (0.06, 0.02, 0.03), (0.0, y + height / 2 - 0.005, 0.07), 0.006, 1)


def arched_window(width: float = 1.0, height: float = 1.5) -> Iterator[Solid]:
    """Build a rectangular frame, filled in above a round arch of glass."""
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


def louvred_window(width: float = 0.9, height: float = 1.3) -> Iterator[Solid]:
    """Build a window of tilted glass louvres."""
    yield from window(width, height, 0, "plain")
    inner, count = width - 0.16, int((height - 0.16) / 0.11)
    for s in (-1, 1):
        yield rounded_box("chrome", (0.02, height - 0.14, 0.06), (s * (width / 2 - 0.07), 0.07, 0.0), 0.005, 1)
    for k in range(count):
        y = 0.09 + 0.11 * k
        yield rotate(box("color_1", (inner, 0.12, 0.006), (0.0, y, 0.0)), 0, 0.35, (0.0, y + 0.06, 0.0))
    yield rounded_box("chrome", (0.014, 0.12, 0.04), (width / 2 - 0.1, 0.4 * height, 0.04), 0.005, 1)


WINDOWS = (
    design(window, width=0.7, height=0.8, sashes=1), design(window, width=1.0, height=1.4, sashes=1, style="bars"),
    design(window), design(window, width=2.0, sashes=3), design(window, width=1.0, height=1.5, style="sash"),
    design(window, style="transom"), design(window, width=1.0, sashes=1, style="diamond", height=1.2),
    design(arched_window), design(window, style="bars", width=1.6), design(louvred_window),
    # The same, as low as kitchens need them above worktops.
    design(window, width=1.0, height=1.2, sashes=1, style="bars"), design(window, height=1.2),
    design(window, width=2.0, height=1.2, sashes=3), design(window, width=1.0, height=1.2, style="sash"),
    design(window, style="transom", height=1.2), design(arched_window, height=1.2),
    design(window, style="bars", width=1.6, height=1.2),
)  # fmt: skip

_GLASS = {"color": "color", "color_1": "glass"}


FAMILIES = (FurnitureFamily("window", "window", WINDOWS, None, False, _GLASS),)
