"""Table, floor, ceiling, wall and outdoor lamps; each gives light where its bulbs are."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.groups import Piece, around, moved, turned_about
from home_mjx.datasets.homes.shapes.soft import ball, between_loops, rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import shade, turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc, foot_plate
from home_mjx.datasets.procedural.primitives.family import Bulb
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder


def bulb(
    y: float, power: float, x: float = 0.0, z: float = 0.0, radius: float = 0.03, light: float | None = None
) -> Iterator[Piece]:
    """A bulb at height y; its light comes from `light`, by default just above it [m]."""
    yield turned(
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


def _table_foot(kind: str, high: float) -> Iterator[Solid]:
    """What carries a table lamp's shade, up to a height."""
    shapes = {
        "gourd": [(0.07, 0.0), (0.08, 0.02), (0.1, 0.1), (0.05, 0.18), (0.065, 0.23), (0.03, 0.28)],
        "urn": [(0.06, 0.0), (0.06, 0.015), (0.025, 0.03), (0.085, 0.14), (0.06, 0.24), (0.03, 0.28)],
        "bottle": [(0.07, 0.0), (0.085, 0.03), (0.085, 0.14), (0.03, 0.22), (0.025, 0.28)],
    }
    if kind in shapes:
        yield turned(
            "glaze" if kind != "bottle" else "tint",
            [(r, h * (high - 0.05) / 0.28) for r, h in shapes[kind]],
            sides=22,
            steps=3,
        )
        yield cylinder("brass", 0.02, 0.07, (0.0, high - 0.06, 0.0), sides=12)
    elif kind == "column":
        yield rounded("marble", (0.13, 0.025, 0.13), (0.0, 0.0, 0.0), 0.006, 1)
        yield cylinder("brass", 0.014, high, (0.0, 0.02, 0.0), sides=12)
    elif kind == "cube":
        for i in range(3):
            yield rounded(
                "wood",
                (0.11 - 0.012 * i, (high - 0.05) / 3, 0.11 - 0.012 * i),
                (0.0, i * (high - 0.05) / 3, 0.0),
                0.012,
                2,
            )
        yield cylinder("brass", 0.014, 0.07, (0.0, high - 0.06, 0.0), sides=12)
    elif kind == "tripod":
        yield from around([rod("wood", (0.0, 0.0, 0.13), (0.0, high - 0.02, 0.015), 0.012, 0.01)], 3)
        yield cylinder("brass", 0.028, 0.04, (0.0, high - 0.04, 0.0), sides=14)
    else:
        for i in range(5):
            yield ball(
                "glass" if kind == "beads" else "glaze",
                0.055 - 0.004 * i,
                (0.0, 0.05 + 0.055 * i * high / 0.28, 0.0),
                16,
                10,
            )
        yield cylinder("brass", 0.01, high, (0.0, 0.0, 0.0), sides=10)
        yield foot_plate("brass", 0.07, 0.015)


def table_lamp(foot: str = "gourd", top: str = "drum", high: float = 0.28) -> Iterator[Piece]:
    """A foot, a shade and a bulb."""
    yield from _table_foot(foot, high)
    profiles = {
        "drum": [(0.15, 0.0), (0.15, 0.2)],
        "cone": [(0.17, 0.0), (0.09, 0.2)],
        "bell": [(0.17, 0.0), (0.12, 0.06), (0.09, 0.14), (0.075, 0.2)],
        "empire": [(0.19, 0.0), (0.1, 0.17)],
    }
    if top == "pleated":
        angle = 2 * np.pi * np.arange(48) / 48
        wave = 1 + 0.05 * (np.arange(48) % 2)
        rings_ = [
            np.stack([r * wave * np.cos(angle), np.full(48, high - 0.02 + y), r * wave * np.sin(angle)], -1)
            for r, y in ((0.17, 0.0), (0.1, 0.19), (0.095, 0.19), (0.165, 0.0))
        ]
        yield between_loops("shade", rings_, closed=True)
    else:
        yield shade("shade", profiles[top], (0.0, high - 0.02, 0.0), sides=28, steps=2)
    yield from bulb(high + 0.07, 25.0)


def _arm() -> Iterator[Piece]:
    yield foot_plate("paint", 0.1, 0.025)
    yield rod("paint", (0.0, 0.02, 0.0), (0.0, 0.24, -0.12), 0.009)
    yield rod("paint", (0.0, 0.24, -0.12), (0.0, 0.44, 0.06), 0.009)
    yield ball("chrome", 0.018, (0.0, 0.24, -0.12), 10, 6)
    yield ball("chrome", 0.018, (0.0, 0.44, 0.06), 10, 6)
    head = [
        shade("paint", [(0.085, 0.0), (0.06, 0.07), (0.025, 0.11)], (0.0, 0.3, 0.12), 0.004, 22, 2),
        *bulb(0.34, 25.0, 0.0, 0.12, light=0.29),
    ]
    yield from turned_about(head, 0, -0.35, (0.0, 0.42, 0.1))
    for z in (-0.02, 0.02):
        yield rod("chrome", (0.012, 0.1, -0.05 + z), (0.012, 0.2, -0.1 + z), 0.003, sides=5)


