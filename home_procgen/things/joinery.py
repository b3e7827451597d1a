"""Shared furniture pieces: legs, cases, doors, drawers, handles, garments, bulbs."""

from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import Solid, Vector, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, ring, rod, sweep, tube
from home_procgen.shapes.transforms import Piece
from home_procgen.things.movable_parts import OpeningMotion, assign_part, front_part

BOARD_THICKNESS = 0.02  # [m], thickness of boards
LegKind = Literal["square", "taper", "splay", "turned", "hairpin", "sled", "block", "cabriole"]
HandleKind = Literal["bar", "knob", "cup", "slot", "ring", "none"]


def corners(width: float, depth: float) -> tuple[tuple[float, float], ...]:
    """Return the four corners (x, z) of a rectangle around the origin [m]."""
    return tuple((x * width / 2, z * depth / 2) for x in (-1, 1) for z in (-1, 1))


def legs(
    material: str, width: float, depth: float, height: float, kind: LegKind, thick: float = 0.05
) -> Iterator[Solid]:
    """Build legs under the corners of width x depth [m]; their axes are half a thickness inside."""
    if kind == "sled":
        yield from _sleds(material, width - thick, depth - thick, height, 0.5 * thick)
        return
    for x, z in corners(width - thick, depth - thick):
        yield from _leg(material, x, z, height, kind, thick)


def _leg(material: str, x: float, z: float, height: float, kind: str, thick: float) -> Iterator[Solid]:
    sx, sz = np.sign(x), np.sign(z)
    if kind in ("square", "block"):
        yield rounded_box(material, (thick, height, thick), (x, 0.0, z), 0.15 * thick, 1)
    elif kind == "taper":
        yield rod(material, (x, 0.0, z), (x, height, z), 0.28 * thick, 0.5 * thick, 12)
    elif kind == "splay":
        yield rod(
            material,
            (x, 0.0, z),
            (x - sx * 0.22 * height, height, z - sz * 0.14 * height),
            0.28 * thick,
            0.5 * thick,
            10,
        )
    elif kind == "turned":
        shape = [(0.3, 0.0), (0.42, 0.06), (0.24, 0.14), (0.42, 0.45), (0.26, 0.68), (0.48, 0.76), (0.48, 1.0)]
        yield revolve(material, [(r * thick, h * height) for r, h in shape], (x, 0.0, z), 12, 2)
    elif kind == "hairpin":
        for dx, dz in ((0.08, 0.0), (0.0, 0.08)):
            yield rod(material, (x, 0.0, z), (x - sx * dx, height, z - sz * dz), 0.12 * thick + 0.003, sides=6)
        yield ball(material, 0.15 * thick + 0.004, (x, 0.15 * thick + 0.004, z), 8, 4)
    else:
        path = [(0.10, 0.0), (0.02, 0.05), (-0.06, 0.35), (0.08, 0.75), (0.02, 1.0)]
        outline = [(z + sz * a * height * 0.5, b * height) for a, b in path]
        back = [
            (z + sz * (a * 0.5 * height - w * thick), b * height)
            for (a, b), w in zip(path, (0.5, 0.5, 0.6, 1.0, 1.2), strict=True)
        ]
        yield prism(material, [*outline, *back[::-1]], thick, (x, 0.0, 0.0), "side")


def _sleds(material: str, width: float, depth: float, height: float, bar: float) -> Iterator[Solid]:
    for x in (-width / 2, width / 2):
        z = depth / 2 + bar / 2
        path = fillet([(x, height, -z), (x, bar / 2, -z), (x, bar / 2, z), (x, height, z)], 2.5 * bar)
        yield sweep(material, path, np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * bar / 2)


def handle(material: str, at: Vector, kind: HandleKind, upright: bool, length: float = 0.14) -> Iterator[Solid]:
    """Build a handle at `at` on a face towards +z [m]."""
    x, y, z = at
    dx, dy = (0.0, length / 2) if upright else (length / 2, 0.0)
    if kind == "bar":
        for s in (-0.8, 0.8):
            yield rod(material, (x + s * dx, y + s * dy, z), (x + s * dx, y + s * dy, z + 0.028), 0.004, sides=6)
        yield rod(material, (x - dx, y - dy, z + 0.028), (x + dx, y + dy, z + 0.028), 0.006)
    elif kind == "knob":
        knob = revolve(material, [(0.006, 0.0), (0.006, 0.012), (0.016, 0.02), (0.013, 0.03)], sides=10, steps=2)
        yield from lay_towards_front([knob], at)
    elif kind == "cup":
        yield rounded_box(material, (0.08, 0.03, 0.026), (x, y - 0.015, z + 0.012), 0.012, 2)
    elif kind == "ring":
        yield rounded_box(material, (0.03, 0.03, 0.008), (x, y, z + 0.003), 0.004, 1)
        yield ring(material, 0.022, 0.006, (x, y - 0.012, z + 0.009), 2, 12)
    elif kind == "slot":
        yield box(material, (1.6 * dx + 0.01, 1.6 * dy + 0.01, 0.006), (x, y - 0.8 * dy - 0.005, z + 0.002))


