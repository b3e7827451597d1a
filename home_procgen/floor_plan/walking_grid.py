"""Walkability of a room's floor on a grid."""

from bisect import bisect_left
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

from home_procgen.floor_plan.placed_model import Box
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.walls import FLOOR_TOP

CELL_SIZE = 0.1  # [m], edge of a cell
AGENT_RADIUS = 0.28  # [m], radius that must be able to pass: an agent's 0.2 m and a margin
AGENT_HEIGHT = 1.7  # [m], height above which nothing obstructs an agent
MAX_STEP_HEIGHT = 0.05  # [m], height up to which an agent walks over an object
CELL_CONNECTIVITY = ndimage.generate_binary_structure(2, 1)  # 4-connectivity of the cells
MIN_CONNECTED_SHARE = 0.85  # minimum share of the free floor that is connected to the doors


class WalkingGrid:
    """Cells of a room's floor that can hold the centre of an agent.

    Args:
        room: The room.
        obstacles: Boxes of walls and open doors [m].
        doors: Points (x, z) in front of the room's doors [m].
        radius: Half of the width of ways that stay free [m].
    """

    def __init__(
        self,
        room: RoomPlan,
        obstacles: Sequence[Box],
        doors: Sequence[tuple[float, float]],
        radius: float = AGENT_RADIUS,
    ) -> None:
        self._radius = radius
        self._low = room.polygon.min(0)
        count = np.ceil(np.ptp(room.polygon, axis=0) / CELL_SIZE).astype(int)
        self.x = self._low[0] + CELL_SIZE * (np.arange(count[0]) + 0.5)
        self.z = self._low[1] + CELL_SIZE * (np.arange(count[1]) + 0.5)
        self._lines = self.x.tolist(), self.z.tolist()
        x, z = self.x[:, None], self.z[None, :]
        inside = [(r.x0 < x) & (x < r.x1) & (r.z0 < z) & (z < r.z1) for r in room.rects]
        self._free = np.logical_or.reduce(inside)
        self._doors = [cell for x, z in doors if (cell := self._cell(x, z)) and self._free[cell]]
        self.remove_blocked(obstacles)

    def _cell(self, x: float, z: float) -> tuple[int, int] | None:
        i, j = (int(k) for k in np.floor((np.array([x, z]) - self._low) / CELL_SIZE))
        return (i, j) if 0 <= i < len(self.x) and 0 <= j < len(self.z) else None

    def remove_blocked(self, boxes: Sequence[Box]) -> None:
        """Mark as not free the cells in which an agent would touch one of the boxes."""
        self._free = self._without(boxes)

    def stays_connected(self, boxes: Sequence[Box]) -> bool:
        """Return whether boxes leave all doors and nearly all free floor connected; True if they block no cell.

        Without doors nothing is connected.
        """
        free = self._without(boxes)
        if boxes and np.array_equal(free, self._free):
            return True
        label = np.empty(free.shape, np.int32)
        ndimage.label(free, CELL_CONNECTIVITY, output=label)
        at_doors = {int(label[cell]) for cell in self._doors}
        if len(at_doors) != 1 or 0 in at_doors:
            return False
        return bool((label == at_doors.pop()).sum() > MIN_CONNECTED_SHARE * free.sum())

    def _without(self, boxes: Sequence[Box]) -> Bool[np.ndarray, "nx nz"]:
        free = self._free.copy()
        # Lists and `bisect`, because NumPy takes ten times as long for two numbers at a time.
        xs, zs = self._lines
        for (x0, low, z0), (x1, high, z1) in np.array(boxes, float).reshape(-1, 2, 3).tolist():
            if low < AGENT_HEIGHT and high > FLOOR_TOP + MAX_STEP_HEIGHT:
                i = slice(bisect_left(xs, x0 - self._radius), bisect_left(xs, x1 + self._radius))
                free[i, bisect_left(zs, z0 - self._radius) : bisect_left(zs, z1 + self._radius)] = False
        return free
