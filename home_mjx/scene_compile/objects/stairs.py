"""Flights of stairs: where they begin and end, and the even slope that stands for their steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.scene_compile.geometry.polygons import smallest_room
from home_mjx.scene_compile.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import BELOW_FLOOR, Rooms

CATEGORY = "stairs"
NEAR_FLOOR = 0.6  # [m]: stairs that end farther from a floor do not lead to it
FLAT = 0.95  # least vertical part of the normal of a tread
STRAIGHT = 0.95  # least correlation of the treads' heights with the way along them: less in stairs that turn
STEEPEST = 60.0  # [degrees]: steeper ones are ladders
BEFORE, LANDING = 0.3, 0.4  # [m] that a slope may begin before its stairs, and end before their end
BESIDE = 0.2  # [m] from either end of a flight to the rooms that it joins


@dataclass(frozen=True)
class Flight:
    """A straight flight between two levels, as a slope.

    Attributes:
        object_id: Of the stairs.
        lower: Index of the grid at its foot.
        upper: Of the one at its head.
        room: Rooms at foot and head.
        foot: Middle of the slope's lower edge [m].
        yaw: Direction uphill [rad].
        run: Length in the plan [m].
        width: [m].
        low: Height of the floor at its foot [m].
        high: Of that at its head [m].
        level_floor: Of the lowest one of the upper level [m].
        landing: Length of the top tread beyond the slope [m].
    """

    object_id: int
    lower: int
    upper: int
    room: tuple[int, int]
    foot: Float[np.ndarray, "2"]
    yaw: float
    run: float
    width: float
    low: float
    high: float
    level_floor: float
    landing: float

    @property
    def up(self) -> Float[np.ndarray, "2"]:
        """Unit direction uphill in the plan."""
        return np.array([np.cos(self.yaw), np.sin(self.yaw)])

    @property
    def slope(self) -> float:
        """[rad], above the horizontal."""
        return float(np.arctan2(self.high - self.low, self.run))

    @property
    def split(self) -> float:
        """Distance from the foot from which on a point of the slope counts as on the upper level [m]."""
        return self.run * (self.level_floor - BELOW_FLOOR - self.low) / (self.high - self.low)

    @cached_property
    def outline(self) -> Float[np.ndarray, "4 2"]:
        """The slope in the plan [m], counter-clockwise."""
        return self.part(0.0, self.run)

    def part(self, start: float, end: float, wider: float = 0.0) -> Float[np.ndarray, "4 2"]:
        """The part between two distances from the foot, in the plan [m].

        Args:
            start: [m].
            end: [m].
            wider: Added to both sides [m].
        """
        half = self.width / 2 + wider
        corners = np.array([[start, -half], [end, -half], [end, half], [start, half]])
        return self.foot + corners @ yaw_matrix(self.yaw)[:2, :2].T

    def along(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Distance from the foot along the way up [m]."""
        return (points - self.foot) @ self.up

    def contains(self, points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
        """Whether points are over the slope."""
        along, across = self.along(points), (points - self.foot) @ [-self.up[1], self.up[0]]
        return (along >= 0) & (along <= self.run) & (abs(across) <= self.width / 2)

    def surface(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Height of the slope under points, and of the floors beyond its ends [m]."""
        return self.low + (self.high - self.low) * np.clip(self.along(points) / self.run, 0, 1)


def find_flights(
    objects: Sequence[PlacedObject], rooms: Rooms, level: Sequence[int], floor: Float[np.ndarray, " l"]
) -> list[Flight]:
    """The straight flights that lead from one level to the next.

    Args:
        objects: Of the house.
        rooms: Outlines and floors.
        level: Level index of each grid, the lowest first.
        floor: Height of each grid's floor [m].
    """
    found = []
    for item in objects:
        if item.info.coarse == CATEGORY and item.level in level[:-1]:
            lower = list(level).index(item.level)
            flight = _flight(item, rooms, lower, list(level), floor)
            found += [flight] if flight else []
    return found


def _flight(
    item: PlacedObject, rooms: Rooms, lower: int, level: Sequence[int], floor: Float[np.ndarray, " l"]
) -> Flight | None:
    middle, weight = _treads(item.triangles)
    low, high = float(item.triangles[..., 2].min()), float(middle[:, 2].max(initial=-np.inf))
    if abs(low - floor[lower]) > NEAR_FLOOR or abs(high - floor[lower + 1]) > NEAR_FLOOR:
        return None
    line = _line(middle @ yaw_matrix(item.yaw), weight)
    if line is None:
        return None
    axis, rise, offset = line
    yaw = item.yaw + axis * np.pi / 2 + (np.pi if rise < 0 else 0.0)
    local = item.triangles.reshape(-1, 3) @ yaw_matrix(yaw)
    (first, right), (last, left) = local[:, :2].min(axis=0), local[:, :2].max(axis=0)

    def place(along: float) -> Float[np.ndarray, "2"]:
        return yaw_matrix(yaw)[:2, :2] @ [along, (left + right) / 2]

    ends = place(float(first) - BESIDE), place(float(last) + BESIDE)
    at = [_room_at(rooms, level[lower + i], end) for i, end in enumerate(ends)]
    if min(at) < 0:
        return None
    heights = rooms.floor[at].tolist()
    start, end = ((h - offset) / abs(rise) for h in heights)
    start = float(np.clip(start, first - BEFORE, first + BEFORE))
    end = float(np.clip(end, last - LANDING, last))
    return Flight(
        object_id=item.object_id,
        lower=lower,
        upper=lower + 1,
        room=(at[0], at[1]),
        foot=place(start),
        yaw=float(yaw),
        run=end - start,
        width=float(left - right),
        low=heights[0],
        high=heights[1],
        level_floor=float(floor[lower + 1]),
        landing=float(last) - end,
    )


def _treads(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """Middle and area of every triangle on which one can stand."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1)
    flat = normal[:, 2] > FLAT * np.maximum(area, 1e-12)
    return triangles[flat].mean(axis=1), area[flat]


def _line(middle: Float[np.ndarray, "n 3"], weight: Float[np.ndarray, " n"]) -> tuple[int, float, float] | None:
    """The line height = rise * (way) + offset through treads: axis of the way, rise, offset; None if they turn."""
    away = middle - np.average(middle, axis=0, weights=weight)
    spread = np.einsum("n,na,nb->ab", weight, away, away)
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = spread[:2, 2] / np.sqrt(np.diag(spread)[:2] * spread[2, 2])
    axis = int(np.nan_to_num(abs(correlation)).argmax())
    if not abs(correlation[axis]) >= STRAIGHT:
        return None
    rise = float(spread[axis, 2] / spread[axis, axis])
    if abs(rise) > np.tan(np.deg2rad(STEEPEST)):
        return None
    mean = np.average(middle, axis=0, weights=weight)
    return axis, rise, float(mean[2] - rise * mean[axis])


def _room_at(rooms: Rooms, level: int, point: Float[np.ndarray, "2"]) -> int:
    return int(smallest_room(rooms, np.flatnonzero(rooms.level == level), point))
