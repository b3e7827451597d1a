"""Floors, ceilings and walls of a house, and its doors and windows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.outlines import SLAB_THICKNESS, RoomOutline, WallOpening, outline_house
from home_mjx.datasets.procthor.records import Point, ThorHouse, ThorMaterial, ThorRoom
from home_mjx.datasets.procthor.surfaces import room_type, surface_material
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.schema.house import House, Material, Mesh, RoomNode

FLOOR = SLAB_THICKNESS  # [m], height of the floor's top, which is 0 in ProcTHOR


def to_plan(point: Point) -> Point:
    """Return (x, z) in our right-handed frame of a point in Unity's left-handed one.

    Example:
        >>> to_plan((2.0, 3.0))
        (2.0, -3.0)
    """
    return point[0], 0.0 - point[1]


def room_polygon(room: ThorRoom) -> Float[np.ndarray, "n 2"]:
    """Return the corners (x, z) of a room in our frame [m]."""
    return np.array([to_plan(corner) for corner in room.corners])


def build_shell(house: ThorHouse, house_id: str, file: Path, provider: FurnitureProvider) -> House:
    """Build a house of its rooms alone, with holes for doors, windows and open walls.

    Raises:
        DatasetError: The outline of a room crosses itself.
    """
    top = house.height + FLOOR
    holes = [WallOpening(to_plan(a), to_plan(b), 0.0, top) for a, b in house.open_lines]
    for found in house.openings:
        low = found.low + FLOOR if found.kind == "window" else 0.0
        holes.append(WallOpening(to_plan(found.start), to_plan(found.end), low, found.high + FLOOR))
    outlines = [_outline(room, provider) for room in house.rooms]
    try:
        built = outline_house(house_id, outlines, holes, height=top)
    except ConfigError as error:
        element = (error.element or "rooms").replace("corners", "floorPolygon")
        raise DatasetError(error.message, file=file, element=element, hint="Correct its corners.") from None
    rooms = tuple(_with_texture_scale(room, provider.texture_edge) for room in built.levels[0].rooms)
    return replace(built, levels=(replace(built.levels[0], rooms=rooms),))


def _outline(room: ThorRoom, provider: FurnitureProvider) -> RoomOutline:
    def wall(material: ThorMaterial) -> Material:
        return surface_material(material, False, provider)

    return RoomOutline(
        type=room_type(room.type),
        corners=[to_plan(corner) for corner in room.corners],
        floor=surface_material(room.floor, True, provider),
        walls=wall(room.walls),
        ceiling=wall(room.ceiling),
        outside=wall(room.outside),
    )


def _with_texture_scale(room: RoomNode, edge: float) -> RoomNode:
    """Return a room whose UVs, in metres, become repeats of textures that cover squares of `edge` [m]."""

    def scaled(mesh: Mesh | None) -> Mesh | None:
        return None if mesh is None else replace(mesh, uv=mesh.uv / edge)

    types = tuple(name for name in room.types if name)
    return replace(room, types=types, floor=scaled(room.floor), ceiling=scaled(room.ceiling), walls=scaled(room.walls))