def _banker() -> Iterator[Piece]:
    yield foot_plate("brass", 0.09, 0.025)
    yield turned("brass", [(0.03, 0.02), (0.012, 0.06), (0.012, 0.24), (0.02, 0.26)], sides=14, steps=2)
    yield tube("brass", fillet([(0.0, 0.25, 0.0), (0.0, 0.34, -0.02), (0.0, 0.36, 0.02)], 0.04), 0.008)
    half = [(0.075 * np.cos(a), 0.075 * np.sin(a)) for a in np.linspace(0, np.pi, 12)]
    inner = [(0.069 * np.cos(a), 0.069 * np.sin(a)) for a in np.linspace(np.pi, 0, 12)]
    yield prism("green", [*half, *inner], 0.26, (0.0, 0.3, 0.02), "side")
    yield tube("bulb", [(-0.08, 0.325, 0.02), (0.08, 0.325, 0.02)], 0.018)
    yield Bulb((0.0, 0.28, 0.02), 25.0)


def _mushroom() -> Iterator[Piece]:
    yield turned("opal", [(0.08, 0.0), (0.05, 0.03), (0.035, 0.12), (0.05, 0.2)], sides=22, steps=3)
    yield turned("opal", [(0.05, 0.19), (0.15, 0.2), (0.14, 0.25), (0.08, 0.3), (0.02, 0.315)], sides=28, steps=3)
    yield Bulb((0.0, 0.34, 0.0), 25.0)


def _ball() -> Iterator[Piece]:
    yield turned("wood", [(0.08, 0.0), (0.075, 0.025), (0.05, 0.035)], sides=22, steps=1)
    yield ball("opal", 0.12, (0.0, 0.14, 0.0), 24, 14)
    yield Bulb((0.0, 0.28, 0.0), 20.0)


def _bent_tube() -> Iterator[Piece]:
    yield foot_plate("black", 0.09, 0.015)
    yield tube("black", fillet([(0.0, 0.01, -0.06), (0.0, 0.4, -0.06), (0.0, 0.4, 0.16)], 0.1, 6), 0.009)
    yield rounded("black", (0.05, 0.014, 0.2), (0.0, 0.39, 0.1), 0.006, 1)
    yield box("bulb", (0.04, 0.004, 0.18), (0.0, 0.387, 0.1))
    yield Bulb((0.0, 0.36, 0.1), 20.0)


_DESK_LAMP_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "arm": _arm,
    "banker": _banker,
    "mushroom": _mushroom,
    "ball": _ball,
    "tube": _bent_tube,
}


def desk_lamp(kind: str = "arm") -> Iterator[Piece]:
    """A jointed arm, a banker's lamp, a mushroom, a glowing ball, a bent tube."""
    yield from _DESK_LAMP_KINDS[kind]()


def _shaded_pole(kind: str) -> Iterator[Piece]:
    yield foot_plate("brass" if kind != "basket" else "black", 0.15, 0.025)
    yield cylinder("brass" if kind != "basket" else "black", 0.012, 1.35, (0.0, 0.02, 0.0), sides=10)
    if kind == "basket":
        for i in range(5):
            yield ring("cane", 0.2 - 0.035 * abs(i - 1.2), 0.022, (0.0, 1.2 + 0.085 * i, 0.0), 1, 22)
        for i in range(18):
            a = 2 * np.pi * i / 18
            yield tube(
                "cane",
                [
                    (
                        (0.2 - 0.035 * abs(k - 1.2)) * np.cos(a),
                        1.2 + 0.085 * k,
                        (0.2 - 0.035 * abs(k - 1.2)) * np.sin(a),
                    )
                    for k in range(5)
                ],
                0.005,
                5,
            )
    else:
        yield shade("shade", [(0.22, 0.0), (0.15 if kind == "pole" else 0.22, 0.28)], (0.0, 1.25, 0.0), sides=28)
    if kind == "tray":
        yield cylinder("wood", 0.19, 0.02, (0.0, 0.55, 0.0), sides=26)
    yield from bulb(1.38, 40.0)


def _tripod() -> Iterator[Piece]:
    yield from around([rod("wood", (0.0, 0.0, 0.34), (0.0, 1.2, 0.03), 0.02, 0.015, 10)], 3)
    yield cylinder("brass", 0.05, 0.06, (0.0, 1.17, 0.0), sides=16)
    yield from around([rod("brass", (0.0, 0.55, 0.2), (0.0, 0.55, 0.0), 0.005, sides=6)], 3)
    yield shade("shade", [(0.26, 0.0), (0.24, 0.3)], (0.0, 1.2, 0.0), sides=28)
    yield from bulb(1.35, 40.0)


