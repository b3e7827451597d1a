"""World frame of a house, and its rooms: outlines and heights, derived from their meshes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.errors import DatasetError
from home_mjx.geometry.meshes import to_z_up, triangles_z_up
from home_mjx.geometry.polygons import bounding_outline, outline
from home_mjx.geometry.slabs import signed_area
from home_mjx.schema.categories import room_labels, room_type_index
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import House, Mesh, RoomNode, StatedOutline


def ground_floor_height(rooms: RoomTable) -> float:
    """Return the height of the lowest floor on the lowest level that has rooms [m]."""
    return float(rooms.floor[rooms.level == rooms.level.min()].min())


def world_triangles(mesh: Mesh, offset: Float[np.ndarray, "3"]) -> Float[np.ndarray, "f 3 3"]:
    """Return the triangles of a mesh, Y up as in the file, in the world frame: Z up, moved by `offset` [m]."""
    return triangles_z_up(mesh) + offset


def house_rooms(house: House) -> list[tuple[int, RoomNode]]:
    """Return pairs (level index, room) in file order; a pair's position is the room index."""
    return [(level.index, room) for level in house.levels for room in level.rooms]


def ground_offset(house: House) -> Float[np.ndarray, "3"]:
    """Return the offset (z = 0) of Z-up file coordinates that moves the centre of the ground-floor rooms to x = y = 0.

    The ground floor is the first level that has a mesh of a room; its centre is that of the meshes' bounding box.

    Raises:
        DatasetError: The house has no room with a mesh.
    """
    for level in house.levels:
        meshes = [m for room in level.rooms for m in (room.floor, room.ceiling, room.walls) if m is not None]
        if meshes:
            points = to_z_up(np.concatenate([m.vertices for m in meshes]).astype(np.float64))
            middle = (points.min(axis=0) + points.max(axis=0)) / 2
            return np.array([-middle[0], -middle[1], 0.0])
    raise DatasetError(
        "the house has no room with a floor, ceiling or wall mesh",
        file=house.path,
        hint="Restore the folder room/<house id>, or leave this house out.",
    )


def extract_rooms(house: House, offset: Float[np.ndarray, "3"]) -> RoomTable:
    """Return types, levels, outlines and heights of all rooms in file order, in Z-up coordinates moved by `offset` [m].

    Rooms without meshes have an empty outline and heights 0. The house must have a room.
    """
    found = house_rooms(house)
    polygons, heights = zip(*(_measure(room, offset) for _, room in found), strict=True)
    floor, ceiling = np.array(heights).T
    return RoomTable(
        type=np.array([_first_type(room) for _, room in found], np.int32),
        level=np.array([level for level, _ in found], np.int32),
        polygon=tuple(polygons),
        floor=floor,
        ceiling=ceiling,
        labels=np.array([room_labels(room.types) for _, room in found], np.int32),
    )


def _first_type(room: RoomNode) -> int:
    """Return the first known label of a room as an index into `ROOM_TYPES`; -1 if it has none."""
    return next((index for index in map(room_type_index, room.types) if index >= 0), -1)


def _measure(room: RoomNode, offset: Float[np.ndarray, "3"]) -> tuple[Float[np.ndarray, "n 2"], tuple[float, float]]:
    """Return a room's outline, top of its floor and underside of its ceiling [m].

    The outline is that of the floor with its holes, else of the ceiling, else the rectangle around the walls. Without a
    floor or a ceiling, the lowest or highest point of the other meshes replaces it. Without any mesh, the outline is
    empty and the heights are 0. A stated `shape` is used instead of meshes.
    """
    if room.shape is not None:
        return _stated_outline(room.shape) + offset[:2], (room.shape.floor, room.shape.ceiling)
    meshes = (room.floor, room.ceiling, room.walls)
    floor, ceiling, walls = (None if m is None else world_triangles(m, offset) for m in meshes)
    parts = [p for p in (floor, ceiling, walls) if p is not None]
    if not parts:
        return np.zeros((0, 2)), (0.0, 0.0)
    low, high = min(p[..., 2].min() for p in parts), max(p[..., 2].max() for p in parts)
    heights = low if floor is None else floor[..., 2].max(), high if ceiling is None else ceiling[..., 2].min()
    slab = floor if floor is not None else ceiling
    polygon = bounding_outline(parts[0]) if slab is None else outline(slab, with_holes=slab is floor)
    return polygon, (float(heights[0]), float(heights[1]))


def _stated_outline(shape: StatedOutline) -> Float[np.ndarray, "n 2"]:
    """Return the stated corners of a room in Z-up coordinates (x, y), counter-clockwise [m]."""
    corners = shape.corners * [1.0, -1.0]
    return corners if signed_area(corners) > 0 else corners[::-1]


@dataclass(frozen=True)
class HouseFrame:
    """A house with its rooms in the world frame (Z up, metres).

    Attributes:
        house: House as read from the dataset.
        offset: Translation added to Z-up file coordinates [m].
        rooms: Outlines, floor heights and ceiling heights in the world frame.
    """

    house: House
    offset: Float[np.ndarray, "3"]
    rooms: RoomTable


def find_frame(house: House) -> HouseFrame:
    """Return the world frame of a house, with the centre of its ground-floor rooms at x = y = 0.

    Raises:
        DatasetError: The house has no room with a mesh.
    """
    offset = ground_offset(house)
    return HouseFrame(house, offset, extract_rooms(house, offset))
