"""Cabinets on the wall."""

from collections.abc import Iterator

from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import case, disc, doors, front
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder


def hanging(
    width: float = 0.6, height: float = 0.68, style: str = "flat", count: int = 1, grip: tuple = ("chrome", "bar")
) -> Iterator[Solid]:
    """A wall cabinet with doors."""
    yield rounded("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 1)
    if style == "glass":
        for y in (0.02, height / 2):
            for i in range(3):
                yield cylinder(f"crockery_{i}", 0.045, 0.09, ((i - 1) * width / 4, y, 0.16), sides=14)
    yield from doors(
        "paint",
        width - 0.006,
        height - 0.006,
        (0.003 - width / 2, 0.003, 0.15 + 0.06 * (style == "glass")),
        count,
        style,
        grip,
        0.15,
    )
    if style == "glass":
        for s in (-1, 1):
            yield box("paint", (0.02, height, 0.06), (s * (width / 2 - 0.01), 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, height - 0.02, 0.18))


def hanging_open(width: float = 0.6, height: float = 0.68) -> Iterator[Solid]:
    """Open wall shelves with crockery, and hooks with cups below."""
    yield from case("wood", width, height - 0.08, 0.32, (0.3,), (0.0, 0.08, 0.0), (), "wood")
    for i in range(7):
        yield disc("crockery", 0.1, 0.01, (-0.2 + 0.03 * i, 0.205, -0.05 + 0.02 * i), 18)
    for i in range(3):
        yield turned(
            "glaze", [(0.04, 0.0), (0.05, 0.1), (0.045, 0.14), (0.02, 0.16)], (-0.18 + 0.18 * i, 0.4, 0.02), 14, 2
        )
        yield vessel(
            "crockery_1", [(0.03, 0.0), (0.038, 0.04), (0.036, 0.075)], 0.004, (-0.18 + 0.18 * i, 0.0, 0.08), 12, 2
        )
        yield ring("crockery_1", 0.02, 0.008, (-0.18 + 0.18 * i, 0.06, 0.122), 0, 10)


def corner_hanging(height: float = 0.68) -> Iterator[Solid]:
    """A five-sided wall cabinet for a corner."""
    outline = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.0), (0.0, 0.3), (-0.3, 0.3)]
    yield prism("paint", outline, height, (0.0, 0.0, 0.0), "top")
    yield beam("paint", (0.29, height / 2, 0.03), (0.03, height / 2, 0.29), 0.02, height - 0.02)
    yield rod("chrome", (0.185, 0.06, 0.175), (0.185, 0.2, 0.175), 0.006)


def flap(width: float = 0.9, height: float = 0.4) -> Iterator[Solid]:
    """A wide low wall cabinet whose front lifts."""
    yield rounded("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 1)
    yield from front(
        "paint",
        (width - 0.006, height - 0.006),
        (0.003 - width / 2, 0.003, 0.15),
        "flat",
        ("chrome", "bar", 0.5, 0.12),
        False,
    )


WALL = (
    design(hanging), design(hanging, width=0.8, count=2, style="shaker", grip=("brass", "knob")),
    design(hanging, width=0.8, count=2, style="glass"), design(hanging_open), design(corner_hanging), design(flap),
    design(hanging, width=0.4, style="raised", grip=("brass", "knob")),
    design(hanging, width=0.6, style="grooves", grip=("black", "slot")),
)  # fmt: skip


FAMILIES = (Family("hanging_cabinet", "hanging_kitchen_cabinet", WALL),)
