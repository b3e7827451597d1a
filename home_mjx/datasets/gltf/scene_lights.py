"""Lights of a scene on its objects: each on the nearest one in the same room."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.polygons import is_inside_polygon, polygon_area
from home_mjx.schema.house import Level, Light, ObjectNode, Vector

OTHER_ROOM = 1e6  # [m], added to the distance of objects in other rooms
ROOM_POWER = 3.0  # [W/m^2], mean power of the lights of a house per floor area, since lights of scenes have no unit


@dataclass(frozen=True)
class SceneLight:
    """A point light or spot in the house.

    Attributes:
        element: Its name in messages.
        light: The record, in the house's frame.
    """

    element: str
    light: Light


def floor_area(levels: Sequence[Level]) -> float:
    """Return the area of all rooms with stated outlines [m^2]."""
    return sum(polygon_area(room.shape.corners) for level in levels for room in level.rooms if room.shape is not None)


def add_lights(levels: Sequence[Level], lights: Sequence[SceneLight]) -> tuple[Level, ...]:
    """Return levels with each light on the nearest object or piece of its room, in whose frame it is."""
    found = list(levels)
    carriers = [(number, node) for number, level in enumerate(levels) for node in level.objects]
    places = np.array([node.transform[:3, 3] for _, node in carriers]).reshape(-1, 3)
    for one in lights if carriers else ():
        place = np.array(one.light.position)
        outline = _outline_around(levels, place)
        away = np.linalg.norm(places - place, axis=1)
        if outline is not None:
            away = away + OTHER_ROOM * ~is_inside_polygon(outline, places[:, [0, 2]])
        number, node = carriers[int(away.argmin())]
        objects = [_lit(o, one.light) if o.id == node.id else o for o in found[number].objects]
        found[number] = replace(found[number], objects=tuple(objects))
    return tuple(found)


def _outline_around(levels: Sequence[Level], place: Float[np.ndarray, "3"]) -> Float[np.ndarray, "n 2"] | None:
    """Return the outline of the highest room whose floor is below a place; None if no room is."""
    rooms = [room.shape for level in levels for room in level.rooms if room.shape is not None]
    below = [shape for shape in rooms if shape.floor < place[1] and _is_in(shape.corners, place)]
    return max(below, key=lambda shape: shape.floor).corners if below else None


def _is_in(outline: Float[np.ndarray, "n 2"], place: Float[np.ndarray, "3"]) -> bool:
    """Return whether a place is in an outline (x, z)."""
    return bool(is_inside_polygon(outline, place[[0, 2]]))


def _lit(node: ObjectNode, light: Light) -> ObjectNode:
    """Return an object with one light more, moved from the house's frame to its own."""
    back = np.linalg.inv(node.transform)
    aim = None if light.direction is None else back[:3, :3] @ np.array(light.direction)
    own = replace(
        light,
        position=to_vector(back[:3, :3] @ np.array(light.position) + back[:3, 3]),
        direction=None if aim is None else to_vector(aim / np.linalg.norm(aim)),
    )
    return replace(node, lights=(*node.lights, own))


def to_vector(values: Float[np.ndarray, "3"]) -> Vector:
    """Return three values as a tuple of floats."""
    x, y, z = np.asarray(values, float).tolist()
    return x, y, z