def _arc() -> Iterator[Piece]:
    yield rounded("marble", (0.3, 0.1, 0.2), (0.0, 0.0, -0.7), 0.02, 1)
    yield tube(
        "chrome",
        spline([(0.0, 0.08, -0.7), (0.0, 1.2, -0.75), (0.0, 1.85, -0.4), (0.0, 1.95, 0.1), (0.0, 1.75, 0.5)], 6),
        0.012,
    )
    yield from moved(
        [
            turned("chrome", [(0.19, 0.0), (0.17, 0.08), (0.1, 0.15), (0.02, 0.17), (0.02, 0.19)], sides=26, steps=2),
            *bulb(-0.005, 40.0, light=-0.06),
        ],
        0.0,
        1.6,
        0.5,
    )


def _torch() -> Iterator[Piece]:
    yield foot_plate("black", 0.15, 0.03)
    yield cylinder("black", 0.014, 1.65, (0.0, 0.02, 0.0), sides=10)
    yield vessel("opal", [(0.03, 0.0), (0.1, 0.04), (0.16, 0.12)], 0.005, (0.0, 1.64, 0.0), 26, 3)
    yield from bulb(1.72, 60.0, light=1.82)
    yield tube("black", fillet([(0.0, 1.2, 0.0), (0.0, 1.2, 0.12), (0.0, 1.12, 0.22)], 0.06), 0.007)
    yield shade("opal", [(0.07, 0.0), (0.03, 0.09)], (0.0, 1.03, 0.24), 0.004, 18)


def _paper() -> Iterator[Piece]:
    for s in (-1, 1):
        for t in (-1, 1):
            yield box("wood", (0.02, 1.2, 0.02), (s * 0.12, 0.0, t * 0.12))
    for y in (0.04, 0.6, 1.16):
        for s in (-1, 1):
            yield box("wood", (0.24, 0.015, 0.015), (0.0, y, s * 0.12))
            yield box("wood", (0.015, 0.015, 0.24), (s * 0.12, y, 0.0))
    yield rounded("opal", (0.22, 1.1, 0.22), (0.0, 0.06, 0.0), 0.02, 2)
    yield Bulb((0.0, 1.26, 0.0), 40.0)


def _spots() -> Iterator[Piece]:
    yield foot_plate("white", 0.15, 0.025)
    yield cylinder("chrome", 0.014, 1.6, (0.0, 0.02, 0.0), sides=10)
    for i, turn in enumerate((0.4, 2.6, 4.6)):
        spot = [
            shade("paint", [(0.07, -0.02), (0.06, 0.08), (0.02, 0.13)], (0.0, 0.0, 0.1), 0.004, 18, 2),
            rod("chrome", (0.0, 0.06, 0.0), (0.0, 0.08, 0.09), 0.006),
            *bulb(0.02, 20.0, 0.0, 0.1, light=-0.05),
        ]
        yield from moved(turned_about(spot, 1, turn), 0.0, 1.1 + 0.2 * i, 0.0)


def _reading() -> Iterator[Piece]:
    yield foot_plate("brass", 0.13, 0.02)
    yield cylinder("brass", 0.01, 1.1, (0.0, 0.02, 0.0), sides=10)
    yield tube("brass", fillet([(0.0, 1.1, 0.0), (0.0, 1.3, 0.02), (0.0, 1.3, 0.2), (0.0, 1.2, 0.26)], 0.1, 5), 0.008)
    yield from moved(
        [
            shade("brass", [(0.09, 0.0), (0.08, 0.04), (0.03, 0.1)], (0.0, 0.0, 0.0), 0.004, 22, 2),
            *bulb(0.03, 25.0, light=-0.04),
        ],
        0.0,
        1.11,
        0.28,
    )


def _cones() -> Iterator[Piece]:
    yield foot_plate("black", 0.16, 0.02)
    for i in range(3):
        a = 2 * np.pi * i / 3
        x, z, y = 0.12 * np.cos(a), 0.12 * np.sin(a), 1.1 + 0.2 * i
        yield tube(
            "brass",
            spline([(0.03 * np.cos(a), 0.02, 0.03 * np.sin(a)), (0.3 * x, 0.7, 0.3 * z), (x, y - 0.06, z)], 4),
            0.006,
            6,
        )
        yield ball("opal", 0.085, (x, y + 0.02, z), 18, 12)
        yield Bulb((x, y + 0.13, z), 15.0)


def _urn() -> Iterator[Piece]:
    yield turned(
        "glaze",
        [(0.16, 0.0), (0.18, 0.03), (0.1, 0.12), (0.16, 0.4), (0.06, 0.62), (0.03, 0.66)],
        sides=24,
        steps=3,
    )
    yield cylinder("brass", 0.012, 0.42, (0.0, 0.64, 0.0), sides=10)
    yield shade("shade", [(0.28, 0.0), (0.22, 0.1), (0.17, 0.3)], (0.0, 0.95, 0.0), sides=28, steps=2)
    yield from bulb(1.1, 40.0)


