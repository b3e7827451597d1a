"""Floors as collision boxes: rooms of a level and doorways between them, with holes above stairs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.boxes import BoxSet, concat_boxes, make_boxes
from home_mjx.geometry.polygons import boundary_edges, find_smallest_room, is_inside_polygon, polygon_distance
from home_mjx.geometry.rectangle_cover import cell_centers, cover_with_rectangles, merge_close_values
from home_mjx.geometry.rotations import plane_matrix, yaw_matrix
from home_mjx.scene_compile.objects.stairs import Staircase
from home_mjx.schema.compiled import RoomTable

FLOOR_THICKNESS = 0.15  # [m], thickness of a floor
LINE_MERGE_DISTANCE = 0.01  # [m], grid lines closer than this are merged
MAX_STRAIGHT_DEVIATION = 0.02  # [m], edges that deviate less than this from a grid direction count as straight
PARALLEL_TOLERANCE = 0.01  # [rad], maximum deviation of edges that count as parallel or perpendicular
MAX_STRIP_WIDTH = 0.1  # [m], maximum width of the strips along a slanted edge

Polygon = Float[np.ndarray, "_ 2"]


@dataclass(frozen=True)
class FloorPlan:
    """Floors of one level as cells of an irregular grid, whose yaw aligns it with most walls.

    Attributes:
        yaw: Direction of the first axis [rad].
        u: Grid lines along the first axis [m], ascending.
        v: Grid lines along the second axis [m], ascending.
        height: Floor height of each cell [m], row = v; -inf if the cell has no floor.
        lowest: Height of the level's lowest floor [m].
    """

    yaw: float
    u: Float[np.ndarray, " nu"]
    v: Float[np.ndarray, " nv"]
    height: Float[np.ndarray, "_ _"]
    lowest: float

    def to_world(self, local: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p 2"]:
        """Rotate points or directions from the plan's axes to the world's; both have the same origin."""
        return local @ plane_matrix(self.yaw).T

    def boxes(self, above: float = -np.inf) -> BoxSet:
        """Return the floors above height `above` [m] as boxes down to `FLOOR_THICKNESS` below the lowest floor."""
        found = []
        for height in np.unique(self.height[self.height > above]).tolist():
            bottom = self.lowest - FLOOR_THICKNESS
            for u0, v0, u1, v1 in _smaller_cover(self.u, self.v, self.height == height).tolist():
                middle = self.to_world(np.array([(u0 + u1) / 2, (v0 + v1) / 2]))
                half = [(u1 - u0) / 2, (v1 - v0) / 2, (height - bottom) / 2]
                found.append(make_boxes([*middle, (height + bottom) / 2], half, self.yaw))
        return concat_boxes(found)


def _smaller_cover(
    u: Float[np.ndarray, " nu"], v: Float[np.ndarray, " nv"], solid: Bool[np.ndarray, "_ _"]
) -> Float[np.ndarray, "r 4"]:
    """Return rectangles (u0, v0, u1, v1) that cover the solid cells (row = v), the fewer of two covers."""
    upright, lying = cover_with_rectangles(u, v, solid), cover_with_rectangles(v, u, solid.T)[:, [1, 0, 3, 2]]
    return min(upright, lying, key=len)


def plan_floors(
    rooms: RoomTable, level: int, doorways: Sequence[Float[np.ndarray, "4 2"]], stairs: Sequence[Staircase], grid: int
) -> FloorPlan:
    """Return the floor plan of a level: rooms, doorways and top treads of stairs, with holes at the wells of stairs.

    A cell has the floor of the smallest room at its centre. Outside all rooms, the first doorway there counts, at the
    floor of the nearest room, then the first top tread. Heights are rounded to 0.1 mm.

    Args:
        rooms: Outlines and floors.
        level: Level index.
        doorways: Footprints of its doors [m].
        stairs: Stairs of the house.
        grid: Index of the level among those that have rooms; only stairs with this `upper` count.
    """
    here = np.flatnonzero(rooms.level == level)
    holes = [outline for s in stairs if s.upper == grid for outline in s.well]
    treads = [(top, s.high) for s in stairs if s.upper == grid for top in s.top_tread]
    gaps = [(way, _nearest_floor(rooms, here, way.mean(axis=0))) for way in doorways] + treads
    outlines = [*(rooms.polygon[r] for r in here if len(rooms.polygon[r])), *(p for p, _ in gaps), *holes]
    lowest = float(rooms.floor[here].min())
    if not outlines:
        return FloorPlan(0.0, np.zeros(1), np.zeros(1), np.zeros((0, 0)), lowest)
    yaw = _main_direction(outlines)
    u, v = _lines([p @ plane_matrix(yaw) for p in outlines])
    centers = cell_centers(u, v) @ plane_matrix(yaw).T
    room = find_smallest_room(rooms, here, centers)
    height = np.where(room >= 0, rooms.floor[room], -np.inf)
    for outline, floor in gaps:
        height = np.where(np.isinf(height) & is_inside_polygon(outline, centers), floor, height)
    for hole in holes:
        height[is_inside_polygon(hole, centers)] = -np.inf
    return FloorPlan(yaw, u, v, np.round(height, 4), lowest)


def _nearest_floor(rooms: RoomTable, here: Int[np.ndarray, " r"], point: Float[np.ndarray, "2"]) -> float:
    """Return the floor height [m] of the room, of those in `here`, that is nearest to a plan point."""
    away = [polygon_distance(rooms.polygon[r], point) for r in here]
    return float(rooms.floor[here[int(np.argmin(away))]])


def _main_direction(outlines: Sequence[Polygon]) -> float:
    """Return the yaw [rad], from -45 to 45 degrees, parallel or perpendicular to edges of the largest total length."""
    edge = np.concatenate([np.diff(boundary_edges(p), axis=1)[:, 0] for p in outlines])
    length, yaw = np.hypot(*edge.T), np.arctan2(edge[:, 1], edge[:, 0])
    stray = abs(np.sin(2 * (yaw[:, None] - yaw))) / 2  # sine of the deviation from parallel or perpendicular
    best = int(np.argmax((length * (stray < PARALLEL_TOLERANCE)).sum(axis=1) + 1e-6 * length))
    return float((yaw[best] + np.pi / 4) % (np.pi / 2) - np.pi / 4)


def _lines(outlines: Sequence[Polygon]) -> tuple[Float[np.ndarray, " nu"], Float[np.ndarray, " nv"]]:
    """Return ascending grid lines along both axes, through all corners and through points along slanted edges.

    A slanted edge is cut so that its pieces extend by at most `MAX_STRIP_WIDTH` along one of the axes. Lines within
    `LINE_MERGE_DISTANCE` become one.
    """
    points = []
    for outline in outlines:
        for a, b in boundary_edges(outline):
            stray = float(abs(b - a).min())
            count = int(np.ceil(stray / MAX_STRIP_WIDTH)) if stray > MAX_STRAIGHT_DEVIATION else 1
            points.append(a + (b - a) * np.linspace(0, 1, count + 1)[:, None])
    u, v = np.concatenate(points).T
    return merge_close_values(u, LINE_MERGE_DISTANCE), merge_close_values(v, LINE_MERGE_DISTANCE)


def highest_top_below(boxes: BoxSet, points: Float[np.ndarray, "p 2"], max_height: float) -> Float[np.ndarray, " p"]:
    """Return the highest top [m] at each plan point of the boxes whose top is at most `max_height`; -inf if none."""
    height = np.full(len(points), -np.inf)
    for i in np.flatnonzero(boxes.top <= max_height).tolist():
        local = (points - boxes.center[i, :2]) @ yaw_matrix(boxes.yaw[i])[:2, :2]
        inside = (abs(local) <= boxes.half[i, :2]).all(axis=1)
        height[inside] = np.maximum(height[inside], boxes.top[i])
    return height
