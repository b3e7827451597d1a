"""Cars."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.vehicles.wheels import wheel


def _hull(points: list[tuple[float, float]], wide: float, inset: float, slot: str) -> Iterator[Solid]:
    outline = fillet(points, 0.16, 4, True)
    for k, shrink in ((0, 0.0), (1, inset)):
        yield prism(
            slot,
            outline * (1 - 0.35 * shrink, 1.0) + np.array([0.0, 0.01 * k]),
            wide - 2 * shrink,
            (0.0, 0.0, 0.0),
            "side",
        )


def _lower_body(half: float, belt: float, roof: tuple[float, float]) -> Iterator[Solid]:
    low = [
        (-half, 0.36),
        (half, 0.34),
        (half, 0.6),
        (half - 0.12, belt - 0.16),
        (roof[1] + 0.55, belt),
        (roof[0] - 0.5, belt + 0.02),
        (-half, belt - 0.06),
    ]
    low[5] = (max(roof[0] - 0.5, 0.08 - half), belt + 0.02)
    yield from _hull(low, 1.72, 0.05, "car")


def _cabin(belt: float, high: float, roof: tuple[float, float], back: float) -> Iterator[Solid]:
    cabin = [
        (back, belt - 0.05),
        (roof[1] + 0.62, belt - 0.05),
        (roof[1] + 0.06, high - 0.05),
        (roof[1] - 0.15, high),
        (roof[0] + 0.1, high),
        (roof[0] - 0.05, high - 0.06),
    ]
    outline = fillet(cabin, 0.12, 3, True)
    yield prism("screen", outline, 1.42, (0.0, 0.0, 0.0), "side")
    yield rounded_box("car", (1.4, 0.06, roof[1] - roof[0]), (0.0, high - 0.035, (roof[0] + roof[1]) / 2), 0.025, 2)


def _flank(s: int, half: float, belt: float, high: float, roof: tuple[float, float], back: float) -> Iterator[Solid]:
    for z0, z1 in ((back + 0.02, roof[0]), (roof[1] + 0.6, roof[1])):
        yield beam("car", (s * 0.7, belt - 0.04, z0), (s * 0.67, high - 0.02, z1), 0.05, 0.06)
    middle = (roof[0] + roof[1]) / 2
    yield beam("car", (s * 0.712, belt - 0.04, middle), (s * 0.69, high - 0.02, middle), 0.03, 0.09)
    for z in (middle + 0.42, middle - 0.42):
        yield rounded_box("chrome", (0.03, 0.03, 0.14), (s * 0.87, belt - 0.14, z - 0.1), 0.01, 1)
    yield ball("car", (0.09, 0.07, 0.06), (s * 0.92, belt + 0.08, roof[1] + 0.42), 12, 8)
    yield padded_block("white", (0.36, 0.14, 0.08), (s * 0.6, 0.55, half - 0.05), 3.0, 5)
    yield padded_block("red", (0.3, 0.14, 0.06), (s * 0.65, 0.66, 0.03 - half), 3.0, 5)
    for z in (half - 0.82, 0.82 - half):
        yield from wheel(s * 0.76, 0.33, z, 0.33, 0.22)
        arch = [(z + 0.4 * np.cos(a), 0.34 + 0.4 * np.sin(a)) for a in np.linspace(0, np.pi, 14)]
        inner = [(z + 0.36 * np.cos(a), 0.34 + 0.36 * np.sin(a)) for a in np.linspace(np.pi, 0, 14)]
        yield prism("black", [*arch, *inner], 0.1, (s * 0.83, 0.0, 0.0), "side")


def _bumpers(half: float) -> Iterator[Solid]:
    yield rounded_box("black", (1.7, 0.16, 0.14), (0.0, 0.3, half - 0.02), 0.05, 2)
    yield rounded_box("black", (1.7, 0.16, 0.14), (0.0, 0.32, 0.02 - half), 0.05, 2)
    yield rounded_box("black", (0.8, 0.12, 0.03), (0.0, 0.56, half - 0.005), 0.01, 1)
    yield rounded_box("white", (0.5, 0.1, 0.01), (0.0, 0.37, half + 0.052), 0.004, 1)


# kind -> length, height, z range of the roof [m]
_CARS = {
    "saloon": (4.4, 1.42, (-0.95, 0.62)),
    "hatch": (3.8, 1.48, (-1.45, 0.5)),
    "jeep": (4.0, 1.75, (-1.75, 0.5)),
    "van": (4.5, 1.85, (-2.05, 0.9)),
}


def car(kind: str = "saloon") -> Iterator[Solid]:
    """Build a saloon, a hatchback, a jeep or a van."""
    long, high, roof = _CARS[kind]
    half, belt = long / 2, 0.88 if high < 1.6 else 1.05
    back = max(roof[0] - (0.55 if kind == "saloon" else 0.15), 0.05 - half)
    yield from _lower_body(half, belt, roof)
    yield from _cabin(belt, high, roof, back)
    for s in (-1, 1):
        yield from _flank(s, half, belt, high, roof, back)
    yield from _bumpers(half)
    if kind == "jeep":
        yield from (move(rotate(p, 1, np.pi / 2), (0.0, 0.9, -half - 0.12)) for p in wheel(0.0, 0.0, 0.0, 0.33, 0.2))


FAMILIES = (FurnitureFamily("car", "car", design_kinds(car, "saloon", "hatch", "jeep", "van")),)