_FLOOR_LAMP_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "pole": partial(_shaded_pole, "pole"),
    "tray": partial(_shaded_pole, "tray"),
    "basket": partial(_shaded_pole, "basket"),
    "tripod": _tripod,
    "arc": _arc,
    "torch": _torch,
    "paper": _paper,
    "spots": _spots,
    "reading": _reading,
    "cones": _cones,
    "urn": _urn,
}


def floor_lamp(kind: str = "pole") -> Iterator[Piece]:
    """Pole, tripod, arc, torch, tray, paper column, spots, reading arm, balls on stems, basket, urn."""
    yield from _FLOOR_LAMP_KINDS[kind]()


def _hang(drop: float, slot: str = "black") -> Iterator[Solid]:
    """A ceiling rose at height `drop` and a cord down to 0.2."""
    yield turned(slot, [(0.02, drop - 0.035), (0.055, drop - 0.02), (0.055, drop)], sides=18, steps=1)
    yield cylinder(slot, 0.005, drop - 0.22, (0.0, 0.2, 0.0), sides=6)


def _dome() -> Iterator[Piece]:
    yield shade(
        "paint", [(0.22, 0.0), (0.2, 0.07), (0.13, 0.15), (0.03, 0.19), (0.02, 0.23)], (0.0, 0.0, 0.0), 0.005, 28, 3
    )
    yield from bulb(0.07, 60.0, light=0.0)


def _globe() -> Iterator[Piece]:
    yield ball("opal", 0.15, (0.0, 0.15, 0.0), 26, 16)
    yield cylinder("brass", 0.04, 0.03, (0.0, 0.28, 0.0), sides=16)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _drum() -> Iterator[Piece]:
    yield shade("shade", [(0.25, 0.0), (0.25, 0.2)], sides=32)
    yield cylinder("opal", 0.243, 0.008, (0.0, 0.012, 0.0), sides=32)
    yield from (
        rod("black", (0.0, 0.22, 0.0), (0.24 * np.cos(a), 0.195, 0.24 * np.sin(a)), 0.004, sides=5)
        for a in (0.0, 2.1, 4.2)
    )
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _cone() -> Iterator[Piece]:
    yield shade("brass", [(0.14, 0.0), (0.03, 0.26)], (0.0, 0.0, 0.0), 0.004, 26)
    yield from bulb(0.06, 40.0, light=0.0)


def _cage() -> Iterator[Piece]:
    for i in range(8):
        a = 2 * np.pi * i / 8
        c, s = np.cos(a), np.sin(a)
        yield tube(
            "iron",
            [
                (0.03 * c, 0.27, 0.03 * s),
                (0.12 * c, 0.2, 0.12 * s),
                (0.14 * c, 0.1, 0.14 * s),
                (0.06 * c, 0.0, 0.06 * s),
            ],
            0.005,
            6,
        )
    for r, y in ((0.06, 0.0), (0.14, 0.1)):
        yield ring("iron", r, 0.01, (0.0, y, 0.0), 1, 24)
    yield cylinder("brass", 0.025, 0.09, (0.0, 0.18, 0.0), sides=12)
    yield from bulb(0.14, 60.0, radius=0.05, light=0.05)


def _basket() -> Iterator[Piece]:
    for k in range(8):
        y, r = 0.035 * k, 0.28 * np.sqrt(max(1 - (k / 8.2) ** 2, 0))
        yield ring("cane", r, 0.03, (0.0, y + 0.015, 0.0), 1, 26)
    yield from bulb(0.1, 60.0, light=0.0)


def _lantern() -> Iterator[Piece]:
    for x in (-0.11, 0.11):
        for z in (-0.11, 0.11):
            yield box("iron", (0.014, 0.3, 0.014), (x, 0.0, z))
    for y in (0.0, 0.29):
        yield from (box("iron", (0.234, 0.014, 0.014), (0.0, y, s * 0.11)) for s in (-1, 1))
        yield from (box("iron", (0.014, 0.014, 0.234), (s * 0.11, y, 0.0)) for s in (-1, 1))
    yield from (box("glass", (0.21, 0.28, 0.004), (0.0, 0.012, s * 0.11)) for s in (-1, 1))
    yield turned("iron", [(0.155, 0.3), (0.03, 0.4), (0.01, 0.42)], sides=4, steps=1)
    yield from (cylinder("cream", 0.012, 0.1, (x, 0.06, 0.0), sides=10) for x in (-0.04, 0.04))
    yield from bulb(0.19, 60.0, light=-0.03)


