"""Polygons of the floor plan."""

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.schema.compiled import RoomTable


def polygon_area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Return the area of a simple polygon [m^2], by the shoelace formula."""
    x, y = polygon.T
    return float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2)


def is_inside_polygon(polygon: Float[np.ndarray, "n 2"], points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
    """Return whether points are inside a simple polygon, by the crossing number."""
    x, y = points[..., 0], points[..., 1]
    inside = np.zeros(x.shape, bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return inside


def polygon_distance(polygon: Float[np.ndarray, "n 2"], point: Float[np.ndarray, "2"]) -> float:
    """Return the distance from a point to a simple polygon [m]; 0 inside, infinite if the polygon has no corners."""
    if is_inside_polygon(polygon, point):
        return 0.0
    way = np.roll(polygon, -1, axis=0) - polygon
    along = np.sum((point - polygon) * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-12)
    nearest = polygon + np.clip(along, 0, 1)[:, None] * way
    return float(np.linalg.norm(nearest - point, axis=1).min(initial=np.inf))


def find_smallest_room(
    rooms: RoomTable, candidates: Int[np.ndarray, " r"], points: Float[np.ndarray, "*p 2"]
) -> Int[np.ndarray, "*p"]:
    """Return the index of the smallest room that contains each point, since rooms may nest; -1 if none."""
    found = np.full(points.shape[:-1], -1, np.int32)
    for room in sorted(candidates, key=lambda r: -polygon_area(rooms.polygon[r])):
        found[is_inside_polygon(rooms.polygon[room], points)] = room
    return found
