"""Cookers and ovens."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc, doors
from home_procgen.things.kitchen.cabinets import BASE_DEPTH, FRONT_Z, WORKTOP_HEIGHT
from home_procgen.things.movable_parts import assign_part, lid_part, panel


def _burner(x: float, z: float, radius: float, gas: bool) -> Iterator[Solid]:
    if gas:
        yield revolve(
            "iron", [(radius * 0.5, 0.0), (radius * 0.5, 0.012), (radius * 0.3, 0.018)], (x, WORKTOP_HEIGHT, z), 14, 1
        )
        for a in range(4):
            c, s = np.cos(a * np.pi / 2), np.sin(a * np.pi / 2)
            yield beam(
                "iron",
                (x + 0.03 * c, WORKTOP_HEIGHT + 0.026, z + 0.03 * s),
                (x + 0.11 * c, WORKTOP_HEIGHT + 0.026, z + 0.11 * s),
                0.008,
            )
        yield ring("iron", 0.1, 0.009, (x, WORKTOP_HEIGHT + 0.02, z), 1, 16)
    else:
        yield ring("gray", radius, 0.004, (x, WORKTOP_HEIGHT + 0.0012, z), 1, 24)
        yield ring("gray", 0.6 * radius, 0.004, (x, WORKTOP_HEIGHT + 0.0012, z), 1, 20)


def _oven_door(slot: str, x: float, wide: float) -> Iterator[Solid]:
    """Build an oven door with a pane and a handle."""
    yield rounded_box(slot, (wide - 0.03, 0.56, 0.035), (x, 0.12, BASE_DEPTH / 2 - 0.035), 0.008, 1)
    yield box("screen", (wide - 0.14, 0.32, 0.006), (x, 0.22, BASE_DEPTH / 2 - 0.017))
    left, right, z = x - wide / 2, x + wide / 2, BASE_DEPTH / 2
    yield rod("chrome", (left + 0.06, 0.63, z + 0.025), (right - 0.06, 0.63, z + 0.025), 0.01)
    for s in (-1, 1):
        end = x + s * (wide / 2 - 0.08)
        yield rod("chrome", (end, 0.63, z - 0.02), (end, 0.63, z + 0.02), 0.007)


def cooker(width: float = 0.6, gas: bool = False, doors_: int = 1, slot: str = "steel") -> Iterator[Solid]:
    """Build a hob above one or two ovens with glass doors and knobs."""
    yield box("black", (width - 0.02, 0.08, BASE_DEPTH - 0.1), (0.0, 0.0, -0.05))
    yield box(slot, (width, WORKTOP_HEIGHT - 0.1, BASE_DEPTH - 0.04), (0.0, 0.08, -0.02))
    yield rounded_box(
        "screen" if not gas else slot, (width, 0.02, BASE_DEPTH - 0.01), (0.0, WORKTOP_HEIGHT - 0.02, 0.0), 0.004, 1
    )
    wide = width / doors_
    for i in range(doors_):
        x = (i - (doors_ - 1) / 2) * wide
        yield from panel("bottom", *_oven_door(slot, x, wide))
    count = 5 if width < 0.8 else 7
    for i in range(count):
        yield disc(
            "black", 0.02, 0.03, ((i - (count - 1) / 2) * width / (count + 1.5), 0.77, BASE_DEPTH / 2 - 0.04), 14
        )
    for i in range(4 if width < 0.8 else 6):
        yield from _burner(
            (i // 2 - (0.5 if width < 0.8 else 1.0)) * 0.27,
            (i % 2 - 0.5) * 0.25,
            0.085 - 0.02 * ((i * 3) % 4 == 2),
            gas,
        )


def oven_column(width: float = 0.6, height: float = 2.1) -> Iterator[Solid]:
    """Build a tall unit with an oven and a microwave at hand height."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, height - 0.1, BASE_DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors(
        "paint", width - 0.006, 0.6, (0.003 - width / 2, 0.105, FRONT_Z), 1, "flat", ("chrome", "bar"), 0.85
    )
    yield from doors(
        "paint", width - 0.006, height - 1.75, (0.003 - width / 2, 1.74, FRONT_Z), 1, "flat", ("chrome", "bar"), 0.2
    )
    for y, high in ((0.73, 0.58), (1.33, 0.39)):
        door = [rounded_box("steel", (width - 0.01, high, 0.03), (0.0, y, FRONT_Z + 0.012), 0.006, 1)]
        door.append(box("screen", (width - 0.1, 0.62 * high, 0.006), (0.0, y + 0.05, FRONT_Z + 0.027)))
        up = y + 0.78 * high
        door.append(rod("chrome", (-0.22, up, FRONT_Z + 0.06), (0.22, up, FRONT_Z + 0.06), 0.009))
        door.append(box("screen", (0.16, 0.04, 0.004), (0.0, y + 0.87 * high, FRONT_Z + 0.027)))
        yield from panel("bottom", *door)


