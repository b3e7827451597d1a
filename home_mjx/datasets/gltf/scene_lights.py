"""Lights of a scene on its objects: each on the nearest one in the same room."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.geometry.meshes import bounds
from home_mjx.geometry.polygons import is_inside_polygon, polygon_area
from home_mjx.schema.house import Level, Light, Mesh, ObjectNode, Vector

OTHER_ROOM = 1e6  # [m], added to the distance of objects in other rooms
ROOM_POWER = 3.0  # [W/m^2], mean power of the lights of a house per floor area, where a file has no units
MAX_LIGHTS = 1_000  # maximum number of lights of a scene
TOO_MANY = f"scene has more than {MAX_LIGHTS} lights"
MAX_FACTOR = 30.0  # maximum ratio of stated power to `ROOM_POWER`, and of `ROOM_POWER` to stated power


@dataclass(frozen=True)
class SceneLight:
    """A point, line or spot in the house.

    Attributes:
        element: Its name in messages.
        light: The record, in the house's frame.
    """

    element: str
    light: Light


def floor_area(levels: Sequence[Level]) -> float:
    """Return the area of all rooms with stated outlines [m^2]."""
    return sum(polygon_area(room.shape.corners) for level in levels for room in level.rooms if room.shape is not None)


def plausible_lights(lights: Sequence[SceneLight], area: float, notes: dict[str, str]) -> list[SceneLight]:
    """Return lights of stated powers, scaled to `ROOM_POWER` on average where they are off by over `MAX_FACTOR`.

    Args:
        lights: The lights.
        area: Area of all rooms [m^2].
        notes: Receives that they are scaled.
    """
    total, expected = sum(one.light.power for one in lights), ROOM_POWER * area
    if not lights or expected / MAX_FACTOR <= total <= expected * MAX_FACTOR or total <= 0:
        return list(lights)
    notes["lights"] = f"{total / max(area, 1e-9):.3g} W per m^2 of floor are scaled to {ROOM_POWER:g}"
    return [replace(one, light=replace(one.light, power=one.light.power * expected / total)) for one in lights]


def add_lights(
    path: Path, levels: Sequence[Level], models: Mapping[str, Mesh], lights: Sequence[SceneLight]
) -> tuple[Level, ...]:
    """Return levels with each light on the nearest object or piece of its room, in whose frame it is.

    The nearest is the one whose box is, of those that are as near to the middle of the light, the smallest one.

    Args:
        path: File of the scene, for messages.
        levels: The levels.
        models: Meshes of their objects.
        lights: The lights.

    Raises:
        DatasetError: Lights are more than `MAX_LIGHTS`.
    """
    if len(lights) > MAX_LIGHTS:
        raise Location(path, lights[MAX_LIGHTS].element).error(TOO_MANY, "Remove lights.")
    carriers = [node for level in levels for node in level.objects]
    if not lights or not carriers:
        return tuple(levels)
    boxes = np.array([_box(node, models) for node in carriers])
    carried: dict[int, list[Light]] = {}
    for one in lights:
        carried.setdefault(_nearest(levels, boxes, _middle(one.light)), []).append(one.light)
    lit = iter([_lit(node, carried.get(row, [])) for row, node in enumerate(carriers)])
    return tuple(replace(level, objects=tuple(next(lit) for _ in level.objects)) for level in levels)


def _middle(light: Light) -> Float[np.ndarray, "3"]:
    """Return the position of a light; of a line the middle between its ends."""
    return np.mean([light.position, light.end or light.position], axis=0)


def _nearest(levels: Sequence[Level], boxes: Float[np.ndarray, "n 2 3"], place: Float[np.ndarray, "3"]) -> int:
    """Return the row of the nearest box to a place in the same room, of those that are as near the smallest one."""
    middles, size = boxes.mean(axis=1), np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)
    outline = _outline_around(levels, place)
    away = np.linalg.norm(np.maximum(np.maximum(boxes[:, 0] - place, place - boxes[:, 1]), 0), axis=1)
    if outline is not None:
        away = away + OTHER_ROOM * ~is_inside_polygon(outline, middles[:, [0, 2]])
    return int(np.lexsort((size, away))[0])


def _box(node: ObjectNode, models: Mapping[str, Mesh]) -> Float[np.ndarray, "2 3"]:
    """Return the corners of an object's box in the house [m]."""
    return bounds(models[node.model_key].vertices @ node.transform[:3, :3].T + node.transform[:3, 3])


def _outline_around(levels: Sequence[Level], place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "n 2"] | None:
    """Return the outline of the highest room whose floor is below a place; None if no room is."""
    rooms = [room.shape for level in levels for room in level.rooms if room.shape is not None]
    below = [shape for shape in rooms if shape.floor < place[1] and _is_in(shape.corners, place)]
    return max(below, key=lambda shape: shape.floor).corners if below else None


def _is_in(outline: Float[np.ndarray, "n 2"], place: Float[np.ndarray, "3"]) -> bool:
    """Return whether a place is in an outline (x, z)."""
    return bool(is_inside_polygon(outline, place[[0, 2]]))


def _lit(node: ObjectNode, lights: Sequence[Light]) -> ObjectNode:
    """Return an object with more lights, moved from the house's frame to its own."""
    if not lights:
        return node
    back = np.linalg.inv(node.transform)
    return replace(node, lights=(*node.lights, *(_moved(light, back) for light in lights)))


def _moved(light: Light, matrix: Float[np.ndarray, "4 4"]) -> Light:
    """Return a light in another frame, into which an affine matrix maps."""
    aim = None if light.direction is None else matrix[:3, :3] @ np.array(light.direction)
    return replace(
        light,
        position=to_vector(matrix[:3, :3] @ np.array(light.position) + matrix[:3, 3]),
        direction=None if aim is None else to_vector(aim / np.linalg.norm(aim)),
        end=None if light.end is None else to_vector(matrix[:3, :3] @ np.array(light.end) + matrix[:3, 3]),
    )


def to_vector(values: Float[np.ndarray, "3"]) -> Vector:
    """Return three values as a tuple of floats."""
    x, y, z = np.asarray(values, float).tolist()
    return x, y, z
