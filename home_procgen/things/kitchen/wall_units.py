"""Wall cabinets with flaps, shutters, sliding panes or racks."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.joinery import BOARD_THICKNESS, front, open_case
from home_procgen.things.movable_parts import assign_part

WALL_UNIT_DEPTH = 0.32  # [m], depth of wall cabinets


def bifold(width: float = 0.8, height: float = 0.68) -> Iterator[Solid]:
    """Build a wall cabinet with two lift-up flaps, one above the other, with grip rails."""
    yield rounded_box("paint", (width, height, WALL_UNIT_DEPTH - 0.02), (0.0, 0.0, -0.01), 0.006, 1)
    for k in (0, 1):
        at = (0.003 - width / 2, 0.003 + k * height / 2, 0.145)
        leaf = list(front("paint", (width - 0.006, height / 2 - 0.006), at, "raised", opens="top"))
        for x in (-0.25, 0.25):
            leaf.append(rod("chrome", (x, at[1] + 0.05, 0.16), (x, at[1] + 0.05, 0.195), 0.005, sides=6))
        leaf.append(rod("chrome", (-0.3, at[1] + 0.05, 0.195), (0.3, at[1] + 0.05, 0.195), 0.007))
        yield from assign_part(leaf[0].part, leaf)


def tambour(width: float = 0.6, height: float = 0.7) -> Iterator[Solid]:
    """Build a wall cabinet with a half-open roll-up shutter of slats."""
    yield from open_case("wood", width, height, WALL_UNIT_DEPTH, (0.36,), (0.0, 0.0, 0.0), (), "wood")
    for i in range(11):
        yield rounded_box("paint", (width - 0.05, 0.026, 0.014), (0.0, height - 0.06 - 0.03 * i, 0.145), 0.005, 1)
    yield rounded_box("chrome", (width - 0.05, 0.02, 0.03), (0.0, height - 0.4, 0.15), 0.006, 1)
    for i in range(3):
        jar = [(0.045, 0.0), (0.05, 0.02), (0.05, 0.12), (0.03, 0.14), (0.03, 0.16)]
        yield revolve("glaze", jar, ((i - 1) * 0.16, BOARD_THICKNESS, 0.0), 14, 1)


def plate_rack(width: float = 0.7, height: float = 0.6) -> Iterator[Solid]:
    """Build an open rack with plates on edge and cups on hooks below."""
    for s in (-1, 1):
        yield rounded_box("wood", (0.022, height - 0.08, 0.28), (s * (width / 2 - 0.011), 0.08, 0.0), 0.005, 1)
    for y in (0.1, height - 0.022):
        yield rounded_box("wood", (width - 0.05, 0.022, 0.28), (0.0, y, 0.0), 0.005, 1)
    for z in (-0.1, 0.1):
        yield rod("wood", (-width / 2 + 0.02, 0.36, z), (width / 2 - 0.02, 0.36, z), 0.008, sides=6)
    for i in range(9):
        x = (i - 4) * 0.066
        yield rod("wood", (x + 0.033, 0.12, 0.1), (x + 0.033, 0.36, 0.1), 0.006, sides=6)
        plate = vessel("crockery", [(0.05, 0.0), (0.07, 0.004), (0.11, 0.016)], 0.004, sides=18, steps=1)
        yield move(rotate(plate, 2, np.pi / 2 - 0.12), (x + 0.01, 0.233, 0.0))
    for i in range(4):
        x = (i - 1.5) * 0.15
        yield vessel("glaze", [(0.03, 0.0), (0.038, 0.04), (0.036, 0.07)], 0.004, (x, 0.0, 0.02), 12, 2)
        yield tube("chrome", [(x, 0.1, 0.02), (x + 0.012, 0.085, 0.02), (x, 0.06, 0.02)], 0.003, 6)


def sliding_panes(width: float = 0.9, height: float = 0.5) -> Iterator[Solid]:
    """Build a wall cabinet with two overlapping glass panes before crockery."""
    yield from open_case("wood", width, height, WALL_UNIT_DEPTH, (0.23,), (0.0, 0.0, 0.0), (0.5,), "wood")
    for s in (-1, 1):
        yield box("glass", (width / 2 + 0.02, height - 0.05, 0.006), (s * (width / 4 - 0.02), 0.022, 0.14 + 0.006 * s))
        yield rounded_box("chrome", (0.03, 0.06, 0.008), (s * (width / 2 - 0.06), 0.2, 0.15 + 0.006 * s), 0.003, 1)
        for y in (0.02, 0.25):
            for i in range(4):
                plate = [(0.06, 0.0), (0.08, 0.005), (0.1, 0.016)]
                yield vessel("crockery", plate, 0.005, (s * width / 4, y + 0.011 * i, 0.0), 16, 1)


def rounded_end(width: float = 0.34, height: float = 0.68) -> Iterator[Solid]:
    """Build quarter-round open end shelves with jars."""
    turn = np.linspace(0.0, np.pi / 2, 10)
    outline = [
        (-width / 2, -WALL_UNIT_DEPTH / 2),
        *zip(width * np.cos(turn) - width / 2, WALL_UNIT_DEPTH * np.sin(turn) - WALL_UNIT_DEPTH / 2, strict=True),
    ]
    for y in (0.0, 0.22, 0.44, height - 0.02):
        yield prism("wood", [(float(x), float(z)) for x, z in outline], 0.02, (0.0, y, 0.0), "top")
    yield box("wood", (0.016, height, WALL_UNIT_DEPTH), (0.008 - width / 2, 0.0, 0.0))
    yield box("wood", (width - 0.016, height, 0.012), (0.008, 0.0, 0.006 - WALL_UNIT_DEPTH / 2))
    for k, y in enumerate((0.02, 0.24, 0.46)):
        for i in range(2 - k % 2):
            body = [(0.04, 0.0), (0.045, 0.03), (0.04, 0.1), (0.02, 0.12)]
            yield revolve(f"glaze_{k}", body, (-0.07 + 0.1 * i, y, -0.06), 12, 2)


def crossed(width: float = 0.6, height: float = 0.6) -> Iterator[Solid]:
    """Build a cross of boards with wine bottles above a row of drawers."""
    yield from open_case("wood", width, height, WALL_UNIT_DEPTH, (0.15,), (0.0, 0.0, 0.0), (), "wood")
    for s in (-1, 1):
        yield beam(
            "wood", (-s * (width / 2 - 0.03), 0.18, 0.0), (s * (width / 2 - 0.03), height - 0.03, 0.0), 0.28, 0.016
        )
    for i in range(3):
        at = ((i - 1.5) * (width - 0.05) / 3, 0.022, WALL_UNIT_DEPTH / 2 - 0.03)
        yield from front("paint", ((width - 0.06) / 3, 0.125), at, "flat", ("brass", "knob", 0.5, 0.5), opens=0.22)
    for x, y in ((-0.07, 0.2), (0.03, 0.2), (-0.22, 0.3), (0.2, 0.3), (0.0, 0.44), (0.07, 0.47), (-0.22, 0.4)):
        bottle = [(x, y + 0.04, -0.13), (x, y + 0.04, 0.05), (x, y + 0.04, 0.09), (x, y + 0.04, 0.15)]
        yield tube("green", bottle, [0.037, 0.037, 0.014, 0.014], 10)
        yield move(rotate(cylinder("red", 0.0145, 0.03, sides=10), 0, np.pi / 2), (x, y + 0.04, 0.125))
