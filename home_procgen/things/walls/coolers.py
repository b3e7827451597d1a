"""Air conditioners."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import corners, disc


def _split() -> Iterator[Solid]:
    side = fillet([(-0.1, 0.0), (0.06, 0.0), (0.1, 0.08), (0.1, 0.26), (0.06, 0.29), (-0.1, 0.29)], 0.04, 4, True)
    yield prism("white", side, 0.84, (0.0, 0.0, 0.0), "side")
    yield rotate(rounded_box("white", (0.76, 0.01, 0.09), (0.0, 0.02, 0.085), 0.004, 1), 0, 0.5, (0.0, 0.02, 0.085))
    yield box("black", (0.74, 0.03, 0.01), (0.0, 0.012, 0.066))
    for i in range(10):
        yield box("gray", (0.76, 0.004, 0.01), (0.0, 0.289, -0.085 + 0.014 * i))
    yield box("screen", (0.07, 0.025, 0.004), (0.3, 0.12, 0.1))
    yield box("green", (0.006, 0.006, 0.004), (0.24, 0.13, 0.101))


def _window() -> Iterator[Solid]:
    yield rounded_box("white", (0.6, 0.4, 0.5), (0.0, 0.0, -0.1), 0.012, 1)
    yield rounded_box("cream", (0.62, 0.42, 0.06), (0.0, -0.01, 0.16), 0.015, 2)
    for i in range(14):
        yield box("gray", (0.4, 0.008, 0.01), (-0.07, 0.03 + 0.025 * i, 0.188))
    for y in (0.28, 0.18):
        yield disc("black", 0.03, 0.02, (0.22, y, 0.185), 18)


def _mobile() -> Iterator[Solid]:
    yield rounded_box("white", (0.36, 0.68, 0.34), (0.0, 0.05, 0.0), 0.05, 3)
    for x, z in corners(0.26, 0.24):
        yield ball("black", 0.028, (x, 0.028, z), 10, 6)
    for i in range(6):
        yield box("gray", (0.26, 0.01, 0.012), (0.0, 0.5 + 0.028 * i, 0.165))
    yield box("screen", (0.16, 0.004, 0.08), (0.0, 0.729, 0.06))
    yield rounded_box("tint", (0.3, 0.16, 0.012), (0.0, 0.1, 0.168), 0.006, 1)


def _tower() -> Iterator[Solid]:
    yield rounded_box("black", (0.34, 0.03, 0.34), (0.0, 0.0, 0.0), 0.014, 2)
    yield rounded_box("white", (0.28, 0.92, 0.28), (0.0, 0.03, 0.0), 0.06, 4)
    for i in range(18):
        yield box("gray", (0.15, 0.01, 0.01), (0.0, 0.3 + 0.03 * i, 0.138))
    yield box("screen", (0.1, 0.04, 0.004), (0.0, 0.87, 0.14))


_COOLER_KINDS = {
    "split": _split,
    "window": _window,
    "mobile": _mobile,
    "tower": _tower,
}


def cooler(kind: str = "split") -> Iterator[Solid]:
    """Build an air conditioner for a wall or a window, or a cooler that stands and needs no hose."""
    yield from _COOLER_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("air_conditioner", "air_conditioner", design_kinds(cooler, "split", "mobile", "tower")),
    FurnitureFamily("window_cooler", "air_conditioner", design_kinds(cooler, "window")),
)
