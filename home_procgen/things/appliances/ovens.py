"""Microwave ovens and toasters."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc
from home_procgen.things.movable_parts import panel


def microwave(kind: str = "buttons") -> Iterator[Solid]:
    """Build a microwave oven with buttons or dials."""
    slot = "steel" if kind == "buttons" else "bright" if kind == "retro" else "white"
    yield rounded_box(slot, (0.48, 0.27, 0.36), (0.0, 0.012, 0.0), 0.03 if kind == "retro" else 0.01, 2)
    for x in (-0.18, 0.18):
        yield cylinder("black", 0.018, 0.014, (x, 0.0, 0.1), sides=10)
        yield cylinder("black", 0.018, 0.014, (x, 0.0, -0.1), sides=10)
    door = rounded_box("screen", (0.32, 0.22, 0.014), (-0.06, 0.037, 0.178), 0.008, 1)
    yield from panel("left", door, rod("chrome", (0.085, 0.06, 0.205), (0.085, 0.23, 0.205), 0.007))
    if kind == "buttons":
        for i in range(3):
            for j in range(4):
                yield rounded_box("gray", (0.024, 0.02, 0.008), (0.135 + 0.032 * i, 0.05 + 0.034 * j, 0.181), 0.003, 1)
        yield box("screen", (0.09, 0.035, 0.004), (0.167, 0.21, 0.181))
    else:
        for y in (0.1, 0.19):
            yield disc("chrome", 0.026, 0.025, (0.165, y, 0.178), 18)


def toaster(kind: str = "round", slots_: int = 2) -> Iterator[Solid]:
    """Build a toaster with slots and a lever; the round kind holds bread."""
    long = 0.26 + 0.06 * (slots_ > 2)
    yield rounded_box(
        "steel" if kind == "box" else "bright",
        (long, 0.17, 0.17),
        (0.0, 0.012, 0.0),
        0.02 if kind == "box" else 0.055,
        3,
    )
    yield box("black", (long - 0.03, 0.016, 0.14))
    for z in (-0.032, 0.032):
        yield box("black", (long - 0.09, 0.004, 0.026), (0.0, 0.1805, z))
        if kind == "round":
            yield rounded_box("crust", (0.11, 0.1, 0.016), (0.0, 0.14, z), 0.007, 1)
    yield rounded_box("black", (0.02, 0.02, 0.05), (long / 2 + 0.008, 0.12, 0.0), 0.006, 1)
    yield disc("black", 0.014, 0.012, (long / 2 - 0.05, 0.05, 0.08), 12)


FAMILIES = (
    FurnitureFamily(
        "microwave", "microwave", (design(microwave), design(microwave, kind="dials"), design(microwave, kind="retro"))
    ),
    FurnitureFamily(
        "toaster", "toaster", (design(toaster), design(toaster, kind="box"), design(toaster, slots_=4, kind="box"))
    ),
)