def _artichoke() -> Iterator[Piece]:
    for row in range(6):
        for i in range(12):
            a = 2 * np.pi * (i + 0.5 * (row % 2)) / 12
            r, y = 0.06 + 0.16 * np.sin(np.pi * (row + 1) / 7), 0.05 * row + 0.02
            yield beam(
                "brass",
                (r * np.cos(a), y + 0.05, r * np.sin(a)),
                ((r + 0.05) * np.cos(a), y - 0.02, (r + 0.05) * np.sin(a)),
                0.075,
                0.003,
            )
    yield ball("opal", 0.07, (0.0, 0.14, 0.0), 14, 10)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _paper_pendant() -> Iterator[Piece]:
    for k in range(12):
        y = np.linspace(-0.19, 0.19, 12)[k]
        yield ring("opal", np.sqrt(0.2**2 - y**2), 0.034, (0.0, 0.2 + y, 0.0), 1, 26)
    yield cylinder("opal", 0.06, 0.02, (0.0, 0.006, 0.0), sides=18)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _ring() -> Iterator[Piece]:
    yield ring("brass", 0.32, 0.04, (0.0, 0.03, 0.0), 1, 40)
    yield ring("opal", 0.32, 0.03, (0.0, 0.016, 0.0), 1, 40)
    yield from (
        rod("brass", (0.0, 0.4, 0.0), (0.32 * np.cos(a), 0.04, 0.32 * np.sin(a)), 0.003, sides=5)
        for a in (0.5, 2.6, 4.7)
    )
    for a in (0.0, np.pi):
        yield Bulb((0.25 * np.cos(a), -0.03, 0.0), 30.0)


_PENDANT_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "dome": _dome,
    "globe": _globe,
    "drum": _drum,
    "cone": _cone,
    "cage": _cage,
    "basket": _basket,
    "lantern": _lantern,
    "artichoke": _artichoke,
    "paper": _paper_pendant,
    "ring": _ring,
}


def pendant(kind: str = "dome", drop: float = 0.75) -> Iterator[Piece]:
    """A lamp that hangs from a cord: dome, globe, drum, cone, cage, basket, lantern, artichoke, paper ball, ring."""
    yield from _hang(drop, "brass" if kind in ("globe", "ring", "cage") else "black")
    yield from _PENDANT_KINDS[kind]()


def chandelier(kind: str = "arms", drop: float = 0.9, count: int = 6) -> Iterator[Piece]:
    """Several lights: arms with candles, crystal drops, a wheel, branches with balls, a row of domes."""
    yield turned("brass", [(0.02, drop - 0.04), (0.06, drop - 0.02), (0.06, drop)], sides=18, steps=1)
    if kind == "row":
        yield beam("wood", (-0.5, drop - 0.06, 0.0), (0.5, drop - 0.06, 0.0), 0.05, 0.04)
        for x in (-0.38, 0.0, 0.38):
            yield cylinder("black", 0.004, drop - 0.3, (x, 0.22, 0.0), sides=6)
            yield shade("tint", [(0.12, 0.0), (0.1, 0.1), (0.03, 0.18), (0.02, 0.22)], (x, 0.0, 0.0), 0.004, 22, 3)
            yield from bulb(0.09, 25.0, x, light=0.02)
        return
    yield cylinder("brass", 0.008, drop - 0.42, (0.0, 0.4, 0.0), sides=8)
    if kind == "wheel":
        yield ring("wood", 0.38, 0.05, (0.0, 0.06, 0.0), 1, 36)
        yield from (
            rod("iron", (0.0, 0.42, 0.0), (0.38 * np.cos(a), 0.08, 0.38 * np.sin(a)), 0.006, sides=6)
            for a in np.arange(4) * np.pi / 2
        )
        for i in range(8):
            a = 2 * np.pi * i / 8
            yield cylinder("cream", 0.016, 0.09, (0.38 * np.cos(a), 0.08, 0.38 * np.sin(a)), sides=10)
            yield from bulb(0.2, 10.0, 0.38 * np.cos(a), 0.38 * np.sin(a), 0.018)
        return
    yield turned(
        "brass",
        [(0.01, 0.0), (0.035, 0.05), (0.015, 0.12), (0.05, 0.2), (0.015, 0.3), (0.03, 0.36), (0.01, 0.42)],
        sides=18,
        steps=3,
    )
    for i in range(count):
        a = 2 * np.pi * i / count
        c, s = np.cos(a), np.sin(a)
        if kind == "branches":
            y = 0.1 + 0.16 * (i % 3)
            reach = 0.3 + 0.08 * (i % 2)
            yield rod("brass", (0.0, y, 0.0), (reach * c, y + 0.02, reach * s), 0.008)
            yield ball("opal", 0.075, ((reach + 0.07) * c, y + 0.02, (reach + 0.07) * s), 16, 10)
            yield Bulb(((reach + 0.07) * c, y - 0.08, (reach + 0.07) * s), 10.0)
            continue
        arm = [(0.02, 0.16), (0.16, 0.04), (0.3, 0.08), (0.32, 0.2)]
        yield tube("brass", [(r * c, y, r * s) for r, y in spline(arm, 4)], 0.009)
        yield turned("brass", [(0.01, 0.19), (0.04, 0.21), (0.042, 0.22)], (0.32 * c, 0.0, 0.32 * s), 14, 1)
        if kind == "shades":
            yield shade("shade", [(0.075, 0.0), (0.045, 0.1)], (0.32 * c, 0.26, 0.32 * s), 0.004, 18)
        yield cylinder("cream", 0.013, 0.09, (0.32 * c, 0.21, 0.32 * s), sides=10)
        yield from bulb(0.325, 12.0, 0.32 * c, 0.32 * s, 0.018)
        if kind == "crystal":
            for k in range(5):
                t = 0.1 + 0.2 * k
                r, y = 0.3 * (1 - t) + 0.05, 0.2 + 0.2 * t - 0.12 * np.sin(np.pi * t)
                yield ball("glass", (0.012, 0.02, 0.012), (r * c, y - 0.02, r * s), 6, 4)
            yield ball("glass", (0.014, 0.03, 0.014), (0.32 * c, 0.15, 0.32 * s), 6, 4)


