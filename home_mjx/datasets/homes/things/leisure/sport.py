"""Gym equipment, vehicles, garage and garden things."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.groups import around
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import corners, disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def wheel(
    x: float, y: float, z: float, radius: float, wide: float, spokes: int = 0, hub: str = "chrome"
) -> Iterator[Solid]:
    """A wheel whose axle points along x; with spokes it is a ring."""
    if spokes:
        yield ring("rubber", radius - wide / 2, wide, (x, y, z), 0, 30)
        yield ring("chrome", radius - 1.2 * wide, 0.3 * wide, (x, y, z), 0, 28)
        for i in range(spokes):
            a = 2 * np.pi * i / spokes
            yield rod(
                "chrome",
                (x, y, z),
                (x, y + (radius - wide) * np.cos(a), z + (radius - wide) * np.sin(a)),
                0.002,
                sides=4,
            )
        yield move(rotate(cylinder("chrome", 0.022, 0.07, (0.0, -0.035, 0.0), sides=12), 2, np.pi / 2), (x, y, z))
        return
    profile = [
        (0.72 * radius, -wide / 2),
        (0.95 * radius, -wide / 2),
        (radius, -0.3 * wide),
        (radius, 0.3 * wide),
        (0.95 * radius, wide / 2),
        (0.72 * radius, wide / 2),
    ]
    yield move(rotate(turned("rubber", profile, sides=24, steps=1), 2, np.pi / 2), (x, y, z))
    rim = [(0.72 * radius, -0.46 * wide), (0.72 * radius, 0.46 * wide)]
    yield move(rotate(turned(hub, rim, sides=24, steps=1), 2, np.pi / 2), (x, y, z))
    for i in range(5):
        a = 2 * np.pi * i / 5
        for s in (-1, 1):
            yield rod(
                "black",
                (x + s * 0.46 * wide, y + 0.25 * radius * np.cos(a), z + 0.25 * radius * np.sin(a)),
                (x + s * 0.47 * wide, y + 0.6 * radius * np.cos(a), z + 0.6 * radius * np.sin(a)),
                0.09 * radius,
                sides=6,
            )


def _treadmill() -> Iterator[Solid]:
    yield rounded("black", (0.72, 0.14, 1.6), (0.0, 0.02, 0.0), 0.03, 2)
    yield rounded("gray", (0.46, 0.02, 1.46), (0.0, 0.15, 0.02), 0.008, 1)
    for s in (-1, 1):
        yield beam("gray", (s * 0.33, 0.12, -0.62), (s * 0.33, 1.25, -0.5), 0.05, 0.08)
        yield tube("black", fillet([(s * 0.33, 1.05, -0.5), (s * 0.33, 1.05, -0.1), (s * 0.33, 0.9, 0.0)], 0.1), 0.022)
    yield rotate(rounded("black", (0.72, 0.34, 0.06), (0.0, 1.1, -0.52), 0.02, 2), 0, -0.4, (0.0, 1.1, -0.52))
    yield rotate(box("screen", (0.36, 0.2, 0.01), (0.0, 1.17, -0.485)), 0, -0.4, (0.0, 1.1, -0.52))
    yield rounded("black", (0.68, 0.14, 0.24), (0.0, 0.13, -0.68), 0.04, 2)


def _bench() -> Iterator[Solid]:
    yield rounded("black", (0.28, 0.07, 1.15), (0.0, 0.4, 0.05), 0.03, 2)
    for z in (-0.4, 0.5):
        yield beam("gray", (-0.25, 0.025, z), (0.25, 0.025, z), 0.05)
        yield beam("gray", (0.0, 0.02, z), (0.0, 0.41, z), 0.06)
    for s in (-1, 1):
        yield beam("gray", (s * 0.5, 0.02, -0.42), (s * 0.5, 1.0, -0.42), 0.06)
        yield beam("gray", (s * 0.5, 0.025, -0.7), (s * 0.5, 0.025, -0.15), 0.05)
        yield rounded("gray", (0.05, 0.05, 0.14), (s * 0.5, 0.97, -0.38), 0.01, 1)
        for k, r in enumerate((0.2, 0.16)):
            plate = rotate(turned("iron", [(r, -0.02), (r, 0.02), (0.7 * r, 0.03)], sides=26, steps=1), 2, np.pi / 2)
            yield move(plate, (s * (0.72 + 0.06 * k), 1.04, -0.36))
    yield beam("gray", (-0.5, 0.2, -0.42), (0.5, 0.2, -0.42), 0.04)
    yield rod("chrome", (-0.95, 1.04, -0.36), (0.95, 1.04, -0.36), 0.014, sides=10)


def _bike() -> Iterator[Solid]:
    for z in (-0.45, 0.45):
        yield rod("gray", (-0.26, 0.03, z), (0.26, 0.03, z), 0.03, sides=10)
    yield beam("gray", (0.0, 0.06, -0.45), (0.0, 0.06, 0.45), 0.08, 0.05)
    yield from wheel(0.0, 0.33, 0.26, 0.25, 0.05, hub="red")
    yield beam("black", (0.0, 0.08, -0.3), (0.0, 0.9, -0.36), 0.06)
    yield soft("black", (0.22, 0.08, 0.27), (0.0, 0.9, -0.36), 3.0, 6)
    yield beam("black", (0.0, 0.3, 0.1), (0.0, 1.08, 0.34), 0.07, 0.05)
    yield tube(
        "black",
        fillet([(-0.24, 1.12, 0.14), (-0.2, 1.14, 0.34), (0.2, 1.14, 0.34), (0.24, 1.12, 0.14)], 0.08),
        0.016,
    )
    yield rotate(rounded("black", (0.2, 0.14, 0.03), (0.0, 1.16, 0.36), 0.01, 1), 0, -0.5, (0.0, 1.16, 0.36))
    yield ball("gray", (0.07, 0.14, 0.2), (0.0, 0.32, -0.02), 16, 10)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.08, 0.32, -0.02), (s * 0.1, 0.32 + s * 0.15, 0.05), 0.012)
        yield rounded("black", (0.1, 0.025, 0.12), (s * 0.15, 0.31 + s * 0.15, 0.05), 0.008, 1)


def _rower() -> Iterator[Solid]:
    yield beam("gray", (0.0, 0.18, -0.9), (0.0, 0.3, 0.8), 0.09, 0.06)
    for z in (-0.85, 0.75):
        yield beam("gray", (-0.26, 0.03, z), (0.26, 0.03, z), 0.06)
        yield beam("gray", (0.0, 0.04, z), (0.0, 0.22 + 0.06 * (z > 0), z), 0.06)
    yield soft("black", (0.3, 0.09, 0.24), (0.0, 0.26, -0.3), 3.5, 6)
    yield move(
        rotate(turned("black", [(0.24, -0.05), (0.26, 0.0), (0.24, 0.05)], sides=28, steps=1), 2, np.pi / 2),
        (0.0, 0.48, 0.78),
    )
    for s in (-1, 1):
        yield rotate(rounded("black", (0.12, 0.03, 0.3), (s * 0.16, 0.34, 0.4), 0.01, 1), 0, -0.9, (0.0, 0.34, 0.4))
    yield rod("black", (-0.24, 0.55, 0.4), (0.24, 0.55, 0.4), 0.016)
    yield rod("gray", (0.0, 0.55, 0.4), (0.0, 0.48, 0.6), 0.004, sides=5)
    yield beam("gray", (0.0, 0.6, 0.85), (0.0, 1.0, 0.95), 0.04)
    yield rotate(rounded("black", (0.2, 0.14, 0.03), (0.0, 0.98, 0.95), 0.01, 1), 0, -0.3, (0.0, 0.98, 0.95))


def _dumbbells() -> Iterator[Solid]:
    for s in (-1, 1):
        yield prism(
            "gray",
            [(-0.25, 0.0), (0.25, 0.0), (0.2, 0.05), (-0.02, 0.85), (-0.12, 0.85), (-0.2, 0.05)],
            0.05,
            (s * 0.55, 0.0, 0.0),
            "side",
        )
    for row in range(3):
        y, z = 0.16 + 0.26 * row, 0.14 - 0.09 * row
        for dz in (-0.06, 0.06):
            yield beam("gray", (-0.54, y, z + dz), (0.54, y, z + dz), 0.04, 0.02)
        for i in range(5):
            x, r = (i - 2) * 0.2, 0.075 - 0.012 * row
            yield rod("chrome", (x, y + 0.05, z - 0.1), (x, y + 0.05, z + 0.1), 0.014)
            for dz in (-0.08, 0.08):
                yield rod(
                    "rubber",
                    (x, y + 0.02 + r * 0.6, z + dz - 0.035),
                    (x, y + 0.02 + r * 0.6, z + dz + 0.035),
                    r,
                    sides=6,
                )


def _mat() -> Iterator[Solid]:
    yield rounded("bright", (0.6, 0.012, 1.75), (0.0, 0.0, 0.0), 0.005, 2)
    yield tube("bright_1", [(0.5, 0.09, -0.3), (0.5, 0.09, 0.3)], 0.09, 18)
    yield ball("bright_2", 0.32, (-0.6, 0.32, -0.3), 26, 16)
    for z in (0.5, 0.66):
        yield rod("black", (0.4, 0.035, z), (0.62, 0.035, z), 0.012)
        for x in (0.4, 0.62):
            yield rod("rubber", (x - 0.03, 0.04, z), (x + 0.03, 0.04, z), 0.045, sides=6)


def _bag() -> Iterator[Solid]:
    yield beam("black", (-0.5, 0.03, -0.6), (0.5, 0.03, -0.6), 0.08, 0.06)
    yield beam("black", (0.0, 0.03, -0.7), (0.0, 0.03, 0.5), 0.08, 0.06)
    yield beam("black", (0.0, 0.03, -0.6), (0.0, 2.15, -0.6), 0.08)
    yield beam("black", (0.0, 2.12, -0.63), (0.0, 2.12, 0.1), 0.07)
    yield beam("black", (0.0, 1.75, -0.6), (0.0, 2.1, -0.25), 0.05)
    yield turned("red", [(0.12, 0.62), (0.17, 0.66), (0.17, 1.68), (0.12, 1.72)], (0.0, 0.0, 0.06), 24, 1)
    for y in (0.75, 1.6):
        yield ring("black", 0.168, 0.02, (0.0, y, 0.06), 1, 24)
    for i in range(4):
        a = 2 * np.pi * i / 4
        yield rod("chrome", (0.13 * np.cos(a), 1.71, 0.06 + 0.13 * np.sin(a)), (0.0, 2.0, 0.06), 0.005, sides=5)
    yield rod("chrome", (0.0, 2.0, 0.06), (0.0, 2.1, 0.06), 0.008)


def _cross() -> Iterator[Solid]:
    for z in (-0.75, 0.65):
        yield beam("gray", (-0.28, 0.03, z), (0.28, 0.03, z), 0.06)
    yield beam("gray", (0.0, 0.06, -0.75), (0.0, 0.06, 0.65), 0.1, 0.06)
    yield move(
        rotate(turned("black", [(0.28, -0.08), (0.3, 0.0), (0.28, 0.08)], sides=28, steps=1), 2, np.pi / 2),
        (0.0, 0.36, -0.45),
    )
    yield beam("gray", (0.0, 0.1, 0.35), (0.0, 1.45, 0.45), 0.08)
    yield rotate(rounded("black", (0.26, 0.18, 0.04), (0.0, 1.42, 0.45), 0.015, 1), 0, 0.3, (0.0, 1.42, 0.45))
    for s in (-1, 1):
        yield beam("gray", (s * 0.14, 0.36 + s * 0.14, -0.4), (s * 0.18, 0.34, 0.42), 0.035, 0.05)
        yield rounded("black", (0.14, 0.04, 0.36), (s * 0.16, 0.38 + s * 0.06, -0.05), 0.015, 1)
        yield tube(
            "gray",
            fillet([(s * 0.18, 0.34, 0.42), (s * 0.22, 1.0, 0.4), (s * 0.24, 1.4, 0.2), (s * 0.2, 1.55, 0.18)], 0.15),
            0.018,
        )
        yield rod("black", (s * 0.235, 1.36, 0.2), (s * 0.205, 1.53, 0.18), 0.024)


def _rack() -> Iterator[Solid]:
    for x, z in corners(1.1, 1.1):
        yield beam("iron", (x, 0.0, z), (x, 2.1, z), 0.06)
    for y in (0.04, 2.07):
        for s in (-1, 1):
            yield beam("iron", (s * 0.55, y, -0.55), (s * 0.55, y, 0.55), 0.055)
            yield beam("iron", (-0.55, y, -0.55 if y < 1 else s * 0.55), (0.55, y, -0.55 if y < 1 else s * 0.55), 0.05)
    yield rod("chrome", (-0.55, 1.95, 0.3), (0.55, 1.95, 0.3), 0.016)
    yield rod("chrome", (-1.05, 1.25, 0.6), (1.05, 1.25, 0.6), 0.014, sides=10)
    for s in (-1, 1):
        yield rounded("iron", (0.06, 0.08, 0.12), (s * 0.55, 1.19, 0.6), 0.01, 1)
        for k, r in enumerate((0.22, 0.22, 0.15)):
            yield move(
                rotate(turned("rubber", [(r, -0.018), (r, 0.018), (0.6 * r, 0.026)], sides=26, steps=1), 2, np.pi / 2),
                (s * (0.8 + 0.05 * k), 1.25, 0.6),
            )


def _kettlebells() -> Iterator[Solid]:
    for i in range(4):
        x, r = (i - 1.5) * 0.28, 0.085 + 0.014 * i
        yield ball("iron", r, (x, r, 0.0), 18, 12)
        yield cylinder("iron", 0.7 * r, 0.012, (x, 0.0, 0.0), sides=16)
        yield tube(
            "iron",
            fillet(
                [
                    (x - 0.05, 1.7 * r, 0.0),
                    (x - 0.065, 1.9 * r + 0.08, 0.0),
                    (x + 0.065, 1.9 * r + 0.08, 0.0),
                    (x + 0.05, 1.7 * r, 0.0),
                ],
                0.04,
                4,
            ),
            0.014,
            8,
        )


_GYM_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "treadmill": _treadmill,
    "bench": _bench,
    "bike": _bike,
    "rower": _rower,
    "dumbbells": _dumbbells,
    "mat": _mat,
    "bag": _bag,
    "cross": _cross,
    "rack": _rack,
    "kettlebells": _kettlebells,
}


def gym(kind: str = "treadmill") -> Iterator[Solid]:
    """Treadmill, bench press, bikes, rower, dumbbells, mat, punch bag, cross trainer, rack, kettlebells."""
    yield from _GYM_KINDS[kind]()


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
    yield rounded("car", (1.4, 0.06, roof[1] - roof[0]), (0.0, high - 0.035, (roof[0] + roof[1]) / 2), 0.025, 2)


def _flank(s: int, half: float, belt: float, high: float, roof: tuple[float, float], back: float) -> Iterator[Solid]:
    for z0, z1 in ((back + 0.02, roof[0]), (roof[1] + 0.6, roof[1])):
        yield beam("car", (s * 0.7, belt - 0.04, z0), (s * 0.67, high - 0.02, z1), 0.05, 0.06)
    middle = (roof[0] + roof[1]) / 2
    yield beam("car", (s * 0.712, belt - 0.04, middle), (s * 0.69, high - 0.02, middle), 0.03, 0.09)
    for z in (middle + 0.42, middle - 0.42):
        yield rounded("chrome", (0.03, 0.03, 0.14), (s * 0.87, belt - 0.14, z - 0.1), 0.01, 1)
    yield ball("car", (0.09, 0.07, 0.06), (s * 0.92, belt + 0.08, roof[1] + 0.42), 12, 8)
    yield soft("white", (0.36, 0.14, 0.08), (s * 0.6, 0.55, half - 0.05), 3.0, 5)
    yield soft("red", (0.3, 0.14, 0.06), (s * 0.65, 0.66, 0.03 - half), 3.0, 5)
    for z in (half - 0.82, 0.82 - half):
        yield from wheel(s * 0.76, 0.33, z, 0.33, 0.22)
        arch = [(z + 0.4 * np.cos(a), 0.34 + 0.4 * np.sin(a)) for a in np.linspace(0, np.pi, 14)]
        inner = [(z + 0.36 * np.cos(a), 0.34 + 0.36 * np.sin(a)) for a in np.linspace(np.pi, 0, 14)]
        yield prism("black", [*arch, *inner], 0.1, (s * 0.83, 0.0, 0.0), "side")


def _bumpers(half: float) -> Iterator[Solid]:
    yield rounded("black", (1.7, 0.16, 0.14), (0.0, 0.3, half - 0.02), 0.05, 2)
    yield rounded("black", (1.7, 0.16, 0.14), (0.0, 0.32, 0.02 - half), 0.05, 2)
    yield rounded("black", (0.8, 0.12, 0.03), (0.0, 0.56, half - 0.005), 0.01, 1)
    yield rounded("white", (0.5, 0.1, 0.01), (0.0, 0.37, half + 0.052), 0.004, 1)


# Length, height, and from where to where its roof reaches [m].
_CARS = {
    "saloon": (4.4, 1.42, (-0.95, 0.62)),
    "hatch": (3.8, 1.48, (-1.45, 0.5)),
    "jeep": (4.0, 1.75, (-1.75, 0.5)),
    "van": (4.5, 1.85, (-2.05, 0.9)),
}


def car(kind: str = "saloon") -> Iterator[Solid]:
    """A saloon, a hatchback, an estate or a jeep."""
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


def _scooter() -> Iterator[Solid]:
    for z in (-0.62, 0.62):
        yield from wheel(0.0, 0.23, z, 0.23, 0.1)
    yield prism(
        "bright",
        fillet([(-0.85, 0.32), (-0.2, 0.24), (-0.16, 0.3), (-0.24, 0.72), (-0.8, 0.76), (-0.92, 0.6)], 0.1, 4, True),
        0.34,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rounded("bright", (0.34, 0.06, 0.6), (0.0, 0.24, 0.1), 0.025, 2)
    yield rotate(rounded("bright", (0.42, 0.66, 0.06), (0.0, 0.26, 0.42), 0.028, 3), 0, -0.22, (0.0, 0.26, 0.42))
    yield soft("black", (0.3, 0.12, 0.72), (0.0, 0.74, -0.5), 4.0, 6)
    yield tube("chrome", [(0.0, 0.24, 0.62), (0.0, 0.95, 0.34)], 0.03, 10)
    yield ball("bright", (0.12, 0.13, 0.13), (0.0, 1.0, 0.34), 16, 10)
    yield ball("white", (0.08, 0.08, 0.04), (0.0, 1.0, 0.45), 14, 8)
    yield prism(
        "bright",
        fillet([(0.38, 0.42), (0.86, 0.36), (0.84, 0.46), (0.6, 0.54), (0.42, 0.5)], 0.06, 3, True),
        0.16,
        (0.0, 0.0, 0.0),
        "side",
    )


def _road() -> Iterator[Solid]:
    for z in (-0.72, 0.72):
        yield from wheel(0.0, 0.32, z, 0.32, 0.13)
    for s in (-1, 1):
        yield rod("chrome", (s * 0.09, 0.32, 0.72), (s * 0.09, 0.92, 0.44), 0.022)
        yield rod("black", (s * 0.09, 0.32, -0.72), (s * 0.09, 0.42, -0.1), 0.026)
        yield tube(
            "chrome",
            fillet(
                [(s * 0.12, 0.4, 0.22), (s * 0.17, 0.26, 0.2), (s * 0.17, 0.26, -0.75), (s * 0.17, 0.32, -0.95)],
                0.08,
            ),
            0.035,
            10,
        )
        yield rod("chrome", (s * 0.1, 0.5, -0.55), (s * 0.1, 0.75, -0.45), 0.025)
    yield rounded("gray", (0.3, 0.34, 0.44), (0.0, 0.28, 0.05), 0.06, 2)
    for i in range(5):
        yield rounded("gray", (0.28, 0.015, 0.24), (0.0, 0.6 + 0.03 * i, 0.08), 0.006, 1)
    yield ball("car", (0.16, 0.15, 0.3), (0.0, 0.82, 0.16), 20, 12)
    yield soft("black", (0.26, 0.12, 0.66), (0.0, 0.74, -0.42), 3.0, 6)
    yield prism(
        "car",
        fillet([(-0.5, 0.72), (-1.0, 0.78), (-0.98, 0.7), (-0.6, 0.62)], 0.06, 3, True),
        0.18,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield ball("chrome", (0.1, 0.1, 0.08), (0.0, 0.9, 0.58), 16, 10)
    yield ball("white", (0.085, 0.085, 0.03), (0.0, 0.9, 0.64), 14, 8)
    yield tube("car", [(0.0, 0.62, 0.98), (0.0, 0.68, 0.74), (0.0, 0.62, 0.46)], 0.06, 8)


_MOTORCYCLE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "scooter": _scooter,
    "road": _road,
}


def motorcycle(kind: str = "road") -> Iterator[Solid]:
    """A road machine or a scooter."""
    yield from _MOTORCYCLE_KINDS[kind]()
    yield tube(
        "chrome", fillet([(-0.36, 1.02, 0.24), (-0.2, 1.04, 0.38), (0.2, 1.04, 0.38), (0.36, 1.02, 0.24)], 0.1), 0.013
    )
    for s in (-1, 1):
        yield rod("rubber", (s * 0.28, 1.03, 0.31), (s * 0.38, 1.02, 0.22), 0.02)
        yield tube("chrome", [(s * 0.22, 1.04, 0.36), (s * 0.28, 1.2, 0.38)], 0.006, 6)
        yield ball("chrome", (0.06, 0.045, 0.015), (s * 0.28, 1.22, 0.38), 12, 6)
    yield rod("black", (0.16, 0.28, 0.0), (0.28, 0.0, -0.04), 0.014)


def bicycle(kind: str = "bike") -> Iterator[Solid]:
    """A bicycle or a tricycle."""
    if kind == "tricycle":
        yield from wheel(0.0, 0.16, 0.3, 0.16, 0.035, hub="white")
        for s in (-1, 1):
            yield from wheel(s * 0.19, 0.11, -0.22, 0.11, 0.035, hub="white")
        yield rod("red", (-0.19, 0.11, -0.22), (0.19, 0.11, -0.22), 0.012)
        yield tube("red", fillet([(0.0, 0.12, -0.22), (0.0, 0.24, -0.05), (0.0, 0.36, 0.22)], 0.1), 0.018)
        yield rod("red", (0.0, 0.16, 0.3), (0.0, 0.56, 0.19), 0.014)
        yield tube("chrome", fillet([(-0.17, 0.54, 0.1), (0.0, 0.58, 0.19), (0.17, 0.54, 0.1)], 0.06), 0.011)
        yield soft("black", (0.16, 0.05, 0.2), (0.0, 0.28, -0.1), 3.0, 5)
        for s in (-1, 1):
            yield rod("chrome", (0.0, 0.16, 0.3), (s * 0.1, 0.16 + 0.06 * s, 0.3), 0.006)
            yield rounded("black", (0.07, 0.02, 0.05), (s * 0.12, 0.15 + 0.06 * s, 0.3), 0.006, 1)
        return
    r, back, front_ = 0.34, -0.52, 0.54
    for z in (back, front_):
        yield from wheel(0.0, r, z, r, 0.04, 18)
    crank, seat, head = (0.0, 0.29, -0.08), (0.0, 0.82, -0.24), (0.0, 0.8, 0.36)
    for a, b in ((crank, seat), (crank, (0.0, 0.72, 0.38)), ((0.0, 0.78, -0.22), head)):
        yield rod("bright", a, b, 0.016)
    for s in (-1, 1):
        yield rod("bright", crank, (s * 0.05, r, back), 0.009)
        yield rod("bright", (0.0, 0.76, -0.22), (s * 0.05, r, back), 0.008)
        yield rod("bright", (s * 0.03, 0.68, 0.4), (s * 0.05, r, front_), 0.01)
        yield rod("chrome", (s * 0.04, 0.29, -0.08), (s * 0.08, 0.29 + s * 0.16, -0.06), 0.008)
        yield rounded("black", (0.09, 0.02, 0.08), (s * 0.13, 0.28 + s * 0.16, -0.06), 0.006, 1)
    yield rod("bright", (0.0, 0.66, 0.4), (0.0, 0.94, 0.33), 0.018)
    yield rod("chrome", seat, (0.0, 0.94, -0.28), 0.012)
    yield soft("black", (0.15, 0.06, 0.26), (0.0, 0.93, -0.26), 2.6, 6)
    yield tube(
        "chrome", fillet([(-0.28, 0.97, 0.16), (-0.2, 0.98, 0.33), (0.2, 0.98, 0.33), (0.28, 0.97, 0.16)], 0.1), 0.011
    )
    for s in (-1, 1):
        yield rod("rubber", (s * 0.265, 0.972, 0.2), (s * 0.285, 0.97, 0.1), 0.016)
    yield ring("chrome", 0.09, 0.01, (0.035, 0.29, -0.08), 0, 22)
    yield rod("black", (0.06, 0.29, -0.1), (0.2, 0.0, -0.16), 0.008)


def _step_ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("steel", (s * 0.24, 0.0, 0.42), (s * 0.17, 1.5, 0.0), 0.03, 0.06)
        yield beam("steel", (s * 0.24, 0.0, -0.4), (s * 0.17, 1.46, -0.02), 0.025, 0.04)
    for i in range(5):
        y = 0.26 + 0.28 * i
        z, w = 0.42 * (1 - y / 1.5), 0.24 - 0.07 * y / 1.5
        yield rounded("steel", (2 * w - 0.02, 0.025, 0.1), (0.0, y, z), 0.006, 1)
    yield rounded("red", (0.4, 0.03, 0.26), (0.0, 1.48, 0.0), 0.01, 1)
    for y in (0.3, 0.9):
        yield rod("steel", (-0.22, y, -0.4 * (1 - y / 1.5)), (0.22, y, -0.4 * (1 - y / 1.5)), 0.01)


def _long_ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (s * 0.2, 0.0, 0.28), (s * 0.18, 2.3, -0.28), 0.035, 0.06)
    for i in range(8):
        y = 0.2 + 0.28 * i
        z = 0.28 - 0.56 * y / 2.3
        yield rod("wood", (-0.2, y, z), (0.2, y, z), 0.016)


def _mower() -> Iterator[Solid]:
    yield rounded("red", (0.5, 0.16, 0.62), (0.0, 0.1, 0.0), 0.06, 3)
    yield turned("black", [(0.16, 0.26), (0.16, 0.36), (0.1, 0.4), (0.03, 0.42)], (0.0, 0.0, 0.05), 22, 2)
    for x, z, r in ((-0.27, 0.22, 0.09), (0.27, 0.22, 0.09), (-0.28, -0.24, 0.13), (0.28, -0.24, 0.13)):
        yield from wheel(x, r, z, r, 0.05)
    yield tube(
        "black", fillet([(-0.2, 0.2, -0.28), (-0.2, 1.0, -0.95), (0.2, 1.0, -0.95), (0.2, 0.2, -0.28)], 0.08), 0.014
    )
    yield soft("green", (0.4, 0.32, 0.42), (0.0, 0.14, -0.5), 4.0, 6)


def _tool_box() -> Iterator[Solid]:
    yield rounded("red", (0.46, 0.18, 0.22), (0.0, 0.0, 0.0), 0.012, 2)
    yield rounded("black", (0.47, 0.05, 0.23), (0.0, 0.17, 0.0), 0.012, 2)
    yield tube(
        "black", fillet([(-0.12, 0.21, 0.0), (-0.12, 0.28, 0.0), (0.12, 0.28, 0.0), (0.12, 0.21, 0.0)], 0.04), 0.012
    )
    for s in (-1, 1):
        yield rounded("chrome", (0.04, 0.06, 0.01), (s * 0.14, 0.14, 0.115), 0.003, 1)


def _helmet() -> Iterator[Solid]:
    yield turned(
        "bright",
        [(0.11, 0.0), (0.135, 0.07), (0.12, 0.16), (0.07, 0.22), (0.01, 0.24)],
        sides=26,
        steps=3,
        stretch=1.15,
    )
    yield surface(
        "screen",
        lambda u, v: (
            0.142 * np.sin(2.2 * (u - 0.5)),
            0.06 + 0.09 * v,
            1.16 * (0.142 - 0.012 * v) * np.cos(2.2 * (u - 0.5)),
        ),
        14,
        3,
        0.006,
    )
    yield turned("black", [(0.112, -0.004), (0.118, 0.012)], sides=26, steps=1, stretch=1.15)


def _barrow() -> Iterator[Solid]:
    yield from wheel(0.0, 0.18, 0.62, 0.18, 0.08)
    sides = [(-0.42, 0.42), (0.5, 0.42), (0.66, 0.68), (-0.55, 0.66)]
    yield prism("green", fillet(sides, 0.05, 3, True), 0.56, (0.0, 0.0, 0.0), "side")
    yield prism("soil", [(-0.46, 0.64), (0.58, 0.65), (0.3, 0.72), (-0.2, 0.74)], 0.5, (0.0, 0.0, 0.0), "side")
    for s in (-1, 1):
        yield tube("black", [(s * 0.06, 0.18, 0.62), (s * 0.24, 0.4, 0.1), (s * 0.28, 0.5, -0.95)], 0.018)
        yield rod("black", (s * 0.25, 0.4, -0.25), (s * 0.27, 0.0, -0.4), 0.016)
        yield rod("rubber", (s * 0.278, 0.49, -0.85), (s * 0.282, 0.505, -1.0), 0.024)


def _paint() -> Iterator[Solid]:
    for i in range(3):
        yield turned(("white", "blue", "gray")[i], [(0.085, 0.0), (0.085, 0.19)], (-0.2 + 0.2 * i, 0.0, 0.0), 22, 1)
        yield turned("chrome", [(0.088, 0.185), (0.088, 0.2), (0.075, 0.205)], (-0.2 + 0.2 * i, 0.0, 0.0), 22, 1)
        yield tube(
            "chrome",
            [
                (-0.2 + 0.2 * i + 0.088 * np.cos(a), 0.17 - 0.06 * np.sin(a), 0.03 + 0.06 * np.sin(a))
                for a in np.linspace(0, np.pi, 9)
            ],
            0.002,
            4,
        )
    yield rounded("wood", (0.03, 0.02, 0.16), (0.05, 0.205, 0.02), 0.008, 1)
    yield rounded("black", (0.07, 0.014, 0.06), (0.05, 0.206, -0.09), 0.004, 1)


_TOOLS_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "ladder": _step_ladder,
    "long": _long_ladder,
    "mower": _mower,
    "box": _tool_box,
    "helmet": _helmet,
    "barrow": _barrow,
    "paint": _paint,
}


def tools(kind: str = "ladder") -> Iterator[Solid]:
    """A step ladder, a long ladder, a mower, a tool box, a helmet, a wheelbarrow, a paint set."""
    yield from _TOOLS_KINDS[kind]()


def _round_grill() -> Iterator[Solid]:
    yield turned("iron", [(0.05, 0.5), (0.22, 0.56), (0.28, 0.7)], sides=26, steps=3)
    yield turned("iron", [(0.285, 0.71), (0.24, 0.84), (0.1, 0.92), (0.01, 0.93)], sides=26, steps=3)
    yield tube(
        "wood", fillet([(-0.06, 0.92, 0.0), (-0.06, 0.97, 0.0), (0.06, 0.97, 0.0), (0.06, 0.92, 0.0)], 0.02), 0.012
    )
    yield from around([rod("iron", (0.0, 0.0, 0.32), (0.0, 0.58, 0.16), 0.013)], 3)
    yield cylinder("gray", 0.15, 0.012, (0.0, 0.2, 0.0), sides=22)


def _gas_grill() -> Iterator[Solid]:
    yield rounded("steel", (0.75, 0.6, 0.45), (0.0, 0.14, 0.0), 0.012, 1)
    for s in (-1, 1):
        yield rounded("steel", (0.36, 0.5, 0.02), (s * 0.185, 0.17, 0.23), 0.006, 1)
        yield rounded("gray", (0.3, 0.03, 0.42), (s * 0.53, 0.86, 0.0), 0.008, 1)
    yield rounded("black", (0.78, 0.14, 0.5), (0.0, 0.74, 0.0), 0.015, 1)
    lid = [(-0.25, 0.0), (0.25, 0.0), (0.2, 0.2), (-0.05, 0.26), (-0.22, 0.2)]
    yield prism("black", fillet(lid, 0.07, 4, True), 0.76, (0.0, 0.89, 0.0), "side")
    yield rod("chrome", (-0.28, 1.0, 0.28), (0.28, 1.0, 0.28), 0.014)
    for i in range(4):
        yield disc("chrome", 0.03, 0.03, ((i - 1.5) * 0.17, 0.81, 0.25), 18)
    for x, z in corners(0.66, 0.36):
        yield ball("rubber", 0.06, (x, 0.06, z), 12, 8)


def _stone_grill() -> Iterator[Solid]:
    for s in (-1, 1):
        yield box("masonry", (0.22, 1.0, 0.6), (s * 0.48, 0.0, 0.0))
    yield box("masonry", (0.74, 1.0, 0.14), (0.0, 0.0, -0.23))
    yield rounded("stone", (0.78, 0.06, 0.62), (0.0, 0.62, 0.0), 0.01, 1)
    for i in range(14):
        yield rod("iron", ((i - 6.5) * 0.052, 0.84, -0.18), ((i - 6.5) * 0.052, 0.84, 0.3), 0.005, sides=6)
    yield prism(
        "masonry",
        [(-0.59, 1.0), (0.59, 1.0), (0.25, 1.6), (0.25, 2.0), (-0.25, 2.0), (-0.25, 1.6)],
        0.3,
        (0.0, 0.0, -0.15),
    )


def _parasol(kind: str) -> Iterator[Solid]:
    yield turned("concrete", [(0.26, 0.0), (0.25, 0.08), (0.05, 0.12)], sides=22, steps=1)
    yield rod("wood", (0.0, 0.05, 0.0), (0.0, 2.45, 0.0), 0.022, sides=10)
    count = 8
    for i in range(count):
        a, b = 2 * np.pi * i / count, 2 * np.pi * (i + 1) / count

        def gore(u: np.ndarray, v: np.ndarray, a: float = a, b: float = b) -> tuple[np.ndarray, ...]:
            r = 0.03 + 1.35 * v
            t = a + (b - a) * u
            flat = np.cos((b - a) / 2) / np.cos(t - (a + b) / 2)
            return r * flat * np.cos(t), 2.45 - 0.5 * v**1.3 - 0.05 * v * np.sin(np.pi * u), r * flat * np.sin(t)

        yield surface("textile" if i % 2 or kind == "parasol" else "white", gore, 4, 5, 0.008)
        yield rod(
            "wood",
            (0.03 * np.cos(a), 2.38, 0.03 * np.sin(a)),
            (1.36 * np.cos(a), 1.93, 1.36 * np.sin(a)),
            0.008,
            sides=6,
        )
        yield rod(
            "wood",
            (0.03 * np.cos(a), 1.85, 0.03 * np.sin(a)),
            (0.7 * np.cos(a), 2.15, 0.7 * np.sin(a)),
            0.007,
            sides=6,
        )
    yield ball("wood", 0.035, (0.0, 2.48, 0.0), 12, 8)


def _pool() -> Iterator[Solid]:
    yield turned("blue", [(1.5, 0.0), (1.56, 0.3), (1.5, 0.62)], sides=44, steps=3)
    yield ring("white", 1.5, 0.12, (0.0, 0.62, 0.0), 1, 44)
    yield cylinder("blue", 1.44, 0.04, (0.0, 0.6, 0.0), sides=44)
    for s in (-1, 1):
        yield rod("chrome", (1.5, 0.0, s * 0.2), (1.45, 1.1, s * 0.2), 0.02)
    for i in range(3):
        yield rounded("white", (0.08, 0.02, 0.4), (1.63 - 0.04 * i, 0.2 + 0.25 * i, 0.0), 0.006, 1)


def _letter_box() -> Iterator[Solid]:
    yield beam("wood", (0.0, 0.0, 0.0), (0.0, 1.05, 0.0), 0.09)
    half = [
        (-0.1, 0.0),
        (0.1, 0.0),
        *[(0.1 * np.cos(a), 0.12 + 0.1 * np.sin(a)) for a in np.linspace(0, np.pi, 12)],
    ]
    yield prism("red", half, 0.46, (0.0, 1.04, 0.05))
    yield prism("black", [(0.9 * x, 0.9 * y) for x, y in half], 0.012, (0.0, 1.05, 0.282))
    yield rounded("yellow", (0.012, 0.16, 0.05), (0.108, 1.14, 0.0), 0.004, 1)
    yield rounded("chrome", (0.05, 0.02, 0.02), (0.0, 1.2, 0.29), 0.006, 1)


def _wall_box() -> Iterator[Solid]:
    yield rounded("black", (0.34, 0.3, 0.12), (0.0, 0.0, 0.0), 0.015, 2)
    yield rotate(rounded("black", (0.36, 0.02, 0.15), (0.0, 0.29, 0.015), 0.008, 1), 0, 0.15, (0.0, 0.29, 0.0))
    yield box("gray", (0.22, 0.02, 0.006), (0.0, 0.22, 0.061))
    yield disc("brass", 0.012, 0.01, (0.0, 0.1, 0.06), 14)
    yield rounded("white", (0.16, 0.06, 0.006), (0.0, 0.14, 0.06), 0.003, 1)


def _hoop() -> Iterator[Solid]:
    yield rounded("black", (0.7, 0.14, 0.5), (0.0, 0.0, -0.4), 0.05, 2)
    yield rod("gray", (0.0, 0.12, -0.4), (0.0, 2.3, -0.4), 0.04, sides=12)
    yield beam("gray", (0.0, 2.25, -0.4), (0.0, 2.4, -0.02), 0.05)
    yield rounded("white", (1.0, 0.7, 0.03), (0.0, 2.1, 0.0), 0.01, 1)
    for y in (2.2, 2.52):
        yield box("red", (0.44, 0.02, 0.006), (0.0, y, 0.017))
    for s in (-1, 1):
        yield box("red", (0.02, 0.34, 0.006), (s * 0.22, 2.2, 0.017))
    yield ring("orange", 0.225, 0.022, (0.0, 2.2, 0.27), 1, 26)
    for i in range(12):
        a, b = 2 * np.pi * i / 12, 2 * np.pi * (i + 1) / 12
        yield rod(
            "white",
            (0.225 * np.cos(a), 2.2, 0.27 + 0.225 * np.sin(a)),
            (0.13 * np.cos(b), 1.85, 0.27 + 0.13 * np.sin(b)),
            0.004,
            sides=4,
        )
        yield rod(
            "white",
            (0.225 * np.cos(b), 2.2, 0.27 + 0.225 * np.sin(b)),
            (0.13 * np.cos(a), 1.85, 0.27 + 0.13 * np.sin(a)),
            0.004,
            sides=4,
        )


_GARDEN_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "kettle": _round_grill,
    "gas": _gas_grill,
    "stone": _stone_grill,
    "parasol": partial(_parasol, "parasol"),
    "beach": partial(_parasol, "beach"),
    "pool": _pool,
    "letter": _letter_box,
    "box": _wall_box,
    "hoop": _hoop,
}


def garden(kind: str = "kettle") -> Iterator[Solid]:
    """A round grill, a gas grill, a stone grill; parasols; a pool; a letter box; a hoop."""
    yield from _GARDEN_KINDS[kind]()


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


FAMILIES = (
    Family(
        "gym",
        "gym_equipment",
        _of(gym, "treadmill", "bench", "bike", "rower", "dumbbells", "mat", "bag", "cross", "rack", "kettlebells"),
    ),
    Family("car", "car", _of(car, "saloon", "hatch", "jeep", "van")),
    Family("motorcycle", "motorcycle", _of(motorcycle, "road", "scooter")),
    Family("bicycle", "bicycle", _of(bicycle, "bike")),
    Family("tricycle", "tricycle", _of(bicycle, "tricycle")),
    Family("ladder", "ladder", _of(tools, "ladder", "long")),
    Family("lawn_mower", "lawn_mower", _of(tools, "mower")),
    Family("tool_box", "household_appliance", _of(tools, "box", "paint")),
    Family("helmet", "helmet", _of(tools, "helmet")),
    Family("barrow", "cart", _of(tools, "barrow")),
    Family("grill", "grill", _of(garden, "kettle", "gas", "stone")),
    Family("parasol", "umbrella", _of(garden, "parasol", "beach")),
    Family("pool", "pool", _of(garden, "pool")),
    Family("mailbox", "mailbox", _of(garden, "letter")),
    Family("wall_mailbox", "mailbox", _of(garden, "box")),
    Family("hoop", "basketball_hoop", _of(garden, "hoop")),
)
