"""Compiled overlap tests of boxes; furnishing a home runs some thousands of them.

The arithmetic uses the boxes' own coordinates in NumPy's order of operations. The last bits decide whether two boxes
only touch, and a home has to be the same on every machine.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import njit, types

from home_mjx.core.native.numba_cache import verify_cache

_BOXES = types.Array(types.float64, 3, "A", readonly=True)  # any strides
_ROWS = types.Array(types.float64, 2, "C", readonly=True)
_STORED = types.Array(types.float64, 3, "C", readonly=True)
_CORES = types.Array(types.float64, 4, "C", readonly=True)
_TURNS = types.Array(types.int64, 1, "C", readonly=True)


class OverlapKernels(NamedTuple):
    """Compiled overlap tests."""

    # (boxes, others, count, margin, tolerance): whether any box overlaps any of the first `count` others. Others
    # are skipped if the bounding box of all boxes overlaps them by less than the margin.
    any_overlap: Callable[..., bool]
    # (spots, turns, cores, taken, tolerance): mask of spots at which no box of the turned object overlaps `taken`
    free_mask: Callable[..., Any]


@cache
@verify_cache
def overlap_kernels() -> OverlapKernels:
    """Return the overlap tests compiled by Numba; machine code is cached on disk for all processes."""
    return OverlapKernels(
        njit(types.boolean(_BOXES, _BOXES, types.int64, types.float64, types.float64), cache=True)(_any_overlap),
        njit(types.boolean[::1](_ROWS, _TURNS, _CORES, _STORED, types.float64), cache=True)(_free_mask),
    )


@njit
@no_type_check
def _boxes_overlap(boxes, i, others, k, tolerance):
    inside = True
    for axis in range(3):
        high = min(boxes[i, 1, axis], others[k, 1, axis])
        inside &= high - max(boxes[i, 0, axis], others[k, 0, axis]) > tolerance
    return inside


@no_type_check
def _any_overlap(boxes, others, count, margin, tolerance):
    high, low = np.empty(3), np.empty(3)  # of the bounding box, the lower corner negated
    for axis in range(3):
        high[axis] = low[axis] = -np.inf
        for i in range(len(boxes)):
            high[axis] = max(high[axis], boxes[i, 1, axis])
            low[axis] = max(low[axis], -boxes[i, 0, axis])
        high[axis] -= margin
        low[axis] -= margin
    for k in range(count):
        near = True
        for axis in range(3):
            near &= others[k, 0, axis] < high[axis] and -others[k, 1, axis] < low[axis]
        if near:
            for i in range(len(boxes)):
                if _boxes_overlap(boxes, i, others, k, tolerance):
                    return True
    return False


@no_type_check
def _free_mask(spots, turns, cores, taken, tolerance):
    found = np.empty(len(spots), np.bool_)
    around, boxes = np.empty((1, 2, 3)), np.empty((cores.shape[1], 2, 3))  # at the spot, shrunk by the tolerance
    for s in range(len(spots)):
        for axis in range(3):
            around[0, 0, axis], around[0, 1, axis] = np.inf, -np.inf
            for i in range(len(boxes)):
                boxes[i, 0, axis] = cores[turns[s], i, 0, axis] + spots[s, axis] + tolerance
                boxes[i, 1, axis] = cores[turns[s], i, 1, axis] + spots[s, axis] - tolerance
                around[0, 0, axis] = min(around[0, 0, axis], boxes[i, 0, axis])
                around[0, 1, axis] = max(around[0, 1, axis], boxes[i, 1, axis])
        found[s] = not _any_touches(boxes, around, taken, tolerance)
    return found


@njit
@no_type_check
def _any_touches(boxes, around, taken, tolerance):
    for k in range(len(taken)):
        if _touches(around, 0, taken, k):
            thick = True
            for axis in range(3):
                thick &= taken[k, 1, axis] - taken[k, 0, axis] > tolerance
            for i in range(len(boxes)):
                if thick and _touches(boxes, i, taken, k):
                    return True
    return False


@njit
@no_type_check
def _touches(boxes, i, others, k):
    over = True
    for axis in range(3):
        over &= boxes[i, 0, axis] < others[k, 1, axis] and boxes[i, 1, axis] > others[k, 0, axis]
    return over
