"""Laptops and computers."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import beam, ring
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import disc


def laptop(open_: float = 1.85, width: float = 0.34) -> Iterator[Solid]:
    """Build a laptop with keys, its lid open by `open_` [rad]."""
    deep = 0.66 * width
    yield rounded_box("gray", (width, 0.014, deep), (0.0, 0.0, 0.0), 0.005, 2)
    for row in range(5):
        for i in range(12):
            yield box(
                "black", (0.062 * width, 0.003, 0.016), ((i - 5.5) * 0.073 * width, 0.013, -0.34 * deep + 0.021 * row)
            )
    yield rounded_box("steel", (0.1, 0.002, 0.06), (0.0, 0.0135, 0.28 * deep), 0.001, 1)
    hinge = (0.0, 0.012, -deep / 2 + 0.004)
    lid = [
        rounded_box("gray", (width, 0.008, deep), (0.0, 0.012, 0.0), 0.003, 1),
        box("screen", (0.94 * width, 0.002, 0.88 * deep), (0.0, 0.0105, 0.0)),
    ]
    yield from (rotate(p, 0, -open_, hinge) for p in lid)


def shut_laptop(width: float = 0.32) -> Iterator[Solid]:
    """Build a closed laptop."""
    yield rounded_box("gray", (width, 0.011, 0.68 * width), (0.0, 0.002, 0.0), 0.005, 3)
    yield rounded_box("steel", (width, 0.007, 0.68 * width), (0.0, 0.0135, 0.0), 0.003, 3)
    yield cylinder("chrome", 0.02, 0.0008, (0.0, 0.0203, 0.0), sides=20)


def computer(kind: str = "desk") -> Iterator[Solid]:
    """Build a screen with keyboard and mouse, an all-in-one computer, or a tower."""
    if kind == "tower":
        yield rounded_box("black", (0.2, 0.44, 0.44), (0.0, 0.01, 0.0), 0.012, 1)
        yield box("glass", (0.004, 0.36, 0.36), (0.102, 0.05, 0.0))
        yield box("gray", (0.16, 0.05, 0.01), (0.0, 0.36, 0.217))
        for i in range(2):
            yield ring("blue", 0.06, 0.01, (0.0, 0.12 + 0.14 * i, 0.222), 2, 22)
        yield disc("chrome", 0.012, 0.01, (0.06, 0.42, 0.216), 12)
        return
    yield rounded_box("steel" if kind == "all" else "black", (0.56, 0.34, 0.03), (0.0, 0.13, -0.06), 0.01, 2)
    yield box("screen", (0.53, 0.3, 0.004), (0.0, 0.16 if kind == "all" else 0.15, -0.046))
    yield beam("steel" if kind == "all" else "black", (0.0, 0.01, -0.12), (0.0, 0.22, -0.08), 0.08, 0.012)
    yield rounded_box("steel" if kind == "all" else "black", (0.22, 0.012, 0.18), (0.0, 0.0, -0.1), 0.005, 1)
    yield rounded_box("white" if kind == "all" else "black", (0.42, 0.014, 0.13), (-0.03, 0.0, 0.13), 0.005, 1)
    for row in range(4):
        for i in range(14):
            yield box("gray", (0.022, 0.004, 0.02), ((i - 6.5) * 0.028 - 0.03, 0.013, 0.09 + 0.027 * row))
    yield padded_block("white" if kind == "all" else "black", (0.06, 0.03, 0.1), (0.24, 0.0, 0.13), 3.0, 5)


FAMILIES = (
    FurnitureFamily("laptop", "laptop", (design(laptop), design(laptop, open_=2.1, width=0.3), design(shut_laptop))),
    FurnitureFamily("computer", "computer", design_kinds(computer, "desk", "all")),
    FurnitureFamily("computer_tower", "computer", design_kinds(computer, "tower")),
)
