"""Places of houses side by side, in rows of a square (host only)."""

import math

import numpy as np
from jaxtyping import Float

GAP = 3.0  # [m], between two houses


def place_side_by_side(boxes: Float[np.ndarray, "n 2 2"]) -> Float[np.ndarray, "n 2"]:
    """Return shifts of boxes (low, high) in plan that put them into rows of a square, `GAP` apart [m].

    The first row is in the north (+y); rows are as deep as their deepest box.

    Example:
        >>> box = np.array([[-1.0, -1.0], [1.0, 1.0]])
        >>> place_side_by_side(np.stack([box] * 3)).tolist()
        [[1.0, -1.0], [6.0, -1.0], [1.0, -6.0]]
    """
    columns = math.ceil(math.sqrt(len(boxes)))
    shifts, top = np.zeros((len(boxes), 2)), 0.0
    for first in range(0, len(boxes), columns):
        row, left = boxes[first : first + columns], 0.0
        for number, (low, high) in enumerate(row, first):
            shifts[number] = left - low[0], top - high[1]
            left += high[0] - low[0] + GAP
        top -= float(np.max(row[:, 1, 1] - row[:, 0, 1])) + GAP
    return shifts
