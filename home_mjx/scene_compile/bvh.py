"""Bounding-volume trees over boxes and triangles, built on the host by a compiled binned surface-area heuristic.

Source: I. Wald, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium on Interactive Ray
Tracing, 2007.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from home_mjx.errors import CapacityError, ConfigError, DatasetError
from home_mjx.scene_compile.compiled import Tree

BINS = 16
MAX_DEPTH = 32  # levels of child links; the ray casters size their stacks by it
MAX_LEAF = 15  # a leaf code has four bits for the count
MAX_PRIMITIVES = 1 << 27
EMPTY = -1  # code of an empty leaf
SLACK = 1e-6  # of the greatest coordinate, by which boxes grow: a ray may run in a face, where rounding would lose it


def build_tree(boxes: Float[np.ndarray, "n 2 3"], leaf_size: int = 4) -> tuple[Tree, Int[np.ndarray, " n"]]:
    """A tree over boxes.

    Args:
        boxes: Minimum and maximum corners [m].
        leaf_size: Most primitives in a leaf, 1 to 15.

    Returns:
        The tree, whose leaves count primitives in tree order, and `order`: `boxes[order]` is tree order.

    Raises:
        DatasetError: A box is not finite or inside out.
        ConfigError: `leaf_size` is out of range.
        CapacityError: More boxes than a leaf code can number.

    Example:
        >>> tree, order = build_tree(np.array([[[0.0, 0, 0], [1, 1, 1]], [[5.0, 0, 0], [6, 1, 1]]]), leaf_size=1)
        >>> [int(~code) >> 4 for code in tree.child[0]], order.tolist()
        ([0, 1], [0, 1])
    """
    _check(boxes, leaf_size)
    box, child, order, count = _build(np.asarray(boxes, np.float32).reshape(-1, 6), leaf_size)
    slack = np.float32(SLACK * np.abs(boxes).max(initial=0))
    return Tree(box=box[:count] + np.repeat([-slack, slack], 3), child=child[:count]), order


def build_triangle_tree(
    triangles: Float[np.ndarray, "t 3 3"], leaf_size: int = 4
) -> tuple[Tree, Int[np.ndarray, " t"]]:
    """A tree over triangles; see `build_tree`."""
    boxes = np.stack([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
    return build_tree(boxes, leaf_size)


def _check(boxes: Float[np.ndarray, "n 2 3"], leaf_size: int) -> None:
    if not 1 <= leaf_size <= MAX_LEAF:
        raise ConfigError(f"expected leaf_size in 1..{MAX_LEAF}, got {leaf_size}")
    if len(boxes) >= MAX_PRIMITIVES:
        raise CapacityError(f"expected fewer than {MAX_PRIMITIVES} primitives in a tree, got {len(boxes)}")
    bad = ~(np.isfinite(boxes).all(axis=(1, 2)) & (boxes[:, 0] <= boxes[:, 1]).all(axis=1))
    if bad.any():
        row = int(bad.argmax())
        raise DatasetError(f"expected a finite box with min <= max, got {boxes[row].tolist()}", element=f"boxes[{row}]")


@njit(cache=True)
@no_type_check
def _build(bounds, leaf_size):
    n = len(bounds)
    order = np.arange(n).astype(np.int32)
    box = np.empty((max(n, 1), 2, 6), np.float32)
    box[:, :, :3], box[:, :, 3:] = np.inf, -np.inf
    child = np.full((max(n, 1), 2), EMPTY, np.int32)
    # Ranges still to be placed: first, last, parent, side, depth. The root fills side 0 or becomes node 0.
    stack = np.empty((MAX_DEPTH + 2, 5), np.int32)
    _push(stack, 0, 0, n, 0, 0, -1)
    waiting, count = 1, 0
    while waiting:
        waiting -= 1
        first, last, parent, side, depth = stack[waiting]
        is_leaf = last - first <= leaf_size
        if depth >= 0 or is_leaf:
            _bound(bounds, order[first:last], box[parent, side])
            child[parent, side] = ~(first << 4 | (last - first)) if is_leaf else count
        if not is_leaf:
            middle = _split(bounds, order, first, last, leaf_size, depth)
            _push(stack, waiting, middle, last, count, 1, depth + 1)
            _push(stack, waiting + 1, first, middle, count, 0, depth + 1)  # taken next: depth-first node order
            waiting += 2
            count += 1
    return box, child, order, max(count, 1)


@njit(cache=True)
@no_type_check
def _push(stack, slot, first, last, parent, side, depth):
    stack[slot, 0], stack[slot, 1] = first, last
    stack[slot, 2], stack[slot, 3], stack[slot, 4] = parent, side, depth


# The loops below index scalars: in Numba a row view costs ten times the comparison that it serves.


@njit(cache=True)
@no_type_check
def _bound(bounds, rows, out):
    for row in rows:
        for axis in range(3):
            out[axis] = min(out[axis], bounds[row, axis])
            out[axis + 3] = max(out[axis + 3], bounds[row, axis + 3])


@njit(cache=True)
@no_type_check
def _split(bounds, order, first, last, leaf_size, depth):
    """Reorders a range so that its two children are contiguous; returns where the second one begins."""
    rows = order[first:last]
    start, scale = _bin_frame(bounds, rows)
    leaves = (last - first + leaf_size - 1) // leaf_size
    balanced_depth = int(np.ceil(np.log2(leaves)))
    if depth + 1 + balanced_depth < MAX_DEPTH:
        axis, edge = _best_plane(bounds, rows, start, scale)
        if axis >= 0:
            return first + _partition(bounds, rows, axis, edge, start[axis], scale[axis])
    axis = np.argmin(scale)  # the widest; a scale of infinity marks a flat one
    center = bounds[rows, axis] + bounds[rows, axis + 3]
    rows[:] = rows[np.argsort(center, kind="mergesort")]
    # A whole number of full leaves on the left keeps the depth at its minimum.
    return first + max(leaves // 2, 1) * leaf_size


@njit(cache=True)
@no_type_check
def _bin_frame(bounds, rows):
    """Start and bins per metre of each axis, over the (doubled) centres."""
    start = np.full(3, np.inf, np.float32)
    end = np.full(3, -np.inf, np.float32)
    for row in rows:
        for axis in range(3):
            center = bounds[row, axis] + bounds[row, axis + 3]
            start[axis] = min(start[axis], center)
            end[axis] = max(end[axis], center)
    scale = np.full(3, np.inf, np.float32)
    for axis in range(3):
        if end[axis] > start[axis]:
            scale[axis] = np.float32(BINS) / (end[axis] - start[axis])
    return start, scale


@njit(cache=True, inline="always")
@no_type_check
def _bin(bounds, row, axis, start, scale):
    return min(np.int32((bounds[row, axis] + bounds[row, axis + 3] - start) * scale), BINS - 1)


@njit(cache=True)
@no_type_check
def _best_plane(bounds, rows, start, scale):
    """The axis and bin edge of least cost; axis -1 if no plane separates the centres."""
    size, box = _fill_bins(bounds, rows, start, scale)
    best, best_axis, best_edge = np.inf, -1, 0
    for axis in range(3):
        if scale[axis] < np.inf:
            cost, edge = _cheapest_edge(size[axis], box[axis])
            if cost < best:
                best, best_axis, best_edge = cost, axis, edge
    return best_axis, best_edge


@njit(cache=True)
@no_type_check
def _fill_bins(bounds, rows, start, scale):
    size = np.zeros((3, BINS), np.int32)
    box = np.empty((3, BINS, 6), np.float32)
    box[:, :, :3], box[:, :, 3:] = np.inf, -np.inf
    for row in rows:
        for axis in range(3):
            if scale[axis] < np.inf:
                k = _bin(bounds, row, axis, start[axis], scale[axis])
                size[axis, k] += 1
                for side in range(3):
                    box[axis, k, side] = min(box[axis, k, side], bounds[row, side])
                    box[axis, k, side + 3] = max(box[axis, k, side + 3], bounds[row, side + 3])
    return size, box


@njit(cache=True)
@no_type_check
def _cheapest_edge(size, box):
    """Sweeps from both ends: cost of an edge = count times half area, left plus right."""
    cost = np.zeros(BINS)
    _sweep(size, box, cost[1:])
    _sweep(size[::-1], box[::-1], cost[:0:-1])
    return cost[1:].min(), cost[1:].argmin() + 1


@njit(cache=True)
@no_type_check
def _sweep(size, box, cost):
    low, high, total = np.full(3, np.inf, np.float32), np.full(3, -np.inf, np.float32), 0
    for k in range(BINS - 1):
        for axis in range(3):
            low[axis] = min(low[axis], box[k, axis])
            high[axis] = max(high[axis], box[k, axis + 3])
        total += size[k]
        a, b, c = high[0] - low[0], high[1] - low[1], high[2] - low[2]
        cost[k] += total * (a * b + b * c + c * a) if total else np.inf


@njit(cache=True)
@no_type_check
def _partition(bounds, rows, axis, edge, start, scale):
    left, right = 0, len(rows) - 1
    while left <= right:
        if _bin(bounds, rows[left], axis, start, scale) < edge:
            left += 1
        else:
            rows[left], rows[right] = rows[right], rows[left]
            right -= 1
    return left
