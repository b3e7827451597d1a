"""Cars."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.vehicles.wheels import wheel

# All lengths are in metres; z points forward.
WAIST, SILL = 0.62, 0.24  # heights of the crease along the flanks, and of the lower edge of the body
WHEEL_RADIUS, ARCH_RADIUS, AXLE_INSET = 0.33, 0.39, 0.8  # radii, and distance of the axles from the ends
HALF_WIDTH, SHOULDER, ROOF_HALF = 0.86, 0.79, 0.6  # half widths at the waist, at the windows' lower edges, of the roof
PLAN_TAPER = 0.1  # share by which the ends are narrower than the middle
Point = tuple[float, float]


class CarShape(NamedTuple):
    """Proportions of a car."""

    length: float
    height: float
    roof: tuple[float, float]  # z of the rear and the front end of the roof
    belt: float  # height of the windows' lower edges
    tail: float  # z of the rear window's lower edge


_CARS = {
    "saloon": CarShape(4.4, 1.42, (-0.95, 0.62), 0.9, -1.5),
    "hatch": CarShape(3.8, 1.48, (-1.45, 0.5), 0.92, -1.75),
    "jeep": CarShape(4.0, 1.75, (-1.75, 0.5), 1.06, -1.86),
    "van": CarShape(4.5, 1.85, (-2.05, 0.9), 1.06, -2.16),
}


def _shaped(piece: Solid, shape: CarShape, heights: Sequence[float], widths: Sequence[float]) -> Solid:
    """Return a board across the car that is as wide as `widths` at `heights`, and narrower towards both ends."""
    x, y, z = piece.vertices.T
    wide = np.interp(y, heights, widths) * (1 - PLAN_TAPER * np.abs(2 * z / shape.length) ** 3)
    return replace(piece, vertices=np.stack([np.sign(x) * wide, y, z], axis=1))


def _arch(middle: float) -> list[Point]:
    """Return the outline (z, y) of a wheel arch, from back to front."""
    low = float(np.arcsin((SILL - WHEEL_RADIUS) / ARCH_RADIUS))
    turns = np.linspace(np.pi - low, low, 13)
    return [(middle + ARCH_RADIUS * np.cos(a), WHEEL_RADIUS + ARCH_RADIUS * np.sin(a)) for a in turns.tolist()]


def _split(outline: Sequence[Point]) -> list[Point]:
    """Return an outline with more points on long sides, so that the body's ends can be round."""
    found: list[Point] = []
    for (a, b), (c, d) in zip(outline, [*outline[1:], outline[0]], strict=True):
        count = max(1, round(float(np.hypot(c - a, d - b)) / 0.3))
        found += [(a + (c - a) * i / count, b + (d - b) * i / count) for i in range(count)]
    return found


def _body(shape: CarShape) -> Iterator[Solid]:
    half, belt = shape.length / 2, shape.belt
    axle = half - AXLE_INSET
    lower = [(-half, 0.36), *_arch(-axle), *_arch(axle), (half, 0.32), (half, WAIST), (-half, WAIST)]
    flank = prism("car", _split(lower), 1.0, (0.0, 0.0, 0.0), "side")
    yield _shaped(flank, shape, (SILL, WAIST), (0.95 * HALF_WIDTH, HALF_WIDTH))
    cowl = shape.roof[1] + 0.62
    deck = [(half - 0.16, belt - 0.14), (cowl, belt), (shape.tail, belt), (-half + 0.03, belt - 0.05)]
    upper = fillet([(-half, WAIST), (half, WAIST), *deck], 0.07, 3, True)
    shoulder = prism("car", _split([(float(z), float(y)) for z, y in upper]), 1.0, (0.0, 0.0, 0.0), "side")
    yield _shaped(shoulder, shape, (WAIST, belt), (HALF_WIDTH, SHOULDER))
    yield box("black", (1.3, 0.5, shape.length - 0.5), (0.0, 0.22, 0.0))
    for z in (-axle, axle):
        for s in (-1, 1):
            yield from wheel(s * 0.74, WHEEL_RADIUS, z, WHEEL_RADIUS, 0.2)


def _inside(shape: CarShape, y: float) -> float:
    """Return the half width of the cabin at a height."""
    return float(np.interp(y, (shape.belt, shape.height), (SHOULDER - 0.05, ROOF_HALF)))


def _pane(shape: CarShape, outline: Sequence[Point], side: int) -> Solid:
    """Return a pane (z, y) in one flank of the cabin."""
    piece = prism("glass", outline, 0.006, (0.0, 0.0, 0.0), "side")
    shift = np.array([side * _inside(shape, y) for y in piece.vertices[:, 1].tolist()])
    return replace(piece, vertices=piece.vertices + np.stack([shift, 0 * shift, 0 * shift], axis=1))


