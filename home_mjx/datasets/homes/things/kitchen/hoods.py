"""Range hoods."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, rod
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder


def _chimney(width: float) -> Iterator[Solid]:
    yield rounded("steel", (width, 0.06, 0.48), (0.0, 0.0, 0.0), 0.006, 1)
    slope = [(-0.24, 0.0), (0.24, 0.0), (0.02, 0.22), (-0.24, 0.22)]
    yield prism("steel", slope, width - 0.1, (0.0, 0.06, 0.0), "side")
    yield rounded("steel", (0.28, 0.5, 0.26), (0.0, 0.27, -0.11), 0.004, 1)
    yield from _switches(0.0, 0.03, 0.24)


def _glass(width: float) -> Iterator[Solid]:
    yield prism(
        "glass",
        [(width / 2 * np.cos(a), -0.24 + 0.48 * np.sin(a)) for a in np.linspace(0, np.pi, 16)],
        0.012,
        (0.0, 0.04, 0.0),
        "top",
    )
    yield rounded("steel", (width - 0.12, 0.05, 0.3), (0.0, 0.0, -0.09), 0.008, 1)
    yield cylinder("steel", 0.12, 0.6, (0.0, 0.05, -0.12), sides=20)


def _slanted(width: float) -> Iterator[Solid]:
    plate = [(-0.2, 0.0), (-0.16, 0.0), (0.2, 0.48), (0.2, 0.52), (-0.2, 0.52)]
    yield prism("black", plate, width, (0.0, 0.0, 0.0), "side")
    yield beam("screen", (0.0, 0.05, -0.115), (0.0, 0.45, 0.185), width - 0.05, 0.012)
    yield rounded("black", (0.26, 0.4, 0.22), (0.0, 0.5, -0.09), 0.004, 1)
    yield from _switches(0.0, 0.5, 0.2)


def _box(width: float) -> Iterator[Solid]:
    yield rounded("steel", (width, 0.13, 0.46), (0.0, 0.0, 0.0), 0.012, 1)
    yield box("black", (width - 0.06, 0.006, 0.3), (0.0, -0.004, 0.02))
    yield rounded("chrome", (0.3, 0.03, 0.02), (0.0, 0.05, 0.235), 0.008, 2)
    yield from _switches(0.0, 0.065, 0.242)


def _mantel(width: float) -> Iterator[Solid]:
    yield prism(
        "paint",
        [(-0.25, 0.0), (0.25, 0.0), (0.24, 0.12), (-0.02, 0.5), (-0.02, 0.9), (-0.25, 0.9)],
        width,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rounded("wood", (width + 0.04, 0.05, 0.54), (0.0, 0.02, 0.0), 0.012, 1)
    yield rounded("wood", (width + 0.02, 0.04, 0.28), (0.0, 0.5, -0.11), 0.012, 1)
    for i in range(5):
        yield rod("chrome", ((i - 2) * 0.16, 0.045, 0.27), ((i - 2) * 0.16, 0.045, 0.3), 0.006)


_HOOD_KINDS = {
    "chimney": _chimney,
    "glass": _glass,
    "slanted": _slanted,
    "box": _box,
    "mantel": _mantel,
}


def hood(width: float = 0.6, kind: str = "chimney") -> Iterator[Solid]:
    """Collects vapour above a cooker."""
    yield from _HOOD_KINDS[kind](width)


def _switches(x: float, y: float, z: float) -> Iterator[Solid]:
    for i in range(4):
        yield disc("chrome", 0.01, 0.01, (x + 0.04 * (i - 1.5), y, z), 12)


HOODS = (
    design(hood),
    design(hood, kind="glass"),
    design(hood, kind="slanted"),
    design(hood, kind="box"),
    design(hood, kind="mantel", width=0.9),
)


FAMILIES = (Family("range_hood", "range_hood", HOODS),)
