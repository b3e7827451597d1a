"""Scripted path follower on the host, from goal to goal along geodesic distance fields."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.geodesic import is_walkable_rise
from home_mjx.navigation.grid import ground_fields, row_of_cell

MAX_GOAL_RISE = 1.5  # [m], maximum height above the lowest floor of goals on the ground floor
LOOK_AHEAD_CELLS = 5  # [cells], distance of the point that the agent steers to


@dataclass
class PathFollower:
    """Controller that steers one agent through the rooms of its house.

    Args:
        fields: Geodesic distance to each goal [m]; inf where an agent cannot be.
        origin: Corner of cell (0, 0) [m].
        cell: Cell size [m].
        targets: Goals in the order of visits; repeated cyclically.
        turn_per_step: Maximum turn in one step [rad].
        visited: Number of goals reached.
        height: Height of the cells [m]; the agent does not step to cells that are too high or low. None: equal heights.
    """

    fields: Float[np.ndarray, "g ny nx"]
    origin: Float[np.ndarray, " 2"]
    cell: float
    targets: list[int]
    turn_per_step: float
    visited: int = field(default=0)
    height: Float[np.ndarray, "ny nx"] | None = None

    def action(self, pos: Float[np.ndarray, " 3"], yaw: float) -> Float[np.ndarray, " 4"]:
        """Return the next action, see `steer`; count a target within 0.4 m by path as visited and head for the next.

        After the last target the first one follows. A `pos` [m] without free cell counts as in the nearest free cell.
        """
        cell = self._free_cell(self._cell(pos))
        if self._field[cell] < 0.4:
            self.visited += 1
        aim = self._downhill(cell)
        return steer(pos, yaw, self.origin + (np.array([aim[1], aim[0]]) + 0.5) * self.cell, self.turn_per_step)

    @property
    def _field(self) -> Float[np.ndarray, "ny nx"]:
        return self.fields[self.targets[self.visited % len(self.targets)]]

    def _cell(self, pos: Float[np.ndarray, " 3"]) -> tuple[int, int]:
        x, y = np.floor((pos[:2] - self.origin) / self.cell).astype(int)
        rows, columns = self._field.shape
        return int(np.clip(y, 0, rows - 1)), int(np.clip(x, 0, columns - 1))

    def _free_cell(self, cell: tuple[int, int]) -> tuple[int, int]:
        if np.isfinite(self._field[cell]):
            return cell
        free = np.argwhere(np.isfinite(self._field))
        nearest = free[np.argmin(np.abs(free - np.array(cell)).sum(-1))]
        return int(nearest[0]), int(nearest[1])

    def _downhill(self, cell: tuple[int, int]) -> tuple[int, int]:
        """Return the cell (row, column) after `LOOK_AHEAD_CELLS` steps to the neighbour nearest to the target."""
        for _ in range(LOOK_AHEAD_CELLS):
            y, x = cell
            y0, x0 = max(y - 1, 0), max(x - 1, 0)
            window = self._field[y0 : y + 2, x0 : x + 2]
            if self.height is not None:
                rise = self.height[y0 : y + 2, x0 : x + 2] - self.height[cell]
                window = np.where(is_walkable_rise(rise, self.cell), window, np.inf)
            dy, dx = np.unravel_index(np.argmin(window), window.shape)
            cell = (y0 + int(dy), x0 + int(dx))
        return cell


def steer(
    pos: Float[np.ndarray, " 3"], yaw: float, aim: Float[np.ndarray, " 2"], turn_per_step: float
) -> Float[np.ndarray, " 4"]:
    """Return the action (forward, left, turn, look) towards a point, each in [-1, 1]; turn is positive to the left.

    It turns, and while the point is less than 0.8 rad off its heading also walks, at the cosine of that angle.

    Args:
        pos: Position of the agent [m].
        yaw: Heading of the agent [rad].
        aim: Point to walk to [m].
        turn_per_step: Maximum turn in one step [rad].

    Example:
        >>> steer(np.zeros(3), 0.0, np.array([2.0, 0.0]), 0.1).tolist()
        [1.0, 0.0, 0.0, 0.0]
    """
    error = turn_towards(pos, yaw, aim)
    forward = max(0.0, np.cos(error)) if abs(error) < 0.8 else 0.0
    return np.array([forward, 0.0, np.clip(error / turn_per_step, -1, 1), 0.0], np.float32)


def turn_towards(pos: Float[np.ndarray, " 3"], yaw: float, aim: Float[np.ndarray, " *p"]) -> float:
    """Return the left turn (negative: right) that makes an agent face a point in plan [rad], in [-π, π)."""
    offset = aim[:2] - pos[:2]
    return float((np.arctan2(offset[1], offset[0]) - yaw + np.pi) % (2 * np.pi) - np.pi)


def make_path_follower(bank: HouseBank, house: int, pos: Float[np.ndarray, " 3"], turn_per_step: float) -> PathFollower:
    """Make a path follower that visits one goal in every other room before any room twice, each time nearest first.

    Nearest is by path from `pos`. Goals that are unreachable or upstairs (not on the lowest grid) are omitted.

    Args:
        bank: The houses.
        house: Index of the house.
        pos: Start of the agent [m].
        turn_per_step: Maximum turn in one step [rad].
    """
    navigation = bank.navigation
    fields = ground_fields(bank, house)
    height = np.asarray(navigation.height[row_of_cell(navigation.cell[house, 0])])
    origin = np.asarray(navigation.origin[house])
    walker = PathFollower(fields, origin, bank.spec.cell, [0], turn_per_step, height=height)
    rooms = [_room(bank, house, goal) for goal in np.asarray(navigation.goal[house])]
    seen = [_room(bank, house, pos)]
    reach = fields[:, *walker._free_cell(walker._cell(pos))]
    upstairs = np.asarray(navigation.goal[house])[:, 2] > float(navigation.floor[house, 0]) + MAX_GOAL_RISE
    order = sorted(range(len(rooms)), key=lambda g: ((seen + rooms[:g]).count(rooms[g]), reach[g]))
    walker.targets = [g for g in order if np.isfinite(reach[g]) and not upstairs[g]] or [0]
    return walker


def _room(bank: HouseBank, house: int, pos: np.ndarray) -> int:
    grid = np.asarray(bank.navigation.room[house, 0])
    x, y = np.floor((pos[:2] - np.asarray(bank.navigation.origin[house])) / bank.spec.cell).astype(int)
    return int(grid[np.clip(y, 0, grid.shape[0] - 1), np.clip(x, 0, grid.shape[1] - 1)])