def _bowl() -> Iterator[Piece]:
    yield turned("opal", [(0.03, 0.0), (0.14, 0.02), (0.2, 0.08)], sides=30, steps=3)
    yield turned("chrome", [(0.205, 0.075), (0.215, 0.085), (0.2, 0.1)], sides=30, steps=1)
    yield ball("chrome", 0.012, (0.0, 0.0, 0.0), 10, 6)
    yield Bulb((0.0, -0.04, 0.0), 60.0)


def _square() -> Iterator[Piece]:
    yield rounded("opal", (0.4, 0.06, 0.4), (0.0, 0.0, 0.0), 0.02, 2)
    yield rounded("wood", (0.44, 0.04, 0.44), (0.0, 0.05, 0.0), 0.008, 1)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _disc() -> Iterator[Piece]:
    yield turned("opal", [(0.22, 0.0), (0.24, 0.015), (0.24, 0.04)], sides=36, steps=2)
    yield turned("black", [(0.25, 0.02), (0.25, 0.05), (0.2, 0.06)], sides=36, steps=1)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def _rail() -> Iterator[Piece]:
    yield rounded("white", (1.0, 0.03, 0.04), (0.0, 0.14, 0.0), 0.006, 1)
    for i in range(4):
        x = -0.39 + 0.26 * i
        yield rod("white", (x, 0.09, 0.0), (x, 0.145, 0.0), 0.008)
        spot = [
            shade("white", [(0.04, -0.06), (0.035, 0.04), (0.02, 0.06)], (0.0, 0.0, 0.0), 0.004, 16, 1),
            *bulb(-0.03, 15.0, radius=0.02, light=-0.09),
        ]
        yield from moved(turned_about(spot, 0, 0.4 * (-1) ** i), x, 0.065, 0.0)


def _cluster() -> Iterator[Piece]:
    yield turned("brass", [(0.12, 0.2), (0.12, 0.22), (0.05, 0.23)], sides=26, steps=1)
    for i in range(5):
        a = 2 * np.pi * i / 5
        x, z, y = 0.16 * np.cos(a), 0.16 * np.sin(a), 0.08 + 0.03 * (i % 2)
        yield rod("brass", (0.4 * x, 0.21, 0.4 * z), (x, y, z), 0.007)
        yield ball("opal", 0.07, (x, y, z), 16, 10)
        yield Bulb((x, y - 0.1, z), 12.0)


_CEILING_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "bowl": _bowl,
    "square": _square,
    "disc": _disc,
    "rail": _rail,
    "cluster": _cluster,
}


def ceiling(kind: str = "bowl") -> Iterator[Piece]:
    """Close under the ceiling: a bowl, a square, a ring, a rail with spots, a cluster."""
    yield from _CEILING_KINDS[kind]()


_BACK = -0.09  # [m], where a wall lamp meets its wall


def _cone_wall_lamp() -> Iterator[Piece]:
    yield vessel("paint", [(0.03, 0.0), (0.05, 0.08), (0.09, 0.2)], 0.005, (0.0, 0.0, 0.0), 22, 2)
    yield rounded("paint", (0.06, 0.1, 0.05), (0.0, 0.03, -0.065), 0.01, 1)
    yield from bulb(0.14, 40.0, light=0.24)


def _on_arms(kind: str) -> Iterator[Piece]:
    for x in (0.0,) if kind == "shade" else (-0.09, 0.09):
        yield rounded("brass", (0.07, 0.12, 0.015), (0.0, 0.06, _BACK), 0.006, 2)
        yield tube("brass", fillet([(0.0, 0.11, _BACK), (x, 0.06, 0.0), (x, 0.13, 0.0)], 0.05, 4), 0.007)
        yield turned("brass", [(0.01, 0.12), (0.03, 0.13), (0.03, 0.14)], (x, 0.0, 0.0), 14, 1)
        yield cylinder("cream", 0.012, 0.07, (x, 0.13, 0.0), sides=10)
        yield from bulb(0.22, 25.0, x, 0.0, 0.018)
        if kind == "shade":
            yield shade("shade", [(0.085, 0.0), (0.055, 0.12)], (x, 0.16, 0.0), 0.004, 20)


