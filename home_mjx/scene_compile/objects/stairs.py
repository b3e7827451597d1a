"""Stairs between levels, and the slopes that replace their steps."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.polygons import find_smallest_room
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.box_stairs import find_box_stairs
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.scene_compile.objects.slopes import Slope
from home_mjx.scene_compile.objects.stair_detection import (
    CurvedFlight,
    StraightFlights,
    find_stair_path,
    tread_triangles,
)
from home_mjx.schema.compiled import MAX_DEPTH_BELOW_FLOOR, RoomTable

STAIRS_CATEGORY = "stairs"
MAX_FLOOR_DISTANCE = 0.6  # [m], maximum vertical distance between an end of stairs and the floor that it leads to
MIN_HEADROOM = 2.1  # [m], minimum height of a slope above the foot of its stairs for agents to walk under it
MIN_HEAD_GAP = 1e-4  # [m], minimum gap between the last tread and the floor beyond that is filled
ROOM_PROBE_DISTANCE = 0.2  # [m], distance beyond either end of stairs of the test points for rooms

Polygon = Float[np.ndarray, "_ 2"]


@dataclass(frozen=True)
class Staircase:
    """Stairs between two levels, as a sequence of slopes.

    Attributes:
        object_id: Id of the stairs; for stairs built from boxes, of the first box.
        lower: Index of the grid at the foot.
        upper: Index of the grid at the head.
        room: Rooms at foot and head.
        slopes: From the foot to the head; landings are flat.
        top_tread: Remaining polygons of the top tread beyond the last slope, at the height of the upper floor [m].
        well: Polygons of the opening in the upper level's floor [m].
        level_floor: Height of the lowest floor of the upper level [m].
        object_ids: Ids of all objects that form the stairs.
        stacked: True if other stairs, from the level below, exit under their head.
    """

    object_id: int
    lower: int
    upper: int
    room: tuple[int, int]
    slopes: tuple[Slope, ...]
    top_tread: tuple[Polygon, ...]
    well: tuple[Polygon, ...]
    level_floor: float
    object_ids: tuple[int, ...]
    stacked: bool = False

    @property
    def low(self) -> float:
        """Height of the floor at the foot [m]."""
        return self.slopes[0].low

    @property
    def high(self) -> float:
        """Height of the floor at the head [m]."""
        return self.slopes[-1].high

    @property
    def width(self) -> float:
        """Width of the narrowest slope [m]."""
        return min(slope.width for slope in self.slopes)

    @cached_property
    def first_open_slope(self) -> int:
        """Index of the first slope that agents can walk under; the number of slopes if there is none."""
        return next((i for i, s in enumerate(self.slopes) if s.low >= self.low + MIN_HEADROOM), len(self.slopes))

    @property
    def is_open(self) -> bool:
        """True if agents can walk under some of the slopes."""
        return self.first_open_slope < len(self.slopes)

    @property
    def split(self) -> float:
        """Height above which the stairs are in the upper level's grid [m].

        The grids have one surface per cell: under slopes that agents can walk under, that of the lower level is the
        floor.
        """
        depth = self.level_floor - MAX_DEPTH_BELOW_FLOOR
        return min([depth, *(slope.low for slope in self.slopes[self.first_open_slope :])])

    @cached_property
    def outlines(self) -> tuple[Float[np.ndarray, "4 2"], ...]:
        """Outlines of the slopes in the plan [m]."""
        return tuple(slope.outline for slope in self.slopes)

    def contains(self, points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
        """Return whether plan points are over any slope of the stairs, edges included."""
        return np.any([slope.contains(points) for slope in self.slopes], axis=0)

    def blocks_floor(self, points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
        """Return whether plan points are over the stairs, and not over slopes that agents can walk under."""
        open_slopes = [slope.contains(points) for slope in self.slopes[self.first_open_slope :]]
        return self.contains(points) & ~np.any(open_slopes, axis=0) if open_slopes else self.contains(points)

    def surface(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Return the height of the highest slope at each plan point [m]; -inf beside the stairs."""
        heights = [np.where(slope.contains(points), slope.surface(points), -np.inf) for slope in self.slopes]
        return np.max(heights, axis=0)

    def belongs_to_level(self, points: Float[np.ndarray, "*p 2"], end: int, margin: float) -> Bool[np.ndarray, "*p"]:
        """Return whether points are over the stairs and belong to the lower (0) or the upper (1) level.

        Args:
            points: Points in the plan [m].
            end: 0 or 1.
            margin: Overlap of both levels beyond the split between them, along the way [m].
        """
        surface, split = self.surface(points), self.split
        found = np.zeros(surface.shape, bool)
        for slope in self.slopes:
            near = margin * slope.grade
            on = slope.contains(points) & (slope.surface(points) == surface)
            found |= on & ((surface >= split - near) if end else (surface < split + near))
        return found


