"""Toilets and bidets."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, loop
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import join_loops, rounded_box
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.things.bath.bathtubs import tub
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.kitchen.sinks import tap
from home_procgen.things.movable_parts import assign_part, lid_part


def _seat(y: float, z: float, lid: str = "up", free: bool = False) -> Iterator[Solid]:
    outer = [np.insert(loop(0.36, 0.42, 28, 2.3) + np.array([0.0, z]), 1, h, axis=1) for h in (y, y + 0.02)]
    inner = [np.insert(loop(0.23, 0.28, 28, 2.2) + np.array([0.0, z + 0.01]), 1, h, axis=1) for h in (y, y + 0.02)]
    if lid == "down":
        # A tank that overhangs the back of the lid blocks its hinge, so the lid is fixed.
        part = lid_part(y + 0.026, z - 0.215) if free else None
        yield from assign_part(part, [prism("ceramic", loop(0.37, 0.43, 28, 2.3), 0.026, (0.0, y, z), "top")])
        return
    yield join_loops("ceramic", [outer[0], outer[1], inner[1], inner[0]], closed=True)
    upright = rotate(prism("ceramic", loop(0.36, 0.42, 28, 2.3), 0.018, (0.0, 0.0, 0.2), "top"), 0, -np.pi / 2 - 0.12)
    yield move(upright, (0.0, y + 0.02, z - 0.215))


def toilet(kind: str = "tank") -> Iterator[Solid]:
    """Build a toilet: close-coupled, wall-hung, with a high tank and chain, or in one piece."""
    if kind == "hung":
        yield tub("ceramic", [(0.08, 0.22, 0.34, 0.0), (0.2, 0.3, 0.48, 0.0), (0.39, 0.36, 0.53, 0.0)], 0.03, 2.4)
        yield from _seat(0.39, 0.02, "down", True)
        yield box("ceramic", (0.34, 0.3, 0.05), (0.0, 0.1, -0.255))
        yield rounded_box("white", (0.5, 1.1, 0.12), (0.0, 0.0, -0.34), 0.01, 1)
        yield rounded_box("chrome", (0.24, 0.15, 0.012), (0.0, 0.86, -0.278), 0.005, 1)
        return
    yield tub(
        "ceramic",
        [(0.0, 0.2, 0.36, 0.0), (0.14, 0.2, 0.34, 0.0), (0.28, 0.3, 0.42, 0.0), (0.4, 0.36, 0.46, 0.0)],
        0.035,
        2.6,
    )
    yield from _seat(0.4, 0.0, "down" if kind == "one" else "up")
    if kind == "high":
        yield rounded_box("wood", (0.46, 0.26, 0.2), (0.0, 1.75, -0.28), 0.012, 1)
        yield rod("brass", (0.0, 0.36, -0.3), (0.0, 1.76, -0.3), 0.018)
        yield rod("brass", (0.18, 1.3, -0.2), (0.18, 1.76, -0.2), 0.003, sides=5)
        yield revolve("wood", [(0.006, 0.0), (0.016, 0.03), (0.01, 0.09), (0.006, 0.1)], (0.18, 1.21, -0.2), 10, 2)
        yield rounded_box("ceramic", (0.18, 0.36, 0.16), (0.0, 0.0, -0.24), 0.02, 2)
        return
    yield rounded_box("ceramic", (0.24, 0.4, 0.16), (0.0, 0.0, -0.2), 0.03, 2)
    high = 0.34 if kind == "tank" else 0.22
    yield rounded_box("ceramic", (0.4, high, 0.17), (0.0, 0.39, -0.28), 0.035, 3)
    yield rounded_box("ceramic", (0.42, 0.035, 0.19), (0.0, 0.39 + high - 0.01, -0.28), 0.014, 2)
    if kind == "tank":
        yield rounded_box("chrome", (0.06, 0.02, 0.03), (-0.13, 0.66, -0.19), 0.008, 1)
    else:
        yield revolve("chrome", [(0.03, 0.0), (0.03, 0.008), (0.02, 0.012)], (0.0, 0.412 + high, -0.28), 18, 1)


def skirted(smart: bool = False) -> Iterator[Solid]:
    """Build a toilet with a straight skirt, and a button panel beside the seat or a slim tank."""
    sides = [(0.0, 0.34, 0.52, 0.0), (0.3, 0.35, 0.54, 0.0), (0.4, 0.37, 0.56, 0.0)]
    yield tub("ceramic", sides, 0.045, 3.2)
    yield from _seat(0.4, 0.03, "down", not smart)
    if smart:
        yield rounded_box("ceramic", (0.38, 0.14, 0.17), (0.0, 0.39, -0.22), 0.05, 3)
        yield rounded_box("gray", (0.05, 0.03, 0.26), (0.205, 0.42, -0.02), 0.01, 2)
        for i in range(4):
            yield cylinder("white", 0.012, 0.006, (0.205, 0.448, 0.07 - 0.045 * i), sides=12)
        return
    yield rounded_box("ceramic", (0.37, 0.42, 0.13), (0.0, 0.36, -0.25), 0.015, 2)
    for s in (-1, 1):
        yield rounded_box("chrome", (0.05, 0.008, 0.05), (s * 0.028, 0.778, -0.25), 0.003, 1)


def low_tank() -> Iterator[Solid]:
    """Build a toilet with a wooden seat and a wall tank joined to the bowl by a bent pipe."""
    foot = [(0.0, 0.22, 0.38, 0.0), (0.12, 0.19, 0.32, 0.0), (0.26, 0.28, 0.4, 0.0), (0.4, 0.36, 0.46, 0.0)]
    yield tub("ceramic", foot, 0.035, 2.4)
    rims = ((0.37, 0.43, 0.4), (0.37, 0.43, 0.422), (0.24, 0.29, 0.422), (0.24, 0.29, 0.4))
    seat = [np.insert(loop(wide, deep, 28, 2.3), 1, y, axis=1) for wide, deep, y in rims]
    yield join_loops("wood", seat, closed=True)
    yield rounded_box("ceramic", (0.46, 0.34, 0.16), (0.0, 0.62, -0.33), 0.02, 2)
    yield rounded_box("ceramic", (0.48, 0.03, 0.18), (0.0, 0.95, -0.33), 0.012, 2)
    yield tube("chrome", fillet([(0.0, 0.64, -0.33), (0.0, 0.4, -0.33), (0.0, 0.34, -0.16)], 0.08, 5), 0.022)
    yield tube("chrome", fillet([(0.2, 0.9, -0.25), (0.2, 0.9, -0.22), (0.13, 0.89, -0.21)], 0.02), 0.007)
    yield rounded_box("ceramic", (0.2, 0.3, 0.14), (0.0, 0.0, -0.18), 0.02, 2)


def cornered() -> Iterator[Solid]:
    """Build a toilet with a three-sided tank for a corner."""
    sides = [(0.0, 0.2, 0.34, 0.0), (0.14, 0.2, 0.34, 0.0), (0.28, 0.3, 0.42, 0.0), (0.4, 0.36, 0.46, 0.0)]
    yield tub("ceramic", sides, 0.035, 2.6)
    yield from _seat(0.4, 0.0, "down", True)
    tank = fillet([(-0.26, -0.22), (0.26, -0.22), (0.26, -0.26), (0.0, -0.48), (-0.26, -0.26)], 0.05, 3, True)
    yield prism("ceramic", tank, 0.36, (0.0, 0.38, 0.0), "top")
    yield prism("ceramic", [(1.05 * x, 1.02 * z + 0.005) for x, z in tank], 0.03, (0.0, 0.73, 0.0), "top")
    yield revolve("chrome", [(0.025, 0.0), (0.025, 0.008), (0.016, 0.012)], (0.0, 0.758, -0.3), 18, 1)
    yield rounded_box("ceramic", (0.22, 0.38, 0.16), (0.0, 0.0, -0.2), 0.03, 2)


def with_rails() -> Iterator[Solid]:
    """Build a toilet between two support rails."""
    yield from toilet("one")
    for s in (-1, 1):
        path = [(s * 0.25, 0.02, -0.28), (s * 0.25, 0.7, -0.28), (s * 0.25, 0.7, 0.2), (s * 0.25, 0.02, 0.2)]
        yield tube("chrome", fillet(path, 0.07, 4), 0.014)
        yield rounded_box("black", (0.05, 0.03, 0.28), (s * 0.25, 0.705, -0.04), 0.014, 2)
        for z in (-0.28, 0.2):
            yield cylinder("black", 0.022, 0.03, (s * 0.25, 0.0, z), sides=12)


def bidet() -> Iterator[Solid]:
    """Build a bidet: a low bowl with a tap."""
    yield tub("ceramic", [(0.0, 0.2, 0.34, 0.0), (0.16, 0.22, 0.36, 0.0), (0.38, 0.37, 0.54, 0.0)], 0.05, 2.4)
    yield from (move(p, (0.0, 0.0, 0.0)) for p in tap(0.0, 0.385, -0.22, "lever"))


TOILETS = (
    *(design(toilet, kind=kind) for kind in ("tank", "hung", "high", "one")), design(bidet), design(skirted),
    design(skirted, smart=True), design(low_tank), design(cornered), design(with_rails),
)  # fmt: skip


FAMILIES = (FurnitureFamily("toilet", "toilet", TOILETS),)
