"""Covers of rectilinear figures in the plane by few rectangles."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

MAX_PAIRS = 2_000_000  # maximum number of pairs of a triangle and a point that are compared at once


def merge_close_values(values: Float[np.ndarray, "*n"], tolerance: float) -> Float[np.ndarray, " k"]:
    """Return the sorted distinct values; chains of neighbours up to `tolerance` apart are merged into their mean.

    A chain may be longer than `tolerance`. The minimum and the maximum are kept exactly, unless all values merge into
    their mean. Without values the result is empty.

    Example:
        >>> merge_close_values(np.array([2.0, 0.0, 1.0, 1.02]), 0.05)
        array([0.  , 1.01, 2.  ])
    """
    ordered = np.unique(np.asarray(values, float))
    if not ordered.size:
        return ordered
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) > tolerance) + 1)
    # The first and last value are not averaged, so that the figure keeps its size.
    middle = [float(group.mean()) for group in groups]
    return np.array([ordered[0], *middle[1:-1], ordered[-1]] if len(middle) > 1 else middle)


def cell_centers(u: Float[np.ndarray, " nu"], v: Float[np.ndarray, " nv"]) -> Float[np.ndarray, "_ _ 2"]:
    """Return the centres (u, v) of the cells between ascending grid lines; row = v, column = u.

    The shape is (`len(v)` - 1, `len(u)` - 1, 2).
    """
    return np.stack(np.meshgrid((u[1:] + u[:-1]) / 2, (v[1:] + v[:-1]) / 2), axis=-1)


def is_in_triangles(triangles: Float[np.ndarray, "t 3 2"], points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
    """Return whether points are in or on the edge of any triangle, of either winding.

    A triangle without area contains no point.
    """
    flat = points.reshape(-1, 2)
    triangles = triangles[abs(_side(*triangles.transpose(1, 0, 2))) > 1e-12]
    found, order = np.zeros(len(flat), bool), np.argsort(flat[:, 0], kind="stable")
    u = triangles[..., 0]
    first = np.searchsorted(flat[order, 0], u.min(axis=1), "left")
    count = np.searchsorted(flat[order, 0], u.max(axis=1), "right") - first
    for rows in np.split(np.arange(len(u)), np.flatnonzero(np.diff(np.cumsum(count) // MAX_PAIRS)) + 1):
        triangle = np.repeat(rows, count[rows])
        step = np.arange(len(triangle)) - np.repeat(np.cumsum(count[rows]) - count[rows], count[rows])
        near = order[first[triangle] + step]
        a, b, c = triangles[triangle].transpose(1, 0, 2)
        sides = np.stack([_side(p, q, flat[near]) for p, q in ((a, b), (b, c), (c, a))])
        found[near[(sides >= 0).all(axis=0) | (sides <= 0).all(axis=0)]] = True
    return found.reshape(points.shape[:-1])


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return twice the signed area of the triangle a, b, p, positive if counter-clockwise; leading axes broadcast."""
    return (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])


def cover_with_rectangles(
    u: Float[np.ndarray, " nu"], v: Float[np.ndarray, " nv"], solid: Bool[np.ndarray, "_ _"]
) -> Float[np.ndarray, "r 4"]:
    """Cover exactly the solid cells (row = v, column = u) with disjoint rectangles, grown along v, then along u.

    The cover is greedy, so it may have more rectangles than needed, and depends on which axis is u. `solid` is not
    modified; its shape is (`len(v)` - 1, `len(u)` - 1).

    Returns:
        One row u0, v0, u1, v1 per rectangle, in the unit of the ascending grid lines; no rows if no cell is solid.
        `solid` is not modified.
    """
    left = solid.copy()
    found = []
    for column in range(left.shape[1]):
        for row in range(left.shape[0]):
            if left[row, column]:
                top, right = _grow(left, row, column)
                left[row:top, column:right] = False
                found.append((u[column], v[row], u[right], v[top]))
    return np.array(found, float).reshape(-1, 4)


def _grow(left: Bool[np.ndarray, "_ _"], row: int, column: int) -> tuple[int, int]:
    """Return one past the last row and column of the rectangle that begins at a cell, which must be in `left`.

    Its rows are the run of remaining cells in the first column, from that cell on. The next column joins if it has the
    same run: all of these cells, but neither the one before nor the one after.
    """
    top = row
    while top < left.shape[0] and left[top, column]:
        top += 1
    right = column + 1
    # A run joins only if it is as tall as the first one; otherwise it becomes a separate rectangle.
    while right < left.shape[1] and left[row:top, right].all() and not _is_taller(left[:, right], row, top):
        right += 1
    return top, right


def _is_taller(run: Bool[np.ndarray, " _"], row: int, top: int) -> bool:
    """Return whether the cell before `row` or the cell `top` is set in a column; none is set beyond its ends."""
    return bool((row > 0 and run[row - 1]) or (top < len(run) and run[top]))


def split_rectangles(rectangles: Float[np.ndarray, "r 4"], length: float) -> Float[np.ndarray, "_ 4"]:
    """Cut each rectangle (u0, v0, u1, v1) across u into equal pieces of at most `length` along u, in order.

    v is not cut. `length` must be positive. Excess by rounding errors makes no further piece.
    """
    pieces = []
    for u0, v0, u1, v1 in rectangles:
        edges = np.linspace(u0, u1, max(int(np.ceil((u1 - u0) / length - 1e-9)), 1) + 1)
        pieces += [(a, v0, b, v1) for a, b in pairwise(edges)]
    return np.array(pieces, float).reshape(-1, 4)