def range_stove(width: float = 1.0) -> Iterator[Solid]:
    """Build a cast-iron range with four doors, lidded plates and a rail."""
    yield rounded_box("glaze", (width, 0.78, BASE_DEPTH), (0.0, 0.06, 0.0), 0.015, 2)
    yield box("black", (width - 0.06, 0.06, BASE_DEPTH - 0.06))
    yield rounded_box("glaze", (width + 0.02, 0.045, BASE_DEPTH + 0.02), (0.0, WORKTOP_HEIGHT - 0.045, 0.0), 0.015, 2)
    for i in range(2):
        for j in range(2):
            at = ((i - 0.5) * width / 2, 0.12 + 0.36 * j, BASE_DEPTH / 2 + 0.005)
            board = rounded_box("glaze", (width / 2 - 0.06, 0.31, 0.03), at, 0.012, 1)
            at = ((i - 0.5) * 0.16, 0.27 + 0.36 * j, BASE_DEPTH / 2 + 0.03)
            yield from panel("right" if i else "left", board, rounded_box("chrome", (0.03, 0.02, 0.03), at, 0.006, 1))
    for x in (-0.24, 0.24):
        lid = [
            revolve("chrome", [(0.18, 0.0), (0.18, 0.02), (0.12, 0.06), (0.02, 0.07)], (x, WORKTOP_HEIGHT, 0.0), 24, 2)
        ]
        grip = [
            (x + dx, WORKTOP_HEIGHT + up, 0.0) for dx, up in ((-0.04, 0.06), (-0.04, 0.11), (0.04, 0.11), (0.04, 0.06))
        ]
        lid.append(tube("iron", fillet(grip, 0.02), 0.007, 6))
        yield from assign_part(lid_part(WORKTOP_HEIGHT, -0.18, x), lid)
    yield rod("chrome", (-width / 2, 0.82, BASE_DEPTH / 2 + 0.06), (width / 2, 0.82, BASE_DEPTH / 2 + 0.06), 0.011)


def backed_range(width: float = 0.76) -> Iterator[Solid]:
    """Build a hob above an oven and a drawer, with knobs and a clock on a back panel."""
    yield from cooker(width, True, 1, "white")
    yield rounded_box("white", (width, 0.2, 0.07), (0.0, WORKTOP_HEIGHT, -BASE_DEPTH / 2 + 0.035), 0.02, 2)
    yield box("screen", (0.18, 0.06, 0.006), (0.0, WORKTOP_HEIGHT + 0.09, 0.072 - BASE_DEPTH / 2))
    for x in (-0.3, -0.2, 0.2, 0.3):
        yield disc("chrome", 0.024, 0.03, (x, WORKTOP_HEIGHT + 0.12, 0.07 - BASE_DEPTH / 2), 16)


