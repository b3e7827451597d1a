"""Distance from the cells of a grid to the nearest obstacle, in Numba."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

import math
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numba import njit

from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.geometry.boxes import BoxSet


def compute_clearance(
    obstacles: BoxSet,
    floor: Float[np.ndarray, "ny nx"],
    x: Float[np.ndarray, " nx"],
    y: Float[np.ndarray, " ny"],
    heights: tuple[float, float],
    max_distance: float,
) -> Float[np.ndarray, "ny nx"]:
    """Compute the distance in plan from every cell centre to the nearest obstacle within a height range [m]; 0 inside.

    Args:
        obstacles: Upright boxes.
        floor: Floor height of each cell [m]; rooms may have different heights, or no floor.
        x: x of the cell centres, ascending [m].
        y: y of the cell centres, ascending [m].
        heights: Height range above the floor in which obstacles count [m].
        max_distance: Distances up to this are exact; greater ones may be too large, or inf [m].
    """
    met = (obstacles.top > floor.min() + heights[0]) & (obstacles.bottom < floor.max() + heights[1])
    boxes = np.c_[obstacles.center[:, :2], obstacles.half[:, :2], np.cos(obstacles.yaw), np.sin(obstacles.yaw)]
    boxes = np.c_[boxes, np.hypot(*obstacles.half[:, :2].T) + max_distance, obstacles.bottom, obstacles.top][met]
    return _found(boxes, *(np.ascontiguousarray(values, np.float64) for values in (floor, x, y)), *map(float, heights))


@verify_cache_once
@no_type_check
def _found(boxes, floor, x, y, least, most):
    """Call `_clearance` after a check of Numba's cache."""
    return _clearance(boxes, floor, x, y, least, most)


@njit(cache=True)
@no_type_check
def _clearance(boxes, floor, x, y, least, most):
    """Return the distances of `compute_clearance`.

    Columns of boxes: centre x, y, half extents x, y, cosine and sine of yaw, reach, bottom, top.
    """
    found = np.full(floor.shape, np.inf)
    for i in range(len(boxes)):
        cx, cy, a, b, c, s, reach, bottom, top = boxes[i]
        for row in range(np.searchsorted(y, cy - reach), np.searchsorted(y, cy + reach, side="right")):
            for column in range(np.searchsorted(x, cx - reach), np.searchsorted(x, cx + reach, side="right")):
                ground = floor[row, column]
                if top > ground + least and bottom < ground + most:
                    dx, dy = x[column] - cx, y[row] - cy
                    u, v = max(abs(c * dx + s * dy) - a, 0.0), max(abs(c * dy - s * dx) - b, 0.0)
                    found[row, column] = min(found[row, column], math.hypot(u, v))
    return found
