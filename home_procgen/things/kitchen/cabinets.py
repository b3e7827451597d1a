"""Kitchen base cabinets, their bodies and worktops, islands and pantries."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import doors, drawers, open_case

DRAWER_TRAVEL = 0.45  # [m], travel of drawers

BASE_DEPTH = 0.6  # [m], depth of base cabinets
WORKTOP_HEIGHT = 0.88  # [m], height of the worktop's upper surface
FRONT_Z = BASE_DEPTH / 2 - 0.04  # [m], z of the back of fronts


def base_body(width: float, low: float = 0.1) -> Iterator[Solid]:
    """Build the plinth and body of a base cabinet."""
    yield box("black", (width, low, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, WORKTOP_HEIGHT - 0.04 - low, BASE_DEPTH - 0.04), (0.0, low, -0.02))


def worktop(width: float, slot: str = "stone") -> Solid:
    """Build the worktop slab of a cabinet."""
    return rounded_box(slot, (width, 0.04, BASE_DEPTH), (0.0, WORKTOP_HEIGHT - 0.04, 0.0), 0.008, 2)


def base_unit(
    width: float = 0.6,
    style: str = "flat",
    rows: int = 0,
    count: int = 1,
    grip: tuple = ("chrome", "bar"),
    top: str = "stone",
) -> Iterator[Solid]:
    """Build a base cabinet with doors, with drawers, or with a drawer above doors."""
    yield from base_body(width)
    high, x = WORKTOP_HEIGHT - 0.15, 0.003 - width / 2
    if rows == 1:
        yield from drawers(
            "paint",
            width - 0.006,
            0.16,
            (x, WORKTOP_HEIGHT - 0.205, FRONT_Z),
            count,
            1,
            style,
            grip,
            opens=DRAWER_TRAVEL,
        )
        yield from doors("paint", width - 0.006, high - 0.165, (x, 0.105, FRONT_Z), count, style, grip, 0.8)
    elif rows:
        yield from drawers("paint", width - 0.006, high, (x, 0.105, FRONT_Z), 1, rows, style, grip, True, DRAWER_TRAVEL)
    else:
        yield from doors("paint", width - 0.006, high, (x, 0.105, FRONT_Z), count, style, grip, 0.85)
    yield worktop(width, top)


def open_unit(width: float = 0.4) -> Iterator[Solid]:
    """Build open base shelves with bowls and jars."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield from open_case(
        "wood", width, WORKTOP_HEIGHT - 0.14, BASE_DEPTH - 0.04, (0.24, 0.48), (0.0, 0.1, -0.02), (), "wood"
    )
    for k, y in enumerate((0.12, 0.36, 0.6)):
        for i in range(2):
            yield vessel(
                f"glaze_{k}", [(0.04, 0.0), (0.075, 0.05), (0.08, 0.07)], 0.005, ((i - 0.5) * 0.17, y, 0.12), 14, 2
            )
    yield worktop(width)


def curtained(width: float = 0.8) -> Iterator[Solid]:
    """Build a base cabinet with a curtain on a rod instead of doors."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield from open_case(
        "paint", width, WORKTOP_HEIGHT - 0.14, BASE_DEPTH - 0.06, (0.36,), (0.0, 0.1, -0.03), (), "paint"
    )
    yield rod(
        "chrome",
        (-width / 2, WORKTOP_HEIGHT - 0.08, FRONT_Z + 0.01),
        (width / 2, WORKTOP_HEIGHT - 0.08, FRONT_Z + 0.01),
        0.007,
    )
    yield surface(
        "patterned",
        lambda u, v: (
            (u - 0.5) * (width - 0.03),
            0.1 + (WORKTOP_HEIGHT - 0.18) * v,
            FRONT_Z + 0.012 + 0.014 * np.sin(34 * u),
        ),
        60,
        2,
        0.005,
    )
    yield worktop(width, "wood")


def island(width: float = 1.4, depth: float = 0.9) -> Iterator[Solid]:
    """Build a kitchen island with drawers, an overhanging top and towel rails."""
    yield box("black", (width - 0.1, 0.1, depth - 0.4))
    yield box("paint", (width - 0.06, WORKTOP_HEIGHT - 0.14, depth - 0.36), (0.0, 0.1, 0.0))
    yield rounded_box("stone", (width, 0.045, depth), (0.0, WORKTOP_HEIGHT - 0.04, 0.05), 0.01, 2)
    yield from drawers(
        "paint",
        width - 0.07,
        WORKTOP_HEIGHT - 0.16,
        (0.035 - width / 2, 0.11, (depth - 0.36) / 2),
        3,
        2,
        "shaker",
        ("brass", "cup"),
        opens=0.12,  # [m], limited by the posts of the top
    )
    for s in (-1, 1):
        yield rounded_box(
            "wood", (0.06, WORKTOP_HEIGHT - 0.04, 0.06), (s * (width / 2 - 0.06), 0.0, depth / 2), 0.008, 1
        )
        yield rod("brass", (s * (width / 2 - 0.02), 0.7, -0.2), (s * (width / 2 - 0.02), 0.7, 0.2), 0.008)


def pantry(width: float = 0.6, height: float = 2.1, style: str = "shaker") -> Iterator[Solid]:
    """Build a tall cupboard of kitchen cabinet depth."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, height - 0.1, BASE_DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors("paint", width - 0.006, 1.2, (0.003 - width / 2, 0.105, FRONT_Z), 1, style, ("brass", "bar"), 0.8)
    yield from doors(
        "paint", width - 0.006, height - 1.32, (0.003 - width / 2, 1.31, FRONT_Z), 1, style, ("brass", "bar"), 0.2
    )


BASES = (
    design(base_unit), design(base_unit, width=0.8, count=2, style="shaker", grip=("brass", "knob"), top="wood"),
    design(base_unit, rows=3), design(base_unit, rows=1, style="shaker", grip=("black", "cup")), design(open_unit),
    design(curtained), design(island), design(pantry), design(base_unit, width=0.4),
    design(base_unit, width=0.8, rows=1, count=2, style="raised", grip=("brass", "ring")),
    design(base_unit, width=0.6, style="grooves", grip=("black", "slot")),
    design(base_unit, width=0.8, rows=4, grip=("black", "bar"), top="wood"),
)  # fmt: skip


FAMILIES = (FurnitureFamily("kitchen_cabinet", "kitchen_cabinet", BASES),)
