"""Toilets and bidets."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import loop
from home_mjx.datasets.homes.shapes.soft import between_loops, rounded
from home_mjx.datasets.homes.shapes.swept import prism, rod
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.bath.bowls import tub
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.kitchen.taps import tap
from home_mjx.datasets.procedural.primitives.solids import Solid, box, move, rotate


def _seat(y: float, z: float, lid: str = "up") -> Iterator[Solid]:
    outer = [np.insert(loop(0.36, 0.42, 28, 2.3) + np.array([0.0, z]), 1, h, axis=1) for h in (y, y + 0.02)]
    inner = [np.insert(loop(0.23, 0.28, 28, 2.2) + np.array([0.0, z + 0.01]), 1, h, axis=1) for h in (y, y + 0.02)]
    if lid == "down":
        yield prism("ceramic", loop(0.37, 0.43, 28, 2.3), 0.026, (0.0, y, z), "top")
        return
    yield between_loops("ceramic", [outer[0], outer[1], inner[1], inner[0]], closed=True)
    upright = rotate(prism("ceramic", loop(0.36, 0.42, 28, 2.3), 0.018, (0.0, 0.0, 0.2), "top"), 0, -np.pi / 2 - 0.12)
    yield move(upright, (0.0, y + 0.02, z - 0.215))


def toilet(kind: str = "tank") -> Iterator[Solid]:
    """With a tank on it, hung from a wall, with a high tank and chain, or all of one piece."""
    if kind == "hung":
        yield tub("ceramic", [(0.08, 0.22, 0.34, 0.0), (0.2, 0.3, 0.48, 0.0), (0.39, 0.36, 0.53, 0.0)], 0.03, 2.4)
        yield from _seat(0.39, 0.02, "down")
        yield box("ceramic", (0.34, 0.3, 0.05), (0.0, 0.1, -0.255))
        yield rounded("white", (0.5, 1.1, 0.12), (0.0, 0.0, -0.34), 0.01, 1)
        yield rounded("chrome", (0.24, 0.15, 0.012), (0.0, 0.86, -0.278), 0.005, 1)
        return
    yield tub(
        "ceramic",
        [(0.0, 0.2, 0.36, 0.0), (0.14, 0.2, 0.34, 0.0), (0.28, 0.3, 0.42, 0.0), (0.4, 0.36, 0.46, 0.0)],
        0.035,
        2.6,
    )
    yield from _seat(0.4, 0.0, "down" if kind == "one" else "up")
    if kind == "high":
        yield rounded("wood", (0.46, 0.26, 0.2), (0.0, 1.75, -0.28), 0.012, 1)
        yield rod("brass", (0.0, 0.36, -0.3), (0.0, 1.76, -0.3), 0.018)
        yield rod("brass", (0.18, 1.3, -0.2), (0.18, 1.76, -0.2), 0.003, sides=5)
        yield turned("wood", [(0.006, 0.0), (0.016, 0.03), (0.01, 0.09), (0.006, 0.1)], (0.18, 1.21, -0.2), 10, 2)
        yield rounded("ceramic", (0.18, 0.36, 0.16), (0.0, 0.0, -0.24), 0.02, 2)
        return
    yield rounded("ceramic", (0.24, 0.4, 0.16), (0.0, 0.0, -0.2), 0.03, 2)
    high = 0.34 if kind == "tank" else 0.22
    yield rounded("ceramic", (0.4, high, 0.17), (0.0, 0.39, -0.28), 0.035, 3)
    yield rounded("ceramic", (0.42, 0.035, 0.19), (0.0, 0.39 + high - 0.01, -0.28), 0.014, 2)
    if kind == "tank":
        yield rounded("chrome", (0.06, 0.02, 0.03), (-0.13, 0.66, -0.19), 0.008, 1)
    else:
        yield turned("chrome", [(0.03, 0.0), (0.03, 0.008), (0.02, 0.012)], (0.0, 0.412 + high, -0.28), 18, 1)


def bidet() -> Iterator[Solid]:
    """A low bowl with a tap."""
    yield tub("ceramic", [(0.0, 0.2, 0.34, 0.0), (0.16, 0.22, 0.36, 0.0), (0.38, 0.37, 0.54, 0.0)], 0.05, 2.4)
    yield from (move(p, (0.0, 0.0, 0.0)) for p in tap(0.0, 0.385, -0.22, "lever"))


TOILETS = (*(design(toilet, kind=kind) for kind in ("tank", "hung", "high", "one")), design(bidet))


FAMILIES = (Family("toilet", "toilet", TOILETS),)
