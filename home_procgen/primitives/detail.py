"""Level of detail of the shapes that are being built: all facets, or few."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from jaxtyping import Float

from home_procgen.primitives.grid import round_shape

DETAILS = ("full", "low")  # the second has few facets and sharp edges
MIN_SIDES, MID_SIDES, MAX_SIDES = 4, 6, 8  # of round pieces, if thin, very coarse, and coarse
THIN_RADIUS = 0.012  # [m], radius below which coarse round pieces have `MIN_SIDES`
MAX_SHARP_BEVEL = 0.03  # [m], radius below which coarse edges are sharp
# Deviation of coarse surfaces: [m], and by their extent.
MIN_GRID_TOLERANCE, GRID_TOLERANCE = 0.002, 0.004
MAX_AREA_CHANGE, SHARES = 0.25, (1.0, 0.5, 0.25, 0.125)  # of outlines, and of the tolerance
_coarseness: ContextVar[float] = ContextVar("coarseness", default=0.0)


@contextmanager
def build_coarsely(coarseness: float) -> Iterator[None]:
    """Build all shapes with few facets.

    Args:
        coarseness: Factor on all tolerances; 0 for all facets.
    """
    token = _coarseness.set(coarseness)
    try:
        yield
    finally:
        _coarseness.reset(token)


def is_sharp(bevel: float) -> bool:
    """Return whether an edge of a radius [m] is built without it."""
    return bevel < MAX_SHARP_BEVEL * _coarseness.get()


def limit_sides(sides: int, radius: float) -> int:
    """Return the number of sides of a round piece of a radius [m].

    Example:
        >>> with build_coarsely(1.0):
        ...     limit_sides(24, 0.2), limit_sides(12, 0.005)
        (8, 4)
    """
    coarseness = _coarseness.get()
    if not coarseness:
        return sides
    return min(sides, MIN_SIDES if radius < THIN_RADIUS * coarseness else MAX_SIDES if coarseness < 2 else MID_SIDES)


def limit_steps(steps: int) -> int:
    """Return the number of facets along an edge, half where shapes are coarse."""
    return max(1, steps // 2) if _coarseness.get() else steps


def simplify_line(points: Float[np.ndarray, "n d"], tolerance: float) -> Float[np.ndarray, "m d"]:
    """Return the points of a polyline that keep it within tolerance [m] times coarseness (Douglas and Peucker)."""
    tolerance *= _coarseness.get()
    if not tolerance or len(points) < 3:
        return points
    rounded, kept = round_shape(points), np.zeros(len(points), bool)
    kept[[0, -1]] = True
    spans = [(0, len(points) - 1)]
    while spans:
        first, last = spans.pop()
        away = _distance(rounded[first : last + 1])
        if away.max(initial=0.0) > tolerance:
            middle = first + int(away.argmax())
            kept[middle] = True
            spans += [(first, middle), (middle, last)]
    return points[kept]


def simplify_outline(points: Float[np.ndarray, "n 2"], tolerance: float) -> Float[np.ndarray, "m 2"]:
    """Return a closed outline as by `simplify_line`, with a smaller tolerance where too much of its area would go."""
    points = round_shape(points)
    area = _area(points)
    for share in SHARES:
        found = simplify_line(points, share * tolerance)
        if len(found) > 2 and abs(_area(found) - area) <= MAX_AREA_CHANGE * abs(area):
            return found
    return points


def _area(outline: Float[np.ndarray, "n 2"]) -> float:
    x, y = outline.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def simplify_grid(points: Float[np.ndarray, "n m d"]) -> Float[np.ndarray, "k l d"]:
    """Return a grid of points without the rows and columns between which it hardly bends, where shapes are coarse."""
    if not _coarseness.get():
        return points
    tolerance = MIN_GRID_TOLERANCE + GRID_TOLERANCE * float(np.ptp(points[..., :3], axis=(0, 1)).max())
    for axis in (0, 1):
        rows = np.moveaxis(points, axis, 0)
        shape = rows.shape[1:]
        flat = simplify_line(rows.reshape(len(rows), -1), tolerance * np.sqrt(shape[0]))
        points = np.moveaxis(flat.reshape(-1, *shape), 0, axis)
    return points


def _distance(points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " n"]:
    """Return the distances of points from the segment between the first and the last."""
    way = points[-1] - points[0]
    along = ((points - points[0]) * way).sum(axis=1) / max(float((way * way).sum()), 1e-18)
    return np.linalg.norm(points - points[0] - np.clip(along, 0.0, 1.0)[:, None] * way, axis=1)
