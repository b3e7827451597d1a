"""Refrigerators."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import corners, disc, front, legs
from home_procgen.things.movable_parts import assign_part, front_part, panel


def fridge(width: float = 0.6, height: float = 1.85, split: float = 0.7, slot: str = "steel") -> Iterator[Solid]:
    """Build a refrigerator with two doors, one above the other."""
    yield box("black", (width - 0.02, 0.05, 0.56), (0.0, 0.0, -0.03))
    yield rounded_box(slot, (width, height - 0.05, 0.58), (0.0, 0.05, -0.04), 0.012, 1)
    for low, high, grip in ((0.06, split - 0.004, split - 0.36), (split + 0.004, height, split + 0.06)):
        x, door = width / 2 - 0.05, [rounded_box(slot, (width - 0.004, high - low, 0.065), (0.0, low, 0.285), 0.015, 2)]
        door += [rod("chrome", (x, grip + s, 0.31), (x, grip + s, 0.35), 0.006) for s in (0.02, 0.28)]
        yield from panel("left", *door, rod("chrome", (x, grip, 0.35), (x, grip + 0.3, 0.35), 0.01))


def side_by_side(width: float = 0.92, height: float = 1.8, dispenser: bool = True) -> Iterator[Solid]:
    """Build a refrigerator with two tall doors and an optional water dispenser."""
    yield box("black", (width - 0.02, 0.06, 0.6), (0.0, 0.0, -0.03))
    yield rounded_box("steel", (width, height - 0.06, 0.62), (0.0, 0.06, -0.04), 0.012, 1)
    leaves: list[Solid] = []
    for s in (-1, 1):
        door = [rounded_box("steel", (width / 2 - 0.005, height - 0.08, 0.07), (s * width / 4, 0.07, 0.305), 0.018, 2)]
        door.append(rod("chrome", (s * 0.04, 0.5, 0.38), (s * 0.04, 1.4, 0.38), 0.012))
        door += [rod("chrome", (s * 0.04, y, 0.33), (s * 0.04, y, 0.38), 0.008) for y in (0.56, 1.34)]
        leaves += panel("left" if s < 0 else "right", *door)
    yield from leaves
    if dispenser:
        tap = [rounded_box("black", (0.2, 0.36, 0.03), (-width / 4, 0.95, 0.335), 0.012, 1)]
        tap.append(box("screen", (0.14, 0.06, 0.006), (-width / 4, 1.22, 0.352)))
        tap.append(rounded_box("chrome", (0.05, 0.06, 0.03), (-width / 4, 1.12, 0.345), 0.008, 1))
        yield from assign_part(leaves[0].part, tap)


def retro(height: float = 1.5) -> Iterator[Solid]:
    """Build a rounded 1950s refrigerator on short feet."""
    for x, z in corners(0.44, 0.4):
        yield cylinder("chrome", 0.02, 0.07, (x, 0.0, z), sides=10)
    yield rounded_box("bright", (0.6, height - 0.06, 0.56), (0.0, 0.06, -0.04), 0.1, 4)
    door = [rounded_box("bright", (0.58, height - 0.1, 0.12), (0.0, 0.08, 0.25), 0.055, 4)]
    door.append(box("chrome", (0.56, 0.014, 0.1), (0.0, height * 0.72, 0.262)))
    door.append(rounded_box("chrome", (0.05, 0.2, 0.05), (0.22, height * 0.5, 0.32), 0.02, 2))
    yield from panel("left", *door, rounded_box("chrome", (0.2, 0.035, 0.02), (-0.05, height * 0.82, 0.312), 0.009, 2))


def french(width: float = 0.9, height: float = 1.78) -> Iterator[Solid]:
    """Build a refrigerator with two doors above a freezer drawer."""
    yield box("black", (width - 0.02, 0.05, 0.6), (0.0, 0.0, -0.03))
    yield rounded_box("gray", (width, height - 0.05, 0.62), (0.0, 0.05, -0.04), 0.012, 1)
    for s in (-1, 1):
        door = rounded_box("gray", (width / 2 - 0.004, height - 0.74, 0.07), (s * width / 4, 0.73, 0.305), 0.016, 2)
        grip = [(s * 0.05, 0.9, 0.33), (s * 0.05, 0.92, 0.38), (s * 0.05, 1.5, 0.38), (s * 0.05, 1.52, 0.33)]
        yield from panel("left" if s < 0 else "right", door, tube("chrome", fillet(grip, 0.03), 0.01))
    drawer = rounded_box("gray", (width - 0.004, 0.64, 0.07), (0.0, 0.06, 0.305), 0.016, 2)
    grip = [(-0.34, 0.58, 0.33), (-0.32, 0.58, 0.38), (0.32, 0.58, 0.38), (0.34, 0.58, 0.33)]
    yield from panel(0.45, drawer, tube("chrome", fillet(grip, 0.03), 0.01))


def mini() -> Iterator[Solid]:
    """Build a small refrigerator with magnets and a note on its door."""
    yield rounded_box("white", (0.5, 0.8, 0.46), (0.0, 0.02, -0.03), 0.015, 2)
    (door,) = panel("left", rounded_box("white", (0.5, 0.79, 0.05), (0.0, 0.025, 0.225), 0.018, 2))
    yield door
    yield box("black", (0.44, 0.03, 0.4))
    fixed = [rounded_box("gray", (0.03, 0.16, 0.03), (0.21, 0.55, 0.25), 0.01, 1)]
    for x, y, slot in ((-0.1, 0.6, "red"), (0.02, 0.5, "yellow"), (-0.06, 0.42, "blue")):
        fixed.append(disc(slot, 0.022, 0.012, (x, y, 0.247), 14))
    yield from assign_part(door.part, [*fixed, box("paper", (0.1, 0.14, 0.004), (-0.12, 0.36, 0.25))])


def wine_cooler() -> Iterator[Solid]:
    """Build a wine cooler with a glass door and bottles on shelves."""
    for s in (-1, 1):
        yield box("black", (0.03, 1.2, 0.5), (s * 0.265, 0.03, 0.0))
    for y in (0.0, 1.2):
        yield box("black", (0.56, 0.05, 0.5), (0.0, y, 0.0))
    yield box("black", (0.54, 1.2, 0.02), (0.0, 0.03, -0.24))
    for row in range(6):
        y = 0.16 + 0.18 * row
        yield box("wood", (0.5, 0.012, 0.42), (0.0, y - 0.05, 0.0))
        for i in range(5):
            yield tube(
                "green",
                [
                    ((i - 2) * 0.095, y, -0.16),
                    ((i - 2) * 0.095, y, 0.06),
                    ((i - 2) * 0.095, y, 0.1),
                    ((i - 2) * 0.095, y, 0.17),
                ],
                [0.036, 0.036, 0.014, 0.014],
                8,
            )
    door = [box("glass", (0.48, 1.12, 0.01), (0.0, 0.07, 0.245))]
    for s in (-1, 1):
        door.append(box("steel", (0.035, 1.18, 0.03), (s * 0.255, 0.04, 0.255)))
        door.append(box("steel", (0.48, 0.04, 0.03), (0.0, 0.04 + 1.14 * (s + 1) / 2, 0.255)))
    frame = front_part("left", (-0.2725, 0.04, 0.27), (0.545, 1.18))
    yield from assign_part(frame, [*door, rod("chrome", (0.22, 0.5, 0.3), (0.22, 0.9, 0.3), 0.009)])


def integrated(width: float = 0.6, height: float = 1.98) -> Iterator[Solid]:
    """Build a refrigerator behind kitchen fronts, with a grille below."""
    yield box("black", (width - 0.02, 0.1, 0.5), (0.0, 0.0, -0.03))
    for i in range(8):
        yield box("steel", (0.02, 0.06, 0.006), ((i - 3.5) * 0.06, 0.02, 0.222))
    yield box("paint", (width, height - 0.1, 0.56), (0.0, 0.1, -0.03))
    for low, high, up in ((0.1, 0.75, 0.85), (0.75, height, 0.15)):
        corner = (0.003 - width / 2, low + 0.003, 0.25)
        yield from front(
            "paint", (width - 0.006, high - low), corner, "shaker", ("chrome", "bar", 0.9, up), opens="left"
        )


def display(width: float = 0.7, height: float = 1.95) -> Iterator[Solid]:
    """Build a display refrigerator with a glass door and food on its shelves."""
    for s in (-1, 1):
        yield box("black", (0.04, height, 0.58), (s * (width - 0.04) / 2, 0.0, 0.0))
    for y, high in ((0.0, 0.12), (height - 0.16, 0.16)):
        yield box("black", (width - 0.08, high, 0.58), (0.0, y, 0.0))
    yield box("white", (width - 0.08, height - 0.28, 0.02), (0.0, 0.12, -0.28))
    for k in range(4):
        y = 0.3 + 0.38 * k
        yield box("glass", (width - 0.09, 0.01, 0.46), (0.0, y, -0.02))
        for i in range(4):
            slot = ("green", "red", "yellow", "orange", "cream")[(i + k) % 5]
            tall = [(0.05, 0.0), (0.055, 0.02), (0.05, 0.14), (0.02, 0.18), (0.02, 0.22)]
            yield revolve(slot, tall, ((i - 1.5) * 0.13, y + 0.01, 0.02), 12, 1)
    x, door = width / 2 - 0.05, [box("glass", (width - 0.12, height - 0.34, 0.01), (0.0, 0.15, 0.285))]
    for s in (-1, 1):
        door.append(box("steel", (0.04, height - 0.2, 0.03), (s * (width - 0.1) / 2, 0.1, 0.3)))
    door.append(rod("chrome", (x, 0.7, 0.35), (x, 1.4, 0.35), 0.012))
    door += [rod("chrome", (x, y, 0.3), (x, y, 0.35), 0.008, sides=6) for y in (0.76, 1.34)]
    yield from assign_part(front_part("left", (0.03 - width / 2, 0.1, 0.315), (width - 0.06, height - 0.2)), door)


def ice_box(width: float = 0.66, height: float = 1.4) -> Iterator[Solid]:
    """Build a wooden ice box with small doors, brass hinges and latches."""
    yield from legs("wood", width, 0.5, 0.14, "taper", 0.06)
    yield rounded_box("wood", (width, height - 0.16, 0.5), (0.0, 0.12, 0.0), 0.012, 1)
    yield rounded_box("wood", (width + 0.04, 0.03, 0.54), (0.0, height - 0.05, 0.0), 0.01, 2)
    for x, y, w, h in ((-0.16, 0.16, 0.3, 1.15), (0.16, 0.16, 0.3, 0.62), (0.16, 0.82, 0.3, 0.49)):
        door = list(front("wood_1", (w, h), (x - w / 2, y, 0.25), "raised", opens="left"))
        for up in (0.15, 0.85):
            door.append(rounded_box("brass", (0.07, 0.03, 0.008), (x - 0.12, y + up * h - 0.015, 0.273), 0.003, 1))
        door.append(rounded_box("brass", (0.05, 0.08, 0.02), (x + 0.13, y + h / 2 - 0.04, 0.275), 0.008, 1))
        yield from assign_part(door[0].part, door)


def twin(width: float = 0.96, height: float = 1.86) -> Iterator[Solid]:
    """Build a refrigerator and freezer column side by side, with long handles and a screen."""
    yield box("black", (width - 0.04, 0.08, 0.54), (0.0, 0.0, -0.02))
    leaf: list[Solid] = []
    for s in (-1, 1):
        yield rounded_box("steel", (width / 2 - 0.008, height - 0.08, 0.6), (s * width / 4, 0.08, -0.02), 0.012, 2)
        door = [rounded_box("steel", (width / 2 - 0.014, height - 0.1, 0.05), (s * width / 4, 0.09, 0.295), 0.02, 3)]
        door.append(rounded_box("chrome", (0.03, 1.2, 0.025), (s * 0.05, 0.35, 0.345), 0.012, 3))
        door += [rod("chrome", (s * 0.05, y, 0.31), (s * 0.05, y, 0.345), 0.008) for y in (0.42, 1.46)]
        leaf = list(panel("left" if s < 0 else "right", *door))
        yield from leaf
    shown = [rounded_box("screen", (0.22, 0.32, 0.01), (width / 4, 1.2, 0.322), 0.004, 1)]
    for k, slot in enumerate(("blue", "green", "orange", "gray")):
        at = (width / 4 + 0.045 * (-1) ** k, 1.27 + 0.09 * (k // 2), 0.3275)
        shown.append(box(slot, (0.07, 0.05, 0.002), at))
    yield from assign_part(leaf[0].part, shown)


FRIDGES = (
    design(fridge), design(side_by_side), design(retro), design(french), design(mini), design(wine_cooler),
    design(fridge, slot="white", split=1.3, height=1.7), design(integrated), design(display), design(ice_box),
    design(twin),
)  # fmt: skip


FAMILIES = (FurnitureFamily("refrigerator", "refrigerator", FRIDGES),)
