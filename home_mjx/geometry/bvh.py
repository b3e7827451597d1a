"""Bounding volume hierarchies over boxes and triangles, built on the host with the surface area heuristic in Numba.

Every split between two primitives, sorted by their centres along each axis, is evaluated. Primitives are sorted once,
and the parts of a range keep the order.

Source: I. Wald, S. Boulos, P. Shirley, "Ray tracing deformable scenes using dynamic bounding volume hierarchies", ACM
Transactions on Graphics 26(1), 2007, section 4.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.errors import CapacityError, ConfigError, DatasetError
from home_mjx.schema.compiled import BVH, EMPTY_LEAF, MAX_DEPTH

NODE_COST = 2.0  # cost of visiting a node; testing a primitive costs 1
MAX_LEAF = 15  # maximum primitives per leaf; a leaf code has four bits for the count
MAX_PRIMITIVES = 1 << 27
# Margin of node boxes as a fraction of the largest coordinate; without it, rounding loses rays that run in a face.
RELATIVE_BOX_MARGIN = 1e-6


def build_tree(boxes: Float[np.ndarray, "n 2 3"], leaf_size: int = 4) -> tuple[BVH, Int[np.ndarray, " n"]]:
    """Build a binary tree over boxes by the surface-area heuristic; its boxes are enlarged by `RELATIVE_BOX_MARGIN`.

    Args:
        boxes: Minimum and maximum corners [m], equal or not; without any, the tree is a root with two empty leaves.
        leaf_size: Maximum number of primitives in a leaf, 1 to 15.

    Returns:
        The tree, whose leaves index primitives in tree order, and `order`: `boxes[order]` is tree order.

    Raises:
        DatasetError: A box is not finite, or its minimum exceeds its maximum.
        ConfigError: `leaf_size` is out of range.
        CapacityError: There are more boxes than a leaf code can index.

    Example:
        >>> tree, order = build_tree(np.array([[[0.0, 0, 0], [1, 1, 1]], [[5.0, 0, 0], [6, 1, 1]]]), leaf_size=1)
        >>> [int(~code) >> 4 for code in tree.child[0]], order.tolist()
        ([0, 1], [0, 1])
    """
    _check(boxes, leaf_size)
    box, child, order, count = _built(np.asarray(boxes, np.float32).reshape(-1, 6), leaf_size)
    slack = np.float32(RELATIVE_BOX_MARGIN * np.abs(boxes).max(initial=0))
    return BVH(box=box[:count] + np.repeat([-slack, slack], 3), child=child[:count]), order


def build_triangle_tree(triangles: Float[np.ndarray, "t 3 3"], leaf_size: int = 4) -> tuple[BVH, Int[np.ndarray, " t"]]:
    """Build a tree over the bounding boxes of triangles, also of ones without area; see `build_tree` for the rest."""
    boxes = np.stack([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
    return build_tree(boxes, leaf_size)


def _check(boxes: Float[np.ndarray, "n 2 3"], leaf_size: int) -> None:
    """Raise the errors of `build_tree`; that for boxes names the first bad one."""
    if not 1 <= leaf_size <= MAX_LEAF:
        raise ConfigError(f"expected leaf_size in 1..{MAX_LEAF}, got {leaf_size}")
    if len(boxes) >= MAX_PRIMITIVES:
        raise CapacityError(f"expected fewer than {MAX_PRIMITIVES} primitives in a tree, got {len(boxes)}")
    bad = ~(np.isfinite(boxes).all(axis=(1, 2)) & (boxes[:, 0] <= boxes[:, 1]).all(axis=1))
    if bad.any():
        row = int(bad.argmax())
        raise DatasetError(f"expected a finite box with min <= max, got {boxes[row].tolist()}", element=f"boxes[{row}]")


@verify_cache_once
@no_type_check
def _built(bounds, leaf_size):
    """Call `_build` after a check of Numba's cache."""
    return _build(bounds, leaf_size)


@njit(cache=True)
@no_type_check
def _build(bounds, leaf_size):
    """Return node boxes, child codes, the primitives in tree order, and the node count, from rows min xyz, max xyz.

    A node has the boxes of its two children. A code is a node, or ~(first << 4 | count) for a leaf. Only the first
    `node count` rows are valid.
    """
    n = len(bounds)
    # All three orders have the same primitives in each range, sorted by their centres along x, y and z.
    order = np.empty((3, n), np.int32)
    for axis in range(3):
        order[axis] = np.argsort(bounds[:, axis] + bounds[:, axis + 3], kind="mergesort")
    cost, is_left = np.empty(n), np.empty(n, np.bool_)
    box = np.empty((max(n, 1), 2, 6), np.float32)
    box[:, :, :3], box[:, :, 3:] = np.inf, -np.inf
    child = np.full((max(n, 1), 2), EMPTY_LEAF, np.int32)
    # Pending ranges: first, last, parent, side, depth. The root fills side 0 or becomes node 0.
    stack = np.empty((MAX_DEPTH + 2, 5), np.int32)
    _push(stack, 0, 0, n, 0, 0, -1)
    waiting, count = 1, 0
    while waiting:
        waiting -= 1
        first, last, parent, side, depth = stack[waiting]
        split = _split(bounds, order[:, first:last], cost, is_left, leaf_size, depth)
        if depth >= 0 or split < 0:
            _bound(bounds, order[0, first:last], box[parent, side])
            child[parent, side] = ~(first << 4 | (last - first)) if split < 0 else count
        if split >= 0:
            _push(stack, waiting, first + split, last, count, 1, depth + 1)
            _push(stack, waiting + 1, first, first + split, count, 0, depth + 1)  # popped next: depth-first node order
            waiting += 2
            count += 1
    return box, child, order[0], max(count, 1)


