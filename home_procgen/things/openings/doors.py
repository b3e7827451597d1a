"""Doors, placed on a wall's centre line; their bounding box defines the hole in the wall."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, move, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc, lay_towards_front
from home_procgen.things.openings.leaves import FRAME_DEPTH, JAMB_WIDTH, LEAF_THICKNESS, frame, leaf


def _handles(x: float, kind: str, direction: float) -> Iterator[Solid]:
    """Build handles on both sides of a leaf around z = 0, about 1 m above its foot."""
    for s in (-1, 1):
        z = s * (LEAF_THICKNESS / 2)
        if kind == "lever":
            yield rounded_box("chrome", (0.035, 0.14, 0.01), (x, 0.93, z + s * 0.005), 0.004, 1)
            yield rod("chrome", (x, 1.02, z), (x, 1.02, z + s * 0.045), 0.008)
            yield rod("chrome", (x, 1.02, z + s * 0.045), (x + direction * 0.12, 1.02, z + s * 0.045), 0.008)
        elif kind == "knob":
            knob = revolve(
                "brass", [(0.026, 0.0), (0.012, 0.008), (0.012, 0.03), (0.028, 0.045), (0.02, 0.062)], sides=14, steps=2
            )
            yield from (
                lay_towards_front([knob], (x, 1.02, LEAF_THICKNESS / 2))
                if s > 0
                else (
                    rotate(p, 1, np.pi, (x, 1.02, 0.0))
                    for p in lay_towards_front([knob], (x, 1.02, LEAF_THICKNESS / 2))
                )
            )
        else:
            for y in (0.88, 1.22):
                yield rod("black", (x, y, z), (x, y, z + s * 0.04), 0.008)
            yield rod("black", (x, 0.85, z + s * 0.04), (x, 1.25, z + s * 0.04), 0.01)


def door(
    width: float = 0.9,
    height: float = 2.1,
    angle: float = np.pi / 2,
    style: str = "panels",
    grip: str = "lever",
    entry: bool = False,
) -> Iterator[Solid]:
    """Build a frame and a leaf hinged at -x that swings to -z.

    Args:
        width: Width over the frame [m].
        height: Height over the frame [m].
        angle: Angle of the leaf [rad]; 0 is closed.
        style: Style of the leaf.
        grip: Kind of handle.
        entry: Make a front door with a letter slot, a knocker and a spy-hole.
    """
    yield from frame(width, height)
    pivot = (JAMB_WIDTH - width / 2, 0.0, -FRAME_DEPTH / 2)
    wide, high = width - 2 * JAMB_WIDTH - 0.006, height - JAMB_WIDTH - 0.04
    pieces = [*leaf(wide, high, style), *_handles(wide / 2 - 0.06, grip, -1.0)]
    if entry:
        for s in (-1, 1):
            pieces.append(
                rounded_box("brass", (0.26, 0.05, 0.01), (0.0, 0.75, s * (LEAF_THICKNESS / 2 + 0.01)), 0.004, 1)
            )
            pieces.append(disc("brass", 0.012, 0.012, (0.0, 1.52, s * (LEAF_THICKNESS / 2 + 0.004) - 0.006), 12))
    for piece in pieces:
        yield rotate(move(piece, (0.0, 0.035, -FRAME_DEPTH / 2 + LEAF_THICKNESS / 2)), 1, angle, pivot)


def double_door(
    width: float = 1.5, height: float = 2.1, angle: float = np.pi / 2, style: str = "lattice"
) -> Iterator[Solid]:
    """Build a frame with two leaves that swing to -z."""
    yield from frame(width, height)
    wide, high = (width - 2 * JAMB_WIDTH) / 2 - 0.005, height - JAMB_WIDTH - 0.04
    for s in (-1, 1):
        pivot = (s * (width / 2 - JAMB_WIDTH), 0.0, -FRAME_DEPTH / 2)
        for piece in [*leaf(wide, high, style), *_handles(-s * (wide / 2 - 0.06), "lever", float(s))]:
            shut = move(piece, (s * (wide / 2 + 0.0035), 0.035, -FRAME_DEPTH / 2 + LEAF_THICKNESS / 2))
            yield rotate(shut, 1, -s * angle, pivot)


DOORS = (
    design(door), design(door, style="flat", height=2.12), design(door, style="glazed", width=0.86, height=2.08),
    design(door, style="four", grip="knob"), design(door, style="boards", grip="bar"), design(door, style="lattice"),
    design(door, style="arch", grip="knob"), design(door, style="lines", grip="bar"), design(door, style="port"),
    design(door, style="louvres", grip="knob"), design(door, style="ladder"), design(door, style="oval", grip="knob"),
    design(door, style="chevron", grip="bar"),
)  # fmt: skip

ENTRIES = (
    design(door, style="panels", width=1.0, entry=True, grip="knob"),
    design(door, style="half", width=1.0, entry=True),
    design(door, style="arch", width=1.0, entry=True, grip="bar"),
)


FAMILIES = (
    FurnitureFamily("door", "door", DOORS, {"angle": 0.0}, False),
    FurnitureFamily("entry_door", "door", ENTRIES, {"angle": 0.0}, False),
    FurnitureFamily(
        "double_door",
        "door",
        (design(double_door), design(double_door, style="glazed", width=1.6), design(double_door, style="panels")),
        {"angle": 0.0},
        False,
    ),
)
