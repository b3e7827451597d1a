"""Points along curves: splines, arcs and rounded corners."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

Points = Sequence[Sequence[float]] | Float[np.ndarray, "_ _"]


def spline(points: Points, steps: int = 4) -> Float[np.ndarray, "_ _"]:
    """Sample a Catmull-Rom spline through points, without repetitions.

    Args:
        points: Points with two or three coordinates.
        steps: Segments between two points.

    Example:
        >>> spline([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 2)[:, 0].tolist()
        [0.0, 0.4375, 1.0, 1.5625, 2.0]
    """
    p = np.asarray(points, float)
    padded = np.concatenate([p[:1], p, p[-1:]])
    t = np.arange(steps)[:, None] / steps
    pieces = [_between(padded[i], padded[i + 1], padded[i + 2], padded[i + 3], t) for i in range(len(p) - 1)]
    return _distinct(np.concatenate([*pieces, p[-1:]]))


def _between(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, t: np.ndarray) -> np.ndarray:
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)


def _distinct(points: np.ndarray) -> np.ndarray:
    """Remove points equal to their predecessor."""
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return points[np.concatenate([[True], step > 1e-6])]


def arc(
    radius: float, start: float, end: float, steps: int = 8, center: Sequence[float] = (0.0, 0.0)
) -> Float[np.ndarray, "_ 2"]:
    """Sample points on a circular arc, both ends included.

    Args:
        radius: Radius [m].
        start: Angle of the first point from the first axis [rad].
        end: Angle of the last point [rad].
        steps: Segments between them.
        center: Centre [m].

    Example:
        >>> arc(1.0, 0.0, np.pi, 2).round(6).tolist()[1]
        [0.0, 1.0]
    """
    angle = np.linspace(start, end, steps + 1)
    return np.stack([np.cos(angle), np.sin(angle)], -1) * radius + np.asarray(center)


def loop(width: float, height: float, steps: int = 16, power: float = 2.0) -> Float[np.ndarray, "_ 2"]:
    """Sample an oval outline around the origin, first point not repeated [m]; a `power` above 2 makes it squarer.

    Example:
        >>> loop(2.0, 1.0, 4).round(6).tolist()
        [[1.0, 0.0], [0.0, 0.5], [-1.0, 0.0], [-0.0, -0.5]]
    """
    angle = 2 * np.pi * np.arange(steps) / steps
    ends = np.stack([np.cos(angle), np.sin(angle)], -1)
    return np.sign(ends) * np.abs(ends) ** (2 / power) * (width / 2, height / 2)


def fillet(points: Points, radius: float, steps: int = 3, closed: bool = False) -> Float[np.ndarray, "_ _"]:
    """Round the corners of a polyline by quadratic curves from `radius` before them [m], at most 0.45 of each side.

    Example:
        >>> len(fillet([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 0.2))
        6
    """
    p = np.asarray(points, float)
    t = np.linspace(0, 1, steps + 1)[:, None]
    parts: list[np.ndarray] = []
    for i in range(len(p)):
        if not closed and i in (0, len(p) - 1):
            parts.append(p[i : i + 1])
            continue
        before, after = p[i - 1] - p[i], p[(i + 1) % len(p)] - p[i]
        a, b = (p[i] + d * min(0.45, radius / max(float(np.linalg.norm(d)), 1e-9)) for d in (before, after))
        parts.append(a * (1 - t) ** 2 + 2 * p[i] * t * (1 - t) + b * t**2)
    return _distinct(np.concatenate(parts))


def star(outer: float, inner: float, tips: int) -> Float[np.ndarray, "_ 2"]:
    """Return the 2 x `tips` points of a star, tips at radius `outer`, notches at `inner`, the first tip up [m]."""
    angle = np.pi / 2 + np.pi * np.arange(2 * tips) / tips
    radius = np.where(np.arange(2 * tips) % 2 == 0, outer, inner)[:, None]
    return np.stack([np.cos(angle), np.sin(angle)], -1) * radius
