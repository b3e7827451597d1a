"""Valid starts of episodes (host side)."""

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.state import MAX_FLOOR_OFFSET

NEIGHBOR_OFFSETS = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]


def is_standable(
    bank: HouseBank, house: Int[np.ndarray, " t"], start: Float[np.ndarray, "t 3"]
) -> Bool[np.ndarray, " t"]:
    """Return whether an agent fits at each position and can reach the home region from there.

    True in or next to a cell of the home region, which is free for the body size that the houses were compiled for.

    Args:
        bank: The houses.
        house: Index of the house of each position.
        start: Positions on the floor [m].
    """
    navigation = bank.navigation
    numbers, height = np.asarray(navigation.cell), np.asarray(navigation.height)
    levels, *size = numbers.shape[1:]
    first = np.asarray(navigation.first_cell)[house]
    end = first + np.asarray(navigation.num_cells)[house]
    plan = np.floor((start[:, :2] - np.asarray(navigation.origin)[house]) / bank.spec.cell)
    column, row = np.clip(plan, -2, np.array(size[::-1]) + 1).astype(int).T  # keeps integers in range
    found = np.zeros(len(house), bool)
    for level in range(levels):
        for away in NEIGHBOR_OFFSETS:
            at = row + away[0], column + away[1]
            inside = (at[0] >= 0) & (at[0] < size[0]) & (at[1] >= 0) & (at[1] < size[1])
            number = numbers[house, level, np.clip(at[0], 0, size[0] - 1), np.clip(at[1], 0, size[1] - 1)]
            near = np.abs(height[np.maximum(number, 0)] - start[:, 2]) < MAX_FLOOR_OFFSET
            found |= inside & (number >= first) & (number < end) & near
    return found
