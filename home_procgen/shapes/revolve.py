"""Solids of revolution with curved profiles: turned wood, vessels, shades."""

from collections.abc import Sequence

import numpy as np

from home_procgen.primitives.solids import Solid, Vector, lathe
from home_procgen.shapes.curves import spline

Profile = Sequence[tuple[float, float]]


def revolve(
    material: str, points: Profile, at: Vector = (0.0, 0.0, 0.0), sides: int = 16, steps: int = 3, stretch: float = 1.0
) -> Solid:
    """Return a solid of revolution about y; its profile is a spline through (radius, height) [m] from the bottom up."""
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
    """Return a hollow solid of revolution with an open top, such as a cup, bowl or pot.

    Args:
        material: Slot name.
        points: Outer profile (radius, height) [m], from the bottom up.
        wall: Thickness [m].
        at: Point of the axis at height 0 [m].
        sides: Number of facets.
        steps: Segments of the profile between two points.
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
    """Return a wall of thickness `wall` around the y axis, open at top and bottom; the profile is its outside [m]."""
    outer = spline(points, steps)
    inner = [(r - wall, h) for r, h in outer.tolist()]
    return lathe(material, [*_pairs(outer), *inner[::-1]], at, sides, closed=True)


def _pairs(points: np.ndarray) -> list[tuple[float, float]]:
    """Return points as pairs, with radii of at least 0.1 mm."""
    return [(max(float(r), 1e-4), float(h)) for r, h in points]
