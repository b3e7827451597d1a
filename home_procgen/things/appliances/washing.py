"""Dishwashers, washing machines and dryers."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc, lay_towards_front
from home_procgen.things.movable_parts import assign_part, front_part, lid_part, panel


def slim_dishwasher(slot: str = "white") -> Iterator[Solid]:
    """Build a narrow dishwasher with a recessed grip and a display."""
    yield box("black", (0.43, 0.1, 0.46), (0.0, 0.0, -0.05))
    yield box(slot, (0.45, 0.76, 0.54), (0.0, 0.1, -0.02))
    (door,) = panel("bottom", rounded_box(slot, (0.445, 0.66, 0.03), (0.0, 0.11, 0.265), 0.008, 1))
    yield door
    yield from assign_part(door.part, [rounded_box("black", (0.2, 0.03, 0.012), (0.0, 0.71, 0.277), 0.004, 1)])
    yield rounded_box("gray", (0.445, 0.06, 0.035), (0.0, 0.785, 0.262), 0.008, 1)
    yield box("screen", (0.08, 0.025, 0.004), (0.1, 0.8, 0.281))


def dishwasher(open_: bool = False) -> Iterator[Solid]:
    """Build a dishwasher with a door below a button panel."""
    yield box("black", (0.58, 0.1, 0.46), (0.0, 0.0, -0.05))
    yield box("steel", (0.6, 0.76, 0.54), (0.0, 0.1, -0.02))
    (door,) = panel("bottom", rounded_box("steel", (0.595, 0.62, 0.03), (0.0, 0.11, 0.265), 0.008, 1))
    yield door
    yield rounded_box("black", (0.595, 0.1, 0.035), (0.0, 0.745, 0.262), 0.008, 1)
    grip = [rod("chrome", (-0.24, 0.69, 0.31), (0.24, 0.69, 0.31), 0.01)]
    grip += [rod("chrome", (s * 0.22, 0.69, 0.27), (s * 0.22, 0.69, 0.31), 0.007) for s in (-1, 1)]
    yield from assign_part(door.part, grip)
    for i in range(5):
        yield disc("chrome", 0.009, 0.01, (0.1 + 0.035 * i, 0.795, 0.277), 10)
    yield box("screen", (0.12, 0.035, 0.004), (-0.12, 0.778, 0.281))


def washer(kind: str = "front") -> Iterator[Solid]:
    """Build a washing machine, front-loading with a round window or top-loading."""
    if kind == "top":
        yield rounded_box("white", (0.58, 0.84, 0.6), (0.0, 0.02, 0.0), 0.02, 2)
        yield from assign_part(
            lid_part(0.88, -0.15), [rounded_box("white", (0.5, 0.02, 0.42), (0.0, 0.86, 0.06), 0.008, 1)]
        )
        yield prism("gray", [(-0.3, 0.0), (-0.16, 0.0), (-0.22, 0.16), (-0.3, 0.16)], 0.58, (0.0, 0.86, 0.0), "side")
        for i in range(4):
            yield ball("chrome", 0.025, (-0.18 + 0.12 * i, 0.94, -0.185), 10, 6)
        return
    yield rounded_box("white", (0.6, 0.83, 0.54), (0.0, 0.02, -0.02), 0.015, 2)
    window = [revolve("screen", [(0.16, 0.0), (0.15, 0.03), (0.1, 0.045), (0.02, 0.05)], sides=24, steps=2)]
    rim = [
        revolve(
            "chrome" if kind == "front" else "black",
            [(0.21, 0.0), (0.2, 0.035), (0.165, 0.04), (0.16, 0.02)],
            sides=28,
            steps=2,
        )
    ]
    door = lay_towards_front([*window, *rim], (0.0, 0.44, 0.25))
    yield from assign_part(front_part("left", (-0.21, 0.23, 0.25), (0.42, 0.42)), door)
    yield rounded_box("gray", (0.57, 0.11, 0.02), (0.0, 0.72, 0.248), 0.006, 1)
    yield rounded_box("white", (0.18, 0.09, 0.02), (-0.18, 0.73, 0.253), 0.006, 1)
    yield disc("chrome", 0.036, 0.035, (0.05, 0.775, 0.256), 20)
    yield box("screen", (0.14, 0.05, 0.006), (0.18, 0.75, 0.259))
    for x in (-0.25, 0.25):
        yield cylinder("black", 0.025, 0.025, (x, 0.0, 0.16), sides=10)
        yield cylinder("black", 0.025, 0.025, (x, 0.0, -0.2), sides=10)


def tumble_dryer(slot: str = "white") -> Iterator[Solid]:
    """Build a tumble dryer with a square door and a lint drawer."""
    yield rounded_box(slot, (0.6, 0.84, 0.56), (0.0, 0.01, -0.01), 0.012, 2)
    door = [rounded_box(slot, (0.44, 0.46, 0.03), (0.0, 0.2, 0.28), 0.03, 3)]
    door += [rounded_box("black", (0.03, 0.16, 0.02), (0.19, 0.35, 0.292), 0.008, 1)]
    yield from assign_part(front_part("left", (-0.22, 0.2, 0.27), (0.44, 0.46)), door)
    yield rounded_box("gray", (0.26, 0.1, 0.014), (-0.14, 0.73, 0.272), 0.006, 1)
    yield disc("chrome", 0.034, 0.03, (0.07, 0.78, 0.27), 22)
    yield box("screen", (0.12, 0.04, 0.006), (0.2, 0.76, 0.27))


FAMILIES = (
    FurnitureFamily(
        "dishwasher", "dishwasher", (design(dishwasher), design(slim_dishwasher), design(slim_dishwasher, slot="steel"))
    ),
    FurnitureFamily("washer", "washer", (design(washer), design(washer, kind="top"), design(washer, kind="black"))),
    FurnitureFamily(
        "dryer", "dryer", (design(washer, kind="black"), design(tumble_dryer), design(tumble_dryer, slot="gray"))
    ),
)
