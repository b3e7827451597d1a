"""Boxes of walls and window views that limit the placement of objects."""

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed import Box
from home_procgen.floor_plan.rooms import PlanWall
from home_procgen.floor_plan.walls import PRISM_THICKNESS

VIEW_DEPTH = 0.35  # [m], depth of the clear space on each side of a window


def wall_box(wall: PlanWall, height: float) -> Box:
    """Return the box of a wall, which includes both of its halves [m]."""
    ends: Float[np.ndarray, "2 2"] = np.sort([wall.start, wall.end], axis=0)
    (x0, z0), (x1, z1) = ends + np.array([[-PRISM_THICKNESS], [PRISM_THICKNESS]])
    return np.array([[x0, 0.0, z0], [x1, height, z1]])


def window_view_box(window: Box) -> Box:
    """Return the space on both sides of a window, from 0.12 m above its sill, that tall objects must not enter."""
    grown = window + np.array([[0.0, 0.12, 0.0], [0.0, 0.0, 0.0]])
    across = 0 if np.ptp(window[:, 0]) < np.ptp(window[:, 2]) else 2
    grown[:, across] += (-VIEW_DEPTH, VIEW_DEPTH)
    return grown
