"""Bodies of cabinets, and garments on hangers."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, rod
from home_procgen.things.joinery import BOARD_THICKNESS, cabinet_body, legs


def carcass(
    width: float,
    height: float,
    depth: float,
    foot: float = 0.06,
    kind: str = "plinth",
    wood: str = "wood",
    overhang: float = 0.0,
) -> Iterator[Solid]:
    """Build a closed body with a top board, on a plinth or legs; fronts attach at z = depth / 2 - 2 cm."""
    if kind == "plinth":
        yield box("black" if overhang == 0 else wood, (width - 0.04, foot, depth - 0.08), (0.0, 0.0, -0.02))
    else:
        yield from legs(wood, width - 0.04, depth - 0.04, foot, kind, 0.05)  # type: ignore[arg-type]
    yield cabinet_body(wood, width, height - foot - BOARD_THICKNESS, depth, (0.0, foot, 0.0))
    yield rounded_box(
        wood, (width + overhang, BOARD_THICKNESS, depth + overhang), (0.0, height - BOARD_THICKNESS, 0.0), 0.007, 1
    )


def garment(slot: str, x: float, y: float, long: float) -> Iterator[Solid]:
    """Build a shirt or coat on a hanger below a rail at height y, with its side towards +z [m]."""
    yield rod("chrome", (x, y, 0.0), (x, y - 0.08, 0.0), 0.003, sides=5)
    shape = [
        (0.0, -0.06),
        (0.2, -0.13),
        (0.21, -0.3),
        (0.17, -0.32),
        (0.19, -long),
        (-0.19, -long),
        (-0.17, -0.32),
        (-0.21, -0.3),
        (-0.2, -0.13),
    ]
    yield prism(slot, [(z, y + h) for z, h in shape], 0.05, (x, 0.0, 0.0), "side")
