"""Radiators."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import rod, tube
from home_mjx.datasets.homes.things.family import Family, design, kinds_of
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, rotate


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


_RADIATOR_KINDS = {
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


FAMILIES = (
    Family(
        "radiator",
        "heater",
        (
            *kinds_of(radiator, "panel", "columns", "double", "convector"),
            design(radiator, width=0.6),
            design(radiator, kind="columns", width=0.6, height=0.8),
        ),
    ),
    Family("oil_heater", "heater", kinds_of(radiator, "oil")),
)
