"""Flights of stairs: where they begin and end."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.scene_compile.geometry.boxes import BoxSet, box_set
from home_mjx.scene_compile.navigation.geodesic import Link
from home_mjx.scene_compile.objects.place import PlacedObject

CATEGORY = "stairs"
TREADS = 0.3  # part of the rise at either end whose treads are the foot and the head
NEAR_FLOOR = 0.6  # [m]: stairs that end farther from a floor do not lead to it
REACH = 1.0  # [m] from foot or head to the nearest free cell
HEAD = 1.0  # [m], half the height above the upper floor over which the hole of stairs is closed to agents


@dataclass(frozen=True)
class Stairs:
    """A flight between two grids."""

    lower: int  # index of the grid
    upper: int
    foot: Float[np.ndarray, "2"]  # [m]
    head: Float[np.ndarray, "2"]
    length: float  # [m], along the slope
    hole: BoxSet  # over the upper floor


def find_stairs(objects: Sequence[PlacedObject], level: Sequence[int], floor: Float[np.ndarray, " l"]) -> list[Stairs]:
    """The flights that lead from one level to the next.

    Args:
        objects: Of the house.
        level: Level index of each grid, the lowest first.
        floor: Height of each grid's floor [m].
    """
    found = []
    for item in objects:
        if item.info.coarse == CATEGORY and item.level in level[:-1]:
            lower = list(level).index(item.level)
            flight = _flight(item, lower, float(floor[lower]), float(floor[lower + 1]))
            found += [flight] if flight else []
    return found


def _flight(item: PlacedObject, lower: int, start: float, end: float) -> Stairs | None:
    triangles = item.triangles
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1)
    upward = normal[:, 2] > 0.7 * np.maximum(area, 1e-12)
    if not upward.any():
        return None
    middle, weight = triangles[upward].mean(axis=1), area[upward]
    low, high = float(triangles[..., 2].min()), float(middle[:, 2].max())
    if abs(low - start) > NEAR_FLOOR or abs(high - end) > NEAR_FLOOR:
        return None
    rise = high - low
    foot = _centre(middle, weight, middle[:, 2] <= max(low + TREADS * rise, middle[:, 2].min()))
    head = _centre(middle, weight, middle[:, 2] >= high - TREADS * rise)
    box = item.box
    hole = box_set([*box.center[0, :2], end + HEAD], [*box.half[0, :2], HEAD], box.yaw)
    return Stairs(lower, lower + 1, foot, head, float(np.hypot(np.linalg.norm(head - foot), end - start)), hole)


def _centre(
    points: Float[np.ndarray, "t 3"], weight: Float[np.ndarray, " t"], rows: Bool[np.ndarray, " t"]
) -> Float[np.ndarray, "2"]:
    return np.average(points[rows, :2], axis=0, weights=weight[rows])


def stair_links(
    stairs: Sequence[Stairs],
    standable: Bool[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[Link]:
    """The flights as ways between the free cells nearest to their ends; one without such cells is no way."""
    links = []
    for flight in stairs:
        below = _nearest(standable[flight.lower], centres, flight.foot)
        above = _nearest(standable[flight.upper], centres, flight.head)
        if below and above:
            way = flight.length + below[1] + above[1]
            links.append(Link((flight.lower, *below[0]), (flight.upper, *above[0]), way))
    return links


def _nearest(
    free: Bool[np.ndarray, "ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
    point: Float[np.ndarray, "2"],
) -> tuple[tuple[int, int], float] | None:
    """Row and column of the nearest free cell, and how far it is [m]."""
    x, y = np.meshgrid(*centres)
    away = np.where(free, np.hypot(x - point[0], y - point[1]), np.inf)
    row, column = np.unravel_index(away.argmin(), away.shape)
    gap = float(away[row, column])
    return ((int(row), int(column)), gap) if gap <= REACH else None
