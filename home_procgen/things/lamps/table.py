"""Table and desk lamps."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, shade
from home_procgen.shapes.rounded import ball, join_loops, rounded_box
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.shapes.transforms import Piece, repeat_around, rotate_pieces
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import bulb, foot_plate


def _table_foot(kind: str, high: float) -> Iterator[Solid]:
    """Build the foot of a table lamp up to height `high` [m]."""
    shapes = {
        "gourd": [(0.07, 0.0), (0.08, 0.02), (0.1, 0.1), (0.05, 0.18), (0.065, 0.23), (0.03, 0.28)],
        "urn": [(0.06, 0.0), (0.06, 0.015), (0.025, 0.03), (0.085, 0.14), (0.06, 0.24), (0.03, 0.28)],
        "bottle": [(0.07, 0.0), (0.085, 0.03), (0.085, 0.14), (0.03, 0.22), (0.025, 0.28)],
    }
    if kind in shapes:
        yield revolve(
            "glaze" if kind != "bottle" else "tint",
            [(r, h * (high - 0.05) / 0.28) for r, h in shapes[kind]],
            sides=22,
            steps=3,
        )
        yield cylinder("brass", 0.02, 0.07, (0.0, high - 0.06, 0.0), sides=12)
    elif kind == "column":
        yield rounded_box("marble", (0.13, 0.025, 0.13), (0.0, 0.0, 0.0), 0.006, 1)
        yield cylinder("brass", 0.014, high, (0.0, 0.02, 0.0), sides=12)
    elif kind == "cube":
        for i in range(3):
            yield rounded_box(
                "wood",
                (0.11 - 0.012 * i, (high - 0.05) / 3, 0.11 - 0.012 * i),
                (0.0, i * (high - 0.05) / 3, 0.0),
                0.012,
                2,
            )
        yield cylinder("brass", 0.014, 0.07, (0.0, high - 0.06, 0.0), sides=12)
    elif kind == "tripod":
        yield from repeat_around([rod("wood", (0.0, 0.0, 0.13), (0.0, high - 0.02, 0.015), 0.012, 0.01)], 3)
        yield cylinder("brass", 0.028, 0.04, (0.0, high - 0.04, 0.0), sides=14)
    else:
        for i in range(5):
            yield ball(
                "glass" if kind == "beads" else "glaze",
                0.055 - 0.004 * i,
                (0.0, 0.05 + 0.055 * i * high / 0.28, 0.0),
                16,
                10,
            )
        yield cylinder("brass", 0.01, high, (0.0, 0.0, 0.0), sides=10)
        yield foot_plate("brass", 0.07, 0.015)


def table_lamp(foot: str = "gourd", top: str = "drum", high: float = 0.28) -> Iterator[Piece]:
    """Build a table lamp from a foot, a shade and a bulb."""
    yield from _table_foot(foot, high)
    profiles = {
        "drum": [(0.15, 0.0), (0.15, 0.2)],
        "cone": [(0.17, 0.0), (0.09, 0.2)],
        "bell": [(0.17, 0.0), (0.12, 0.06), (0.09, 0.14), (0.075, 0.2)],
        "empire": [(0.19, 0.0), (0.1, 0.17)],
    }
    if top == "pleated":
        angle = 2 * np.pi * np.arange(48) / 48
        wave = 1 + 0.05 * (np.arange(48) % 2)
        rings_ = [
            np.stack([r * wave * np.cos(angle), np.full(48, high - 0.02 + y), r * wave * np.sin(angle)], -1)
            for r, y in ((0.17, 0.0), (0.1, 0.19), (0.095, 0.19), (0.165, 0.0))
        ]
        yield join_loops("shade", rings_, closed=True)
    else:
        yield shade("shade", profiles[top], (0.0, high - 0.02, 0.0), sides=28, steps=2)
    yield from bulb(high + 0.07, 25.0)


def _arm() -> Iterator[Piece]:
    yield foot_plate("paint", 0.1, 0.025)
    yield rod("paint", (0.0, 0.02, 0.0), (0.0, 0.24, -0.12), 0.009)
    yield rod("paint", (0.0, 0.24, -0.12), (0.0, 0.44, 0.06), 0.009)
    yield ball("chrome", 0.018, (0.0, 0.24, -0.12), 10, 6)
    yield ball("chrome", 0.018, (0.0, 0.44, 0.06), 10, 6)
    head = [
        shade("paint", [(0.085, 0.0), (0.06, 0.07), (0.025, 0.11)], (0.0, 0.3, 0.12), 0.004, 22, 2),
        *bulb(0.34, 25.0, 0.0, 0.12, light=0.29),
    ]
    yield from rotate_pieces(head, 0, -0.35, (0.0, 0.42, 0.1))
    for z in (-0.02, 0.02):
        yield rod("chrome", (0.012, 0.1, -0.05 + z), (0.012, 0.2, -0.1 + z), 0.003, sides=5)


def _banker() -> Iterator[Piece]:
    yield foot_plate("brass", 0.09, 0.025)
    yield revolve("brass", [(0.03, 0.02), (0.012, 0.06), (0.012, 0.24), (0.02, 0.26)], sides=14, steps=2)
    yield tube("brass", fillet([(0.0, 0.25, 0.0), (0.0, 0.34, -0.02), (0.0, 0.36, 0.02)], 0.04), 0.008)
    half = [(0.075 * np.cos(a), 0.075 * np.sin(a)) for a in np.linspace(0, np.pi, 12)]
    inner = [(0.069 * np.cos(a), 0.069 * np.sin(a)) for a in np.linspace(np.pi, 0, 12)]
    yield prism("green", [*half, *inner], 0.26, (0.0, 0.3, 0.02), "side")
    yield tube("bulb", [(-0.08, 0.325, 0.02), (0.08, 0.325, 0.02)], 0.018)
    yield Bulb((0.0, 0.28, 0.02), 25.0)


def _mushroom() -> Iterator[Piece]:
    yield revolve("opal", [(0.08, 0.0), (0.05, 0.03), (0.035, 0.12), (0.05, 0.2)], sides=22, steps=3)
    yield revolve("opal", [(0.05, 0.19), (0.15, 0.2), (0.14, 0.25), (0.08, 0.3), (0.02, 0.315)], sides=28, steps=3)
    yield Bulb((0.0, 0.34, 0.0), 25.0)


def _ball() -> Iterator[Piece]:
    yield revolve("wood", [(0.08, 0.0), (0.075, 0.025), (0.05, 0.035)], sides=22, steps=1)
    yield ball("opal", 0.12, (0.0, 0.14, 0.0), 24, 14)
    yield Bulb((0.0, 0.28, 0.0), 20.0)


def _bent_tube() -> Iterator[Piece]:
    yield foot_plate("black", 0.09, 0.015)
    yield tube("black", fillet([(0.0, 0.01, -0.06), (0.0, 0.4, -0.06), (0.0, 0.4, 0.16)], 0.1, 6), 0.009)
    yield rounded_box("black", (0.05, 0.014, 0.2), (0.0, 0.39, 0.1), 0.006, 1)
    yield box("bulb", (0.04, 0.004, 0.18), (0.0, 0.387, 0.1))
    yield Bulb((0.0, 0.36, 0.1), 20.0)


_DESK_LAMP_KINDS = {
    "arm": _arm,
    "banker": _banker,
    "mushroom": _mushroom,
    "ball": _ball,
    "tube": _bent_tube,
}


def desk_lamp(kind: str = "arm") -> Iterator[Piece]:
    """Build a desk lamp: a jointed arm, a banker's lamp, a mushroom, a glowing ball or a bent tube."""
    yield from _DESK_LAMP_KINDS[kind]()


TABLE = (
    design(table_lamp), design(table_lamp, foot="urn", top="empire"),
    design(table_lamp, foot="column", top="drum", high=0.34), design(table_lamp, foot="tripod", top="cone"),
    design(table_lamp, foot="cube", top="drum"), design(table_lamp, foot="beads", top="bell"),
    design(table_lamp, foot="bottle", top="pleated"),
    *design_kinds(desk_lamp, "arm", "banker", "mushroom", "ball", "tube"),
)  # fmt: skip


FAMILIES = (FurnitureFamily("table_lamp", "table_lamp", TABLE),)
