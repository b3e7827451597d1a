"""Kitchen cabinets and appliances; floor units are 0.6 m deep and share the height of the worktop."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.joinery import BOARD_THICKNESS, make_fronts
from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate

DEPTH, WORKTOP = 0.6, 0.86  # [m]


def base_cabinet(width: float, columns: int, rows: int = 1) -> Iterator[Solid]:
    """A floor cabinet under a worktop, with doors (one row) or drawers."""
    yield from _body(width, columns, rows)
    yield box("stone", (width, 0.04, DEPTH), (0.0, WORKTOP - 0.04, 0.0))


def _body(width: float, columns: int, rows: int) -> Iterator[Solid]:
    yield box("black", (width, 0.1, DEPTH - 0.1), (0.0, 0.0, -0.05))
    yield box("color", (width, WORKTOP - 0.14, DEPTH - BOARD_THICKNESS - 0.02), (0.0, 0.1, -BOARD_THICKNESS / 2 - 0.01))
    yield from make_fronts("color", "chrome", width, WORKTOP - 0.16, 0.11, DEPTH / 2 - 0.02, columns, rows, rows == 1)


def sink_cabinet(width: float) -> Iterator[Solid]:
    """A floor cabinet whose worktop frames a steel basin with a tap."""
    yield from _body(width, 2, 1)
    basin, top = (width - 0.3, 0.4), WORKTOP - 0.04
    for side in (-1, 1):
        yield box("stone", ((width - basin[0]) / 2, 0.04, DEPTH), (side * (width + basin[0]) / 4, top, 0.0))
        yield box("stone", (basin[0], 0.04, (DEPTH - basin[1]) / 2), (0.0, top, side * (DEPTH + basin[1]) / 4))
    yield box("chrome", (*basin[:1], 0.005, basin[1]), (0.0, top, 0.0))
    yield from tap(WORKTOP, -basin[1] / 2 - 0.05)


def tap(height: float, z: float) -> Iterator[Solid]:
    """A mixer tap that stands at `height` and reaches forward from `z`."""
    yield cylinder("chrome", 0.022, 0.2, (0.0, height, z), sides=8)
    yield box("chrome", (0.025, 0.022, 0.18), (0.0, height + 0.18, z + 0.08))


def cooker(width: float, burners: int) -> Iterator[Solid]:
    """An oven with a glass door under a hob."""
    yield box("black", (width - 0.02, 0.1, DEPTH - 0.1), (0.0, 0.0, -0.05))
    yield box("steel", (width - 0.004, WORKTOP - 0.12, DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield box("screen", (width - 0.1, 0.4, 0.02), (0.0, 0.2, DEPTH / 2 - 0.04))
    yield box("chrome", (width - 0.1, 0.02, 0.04), (0.0, 0.64, DEPTH / 2 - 0.02))
    yield box("screen", (width - 0.004, 0.02, DEPTH - 0.02), (0.0, WORKTOP - 0.02, 0.0))
    for i in range(burners):
        x, z = (i % 2 - 0.5) * 0.26, (i // 2 - 0.5) * 0.26
        yield cylinder("steel", 0.09 if i % 3 else 0.07, 0.006, (x, WORKTOP, z), sides=12)
        knob = cylinder("chrome", 0.02, 0.02, (0.0, 0.0, 0.0), sides=8)
        yield move(rotate(knob, 0, np.pi / 2), ((i - (burners - 1) / 2) * 0.1, 0.74, DEPTH / 2 - 0.04))


def refrigerator(width: float, height: float, split: float) -> Iterator[Solid]:
    """A fridge with a freezer below; `split` is the height where the doors meet."""
    yield box("black", (width - 0.02, 0.04, 0.56), (0.0, 0.0, -0.02))
    yield box("steel", (width, height - 0.04, 0.58), (0.0, 0.04, -0.03))
    for low, high, grip in ((0.05, split - 0.004, split - 0.3), (split + 0.004, height, split + 0.06)):
        yield box("steel", (width, high - low, 0.05), (0.0, low, 0.29))
        yield box("chrome", (0.02, 0.24, 0.03), (width / 2 - 0.06, grip, 0.33))


def hanging_cabinet(width: float, height: float, columns: int) -> Iterator[Solid]:
    """A wall cabinet."""
    depth = 0.34
    yield box("color", (width, height, depth - BOARD_THICKNESS), (0.0, 0.0, -BOARD_THICKNESS / 2))
    yield from make_fronts("color", "chrome", width, height, 0.0, depth / 2, columns)


def range_hood(width: float) -> Iterator[Solid]:
    """A hood with a chimney."""
    yield box("steel", (width, 0.06, 0.46), (0.0, 0.0, 0.0))
    yield box("steel", (width * 0.75, 0.06, 0.36), (0.0, 0.06, -0.04))
    yield box("steel", (0.26, 0.5, 0.24), (0.0, 0.12, -0.11))


def microwave(width: float) -> Iterator[Solid]:
    """A microwave oven."""
    yield box("steel", (width, 0.27, 0.34), (0.0, 0.01, -0.01))
    yield box("black", (width - 0.06, 0.01, 0.3))
    yield box("screen", (width - 0.16, 0.2, 0.01), (-0.05, 0.045, 0.164))
    yield box("chrome", (0.02, 0.18, 0.03), (width / 2 - 0.1, 0.055, 0.17))


_UNIT = make_slots("color", "chrome", "black", "stone")
_METAL = make_slots("steel", "chrome", "black", "screen")

FAMILIES = (
    VariantFamily(
        "kitchen_cabinet",
        "kitchen_cabinet",
        base_cabinet,
        _UNIT,
        (
            make_variant(width=0.6, columns=1),
            make_variant(width=0.8, columns=2),
            make_variant(width=0.6, columns=1, rows=3),
        ),
    ),
    VariantFamily("kitchen_sink", "sink", sink_cabinet, _UNIT, (make_variant(width=0.8),)),
    VariantFamily("cooker", "range_oven", cooker, _METAL, (make_variant(width=0.6, burners=4),)),
    VariantFamily(
        "refrigerator",
        "refrigerator",
        refrigerator,
        make_slots("steel", "chrome", "black"),
        (make_variant(width=0.6, height=1.85, split=0.72), make_variant(width=0.68, height=1.72, split=1.15)),
    ),
    VariantFamily(
        "hanging_cabinet",
        "hanging_kitchen_cabinet",
        hanging_cabinet,
        make_slots("color", "chrome"),
        (make_variant(width=0.6, height=0.66, columns=1), make_variant(width=0.8, height=0.66, columns=2)),
    ),
    VariantFamily("range_hood", "range_hood", range_hood, make_slots("steel"), (make_variant(width=0.6),)),
    VariantFamily("microwave", "microwave", microwave, _METAL, (make_variant(width=0.48),)),
)
