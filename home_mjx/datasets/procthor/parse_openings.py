"""Walls, doors and windows of ProcTHOR's JSON."""

from collections.abc import Mapping, Sequence

import numpy as np

from home_mjx.datasets.procthor.parse_values import (
    listed,
    material,
    number_or,
    plan_point,
    position,
    text_or,
)
from home_mjx.datasets.procthor.records import Point, ThorMaterial, ThorOpening, ThorWall
from home_mjx.datasets.suncg.formats.json_value import JsonValue

NUM_WALL_POINTS = 4
MIN_HEIGHT, MAX_HEIGHT = 1.0, 30.0  # [m], of walls
MIN_WIDTH = 0.05  # [m], of walls and openings
EXTERIOR = "exterior"
WALL_HINT = "A wall has four corners, two of them on the floor."


def parse_walls(document: JsonValue) -> tuple[ThorWall, ...]:
    """Return the walls; those without length are left out.

    Raises:
        DatasetError: A wall lacks a corner, or its height is out of range.
    """
    walls = (_wall(entry) for entry in listed(document.member("walls")))
    return tuple(wall for wall in walls if np.subtract(wall.end, wall.start).any())


def _wall(entry: JsonValue) -> ThorWall:
    points = listed(entry.member("polygon"))
    if len(points) != NUM_WALL_POINTS:
        raise entry.member("polygon").error(f"expected {NUM_WALL_POINTS} corners, got {len(points)}", WALL_HINT)
    heights = [position(corner.member("y")) for corner in points]
    first, second = sorted(range(NUM_WALL_POINTS), key=heights.__getitem__)[:2]  # stable: their order is the wall's
    height = max(heights) - min(heights)
    if not MIN_HEIGHT <= height <= MAX_HEIGHT:
        message = f"expected a wall between {MIN_HEIGHT:g} and {MAX_HEIGHT:g} m high, got {height:g} m"
        raise entry.member("polygon").error(message, WALL_HINT)
    name = text_or(entry.member("id"), entry.element)
    return ThorWall(
        id=name,
        room=text_or(entry.member("roomId"), ""),
        start=plan_point(points[first]),
        end=plan_point(points[second]),
        height=height,
        material=material(entry.member("material"), ThorMaterial("PureWhite")),
        is_empty=entry.member("empty").flag(),
        is_exterior=EXTERIOR in name,
    )


def parse_openings(document: JsonValue, walls: Sequence[ThorWall]) -> tuple[ThorOpening, ...]:
    """Return the doors and windows.

    Raises:
        DatasetError: One is in a wall that does not exist, or lacks its hole.
    """
    by_id = {wall.id: wall for wall in walls}
    return tuple(
        _opening(entry, kind, by_id) for kind in ("door", "window") for entry in listed(document.member(f"{kind}s"))
    )


def _opening(entry: JsonValue, kind: str, walls: Mapping[str, ThorWall]) -> ThorOpening:
    left, right, low, high = _hole(entry)
    start, end = _ends(entry, kind, walls, left, right)
    return ThorOpening(
        element=entry.element,
        kind=kind,
        asset=entry.member("assetId").text(),
        start=start,
        end=end,
        low=low,
        high=high,
        openable=entry.member("openable").flag(),
        openness=min(max(number_or(entry.member("openness"), 0.0), 0.0), 1.0),
        rooms=(text_or(entry.member("room0"), ""), text_or(entry.member("room1"), "")),
    )


def _hole(entry: JsonValue) -> tuple[float, float, float, float]:
    """Return a hole: from, to along its wall, from, to above the floor [m]; old files have a bounding box instead."""
    box = entry.member("boundingBox")
    corners = [box.member("min"), box.member("max")] if box.has_value else listed(entry.member("holePolygon"))
    if len(corners) < 2:
        raise entry.error("lacks `holePolygon`, the corners of its hole", "Two corners are enough.")
    along = [position(corner.member("x")) for corner in corners]
    up = [position(corner.member("y")) for corner in corners]
    if max(along) - min(along) < MIN_WIDTH or max(up) - min(up) < MIN_WIDTH:
        raise entry.error(f"hole is narrower than {MIN_WIDTH:g} m", "Correct `holePolygon`.")
    return min(along), max(along), min(up), max(up)


def _ends(entry: JsonValue, kind: str, walls: Mapping[str, ThorWall], left: float, right: float) -> tuple[Point, Point]:
    """Return the ends of a hole in the plan: those that the file states (Holodeck), else along its first wall."""
    stated = listed(entry.member(f"{kind}Segment"))
    if len(stated) == 2:
        return plan_point(stated[0]), plan_point(stated[1])
    name = text_or(entry.member("wall0"), "")
    if name not in walls:
        raise entry.member("wall0").error(f"there is no wall `{name:.60}`", "Name one of `walls`.")
    wall = walls[name]
    start = np.array(wall.start)
    way = np.subtract(wall.end, wall.start) / np.hypot(*np.subtract(wall.end, wall.start))
    (x0, z0), (x1, z1) = (start + way * left).tolist(), (start + way * right).tolist()
    return (x0, z0), (x1, z1)
