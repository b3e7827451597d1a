"""Pianos and keyboards."""

from collections.abc import Iterator
from functools import partial

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism, rod
from home_procgen.things.family import FurnitureFamily, design


def keys(width: float, y: float, z: float, deep: float = 0.14) -> Iterator[Solid]:
    """Build white and black keys."""
    count = int(width / 0.0235)
    yield box("white", (count * 0.0235, 0.018, deep), (0.0, y, z))
    for i in range(1, count):
        x = (i - count / 2) * 0.0235
        if i % 7 not in (0, 3):
            yield box("black", (0.012, 0.012, 0.6 * deep), (x, y + 0.017, z - 0.2 * deep))


def _upright() -> Iterator[Solid]:
    yield rounded_box("wood", (1.5, 1.2, 0.36), (0.0, 0.02, -0.14), 0.012, 2)
    yield rounded_box("wood", (1.52, 0.035, 0.4), (0.0, 1.21, -0.13), 0.012, 1)
    yield rounded_box("wood", (1.5, 0.12, 0.34), (0.0, 0.6, 0.14), 0.02, 2)
    for s in (-1, 1):
        yield revolve("wood", [(0.05, 0.0), (0.03, 0.05), (0.045, 0.4), (0.05, 0.6)], (s * 0.68, 0.0, 0.26), 14, 2)
        yield rounded_box("wood", (0.1, 0.16, 0.32), (s * 0.7, 0.68, 0.14), 0.02, 2)
        yield rod("brass", (s * 0.04, 0.06, 0.04), (s * 0.04, 0.05, 0.16), 0.014)
    yield from keys(1.26, 0.72, 0.2)
    yield rotate(box("wood", (0.7, 0.26, 0.014), (0.0, 0.86, 0.05)), 0, -0.2, (0.0, 0.86, 0.05))
    yield rotate(box("paper", (0.4, 0.24, 0.008), (0.0, 0.87, 0.064)), 0, -0.2, (0.0, 0.86, 0.05))


def _grand() -> Iterator[Solid]:
    body = spline(
        [
            (-0.74, 0.5),
            (-0.74, -0.9),
            (-0.55, -1.2),
            (-0.2, -1.22),
            (0.1, -0.9),
            (0.45, -0.5),
            (0.74, -0.2),
            (0.74, 0.5),
        ],
        4,
    )
    yield prism("black", body, 0.32, (0.0, 0.62, 0.0), "top")
    yield prism("wood", 0.95 * body, 0.01, (0.0, 0.936, 0.0), "top")
    lid = rotate(prism("black", body, 0.02, (0.0, 0.96, 0.0), "top"), 2, 0.55, (-0.74, 0.96, 0.0))
    yield lid
    yield rod("black", (0.55, 0.94, -0.2), (0.44, 1.66, -0.2), 0.01)
    yield rounded_box("black", (1.48, 0.1, 0.3), (0.0, 0.62, 0.6), 0.015, 1)
    yield from keys(1.3, 0.715, 0.62)
    for x, z in ((-0.6, 0.45), (0.6, 0.45), (-0.1, -0.95)):
        yield revolve("black", [(0.035, 0.0), (0.05, 0.06), (0.045, 0.4), (0.07, 0.62)], (x, 0.0, z), 14, 2)
    yield rod("black", (0.0, 0.1, 0.4), (0.0, 0.62, 0.36), 0.03)
    for s in (-1, 0, 1):
        yield rounded_box("brass", (0.03, 0.015, 0.12), (s * 0.06, 0.06, 0.48), 0.005, 1)
    yield rotate(box("black", (0.6, 0.22, 0.014), (0.0, 0.95, 0.36)), 0, -0.3, (0.0, 0.95, 0.36))


def _electric() -> Iterator[Solid]:
    yield rounded_box("black", (1.3, 0.1, 0.3), (0.0, 0.68, 0.0), 0.02, 2)
    yield from keys(1.2, 0.775, 0.06, 0.13)
    for i in range(8):
        yield rounded_box("gray", (0.03, 0.01, 0.016), (-0.5 + 0.06 * i, 0.778, -0.09), 0.003, 1)
    yield box("screen", (0.16, 0.006, 0.05), (0.1, 0.778, -0.09))
    for s in (-1, 1):
        yield beam("iron", (s * 0.5, 0.02, -0.2), (s * 0.5, 0.68, 0.08), 0.03)
        yield beam("iron", (s * 0.5, 0.02, 0.24), (s * 0.5, 0.68, -0.08), 0.03)
        yield beam("iron", (s * 0.5, 0.015, -0.22), (s * 0.5, 0.015, 0.26), 0.03)
    yield beam("iron", (-0.5, 0.36, 0.02), (0.5, 0.36, 0.02), 0.03)


def _on_slab(wide: float) -> Iterator[Solid]:
    """Build an electric piano on two side panels, or a short keyboard on one crossed stand."""
    yield rounded_box("wood" if wide > 1 else "white", (wide, 0.09, 0.28), (0.0, 0.68, 0.0), 0.012, 2)
    yield from keys(wide - 0.1, 0.765, 0.06, 0.12)
    for i in range(5):
        yield rounded_box("gray", (0.024, 0.008, 0.014), (-0.12 + 0.06 * i, 0.768, -0.08), 0.003, 1)
    if wide > 1:
        for s in (-1, 1):
            yield rounded_box("wood", (0.03, 0.68, 0.3), (s * (wide / 2 - 0.06), 0.0, 0.0), 0.008, 1)
        yield rounded_box("wood", (wide - 0.15, 0.12, 0.02), (0.0, 0.25, -0.1), 0.006, 1)
        for k in (-1, 0, 1):
            yield rounded_box("brass", (0.03, 0.012, 0.1), (0.07 * k, 0.06, 0.06), 0.004, 1)
        return
    for s in (-1, 1):
        yield beam("iron", (s * 0.3, 0.02, 0.0), (-s * 0.25, 0.68, 0.02 * s), 0.03)
        yield beam("iron", (s * 0.3, 0.015, -0.18), (s * 0.3, 0.015, 0.18), 0.03)


_PIANO_KINDS = {
    "slab": partial(_on_slab, 1.3),
    "short": partial(_on_slab, 0.85),
    "upright": _upright,
    "grand": _grand,
    "electric": _electric,
}


def piano(kind: str = "upright") -> Iterator[Solid]:
    """Build an upright, grand or electric piano with its stool."""
    yield from _PIANO_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("piano", "piano", (design(piano), design(piano, kind="grand"))),
    FurnitureFamily(
        "keyboard",
        "keyboard",
        (design(piano, kind="electric"), design(piano, kind="slab"), design(piano, kind="short")),
    ),
)