def lay_towards_front(pieces: Iterable[Solid], at: Vector) -> Iterator[Solid]:
    """Rotate upright pieces so that their axis points towards +z, and move their foot to `at` [m]."""
    for piece in pieces:
        laid = rotate(piece, 0, np.pi / 2)
        yield move(laid, np.asarray(at))


def front(
    material: str,
    size: tuple[float, float],
    at: Vector,
    style: Literal["flat", "shaker", "raised", "cane", "glass", "slats", "grooves"] = "flat",
    grip: tuple[str, HandleKind, float, float] | None = None,
    upright: bool = True,
    opens: OpeningMotion | None = None,
) -> Iterator[Solid]:
    """Build one door or drawer front of `size` with its lower left corner at `at`; its outer face is 2 cm in front.

    Args:
        material: Slot of the panel.
        size: Width and height [m].
        at: Lower left corner of the back face [m].
        style: Construction of the panel.
        grip: Slot and kind of the handle, and its position as fractions of width and height; None: no handle.
        upright: Orient the handle vertically.
        opens: Hinged edge, or the distance a drawer slides out [m]; None if fixed.
    """
    board = (size[0] - 0.005, size[1] - 0.005)
    corner = (at[0] + 0.0025, at[1] + 0.0025, at[2] + BOARD_THICKNESS)
    part = None if opens is None else front_part(opens, corner, board)
    yield from assign_part(part, _front(material, size, at, style, grip, upright))


def _front(
    material: str,
    size: tuple[float, float],
    at: Vector,
    style: str,
    grip: tuple[str, HandleKind, float, float] | None,
    upright: bool,
) -> Iterator[Solid]:
    (w, h), (x, y, z) = (size[0] - 0.005, size[1] - 0.005), (at[0] + size[0] / 2, at[1] + 0.0025, at[2])
    if style in ("flat", "raised", "slats", "grooves"):
        yield rounded_box(material, (w, h, BOARD_THICKNESS), (x, y, z + BOARD_THICKNESS / 2), 0.004, 1)
    else:
        yield from _framed(material, (w, h), (x, y, z), {"cane": "cane", "glass": "glass"}.get(style, material))
    if style == "raised" and min(w, h) > 0.14:
        yield rounded_box(material, (w - 0.1, h - 0.1, 0.016), (x, y + 0.05, z + BOARD_THICKNESS + 0.002), 0.008, 1)
    if style == "slats":
        count = max(int(w / 0.05), 3)
        for i in range(count):
            yield box(
                material,
                (0.5 * w / count, h - 0.02, 0.012),
                (x + ((i + 0.5) / count - 0.5) * w, y + 0.01, z + BOARD_THICKNESS + 0.005),
            )
    if style == "grooves":
        for k in (0.25, 0.5, 0.75):
            yield box("black", (w - 0.03, 0.006, 0.004), (x, y + k * h, z + BOARD_THICKNESS))
    if grip is not None:
        slot, kind, across, up = grip
        length = min(0.16, 0.5 * (size[1] if upright else size[0]))
        place = (at[0] + across * size[0], at[1] + up * size[1], z + BOARD_THICKNESS)
        yield from handle(slot, place, kind, upright, length)


def _framed(material: str, size: tuple[float, float], at: Vector, panel: str) -> Iterator[Solid]:
    (w, h), (x, y, z) = size, at
    rail = min(0.06, 0.25 * min(w, h))
    for side in (-1, 1):
        yield box(material, (rail, h, BOARD_THICKNESS), (x + side * (w - rail) / 2, y, z + BOARD_THICKNESS / 2))
        yield box(
            material,
            (w - 2 * rail, rail, BOARD_THICKNESS),
            (x, y + (h - rail) * (side + 1) / 2, z + BOARD_THICKNESS / 2),
        )
    yield box(panel, (w - 2 * rail, h - 2 * rail, 0.008), (x, y + rail, z + 0.006))


def doors(
    material: str,
    width: float,
    height: float,
    at: Vector,
    count: int = 2,
    style: str = "flat",
    grip: tuple[str, HandleKind] = ("chrome", "bar"),
    up: float = 0.5,
    opens: OpeningMotion | None = None,
) -> Iterator[Solid]:
    """Build doors side by side over width x height; `at` is the lower left corner of their back faces [m].

    They are hinged at the edge farther from their handles, unless `opens` overrides it.
    """
    wide = width / count
    for i in range(count):
        across = 0.9 if (i % 2 == 0 and i < count - 1) or (count == 1) else 0.1
        corner, hung = (at[0] + i * wide, at[1], at[2]), "left" if across > 0.5 else "right"
        yield from front(material, (wide, height), corner, style, (*grip, across, up), True, opens or hung)  # type: ignore[arg-type]