def _bulkhead() -> Iterator[Piece]:
    yield disc("white", 0.12, 0.03, (0.0, 0.12, _BACK), 26)
    yield ball("opal", (0.1, 0.1, 0.07), (0.0, 0.12, -0.055), 20, 12)
    for t in (-0.05, 0.05):
        yield tube(
            "white",
            [(0.1 * np.cos(a), 0.12 + t, -0.06 + 0.08 * np.sin(a)) for a in np.linspace(0, np.pi, 10)],
            0.006,
            6,
        )
    yield Bulb((0.0, 0.12, 0.06), 40.0)


def _swing() -> Iterator[Piece]:
    yield rounded("black", (0.06, 0.16, 0.02), (0.0, 0.0, -0.2), 0.008, 1)
    yield rod("black", (0.0, 0.08, -0.19), (0.12, 0.08, -0.05), 0.008)
    yield rod("black", (0.12, 0.08, -0.05), (-0.02, 0.08, 0.1), 0.008)
    yield ball("brass", 0.014, (0.12, 0.08, -0.05), 10, 6)
    yield shade("black", [(0.08, -0.02), (0.07, 0.04), (0.03, 0.1)], (-0.02, 0.0, 0.13), 0.004, 20, 2)
    yield from bulb(0.02, 25.0, -0.02, 0.13, 0.025, light=-0.05)


def _half() -> Iterator[Piece]:
    outline = [(0.15 * np.cos(a), 0.15 * np.sin(a) - 0.075) for a in np.linspace(0, np.pi, 16)]
    for k in range(4):
        yield prism(
            "opal",
            [(x * (0.7 + 0.1 * k), (z + 0.075) * (0.7 + 0.1 * k) - 0.075) for x, z in outline],
            0.03,
            (0.0, 0.03 * k, 0.0),
            "top",
        )
    yield Bulb((0.0, 0.18, 0.02), 40.0)


def _picture() -> Iterator[Piece]:
    yield rounded("brass", (0.1, 0.05, 0.015), (0.0, 0.0, -0.13), 0.006, 1)
    yield tube("brass", fillet([(0.0, 0.03, -0.12), (0.0, 0.12, -0.1), (0.0, 0.13, 0.0)], 0.06), 0.006)
    yield tube("brass", [(-0.17, 0.13, 0.01), (0.17, 0.13, 0.01)], 0.024, 12)
    yield tube("bulb", [(-0.15, 0.112, 0.016), (0.15, 0.112, 0.016)], 0.012)
    yield Bulb((0.0, 0.08, 0.02), 20.0)


def _globe_wall_lamp() -> Iterator[Piece]:
    yield disc("brass", 0.055, 0.015, (0.0, 0.16, _BACK), 20)
    yield tube("brass", fillet([(0.0, 0.16, _BACK), (0.0, 0.16, 0.0), (0.0, 0.11, 0.0)], 0.03), 0.008)
    yield ball("opal", 0.07, (0.0, 0.07, 0.0), 20, 12)
    yield Bulb((0.0, -0.03, 0.02), 40.0)


def _lantern_wall_lamp() -> Iterator[Piece]:
    yield rounded("iron", (0.09, 0.18, 0.015), (0.0, 0.1, -0.13), 0.006, 1)
    yield tube("iron", fillet([(0.0, 0.2, -0.12), (0.0, 0.32, -0.08), (0.0, 0.3, 0.0)], 0.06), 0.007)
    yield turned("iron", [(0.03, 0.0), (0.075, 0.03)], sides=6, steps=1)
    yield turned("glass", [(0.07, 0.03), (0.085, 0.2)], sides=6, steps=1)
    yield turned("iron", [(0.1, 0.2), (0.02, 0.28), (0.01, 0.3)], sides=6, steps=1)
    yield from bulb(0.1, 40.0, radius=0.025, light=-0.03)


def _tube() -> Iterator[Piece]:
    yield rounded("chrome", (0.08, 0.1, 0.03), (0.0, 0.2, -0.05), 0.008, 1)
    yield tube("opal", [(0.0, 0.02, 0.0), (0.0, 0.48, 0.0)], 0.025, 14)
    for y in (0.0, 0.46):
        yield cylinder("chrome", 0.029, 0.04, (0.0, y, 0.0), sides=16)
    yield Bulb((0.0, 0.25, 0.06), 30.0)


