"""Solids of revolution with curved profiles: turned wood, vessels, shades."""

from collections.abc import Sequence

import numpy as np

from home_procgen.primitives.solids import Solid, Vector, lathe
from home_procgen.shapes.curves import spline

Profile = Sequence[tuple[float, float]]


def turned(
    material: str, points: Profile, at: Vector = (0.0, 0.0, 0.0), sides: int = 16, steps: int = 3, stretch: float = 1.0
) -> Solid:
    """A solid of revolution whose profile is a curve through (radius, height) [m], from the bottom up."""
    return lathe(material, _pairs(spline(points, steps)), at, sides, stretch=stretch)


def vessel(
    material: str,
    points: Profile,
    wall: float = 0.004,
    at: Vector = (0.0, 0.0, 0.0),
    sides: int = 16,
    steps: int = 3,
    stretch: float = 1.0,
) -> Solid:
    """A hollow solid of revolution that is open at the top, as cups, bowls and pots are.

    Args:
        material: Slot name.
        points: The outside's profile (radius, height) [m], from the bottom up.
        wall: Thickness [m].
        at: Where the axis meets height 0 [m].
        sides: Number of facets.
        steps: Pieces of the profile between two points.
        stretch: Factor on z.
    """
    outer = spline(points, steps)
    low = outer[0, 1] + wall
    inner = [(max(r - wall, 0.3 * r), h) for r, h in outer.tolist() if h > low + 1e-4]
    floor = max(float(np.interp(low, outer[:, 1], outer[:, 0])) - wall, 0.3 * float(outer[0, 0]))
    return lathe(material, [*_pairs(outer), *inner[::-1], (floor, low)], at, sides, stretch=stretch)


def shade(
    material: str, points: Profile, at: Vector = (0.0, 0.0, 0.0), wall: float = 0.005, sides: int = 20, steps: int = 1
) -> Solid:
    """A thin wall around the axis, open below and above; the profile is that of its outside [m]."""
    outer = spline(points, steps)
    inner = [(r - wall, h) for r, h in outer.tolist()]
    return lathe(material, [*_pairs(outer), *inner[::-1]], at, sides, closed=True)


def _pairs(points: np.ndarray) -> list[tuple[float, float]]:
    """With radii that reach the axis only at the ends."""
    return [(max(float(r), 1e-4), float(h)) for r, h in points]