def _cabin(shape: CarShape) -> Iterator[Solid]:
    """Build pillars, panes and a roof above the shoulders, and what is seen through the panes."""
    (rear, front), low, high = shape.roof, shape.belt, shape.height - 0.05
    cowl, tail = front + 0.6, shape.tail + 0.04
    yield rounded_box(
        "car", (2 * ROOF_HALF, 0.06, front - rear + 0.12), (0.0, high - 0.01, (front + rear) / 2), 0.028, 2
    )
    middle = (front + rear) / 2 + 0.05
    for s in (-1, 1):
        for z, top in ((cowl, front), (middle, middle), (tail, rear)):
            a, b = (s * _inside(shape, low), low - 0.02, z), (s * _inside(shape, high), high + 0.01, top)
            yield beam("black" if z == middle else "car", a, b, 0.05, 0.06)
        for (z0, t0), (z1, t1) in (((tail, rear), (middle, middle)), ((middle, middle), (cowl, front))):
            yield _pane(shape, [(z0, low), (z1, low), (t1, high), (t0, high)], s)
    for z, top in ((cowl, front), (tail, rear)):
        thin = [(z - 0.004, low), (z + 0.004, low), (top + 0.004, high), (top - 0.004, high)]
        pane = prism("glass", thin, 1.0, (0.0, 0.0, 0.0), "side")
        wide = np.sign(pane.vertices[:, 0]) * [_inside(shape, y) - 0.01 for y in pane.vertices[:, 1].tolist()]
        yield replace(pane, vertices=np.stack([wide, *pane.vertices.T[1:]], axis=1))
    yield rounded_box("black", (1.3, 0.08, 0.34), (0.0, low - 0.02, cowl - 0.2), 0.03, 1)
    yield rotate(
        ring("black", 0.17, 0.03, (0.36, low + 0.1, cowl - 0.42), 2, 12), 0, 0.4, (0.36, low + 0.1, cowl - 0.42)
    )
    for x, z in ((-0.36, middle), (0.36, middle), (-0.36, rear + 0.25), (0.36, rear + 0.25)):
        yield rounded_box("gray", (0.46, 0.24, 0.12), (x, low - 0.02, z), 0.04, 1)
        yield rounded_box("gray", (0.24, 0.14, 0.08), (x, low + 0.24, z), 0.03, 1)


def _doors(shape: CarShape) -> Iterator[Solid]:
    """Build the gaps around the doors, and handles, sills and mirrors."""
    low, middle = shape.belt, sum(shape.roof) / 2 + 0.05
    ends = [middle, max(middle - 0.95, 0.45 + AXLE_INSET - shape.length / 2), shape.roof[1] + 0.56]
    for s in (-1, 1):
        for z in ends:
            narrow = 1 - PLAN_TAPER * abs(2 * z / shape.length) ** 3
            foot, crease, top = (s * w * narrow for w in (0.955 * HALF_WIDTH, HALF_WIDTH, SHOULDER))
            yield rod("black", (foot, 0.3, z), (crease, WAIST, z), 0.004, sides=4)
            yield rod("black", (crease, WAIST, z), (top, low, z), 0.004, sides=4)
        for z in ends[:2]:
            yield rounded_box("chrome", (0.03, 0.03, 0.15), (s * (HALF_WIDTH - 0.02), WAIST + 0.08, z + 0.15), 0.01, 1)
        yield rounded_box("black", (0.03, 0.07, 1.5), (s * 0.815, SILL - 0.01, 0.0), 0.012, 1)
        yield ball("car", (0.1, 0.07, 0.06), (s * 0.86, low + 0.07, shape.roof[1] + 0.42), 10, 6)


def _ends(shape: CarShape) -> Iterator[Solid]:
    """Build lights, bumpers, the grille and number plates."""
    half = shape.length / 2
    for s in (-1, 1):
        yield padded_block("white", (0.34, 0.13, 0.1), (s * 0.56, WAIST - 0.04, half - 0.04), 3.0, 4)
        yield rounded_box("red", (0.2, 0.2, 0.08), (s * 0.64, WAIST - 0.02, 0.02 - half), 0.035, 2)
        yield rounded_box("orange", (0.08, 0.05, 0.05), (s * 0.7, 0.42, half - 0.02), 0.015, 1)
    for z in (half - 0.02, 0.02 - half):
        yield rounded_box("black", (1.5, 0.13, 0.12), (0.0, 0.31, z), 0.045, 1)
    yield rounded_box("black", (0.68, 0.13, 0.03), (0.0, 0.54, half), 0.012, 1)
    for i in range(4):
        yield box("chrome", (0.64, 0.008, 0.012), (0.0, 0.555 + 0.03 * i, half + 0.012))
    for s, z in ((1, half + 0.045), (-1, -half - 0.045)):
        yield rounded_box("white", (0.5, 0.1, 0.01), (0.0, 0.33, z + s * 0.005), 0.004, 1)


def car(kind: str = "saloon") -> Iterator[Solid]:
    """Build a saloon, a hatchback, a jeep or a van."""
    shape = _CARS[kind]
    for build in (_body, _cabin, _doors, _ends):
        yield from build(shape)
    if kind == "jeep":
        spare = wheel(0.0, 0.0, 0.0, WHEEL_RADIUS, 0.2)
        yield from (move(rotate(p, 1, np.pi / 2), (0.0, 0.9, -shape.length / 2 - 0.12)) for p in spare)


FAMILIES = (FurnitureFamily("car", "car", design_kinds(car, "saloon", "hatch", "jeep", "van")),)
