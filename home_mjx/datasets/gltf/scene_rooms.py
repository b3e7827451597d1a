"""Rooms of a scene with objects: stated by a file, found from its architecture, or one room around everything."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.house import SceneObject
from home_mjx.datasets.gltf.layout.room_file import StatedRoom, room_file_path
from home_mjx.datasets.gltf.layout.rooms import SceneRoom, find_rooms
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet, concat_triangles
from home_mjx.errors import DatasetError
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.house import Fallback, Material, Problem

MARGIN = 1.5  # [m], of an added floor around all objects
MIN_HEIGHT = 2.5  # [m], minimum height of a room without walls
HEADROOM = 0.3  # [m], minimum height of such a room above its objects


@dataclass(frozen=True)
class FoundRooms:
    """Rooms of a scene, and its architecture with the floor that it may have lacked.

    Attributes:
        rooms: The rooms, by storey.
        triangles: Triangles of the architecture in the house.
        problems: How the rooms were found.
        fallbacks: The added floor, if any.
    """

    rooms: tuple[SceneRoom, ...]
    triangles: TriangleSet
    problems: tuple[Problem, ...] = ()
    fallbacks: tuple[Fallback, ...] = ()


def scene_rooms(
    path: Path,
    objects: Sequence[SceneObject],
    triangles: TriangleSet,
    stated: Sequence[StatedRoom],
    split: bool,
    strict: bool,
    element: str = "worldbody",
    floor: float | None = None,
) -> FoundRooms:
    """Return the rooms of a scene.

    Args:
        path: Its file, whose name may tell the type of a single room.
        objects: Its objects.
        triangles: Its architecture.
        stated: Rooms of its room file; none: they are found.
        split: Whether narrow passages separate rooms.
        strict: Refuse scenes without a floor, instead of adding one.
        element: Element of the file that holds the architecture, for messages.
        floor: Height of a floor that is added [m]; None: that of the lowest point.

    Raises:
        DatasetError: The scene has no floor, and `strict` is set.
    """
    rooms = find_rooms(triangles, stated, split) if len(triangles) else []
    if rooms:
        rooms = rooms if stated else _typed(path, rooms)
        message = f"{len(rooms)} rooms on {rooms[-1].level + 1} storeys were found from the geometry"
        return FoundRooms(tuple(rooms), triangles, () if stated else (Problem(element, message),))
    if strict:
        hint = f"State its rooms in {room_file_path(path).name}, and add a floor."
        raise DatasetError("scene has no floor", file=path, element=element, hint=hint)
    room, triangles = _open_room(objects, triangles, floor)
    rooms = _typed(path, find_rooms(triangles, [room], split))
    where = "the height of its lowest point" if floor is None else f"a height of {floor:.2f} m"
    replacement = f"a level floor around everything, at {where}"
    return FoundRooms(tuple(rooms), triangles, (), (Fallback("room mesh", "floor", element, replacement),))


def _typed(path: Path, rooms: list[SceneRoom]) -> list[SceneRoom]:
    """Return a single room with the type that the file's name has, such as `kitchen1.xml`; others unchanged."""
    words = {word.lower() for word in re.findall(r"[A-Za-z]+", path.stem)}
    types = tuple(name for name in ROOM_TYPES if name.lower() in words)[:1]
    return [replace(rooms[0], types=types)] if len(rooms) == 1 else rooms


def _open_room(
    objects: Sequence[SceneObject], triangles: TriangleSet, floor: float | None
) -> tuple[StatedRoom, TriangleSet]:
    """Return a room around everything, and the architecture with a floor, by default at that of the lowest point."""
    points = np.concatenate([one.points for one in objects] + [triangles.corners.reshape(-1, 3)])
    low, high = points.min(axis=0), points.max(axis=0)
    (x0, z0), (x1, z1) = low[[0, 2]] - MARGIN, high[[0, 2]] + MARGIN
    corners = np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
    base = float(low[1]) if floor is None else floor
    ceiling = max(base + MIN_HEIGHT, high[1] + HEADROOM)
    room = StatedRoom(corners, floor=base, ceiling=float(ceiling))
    return room, concat_triangles([_floor(corners, base, triangles), triangles])


def _floor(corners: Float[np.ndarray, "4 2"], height: float, other: TriangleSet) -> TriangleSet:
    """Return a floor that faces up; its material is the last slot, which `other` is given as well."""
    points = np.insert(corners, 1, height, axis=1)[[[0, 2, 1], [0, 3, 2]]]
    materials = (*other.materials, Material("floor", (0.6, 0.6, 0.6), None, 1.0))
    slot = np.full(2, len(materials) - 1)
    return TriangleSet(points, np.zeros((2, 3, 2)), slot, materials)
