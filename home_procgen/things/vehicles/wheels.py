"""Wheels of vehicles."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.sweep import ring, rod


def wheel(
    x: float, y: float, z: float, radius: float, wide: float, spokes: int = 0, hub: str = "chrome"
) -> Iterator[Solid]:
    """Build a wheel whose axle points along x; with spokes it is a ring."""
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
    yield move(rotate(revolve("rubber", profile, sides=24, steps=1), 2, np.pi / 2), (x, y, z))
    rim = [(0.72 * radius, -0.52 * wide), (0.72 * radius, 0.52 * wide)]  # in front of the tyre, which is a closed disc
    yield move(rotate(revolve(hub, rim, sides=24, steps=1), 2, np.pi / 2), (x, y, z))
    for i in range(5):
        a = 2 * np.pi * i / 5
        for s in (-1, 1):
            yield rod(
                "black",
                (x + s * 0.52 * wide, y + 0.25 * radius * np.cos(a), z + 0.25 * radius * np.sin(a)),
                (x + s * 0.53 * wide, y + 0.6 * radius * np.cos(a), z + 0.6 * radius * np.sin(a)),
                0.09 * radius,
                sides=6,
            )