def find_stairs(
    objects: Sequence[PlacedObject], rooms: RoomTable, level: Sequence[int], floor: Float[np.ndarray, " l"]
) -> list[Staircase]:
    """Find the stairs between adjacent levels: models of that category, and flights of Box nodes.

    Those without a path over treads, or whose ends are not near floors in rooms of both levels, are omitted. Models are
    first, in the order of `objects`, then flights by level.

    Args:
        objects: Objects of the house.
        rooms: Outlines and floors.
        level: Level index of each grid, lowest first.
        floor: Height of each grid's floor [m].
    """
    models = [[item] for item in objects if item.info.coarse == STAIRS_CATEGORY and item.level in level[:-1]]
    boxes = [
        flight for lower in range(len(level) - 1) for flight in find_box_stairs(objects, level[lower], floor[lower:])
    ]
    found = [_stairs(parts, rooms, list(level).index(parts[0].level), list(level), floor) for parts in models + boxes]
    known = [stairs for stairs in found if stairs is not None]
    return [replace(one, stacked=any(_exits_under(other, one) for other in known)) for one in known]


def _stairs(
    parts: Sequence[PlacedObject], rooms: RoomTable, lower: int, level: Sequence[int], floor: Float[np.ndarray, " l"]
) -> Staircase | None:
    """Return the staircase that one object, or boxes, form between rooms of adjacent levels; None if they form none.

    They form none if their ends are not near the floors of the levels or in rooms, or if no path over treads is found.
    `lower` is the index of the lower grid; `level` and `floor` have level index and floor height [m] of each grid.
    """
    triangles, yaw = np.concatenate([item.triangles for item in parts]), parts[0].yaw
    treads = tread_triangles(triangles)
    low, high = float(triangles[..., 2].min()), float(treads[..., 2].max(initial=-np.inf))
    if abs(low - floor[lower]) > MAX_FLOOR_DISTANCE or abs(high - floor[lower + 1]) > MAX_FLOOR_DISTANCE:
        return None
    turn = yaw_matrix(yaw)
    path = find_stair_path(triangles @ turn, treads @ turn)
    if path is None:
        return None
    ends = (turn[:2, :2] @ end for end in path.ends(ROOM_PROBE_DISTANCE))
    at = [_room_at(rooms, level[lower + i], end) for i, end in enumerate(ends)]
    if min(at) < 0:
        return None
    low, high = rooms.floor[at].tolist()
    slopes, top, well = path.slopes(low, high)
    if _room_at(rooms, level[lower + 1], turn[:2, :2] @ path.ends(MIN_HEAD_GAP)[1]) < 0:
        top = [*top, _head_gap(path, slopes[-1].width)]
    return Staircase(
        object_id=parts[0].object_id,
        lower=lower,
        upper=lower + 1,
        room=(at[0], at[1]),
        slopes=tuple(slope.rotated(yaw) for slope in slopes),
        top_tread=tuple(polygon @ turn[:2, :2].T for polygon in top),
        well=tuple(polygon @ turn[:2, :2].T for polygon in well),
        level_floor=float(floor[lower + 1]),
        object_ids=tuple(item.object_id for item in parts),
    )


def _head_gap(path: StraightFlights | CurvedFlight, width: float) -> Float[np.ndarray, "4 2"]:
    """Return a rectangle from the last tread to `ROOM_PROBE_DISTANCE` beyond, `width` wide [m].

    It covers the gap of a hole that is longer than the stairs; its length does not depend on the hole.
    """
    start, end = path.ends(0.0)[1], path.ends(ROOM_PROBE_DISTANCE)[1]
    aside = np.array([start[1] - end[1], end[0] - start[0]]) / ROOM_PROBE_DISTANCE * width / 2
    return np.array([start - aside, end - aside, end + aside, start + aside])


def _exits_under(below: Staircase, above: Staircase) -> bool:
    """Return whether stairs end on the level where others begin, under the last slope of the others.

    That includes `ROOM_PROBE_DISTANCE` beyond the head of the others.
    """
    last, head = below.slopes[-1], above.slopes[-1]
    way = last.foot + last.run * last.up - head.foot
    along, aside = float(way @ head.up), abs(float(way @ np.array([-head.up[1], head.up[0]])))
    return (
        below.upper == above.lower
        and 0 < along < head.run + ROOM_PROBE_DISTANCE
        and aside < (last.width + head.width) / 2
    )


def _room_at(rooms: RoomTable, level: int, point: Float[np.ndarray, "2"]) -> int:
    """Return the smallest room of a level that contains a plan point; -1 if none."""
    return int(find_smallest_room(rooms, np.flatnonzero(rooms.level == level), point))
