"""Rooms of a house: outlines and heights, from their meshes."""

import numpy as np
from jaxtyping import Float, Int

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.geometry.mesh import to_z_up
from home_mjx.scene_compile.geometry.polygons import polygon_area
from home_mjx.schema.categories import room_type_index
from home_mjx.schema.compiled import Rooms
from home_mjx.schema.house import House, Mesh, Room


def ground_floor(rooms: Rooms) -> float:
    """Height of the floor of the lowest level that has rooms [m]."""
    return float(rooms.floor[rooms.level == rooms.level.min()].min())


MERGE = 1e-4  # [m]: corners nearer than this are one


def triangles_of(mesh: Mesh, offset: Float[np.ndarray, "3"]) -> Float[np.ndarray, "f 3 3"]:
    """A room's mesh in the world frame [m]."""
    return to_z_up(mesh.vertices.astype(np.float64))[mesh.faces] + offset


def house_rooms(house: House) -> list[tuple[int, Room]]:
    """Level index and room, in file order."""
    return [(level.index, room) for level in house.levels for room in level.rooms]


def ground_offset(house: House) -> Float[np.ndarray, "3"]:
    """Offset of Z-up file coordinates that puts the middle of the ground floor's rooms at x = y = 0.

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


def extract_rooms(house: House, offset: Float[np.ndarray, "3"]) -> Rooms:
    """Outlines, floors and ceilings of all rooms.

    Args:
        house: The house.
        offset: Added to Z-up file coordinates [m].
    """
    found = house_rooms(house)
    polygons, heights = zip(*(_measure(room, offset) for _, room in found), strict=True)
    floor, ceiling = np.array(heights).T
    return Rooms(
        type=np.array([room_type_index(room.types[0]) if room.types else -1 for _, room in found], np.int32),
        level=np.array([level for level, _ in found], np.int32),
        polygon=tuple(polygons),
        floor=floor,
        ceiling=ceiling,
    )


def _measure(room: Room, offset: Float[np.ndarray, "3"]) -> tuple[Float[np.ndarray, "n 2"], tuple[float, float]]:
    """Outline and heights; visible parts replace hidden ones."""
    meshes = (room.floor, room.ceiling, room.walls)
    floor, ceiling, walls = (None if m is None else triangles_of(m, offset) for m in meshes)
    parts = [p for p in (floor, ceiling, walls) if p is not None]
    if not parts:
        return np.zeros((0, 2)), (0.0, 0.0)
    low, high = min(p[..., 2].min() for p in parts), max(p[..., 2].max() for p in parts)
    heights = low if floor is None else floor[..., 2].max(), high if ceiling is None else ceiling[..., 2].min()
    slab = floor if floor is not None else ceiling
    return (_bounding_outline(parts[0]) if slab is None else outline(slab)), (float(heights[0]), float(heights[1]))


def _bounding_outline(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "4 2"]:
    (x0, y0), (x1, y1) = triangles[..., :2].min(axis=(0, 1)), triangles[..., :2].max(axis=(0, 1))
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def outline(slab: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "n 2"]:
    """The outer edge of a slab's upper side, counter-clockwise.

    Args:
        slab: Its triangles [m].
    """
    normal = np.cross(slab[:, 1] - slab[:, 0], slab[:, 2] - slab[:, 0])
    upper = (normal[:, 2] > 0.7 * np.linalg.norm(normal, axis=1)) & (normal[:, 2] > 1e-12)
    if not upper.any():
        return _bounding_outline(slab)
    points = np.round(slab[upper, :, :2] / MERGE).astype(np.int64).reshape(-1, 2)
    corners, index = np.unique(points, axis=0, return_inverse=True)
    loops = _boundary_loops(index.reshape(-1, 3))
    polygons = [_straighten(corners[loop] * MERGE) for loop in loops]
    largest = max(polygons, key=polygon_area, default=np.zeros((0, 2)))
    area = np.linalg.norm(normal[upper], axis=1).sum() / 2
    # Triangles that do not share corners give several loops; none of them is the outline.
    return largest if polygon_area(largest) > 0.9 * area else _bounding_outline(slab)


def _boundary_loops(triangles: Int[np.ndarray, "t 3"]) -> list[list[int]]:
    """Closed walks along the edges that only one triangle has."""
    edges = {(int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3)}
    following: dict[int, list[int]] = {}
    for a, b in edges:
        if a != b and (b, a) not in edges:
            following.setdefault(a, []).append(b)
    loops = []
    while following:
        loop = _walk(following)
        if len(loop) >= 3:
            loops.append(loop)
    return loops


def _walk(following: dict[int, list[int]]) -> list[int]:
    first = corner = next(iter(following))
    loop = []
    while corner in following:
        loop.append(corner)
        step = following[corner].pop()
        if not following[corner]:
            del following[corner]
        corner = step
        if corner == first:
            return loop
    return []


def _straighten(polygon: Float[np.ndarray, "n 2"], bend: float = 1e-3) -> Float[np.ndarray, "_ 2"]:
    """A polygon without the corners that lie on the line between their neighbours, within `bend` metres."""
    keep = []
    for i in range(len(polygon)):
        before, here, after = polygon[i - 1], polygon[i], polygon[(i + 1) % len(polygon)]
        way = after - before
        away = abs(way[0] * (here - before)[1] - way[1] * (here - before)[0]) / max(np.hypot(*way), MERGE)
        if away > bend:
            keep.append(i)
    return polygon[keep] if len(keep) >= 3 else polygon
