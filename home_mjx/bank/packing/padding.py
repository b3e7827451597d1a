"""Tables of different lengths into arrays of a few sizes, so that similar banks share one compiled step."""

from collections.abc import Sequence

import numpy as np


def size_class(count: int, smallest: int) -> int:
    """Smallest `smallest * 2**n` that holds `count`.

    Example:
        >>> size_class(44, 32), size_class(3, 8)
        (64, 8)
    """
    size = smallest
    while size < count:
        size *= 2
    return size


def ragged_class(count: int) -> int:
    """Capacity of a concatenated table: at least four classes per octave, so at most a quarter is unused.

    Example:
        >>> ragged_class(1000), ragged_class(102_076)
        (1024, 114688)
    """
    step = 64
    while step * 8 < count:
        step *= 2
    return -(-max(count, 1) // step) * step


def pad(rows: Sequence[np.ndarray], size: int, dtype: type, fill: float | np.ndarray) -> np.ndarray:
    """Stacks tables of different lengths, each padded with `fill` to `size` rows."""
    out = np.empty((len(rows), size, *np.shape(rows[0])[1:]), dtype)
    out[...] = fill
    for target, values in zip(out, rows, strict=True):
        target[: len(values)] = values
    return out


def repeat(rows: np.ndarray, size: int) -> np.ndarray:
    """Rows in turn up to `size`, so that every slot is valid and each row is drawn about equally often."""
    return rows[np.arange(size) % len(rows)]