def _block() -> Iterator[Piece]:
    yield rounded("paint", (0.1, 0.2, 0.1), (0.0, 0.0, -0.04), 0.008, 1)
    for y in (-0.004, 0.196):
        yield box("bulb", (0.07, 0.008, 0.07), (0.0, y, -0.04))
    for y in (-0.05, 0.25):
        yield Bulb((0.0, y, -0.03), 20.0)


_WALL_LAMP_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "cone": _cone_wall_lamp,
    "shade": partial(_on_arms, "shade"),
    "candles": partial(_on_arms, "candles"),
    "bulkhead": _bulkhead,
    "swing": _swing,
    "half": _half,
    "picture": _picture,
    "globe": _globe_wall_lamp,
    "lantern": _lantern_wall_lamp,
    "tube": _tube,
    "block": _block,
}


def wall_lamp(kind: str = "cone") -> Iterator[Piece]:
    """Up-light, shade, candles, bulkhead, swing arm, half bowl, picture lamp, globe, lantern, tube, block."""
    yield from _WALL_LAMP_KINDS[kind]()


def _post_or_double(kind: str) -> Iterator[Piece]:
    yield turned("iron", [(0.12, 0.0), (0.1, 0.05), (0.04, 0.12), (0.03, 0.3), (0.03, 1.7)], sides=14, steps=2)
    for x in (0.0,) if kind == "post" else (-0.3, 0.3):
        if x:
            yield tube("iron", fillet([(0.0, 1.5, 0.0), (x, 1.45, 0.0), (x, 1.7, 0.0)], 0.15, 5), 0.016)
        yield turned("iron", [(0.03, 1.68), (0.09, 1.72)], (x, 0.0, 0.0), 6, 1)
        yield turned("glass", [(0.085, 1.72), (0.12, 1.95)], (x, 0.0, 0.0), 6, 1)
        yield turned("iron", [(0.14, 1.95), (0.04, 2.05), (0.01, 2.1)], (x, 0.0, 0.0), 6, 1)
        yield from bulb(1.82, 40.0, x, light=2.15)


def _bollard() -> Iterator[Piece]:
    yield cylinder("gray", 0.07, 0.55, sides=20)
    yield cylinder("opal", 0.065, 0.12, (0.0, 0.55, 0.0), sides=20)
    yield turned("gray", [(0.09, 0.67), (0.09, 0.69), (0.03, 0.71)], sides=20, steps=1)
    for i in range(3):
        yield ring("gray", 0.068, 0.01, (0.0, 0.58 + 0.03 * i, 0.0), 1, 20)
    yield Bulb((0.0, 0.74, 0.0), 20.0)


def _ball_outdoor() -> Iterator[Piece]:
    yield cylinder("black", 0.08, 0.03, sides=18)
    yield ball("opal", 0.17, (0.0, 0.19, 0.0), 24, 14)
    yield Bulb((0.0, 0.39, 0.0), 20.0)


_OUTDOOR_KINDS: dict[str, Callable[..., Iterator[Piece]]] = {
    "post": partial(_post_or_double, "post"),
    "double": partial(_post_or_double, "double"),
    "bollard": _bollard,
    "ball": _ball_outdoor,
}


def outdoor(kind: str = "post") -> Iterator[Piece]:
    """In a garden: a post with a lantern, a bollard, a ball on the ground, a row of two, a torch."""
    yield from _OUTDOOR_KINDS[kind]()


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


TABLE = (
    design(table_lamp), design(table_lamp, foot="urn", top="empire"),
    design(table_lamp, foot="column", top="drum", high=0.34), design(table_lamp, foot="tripod", top="cone"),
    design(table_lamp, foot="cube", top="drum"), design(table_lamp, foot="beads", top="bell"),
    design(table_lamp, foot="bottle", top="pleated"), *_of(desk_lamp, "arm", "banker", "mushroom", "ball", "tube"),
)  # fmt: skip
FLOOR = _of(floor_lamp, "pole", "tripod", "arc", "torch", "tray", "paper", "spots", "reading", "cones", "basket", "urn")
PENDANTS = _of(pendant, "dome", "globe", "drum", "cone", "cage", "basket", "lantern", "artichoke", "paper", "ring")
CHANDELIERS = _of(chandelier, "arms", "crystal", "wheel", "branches", "row", "shades")
CEILING = _of(ceiling, "bowl", "square", "disc", "rail", "cluster")
WALL = _of(
    wall_lamp, "cone", "shade", "candles", "bulkhead", "swing", "half", "picture", "globe", "lantern", "tube", "block"
)

FAMILIES = (
    Family("table_lamp", "table_lamp", TABLE),
    Family("floor_lamp", "floor_lamp", FLOOR),
    Family("pendant", "chandelier", PENDANTS),
    Family("chandelier", "chandelier", CHANDELIERS),
    Family("ceiling_lamp", "chandelier", CEILING),
    Family("wall_lamp", "wall_lamp", WALL),
    Family("outdoor_lamp", "outdoor_lamp", _of(outdoor, "post", "double", "bollard", "ball")),
)