def lidded(width: float = 0.6) -> Iterator[Solid]:
    """Build a 1950s enamelled stove on legs with its lid folded up."""
    for x in (-0.24, 0.24):
        for z in (-0.2, 0.2):
            yield revolve("chrome", [(0.014, 0.0), (0.02, 0.06), (0.026, 0.14)], (x, 0.0, z), 12, 1)
    yield rounded_box("glaze", (width, WORKTOP_HEIGHT - 0.14, BASE_DEPTH - 0.04), (0.0, 0.14, -0.02), 0.05, 4)
    board = rounded_box("glaze", (width - 0.12, 0.34, 0.04), (0.0, 0.24, BASE_DEPTH / 2 - 0.04), 0.02, 3)
    path = fillet([(-0.2, 0.56, 0.28), (-0.2, 0.56, 0.33), (0.2, 0.56, 0.33), (0.2, 0.56, 0.28)], 0.03)
    yield from panel("bottom", board, tube("chrome", path, 0.011))
    for i in range(4):
        yield disc("black", 0.026, 0.03, ((i - 1.5) * 0.12, 0.72, BASE_DEPTH / 2 - 0.045), 16)
    yield rounded_box("glaze", (width - 0.01, 0.5, 0.02), (0.0, WORKTOP_HEIGHT, 0.02 - BASE_DEPTH / 2), 0.008, 2)
    for x in (-0.14, 0.14):
        for z in (-0.12, 0.13):
            yield from _burner(x, z, 0.08, True)


def wood_stove(width: float = 0.7) -> Iterator[Solid]:
    """Build a cast-iron wood stove with a fire door, rings, a pot rail and curved feet."""
    for x in (-0.28, 0.28):
        for z in (-0.2, 0.2):
            yield tube("iron", fillet([(x, 0.16, z), (1.1 * x, 0.1, 1.1 * z), (1.16 * x, 0.01, 1.2 * z)], 0.05), 0.022)
    yield rounded_box("iron", (width, WORKTOP_HEIGHT - 0.18, BASE_DEPTH - 0.08), (0.0, 0.14, -0.02), 0.02, 2)
    yield rounded_box("iron", (width + 0.06, 0.04, BASE_DEPTH - 0.02), (0.0, WORKTOP_HEIGHT - 0.04, 0.0), 0.012, 2)
    for x, w in ((-0.18, 0.26), (0.15, 0.34)):
        door = [rounded_box("iron", (w, 0.32, 0.03), (x, 0.42, BASE_DEPTH / 2 - 0.06), 0.02, 2)]
        door.append(ring("brass", min(w, 0.32) / 2 - 0.06, 0.012, (x, 0.58, BASE_DEPTH / 2 - 0.043), 2, 24))
        end, z = x + w / 2 - 0.03, BASE_DEPTH / 2 - 0.03
        yield from panel("left", *door, rod("brass", (end, 0.54, z), (end, 0.62, z), 0.008))
    yield from panel(0.35, rounded_box("iron", (0.5, 0.16, 0.03), (0.0, 0.2, BASE_DEPTH / 2 - 0.06), 0.01, 1))
    for x in (-0.18, 0.16):
        for r in (0.12, 0.08, 0.04):
            yield ring("gray", r, 0.006, (x, WORKTOP_HEIGHT + 0.001, 0.0), 1, 24)
    yield rod("brass", (-0.36, 0.78, BASE_DEPTH / 2 + 0.03), (0.36, 0.78, BASE_DEPTH / 2 + 0.03), 0.01)
    for s in (-1, 1):
        yield rod("brass", (s * 0.33, 0.78, BASE_DEPTH / 2 - 0.06), (s * 0.33, 0.78, BASE_DEPTH / 2 + 0.03), 0.008)


