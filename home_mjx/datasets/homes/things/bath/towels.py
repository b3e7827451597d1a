"""Racks and hooks of towels."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.sheets import sheet
from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.things.family import Family, kinds_of
from home_mjx.datasets.procedural.primitives.solids import Solid


def draped(slot: str, width: float, x: float, y: float, z: float, front: float, back: float) -> Solid:
    """A towel folded over a bar along x at height y [m]."""
    path = [
        (z + 0.018, y - front),
        (z + 0.018, y - 0.4 * front),
        (z + 0.016, y),
        (z, y + 0.016),
        (z - 0.016, y),
        (z - 0.018, y - back),
    ]
    rows = [
        np.array([(x + s * width / 2, h, d + 0.003 * np.sin(9 * s + 5 * h)) for s in np.linspace(-1, 1, 9)])
        for d, h in path
    ]
    return sheet(slot, np.stack(rows), 0.01)


def _towel_bar(kind: str) -> Iterator[Solid]:
    for k in range(1 if kind == "bar" else 2):
        y, z = 0.5 + 0.1 * k, -0.01 + 0.0 * k if kind == "bar" else 0.05 - 0.06 * k
        yield rod("chrome", (-0.3, y, z), (0.3, y, z), 0.009)
        yield draped(f"towel_{k}" if k else "towel", 0.4 - 0.06 * k, 0.04 * k, y, z, 0.42, 0.36)
    for s in (-1, 1):
        yield rounded("chrome", (0.045, 0.15, 0.012), (s * 0.3, 0.48, -0.08), 0.005, 1)
        for k in range(1 if kind == "bar" else 2):
            y, z = 0.5 + 0.1 * k, -0.01 if kind == "bar" else 0.05 - 0.06 * k
            yield rod("chrome", (s * 0.3, y, -0.075), (s * 0.3, y, z), 0.008)


def _heated() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("white", (s * 0.25, 0.0, 0.0), (s * 0.25, 1.1, 0.0), 0.018, sides=12)
        for y in (0.12, 0.98):
            yield rod("chrome", (s * 0.25, y, -0.06), (s * 0.25, y, 0.0), 0.012)
    for group in range(3):
        for i in range(5):
            yield rod(
                "white",
                (-0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                (0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                0.012,
            )
    yield draped("towel", 0.4, 0.0, 0.97, 0.03, 0.4, 0.3)


def _ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("wood", (s * 0.24, 0.0, 0.16), (s * 0.2, 1.6, -0.16), 0.018, sides=10)
    for i in range(5):
        y = 0.25 + 0.3 * i
        w, z = 0.24 - 0.04 * y / 1.6, 0.16 - 0.32 * y / 1.6
        yield rod("wood", (-w, y, z), (w, y, z), 0.014)
        if i in (2, 4):
            yield draped(f"towel_{i}", 0.34, 0.0, y, z, 0.3, 0.2)


def _stand() -> Iterator[Solid]:
    for s in (-1, 1):
        yield tube("brass", fillet([(s * 0.3, 0.01, -0.12), (s * 0.3, 0.01, 0.12)], 0.01), 0.012)
        yield rod("brass", (s * 0.3, 0.01, 0.0), (s * 0.3, 0.85, 0.0), 0.012)
    for y, z in ((0.83, 0.0), (0.62, 0.07), (0.4, -0.07)):
        yield rod("brass", (-0.3, y, z), (0.3, y, z), 0.01)
    yield draped("towel", 0.42, 0.0, 0.83, 0.0, 0.42, 0.36)
    yield draped("towel_1", 0.3, 0.08, 0.62, 0.07, 0.3, 0.2)
    for s in (-1, 1):
        for y, z in ((0.62, 0.07), (0.4, -0.07)):
            yield rod("brass", (s * 0.3, y, 0.0), (s * 0.3, y, z), 0.008)


_TOWEL_RACK_KINDS = {
    "bar": partial(_towel_bar, "bar"),
    "double": partial(_towel_bar, "double"),
    "heated": _heated,
    "ladder": _ladder,
    "stand": _stand,
}


def towel_rack(kind: str = "bar") -> Iterator[Solid]:
    """A bar with a towel, a ladder, a heated frame, a ring, a free stand."""
    yield from _TOWEL_RACK_KINDS[kind]()


def towel_hook(kind: str = "ring") -> Iterator[Solid]:
    """A ring or hooks with towels, or a robe on a hook."""
    if kind == "ring":
        yield rounded("chrome", (0.05, 0.05, 0.02), (0.0, 0.4, -0.05), 0.008, 2)
        yield rod("chrome", (0.0, 0.425, -0.045), (0.0, 0.425, -0.01), 0.008)
        yield ring("chrome", 0.08, 0.012, (0.0, 0.34, -0.005), 2, 24)
        yield draped("towel", 0.13, 0.0, 0.265, -0.005, 0.26, 0.2)
        return
    yield rounded("wood", (0.4, 0.07, 0.018), (0.0, 0.62, -0.06), 0.006, 1)
    for i in range(3):
        x = (i - 1) * 0.13
        yield tube("brass", fillet([(x, 0.66, -0.05), (x, 0.63, -0.01), (x, 0.66, 0.01)], 0.02), 0.006, 6)
    folds = fillet([(-0.03, 0.65), (0.03, 0.65), (0.1, 0.3), (0.11, 0.02), (-0.11, 0.02), (-0.1, 0.3)], 0.03, 3, True)
    if kind == "robe":
        yield prism("towel", folds, 0.07, (0.0, 0.0, -0.012))
        for s in (-1, 1):
            yield tube(
                "towel", [(s * 0.06, 0.52, 0.0), (s * 0.15, 0.36, 0.0), (s * 0.17, 0.14, 0.0)], [0.04, 0.05, 0.055], 10
            )
        yield tube("towel_1", [(-0.09, 0.32, 0.03), (0.0, 0.31, 0.04), (0.03, 0.1, 0.04)], 0.012, 6)
    else:
        for i in (0, 2):
            yield prism(f"towel_{i}", [(0.7 * x + (i - 1) * 0.13, y) for x, y in folds], 0.05, (0.0, 0.0, -0.012))


FAMILIES = (
    Family("towel_rack", "towel_rack", kinds_of(towel_rack, "bar", "heated", "ladder", "stand", "double")),
    Family("towel_hanger", "towel_hanger", kinds_of(towel_hook, "ring", "hooks", "robe")),
)
