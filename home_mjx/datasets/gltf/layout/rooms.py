"""Rooms of a scene with their outlines and heights, stated by a file or found from the triangles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.layout.free_map import map_storey
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.room_search import find_outlines
from home_mjx.datasets.gltf.layout.storey_search import (
    LEVEL_SLOPE,
    MIN_STOREY_HEIGHT,
    UPRIGHT_SLOPE,
    dominant_height,
    find_storeys,
    floor_height,
)
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet
from home_mjx.geometry.polygons import is_inside_polygon
from home_mjx.schema.house import StatedOutline

DEFAULT_HEIGHT = 2.5  # [m], height of rooms without a ceiling and without walls
MIN_CEILING_HEIGHT = 1.8  # [m] above the floor
MAX_CEILING_HEIGHT = 6.0  # [m] above the floor
EDGE_REACH = 0.3  # [m], distance around a room's box at which its walls are looked for


@dataclass(frozen=True)
class SceneRoom:
    """A room with its storey.

    Attributes:
        level: Index of the storey, from below.
        types: Names of `ROOM_TYPES`; empty if unknown.
        shape: Outline and heights.
    """

    level: int
    types: tuple[str, ...]
    shape: StatedOutline


def find_rooms(triangles: TriangleSet, stated: Sequence[StatedRoom], split: bool) -> list[SceneRoom]:
    """Return the rooms of a scene, by storey.

    Args:
        triangles: Triangles of its architecture.
        stated: Rooms that a file states; none: they are found.
        split: Whether narrow passages separate rooms; without effect on stated ones.
    """
    storeys = find_storeys(triangles)
    if stated:
        return [_stated(triangles, storeys, room) for room in sorted(stated, key=lambda r: r.level)]
    found = []
    for storey in storeys:
        free = map_storey(triangles, storey)
        outlines = find_outlines(free, split) if free is not None else []
        rooms = [_measured(triangles, storeys, corners, storey) for corners in outlines]
        level = max((room.level for room in found), default=-1) + 1
        found += [replace(room, level=level) for room in rooms]
    return found


def _stated(triangles: TriangleSet, storeys: Sequence[float], room: StatedRoom) -> SceneRoom:
    """Return a stated room; heights that it lacks are found from the triangles."""
    storey = room.floor if room.floor is not None else storeys[min(room.level, len(storeys) - 1)] if storeys else 0.0
    found = _measured(triangles, storeys, room.corners, storey)
    floor = found.shape.floor if room.floor is None else room.floor
    ceiling = found.shape.ceiling if room.ceiling is None else room.ceiling
    shape = StatedOutline(room.corners, floor, max(ceiling, floor + 1e-3))
    return SceneRoom(room.level, (room.type,) if room.type else (), shape)


def _measured(
    triangles: TriangleSet, storeys: Sequence[float], corners: Float[np.ndarray, "n 2"], storey: float
) -> SceneRoom:
    """Return a room of unknown type and level 0 with the heights of its floor and ceiling."""
    inside = triangles[is_inside_polygon(corners, triangles.middle[:, [0, 2]])]
    floor = floor_height(inside, storey)
    above = [height for height in storeys if height > storey + MIN_STOREY_HEIGHT / 2]
    most = min([floor + MAX_CEILING_HEIGHT, *above])
    return SceneRoom(0, (), StatedOutline(corners, floor, _ceiling(triangles, inside, corners, floor, most)))


def _ceiling(
    triangles: TriangleSet, inside: TriangleSet, corners: Float[np.ndarray, "n 2"], floor: float, most: float
) -> float:
    """Return the height of a room's ceiling: of level faces that face down, else of the top of walls around it [m]."""
    height = inside.middle[:, 1]
    good = (inside.slope < -LEVEL_SLOPE) & (height > floor + MIN_CEILING_HEIGHT) & (height < most)
    if good.any():
        return dominant_height(height[good], inside.area[good], upper=False)
    low, high = corners.min(axis=0) - EDGE_REACH, corners.max(axis=0) + EDGE_REACH
    plan = triangles.middle[:, [0, 2]]
    near = ((plan > low) & (plan < high)).all(axis=1) & (abs(triangles.slope) < UPRIGHT_SLOPE)
    near &= triangles.within(floor + MIN_CEILING_HEIGHT, most)
    top = float(np.quantile(triangles.heights[near, 1], 0.9)) if near.any() else floor + DEFAULT_HEIGHT
    return min(top, most)
