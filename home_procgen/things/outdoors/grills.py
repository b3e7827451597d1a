"""Barbecue grills."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, rod
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.joinery import bow_handle, corners, disc
from home_procgen.things.movable_parts import assign_part, lid_part, panel


def round_grill() -> Iterator[Solid]:
    """Build a round grill on three legs."""
    yield revolve("iron", [(0.05, 0.5), (0.22, 0.56), (0.28, 0.7)], sides=26, steps=3)
    yield revolve("iron", [(0.285, 0.71), (0.24, 0.84), (0.1, 0.92), (0.01, 0.93)], sides=26, steps=3)
    yield bow_handle("wood", 0.06, (0.92, 0.97), 0.0, 0.02, 0.012)
    yield from repeat_around([rod("iron", (0.0, 0.0, 0.32), (0.0, 0.58, 0.16), 0.013)], 3)
    yield cylinder("gray", 0.15, 0.012, (0.0, 0.2, 0.0), sides=22)


def gas_grill() -> Iterator[Solid]:
    """Build a gas grill with a lid."""
    yield rounded_box("steel", (0.75, 0.6, 0.45), (0.0, 0.14, 0.0), 0.012, 1)
    for s in (-1, 1):
        door = rounded_box("steel", (0.36, 0.5, 0.02), (s * 0.185, 0.17, 0.23), 0.006, 1)
        yield from panel("left" if s < 0 else "right", door)
        yield rounded_box("gray", (0.3, 0.03, 0.42), (s * 0.53, 0.86, 0.0), 0.008, 1)
    yield rounded_box("black", (0.78, 0.14, 0.5), (0.0, 0.74, 0.0), 0.015, 1)
    lid = [(-0.25, 0.0), (0.25, 0.0), (0.2, 0.2), (-0.05, 0.26), (-0.22, 0.2)]
    hood = [prism("black", fillet(lid, 0.07, 4, True), 0.76, (0.0, 0.89, 0.0), "side")]
    hood.append(rod("chrome", (-0.28, 1.0, 0.28), (0.28, 1.0, 0.28), 0.014))
    yield from assign_part(lid_part(0.91, -0.23), hood)
    for i in range(4):
        yield disc("chrome", 0.03, 0.03, ((i - 1.5) * 0.17, 0.81, 0.25), 18)
    for x, z in corners(0.66, 0.36):
        yield ball("rubber", 0.06, (x, 0.06, z), 12, 8)


def stone_grill() -> Iterator[Solid]:
    """Build a masonry grill with a chimney."""
    for s in (-1, 1):
        yield box("masonry", (0.22, 1.0, 0.6), (s * 0.48, 0.0, 0.0))
    yield box("masonry", (0.74, 1.0, 0.14), (0.0, 0.0, -0.23))
    yield rounded_box("stone", (0.78, 0.06, 0.62), (0.0, 0.62, 0.0), 0.01, 1)
    for i in range(14):
        yield rod("iron", ((i - 6.5) * 0.052, 0.84, -0.18), ((i - 6.5) * 0.052, 0.84, 0.3), 0.005, sides=6)
    yield prism(
        "masonry",
        [(-0.59, 1.0), (0.59, 1.0), (0.25, 1.6), (0.25, 2.0), (-0.25, 2.0), (-0.25, 1.6)],
        0.3,
        (0.0, 0.0, -0.15),
    )
