"""JSON of ProcTHOR and its dialects to records; errors name the file and the element."""

import re
from collections.abc import Sequence

import numpy as np

from home_mjx.datasets.procthor.parse_openings import parse_openings, parse_walls
from home_mjx.datasets.procthor.parse_values import (
    MAX_LISTED,
    color_or_none,
    listed,
    material,
    number_or,
    plan_point,
    text_or,
    triple,
)
from home_mjx.datasets.procthor.records import Point, ThorHouse, ThorLight, ThorMaterial, ThorObject, ThorRoom, ThorWall
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.errors import DatasetError
from home_mjx.geometry.slabs import simplify
from home_mjx.schema.house import Problem

SCHEMA = "1.0.0"
DEFAULT_HEIGHT = 2.7  # [m], of a house without walls
MAX_DEPTH = 8  # of things on things
KEPT_FIELDS = ("metadata", "proceduralParameters")  # in `House.extra`
METADATA_HINT = "Dumps of a running scene (iTHOR's metadata) have no rooms: only houses of ProcTHOR are read."
OLD_SCHEMA = Problem("metadata.schema", "file has no schema: read as one from before 1.0.0")
WHITE = ThorMaterial("PureWhite")


def parse_house(document: JsonValue) -> ThorHouse:
    """Return the records of a house.

    Raises:
        DatasetError: A field is missing or has a wrong value, the schema is unknown, or the house shows nothing.
    """
    if not isinstance(document.data, dict) or "rooms" not in document.data:
        raise document.error("expected a house of ProcTHOR with `rooms` and `walls`", METADATA_HINT)
    schema = _schema(document)
    walls = parse_walls(document)
    parameters = document.member("proceduralParameters")
    rooms = _rooms(document, walls, material(_member(parameters, "ceilingMaterial"), WHITE))
    return ThorHouse(
        schema=schema,
        rooms=rooms,
        walls=walls,
        openings=parse_openings(document, walls),
        open_lines=(*_open_lines(document), *((wall.start, wall.end) for wall in walls if wall.is_empty)),
        objects=_objects(document.member("objects")),
        lights=tuple(_lights(parameters)),
        height=max((wall.height for wall in walls), default=DEFAULT_HEIGHT),
        problems=() if schema else (OLD_SCHEMA,),
        extra={key: document.data[key] for key in KEPT_FIELDS if key in document.data},
    )


def _member(value: JsonValue, key: str) -> JsonValue:
    """Return a member of an object that may be absent."""
    return value.member(key) if value.has_value else value


def _schema(document: JsonValue) -> str:
    """Return the schema; "" for files from before schemas had a number."""
    found = _member(_member(document, "metadata"), "schema")
    schema = text_or(found, "")
    if schema not in ("", SCHEMA):
        raise found.error(f"schema `{schema:.40}` is unknown, only {SCHEMA} is read", "Write the house again.")
    return schema


def _rooms(document: JsonValue, walls: Sequence[ThorWall], ceiling: ThorMaterial) -> tuple[ThorRoom, ...]:
    entries = listed(document.member("rooms"))
    if not entries:
        raise document.member("rooms").error("house shows nothing: it has no rooms", "Give a house with rooms.")
    return tuple(_room(entry, walls, ceiling) for entry in entries)


def _room(entry: JsonValue, walls: Sequence[ThorWall], ceiling: ThorMaterial) -> ThorRoom:
    name, kind = text_or(entry.member("id"), entry.element), entry.member("roomType")
    own = [wall for wall in walls if _same_room(wall.room, name)]
    inside = [wall.material for wall in own if not wall.is_exterior]
    outside = [wall.material for wall in own if wall.is_exterior]
    stated = [material(part.member("material"), ceiling) for part in listed(entry.member("ceilings"))]
    return ThorRoom(
        id=name,
        type=kind.text() if kind.has_value else "",
        corners=_corners(entry.member("floorPolygon")),
        floor=material(entry.member("floorMaterial"), ThorMaterial("WoodFloor")),
        walls=material(entry.member("wallMaterial"), inside[0] if inside else WHITE),
        outside=outside[0] if outside else WHITE,
        ceiling=stated[0] if stated else ceiling,
    )


def _same_room(wall: str, room: str) -> bool:
    """Return whether a wall's id of a room means a room; old files write `4` for `room|4`."""
    return wall == room or wall.removeprefix("room|") == room.removeprefix("room|")


def _corners(polygon: JsonValue) -> tuple[Point, ...]:
    if not polygon.has_value:
        raise polygon.error("room lacks `floorPolygon`, the corners of its floor")
    corners = tuple(plan_point(corner) for corner in listed(polygon))
    try:
        simplify(np.array(corners, float).reshape(-1, 2))
    except DatasetError:
        raise
    except ValueError as error:
        raise polygon.error(f"room has no floor: {error}", "Correct its corners.") from None
    return corners


def _open_lines(document: JsonValue) -> list[tuple[Point, Point]]:
    """Return the lines between rooms that are open to each other without a record of a wall (Holodeck)."""
    lines = [line.entries() for line in listed(_member(document.member("open_walls"), "segments"))]
    return [(plan_point(line[0]), plan_point(line[1])) for line in lines if len(line) == 2]


def _objects(entries: JsonValue) -> tuple[ThorObject, ...]:
    found = tuple(_object(entry, 0) for entry in listed(entries))
    if (count := sum(map(count_things, found))) > MAX_LISTED:
        raise entries.error(f"expected at most {MAX_LISTED} things, got {count}")
    return found


def count_things(thing: ThorObject) -> int:
    """Return the number of a thing and all things on it."""
    return 1 + sum(map(count_things, thing.children))


def _object(entry: JsonValue, depth: int) -> ThorObject:
    if depth > MAX_DEPTH:
        raise entry.error(f"things are stacked more than {MAX_DEPTH} deep")
    name = text_or(entry.member("id"), "")
    parts = name.split("|")
    room = text_or(entry.member("roomId"), f"room|{parts[1]}" if len(parts) > 1 else "")
    turn = entry.member("rotation")
    return ThorObject(
        element=entry.element,
        asset=entry.member("assetId").text(),
        kind=text_or(entry.member("objectType"), re.sub(r"-\d+.*$", "", parts[0])),
        room=room,
        position=triple(entry.member("position")),
        rotation=triple(turn) if turn.has_value else (0.0, 0.0, 0.0),
        children=tuple(_object(child, depth + 1) for child in listed(entry.member("children"))),
        footprint=_footprint(entry.member("vertices")),
    )


def _footprint(vertices: JsonValue) -> tuple[float, float] | None:
    """Return the extents along x and z of a footprint in centimetres (Holodeck); None if the file has none."""
    points = [plan_point(corner) for corner in listed(vertices)]
    if not points:
        return None
    width, depth = (np.ptp(np.array(points), axis=0) / 100).tolist()
    return width, depth


def _lights(parameters: JsonValue) -> list[ThorLight]:
    """Return the point lights that shine; the sun is none of them."""
    entries = listed(_member(parameters, "lights"))
    points = [entry for entry in entries if text_or(entry.member("type"), "point") == "point"]
    lights = [
        ThorLight(
            triple(entry.member("position")),
            color_or_none(entry.member("rgb")) or (1.0, 1.0, 1.0),
            number_or(entry.member("intensity"), 1.0),
        )
        for entry in points
    ]
    return [light for light in lights if light.intensity > 0]
