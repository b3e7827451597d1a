"""Places of houses side by side, in rows of a square (host only)."""

import math

import numpy as np
from jaxtyping import Float

from home_mjx.bank.bank import HouseBank
from home_mjx.viewer.pictures.top_view import frame_house

GAP = 3.0  # [m], between two houses
OVERVIEW = np.array([-0.1, -0.7, 0.9])  # from the middle of what is looked at to the camera, in its size


def find_boxes(bank: HouseBank) -> Float[np.ndarray, "n 2 2"]:
    """Return the bounds (low, high) of each house's lowest storey in plan, with `VIEW_MARGIN` [m]."""
    frames = [frame_house(bank, house) for house in range(bank.num_houses)]
    return np.stack([low + side / 2 + np.stack([-size, size]) / 2 for low, size, side in frames])


def look_at(box: Float[np.ndarray, "2 2"]) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Return place and target of a camera that sees a box in plan (low, high) from above [m].

    Example:
        >>> look_at(np.array([[0.0, 0.0], [3.0, 4.0]]))[1].tolist()
        [1.5, 2.0, 0.0]
    """
    middle, size = np.append(box.mean(axis=0), 0.0), float(np.linalg.norm(box[1] - box[0]))
    return middle + OVERVIEW * size, middle


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
