"""Shapes and limits of observations and actions."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

ACTION_NAMES = ("forward", "left", "turn_left", "look_up")
HAND_NAMES = ("pick", "throw", "turn_door")  # see `handling.hand_commands`


@dataclass(frozen=True)
class ArraySpec:
    """What an array may hold.

    Attributes:
        shape: Of one agent's array.
        dtype: NumPy's name of its type.
        low: Least value: one for all, or one per element of the last axis.
        high: Greatest value, alike.
        text: What it means, with units.

    Example:
        >>> ArraySpec((3,), "float32", -1.0, 1.0, "a direction").for_agents(2).shape
        (2, 3)
    """

    shape: tuple[int, ...]
    dtype: str = "float32"
    low: float | tuple[float, ...] = -np.inf
    high: float | tuple[float, ...] = np.inf
    text: str = ""

    def for_agents(self, num_agents: int) -> "ArraySpec":
        """The array of all agents: with a leading axis if there are several."""
        shape = self.shape if num_agents == 1 else (num_agents, *self.shape)
        return ArraySpec(shape, self.dtype, self.low, self.high, self.text)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest value of every element."""
        low, high = (np.broadcast_to(np.asarray(x, self.dtype), self.shape) for x in (self.low, self.high))
        return low, high


Specs = Mapping[str, ArraySpec]
