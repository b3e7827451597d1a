"""Wash basins."""

from collections.abc import Iterator
from functools import partial

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import rod
from home_procgen.things.bath.bathtubs import tub
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import doors, drawers, legs
from home_procgen.things.kitchen.sinks import tap


def _pedestal(width: float) -> Iterator[Solid]:
    yield revolve("ceramic", [(0.13, 0.0), (0.09, 0.1), (0.08, 0.5), (0.12, 0.68)], (0.0, 0.0, -0.06), 24, 3)
    yield tub("ceramic", [(0.66, 0.26, 0.22, 0.0), (0.74, 0.5, 0.4, 0.0), (0.84, width, 0.46, 0.0)], 0.05, 3.0)
    yield box("ceramic", (width - 0.06, 0.12, 0.08), (0.0, 0.72, -0.19))
    yield from tap(0.0, 0.835, -0.18, "lever")


def _bowl(width: float) -> Iterator[Solid]:
    yield from legs("wood", 0.9, 0.46, 0.76, "square", 0.05)
    yield rounded_box("wood", (0.96, 0.05, 0.5), (0.0, 0.74, 0.0), 0.01, 1)
    yield box("wood", (0.86, 0.022, 0.44), (0.0, 0.2, 0.0))
    for i in range(3):
        yield padded_block("towel", (0.32, 0.07, 0.3), (-0.2, 0.222 + 0.06 * i, 0.0), 5.0, 4)
    yield rounded_box("cane", (0.3, 0.2, 0.3), (0.2, 0.222, 0.0), 0.03, 1)
    yield vessel("ceramic", [(0.1, 0.0), (0.17, 0.04), (0.21, 0.13)], 0.012, (0.0, 0.79, 0.03), 32, 3)
    yield from tap(0.0, 0.79, -0.2, "arc")


def _vanity(kind: str, width: float) -> Iterator[Solid]:
    wide = 0.8 if kind == "vanity" else 1.3
    yield box("black", (wide - 0.08, 0.08, 0.4), (0.0, 0.0, -0.03))
    yield rounded_box("paint", (wide - 0.01, 0.7, 0.46), (0.0, 0.08, -0.02), 0.004, 1)
    count = 1 if kind == "vanity" else 2
    if kind == "vanity":
        yield from doors("paint", wide - 0.02, 0.66, (0.01 - wide / 2, 0.1, 0.21), 2, "shaker", ("brass", "knob"), 0.85)
    else:
        yield from drawers("paint", wide - 0.02, 0.66, (0.01 - wide / 2, 0.1, 0.21), 2, 2, "flat", ("black", "bar"))
    for i in range(count):
        x = (i - (count - 1) / 2) * wide / count
        yield tub("ceramic", [(0.76, wide / count, 0.48, x), (0.86, wide / count, 0.48, x)], 0.06, 9.0)
        yield from tap(x, 0.86, -0.2, "lever")


def _hung(width: float) -> Iterator[Solid]:
    yield tub("ceramic", [(0.72, 0.3, 0.24, 0.0), (0.78, 0.44, 0.36, 0.0), (0.86, 0.5, 0.4, 0.0)], 0.04, 5.0)
    yield from tap(0.0, 0.855, -0.15, "lever")
    yield rod("chrome", (0.0, 0.0, -0.1), (0.0, 0.74, -0.1), 0.022, sides=12)
    yield revolve("chrome", [(0.05, 0.0), (0.045, 0.012), (0.02, 0.03)], (0.0, 0.0, -0.1), 16, 1)
    yield revolve("chrome", [(0.02, 0.45), (0.04, 0.48), (0.04, 0.58), (0.02, 0.62)], (0.0, 0.0, -0.1), 16, 2)
    yield box("ceramic", (0.42, 0.2, 0.04), (0.0, 0.66, -0.18))


def _slab(width: float) -> Iterator[Solid]:
    yield box("wood", (0.9, 0.32, 0.44), (0.0, 0.5, 0.0))
    yield from drawers("wood_1", 0.88, 0.3, (-0.44, 0.51, 0.21), 1, 1, "flat", ("black", "slot"))
    yield tub("stone", [(0.82, 0.9, 0.46, 0.0), (0.94, 0.9, 0.46, 0.0)], 0.05, 10.0)
    yield from tap(0.0, 0.94, -0.19, "bridge")
    yield rounded_box("wood", (0.86, 0.5, 0.03), (0.0, 0.0, -0.2), 0.008, 1)


_BASIN_KINDS = {
    "pedestal": _pedestal,
    "bowl": _bowl,
    "vanity": partial(_vanity, "vanity"),
    "double": partial(_vanity, "double"),
    "hung": _hung,
    "slab": _slab,
}


def basin(kind: str = "pedestal", width: float = 0.58) -> Iterator[Solid]:
    """Build a wash basin: pedestal, vessel bowl, cabinet, double, wall-hung or slab."""
    yield from _BASIN_KINDS[kind](width)


BASINS = tuple(design(basin, kind=kind) for kind in ("pedestal", "bowl", "vanity", "double", "hung", "slab"))


FAMILIES = (FurnitureFamily("basin", "sink", BASINS),)