@njit(cache=True)
@no_type_check
def _push(stack, slot, first, last, parent, side, depth):
    """Write the pending range from `first` to one before `last` to row `slot` of the stack."""
    stack[slot, 0], stack[slot, 1] = first, last
    stack[slot, 2], stack[slot, 3], stack[slot, 4] = parent, side, depth


# The loops below index scalars, because a row view in Numba costs ten times as much as the comparison.


@njit(cache=True)
@no_type_check
def _bound(bounds, rows, out):
    """Enlarge `out` (min xyz, max xyz) in place to contain the boxes `rows`."""
    for row in rows:
        for axis in range(3):
            out[axis] = min(out[axis], bounds[row, axis])
            out[axis + 3] = max(out[axis + 3], bounds[row, axis + 3])


@njit(cache=True)
@no_type_check
def _split(bounds, order, cost, is_left, leaf_size, depth):
    """Partition a range in place in all three orders; return the first part's size; -1, unchanged, if it is a leaf.

    A range of at most `leaf_size` is a leaf if the best split of `_cheapest` costs no less. Near `MAX_DEPTH`, larger
    ranges are halved along x instead; `depth` is -1 for the root. `order` is that of `_cheapest`; `cost` and `is_left`
    are overwritten.
    """
    n = order.shape[1]
    leaves = (n + leaf_size - 1) // leaf_size
    balanced_depth = int(np.ceil(np.log2(max(leaves, 1))))
    if depth + 1 + balanced_depth < MAX_DEPTH and n > 1:
        axis, count, split_cost, area = _cheapest(bounds, order, cost)
        if n <= leaf_size and NODE_COST * area + split_cost >= n * area:
            return -1
    elif n > leaf_size:
        # A whole number of full leaves on the left keeps the depth at its minimum.
        axis, count = 0, max(leaves // 2, 1) * leaf_size
    else:
        return -1
    _part(order, axis, count, is_left)
    return count


@njit(cache=True)
@no_type_check
def _cheapest(bounds, order, cost):
    """Return the axis, left count and cost of the best split, and half the surface area of the range.

    The cost is the sum of count times half area over both parts. Ties are resolved in favour of the most even split.
    Rows of `order` are the range's two or more primitives, sorted by their centres along x, y and z; `cost` is
    overwritten. Axes along which all centres are equal are not split; if all three are, the split is along z.
    """
    n = order.shape[1]
    best, best_axis, best_count, area = np.inf, 0, n // 2, 0.0
    for axis in range(3):
        rows = order[axis]
        if axis < 2 and _center(bounds, rows[0], axis) == _center(bounds, rows[-1], axis):
            continue  # all centres are equal, so this axis has no split
        _sweep(bounds, rows[::-1], cost[1:n][::-1], False)
        area = _sweep(bounds, rows, cost[1:n], True)
        for count in range(1, n):
            more_even = abs(2 * count - n) < abs(2 * best_count - n)
            if cost[count] < best or (cost[count] == best and more_even):
                best, best_axis, best_count = cost[count], axis, count
    return best_axis, best_count, best, area


@njit(cache=True, inline="always")
@no_type_check
def _center(bounds, row, axis):
    """Return twice the centre of box `row` along an axis."""
    return bounds[row, axis] + bounds[row, axis + 3]


@njit(cache=True)
@no_type_check
def _sweep(bounds, rows, cost, add):
    """Return half the area of the rows' box; set, or `add` to, `cost[k]` k + 1 times that of the first k + 1 rows.

    `cost` may be shorter than `rows`; it limits only what is written.
    """
    x0, y0, z0, x1, y1, z1 = np.inf, np.inf, np.inf, -np.inf, -np.inf, -np.inf
    area = 0.0
    for k in range(len(rows)):
        row = rows[k]
        x0, y0, z0 = min(x0, bounds[row, 0]), min(y0, bounds[row, 1]), min(z0, bounds[row, 2])
        x1, y1, z1 = max(x1, bounds[row, 3]), max(y1, bounds[row, 4]), max(z1, bounds[row, 5])
        a, b, c = x1 - x0, y1 - y0, z1 - z0
        area = a * b + b * c + c * a
        if k < len(cost):
            cost[k] = (k + 1) * area + (cost[k] if add else 0.0)
    return area


@njit(cache=True)
@no_type_check
def _part(order, axis, count, is_left):
    """Move the first `count` primitives of `order[axis]` to the front of the other orders, in place and stably.

    `is_left`, indexed by primitive, is overwritten.
    """
    for k in range(order.shape[1]):
        is_left[order[axis, k]] = k < count
    for other in range(3):
        if other != axis:
            left = is_left[order[other]]
            order[other] = np.concatenate((order[other][left], order[other][~left]))
