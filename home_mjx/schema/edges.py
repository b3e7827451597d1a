"""Numbering of the twelve edges of a box."""

import numpy as np

NUM_EDGES = 12


def edge_rows() -> np.ndarray:
    """Return for each edge its axis and its side (-1 or 1) on the other two axes in ascending order: shape (12, 3).

    Example:
        >>> edge_rows()[[0, 11]].tolist()
        [[0, -1, -1], [2, 1, 1]]
    """
    return np.array([(along, a, b) for along in range(3) for a in (-1, 1) for b in (-1, 1)])


def edge_number(u: int, side_u: int, v: int, side_v: int) -> int:
    """Return the number of the edge between the faces on the given sides of axes `u` and `v`.

    Example:
        >>> edge_number(1, 1, 0, 1) == edge_number(0, 1, 1, 1) == 11
        True
    """
    first, second = (side_u, side_v) if u < v else (side_v, side_u)
    return 4 * (3 - u - v) + 2 * (first > 0) + (second > 0)
