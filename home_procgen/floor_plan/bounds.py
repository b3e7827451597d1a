"""Boxes of walls and views, within which things are placed."""

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed import Box
from home_procgen.floor_plan.rooms import Wall
from home_procgen.floor_plan.walls import HALF

SIGHT = 0.35  # [m], depth in front of a window that tall things keep clear


def wall_box(wall: Wall, height: float) -> Box:
    """The half of a wall on the side of the room, and the other one [m]."""
    ends: Float[np.ndarray, "2 2"] = np.sort([wall.start, wall.end], axis=0)
    (x0, z0), (x1, z1) = ends + np.array([[-HALF], [HALF]])
    return np.array([[x0, 0.0, z0], [x1, height, z1]])


def sight(window: Box) -> Box:
    """The space before and behind a window, from a little above its sill, that tall things must not fill."""
    grown = window + np.array([[0.0, 0.12, 0.0], [0.0, 0.0, 0.0]])
    across = 0 if np.ptp(window[:, 0]) < np.ptp(window[:, 2]) else 2
    grown[:, across] += (-SIGHT, SIGHT)
    return grown