def built_under(width: float = 0.6) -> Iterator[Solid]:
    """Build a glass hob in a worktop over an oven with a drawer, behind one panel with a display."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, WORKTOP_HEIGHT - 0.14, BASE_DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield rounded_box("stone", (width, 0.04, BASE_DEPTH), (0.0, WORKTOP_HEIGHT - 0.04, 0.0), 0.008, 2)
    yield rounded_box("screen", (0.56, 0.008, 0.5), (0.0, WORKTOP_HEIGHT - 0.002, 0.0), 0.003, 1)
    for x, z, r in ((-0.14, -0.11, 0.09), (0.14, -0.11, 0.07), (-0.14, 0.11, 0.07), (0.14, 0.11, 0.1)):
        yield ring("gray", r, 0.003, (x, WORKTOP_HEIGHT + 0.0065, z), 1, 24)
    door = [rounded_box("steel", (width - 0.01, 0.59, 0.03), (0.0, 0.24, FRONT_Z + 0.012), 0.006, 1)]
    door.append(box("screen", (width - 0.06, 0.4, 0.006), (0.0, 0.27, FRONT_Z + 0.027)))
    door.append(rod("chrome", (-0.24, 0.71, FRONT_Z + 0.06), (0.24, 0.71, FRONT_Z + 0.06), 0.011))
    for s in (-1, 1):
        door.append(rod("chrome", (s * 0.2, 0.71, FRONT_Z + 0.02), (s * 0.2, 0.71, FRONT_Z + 0.06), 0.007, sides=6))
    door.append(box("screen", (0.2, 0.04, 0.004), (0.0, 0.77, FRONT_Z + 0.027)))
    yield from panel("bottom", *door)
    corner = (0.003 - width / 2, 0.105, FRONT_Z)
    yield from doors("paint", width - 0.006, 0.125, corner, 1, "flat", ("chrome", "bar"), 0.5, 0.45)


def big_range(width: float = 0.9) -> Iterator[Solid]:
    """Build a restaurant range: a wide and a narrow oven, a plate between burners, red knobs, a rail."""
    for x in (-0.4, 0.4):
        for z in (-0.22, 0.2):
            yield cylinder("steel", 0.025, 0.12, (x, 0.0, z), sides=14)
    yield rounded_box("steel", (width, WORKTOP_HEIGHT - 0.12, BASE_DEPTH - 0.03), (0.0, 0.12, -0.015), 0.008, 2)
    yield rounded_box("steel", (width, 0.07, 0.03), (0.0, WORKTOP_HEIGHT, 0.015 - BASE_DEPTH / 2), 0.008, 2)
    for x, wide in ((-0.14, 0.56), (0.3, 0.26)):
        door = [rounded_box("steel", (wide, 0.5, 0.03), (x, 0.18, BASE_DEPTH / 2 - 0.02), 0.01, 2)]
        door.append(rounded_box("screen", (wide - 0.1, 0.26, 0.01), (x, 0.27, BASE_DEPTH / 2 - 0.006), 0.004, 1))
        ends = [(x + s * (wide / 2 - 0.04), 0.63, BASE_DEPTH / 2 + 0.04) for s in (-1, 1)]
        door.append(rod("chrome", ends[0], ends[1], 0.012, sides=10))
        door += [rod("chrome", (px, py, pz - 0.045), (px, py, pz), 0.008, sides=6) for px, py, pz in ends]
        yield from panel("bottom", *door)
    for i in range(6):
        yield disc("red", 0.024, 0.035, ((i - 2.5) * 0.14, 0.77, BASE_DEPTH / 2 - 0.035), 16)
    yield rounded_box("iron", (0.22, 0.012, 0.44), (0.0, WORKTOP_HEIGHT, 0.02), 0.004, 1)
    for x in (-0.3, 0.3):
        for z in (-0.1, 0.15):
            yield from _burner(x, z, 0.08, True)


COOKERS = (
    design(cooker), design(cooker, gas=True), design(oven_column), design(range_stove),
    design(cooker, gas=True, width=0.9, doors_=2), design(cooker, slot="white"), design(backed_range),
    design(lidded), design(wood_stove), design(built_under), design(big_range),
)  # fmt: skip


FAMILIES = (FurnitureFamily("cooker", "range_oven", COOKERS),)