def drawers(
    material: str,
    width: float,
    height: float,
    at: Vector,
    columns: int = 1,
    rows: int = 3,
    style: str = "flat",
    grip: tuple[str, HandleKind] = ("chrome", "bar"),
    graded: bool = False,
    opens: OpeningMotion = 0.3,
) -> Iterator[Solid]:
    """Build drawers over width x height; `graded` makes lower ones taller, `opens` is their travel [m]."""
    share = np.linspace(1.5, 0.7, rows) if graded else np.ones(rows)
    edges = np.concatenate([[0], np.cumsum(share / share.sum())]) * height
    for row in range(rows):
        for column in range(columns):
            size = (width / columns, float(edges[row + 1] - edges[row]))
            corner = (at[0] + column * size[0], at[1] + float(edges[row]), at[2])
            yield from front(material, size, corner, style, (*grip, 0.5, 0.55), False, opens)  # type: ignore[arg-type]


def cabinet_body(material: str, width: float, height: float, depth: float, at: Vector = (0.0, 0.0, 0.0)) -> Solid:
    """Build the solid body of a cabinet, 2 cm less deep than its doors reach [m]."""
    return box(material, (width, height, depth - BOARD_THICKNESS), (at[0], at[1], at[2] - BOARD_THICKNESS / 2))


def open_case(
    material: str,
    width: float,
    height: float,
    depth: float,
    levels: Iterable[float],
    at: Vector = (0.0, 0.0, 0.0),
    uprights: Iterable[float] = (),
    back: str | None = None,
) -> Iterator[Solid]:
    """Build an open case: sides, bottom, top, shelves at heights `levels` [m], uprights at fractions of the width."""
    x, y, z = at
    for side in (-1, 1):
        yield box(material, (BOARD_THICKNESS, height, depth), (x + side * (width - BOARD_THICKNESS) / 2, y, z))
    inner = width - 2 * BOARD_THICKNESS
    for level in (0.0, *levels, height - BOARD_THICKNESS):
        yield box(material, (inner, BOARD_THICKNESS, depth - 0.012), (x, y + level, z + 0.006))
    for share in uprights:
        yield box(
            material,
            (BOARD_THICKNESS, height - 2 * BOARD_THICKNESS, depth - 0.016),
            (x + (share - 0.5) * width, y + BOARD_THICKNESS, z + 0.006),
        )
    if back:
        yield box(back, (width - 0.01, height - 0.01, 0.01), (x, y + 0.005, z - depth / 2 + 0.005))


def book_row(
    left: float, bottom: float, width: float, height: float, z: float, seed: int, lean: bool = True
) -> Iterator[Solid]:
    """Build a row of books of varied sizes from `left` on, with spines up to z + 0.09 [m]."""
    rng = np.random.default_rng(seed)
    x, end = left, left + width
    while True:
        thick, tall = float(rng.uniform(0.018, 0.05)), float(height * rng.uniform(0.66, 0.97))
        if x + thick > end - 0.02:
            return
        tilt = lean and rng.random() < 0.07 and x + thick + 0.3 * tall < end
        book = box(
            f"cover_{int(rng.integers(1, 7))}",
            (thick - 0.002, tall, float(rng.uniform(0.13, 0.18))),
            (x + thick / 2, bottom, z),
        )
        if tilt:
            book = rotate(book, 2, 0.2, (x, bottom, z))
            x += 0.2 * tall
            lift = bottom - float(book.box[0, 1])
            book = move(book, (0.0, lift, 0.0))
        yield book
        x += thick


def foot_plate(material: str, radius: float, height: float = 0.02) -> Solid:
    """Build a round foot with a rounded edge."""
    return revolve(material, [(radius, 0.0), (radius, 0.6 * height), (0.93 * radius, height)], sides=20, steps=1)


def disc(material: str, radius: float, thick: float, at: Vector, sides: int = 20) -> Solid:
    """Build a flat disc whose axis points towards +z, with its back face at `at` [m]."""
    laid = rotate(cylinder(material, radius, thick, sides=sides), 0, np.pi / 2)
    return move(laid, np.asarray(at))


def roller(material: str, radius: float, wide: float, at: Vector, sides: int) -> Solid:
    """Build a cylinder whose axis points along x, centred at `at` [m]: wheels, castors, hubs."""
    laid = rotate(cylinder(material, radius, wide, (0.0, -wide / 2, 0.0), sides=sides), 2, np.pi / 2)
    return move(laid, np.asarray(at))


def bow_handle(
    material: str, half: float, heights: tuple[float, float], z: float, bend: float, radius: float, sides: int = 8
) -> Solid:
    """Build a bent handle from x = -half to half, rising from the first to the second of `heights` [m]."""
    low, high = heights
    path = fillet([(-half, low, z), (-half, high, z), (half, high, z), (half, low, z)], bend)
    return tube(material, path, radius, sides)


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


def bulb(
    y: float, power: float, x: float = 0.0, z: float = 0.0, radius: float = 0.03, light: float | None = None
) -> Iterator[Piece]:
    """Build a bulb at height y; its light source is at height `light`, by default just above it [m]."""
    yield revolve(
        "bulb",
        [
            (0.4 * radius, y - 1.4 * radius),
            (0.9 * radius, y - 0.4 * radius),
            (0.95 * radius, y + 0.2 * radius),
            (0.4 * radius, y + radius),
        ],
        (x, 0.0, z),
        12,
        2,
    )
    yield Bulb((x, y + 1.5 * radius if light is None else light, z), power)
