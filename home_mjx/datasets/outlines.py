"""Construction of houses from room outlines: meshes of floors, ceilings and walls for `write_house`."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.errors import ConfigError
from home_mjx.geometry.mesh_pieces import CUT_MATERIAL, MeshPiece, join_pieces, wall_pieces
from home_mjx.geometry.slabs import simplify, slab
from home_mjx.geometry.wall_prisms import WALL_DEPTH, Hole, WallSegment
from home_mjx.schema.house import BoxNode, House, Level, Material, Mesh, RoomNode

SLAB_THICKNESS = 0.05  # [m], of floors and ceilings; also the height of a floor's upper side
SLAB_OUTSET = WALL_DEPTH / 5  # [m], of floors and ceilings beyond the centre lines of walls
MIN_OPENING_WIDTH = 0.05  # [m], minimum width of an opening along a wall
PLASTER, WOOD = Material("plaster", (0.9, 0.9, 0.85)), Material("wood", (0.65, 0.5, 0.35))

Point = tuple[float, float]


@dataclass(frozen=True)
class RoomOutline:
    """A room of a floor plan.

    Attributes:
        type: One of `schema.ROOM_TYPES`.
        corners: (x, z) of the centre lines of its walls in order [m]; two rooms share a wall if they share a line.
        floor: Material of the floor.
        walls: Material of the walls' inner faces.
        ceiling: Material of the ceiling.
        outside: Material of the walls' outer faces.
    """

    type: str
    corners: Sequence[Point]
    floor: Material = WOOD
    walls: Material = PLASTER
    ceiling: Material = PLASTER
    outside: Material = PLASTER


@dataclass(frozen=True)
class WallOpening:
    """A hole through every wall along its line.

    Attributes:
        start: (x, z) of one end, on the centre line of a wall [m].
        end: (x, z) of the other end [m].
        low: Height of its lower edge; 0 for a doorway [m].
        high: Height of its upper edge [m].
    """

    start: Point
    end: Point
    low: float = 0.0
    high: float = 2.1


def outline_house(
    house_id: str,
    rooms: Sequence[RoomOutline],
    openings: Sequence[WallOpening] = (),
    boxes: Sequence[BoxNode] = (),
    height: float = 2.7,
) -> House:
    """Build a house of one level with walls along the outlines of its rooms. Y is up, in metres.

    An opening that is in no wall is ignored. Boxes follow the rooms and are members of none.

    Args:
        house_id: Id of the house and name of its folders.
        rooms: Rooms of the house; neighbours share lines.
        openings: Doorways and windows.
        boxes: Plain furniture; ids and indices are reassigned.
        height: Height of the walls [m].

    Raises:
        ConfigError: The outline of a room has no area or crosses itself.

    Example:
        >>> house = outline_house("cabin", [RoomOutline("Bedroom", [(0, 0), (4, 0), (4, 3), (0, 3)])])
        >>> house.levels[0].rooms[0].walls.groups[:2]
        ('WallInside#0_0_0', 'WallOutside#0_0_0')
    """
    built = tuple(_room(house_id, index, room, openings, height) for index, room in enumerate(rooms))
    numbered = tuple(
        replace(box, id=f"0_{index}", index=index, path=f"levels[0].nodes[{index}]")
        for index, box in enumerate(boxes, len(rooms))
    )
    level = Level(id="0", index=0, rooms=built, objects=(), boxes=numbered, grounds=())
    return House(house_id, "suncg@1.0.0", Path("house") / house_id / "house.json", (level,), {})


def _room(house_id: str, index: int, room: RoomOutline, openings: Sequence[WallOpening], height: float) -> RoomNode:
    """Build node `index` of the level, a room without bounding box; raise `ConfigError` if its outline is invalid."""
    stem = Path("room") / house_id / f"fr_0rm_{index}"
    try:
        corners = simplify(np.array(room.corners, float).reshape(-1, 2))
        floor = _slab(stem, "Floor", corners, 0.0, room.floor)
        ceiling = _slab(stem, "Ceiling", corners, height, room.ceiling)
    except ValueError as error:
        raise ConfigError(f"outline of room {index}: {error}", element=f"rooms[{index}].corners") from None
    return RoomNode(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=stem.name,
        types=(room.type,),
        members=(),
        floor=floor,
        ceiling=ceiling,
        walls=_walls(stem, index, corners, (room.walls, room.outside), openings, height),
    )


def _slab(stem: Path, kind: str, corners: Float[np.ndarray, "n 2"], low: float, material: Material) -> Mesh:
    """Build the mesh of a `Floor` or `Ceiling` (`kind`), whose underside is at height `low` [m].

    It is `SLAB_THICKNESS` thick and extends `SLAB_OUTSET` beyond the corners. Errors are those of
    `geometry.slabs.slab`.
    """
    vertices, faces, uv = slab([corners], low, low + SLAB_THICKNESS, SLAB_OUTSET)
    piece = MeshPiece(f"{kind}#{stem.name}", vertices, faces, uv, np.zeros(len(faces), int))
    return join_pieces(stem.with_name(f"{stem.name}{kind[0].lower()}.obj"), [piece], [material])


def _walls(
    stem: Path,
    room: int,
    corners: Float[np.ndarray, "n 2"],
    faces: tuple[Material, Material],
    openings: Sequence[WallOpening],
    height: float,
) -> Mesh:
    """Build the walls of room `room` as one mesh: one wall per side of its outline, with the openings that are in it.

    `corners` are (x, z), counter-clockwise in a plot with x right and z up, so inner faces look into the room. Inner
    faces have the first material of `faces`, cut faces `CUT_MATERIAL` and outer faces the second: three slots per wall.
    """
    pieces: list[MeshPiece] = []
    for number, (start, end) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
        holes = tuple(hole for opening in openings if (hole := _hole(opening, start, end)) is not None)
        wall = WallSegment(np.array([start[0], 0, start[1]]), np.array([end[0], 0, end[1]]), height, holes)
        pieces += [replace(p, slot=p.slot + 3 * number) for p in wall_pieces(wall, f"0_{room}_{number}")]
    return join_pieces(stem.with_name(f"{stem.name}w.obj"), pieces, [faces[0], CUT_MATERIAL, faces[1]] * len(corners))


def _hole(opening: WallOpening, start: Float[np.ndarray, "2"], end: Float[np.ndarray, "2"]) -> Hole | None:
    """Return (left, right, low, high) of an opening, from `start` and the floor [m], cut to the wall's ends.

    Its heights are unchanged. None if an end is farther than half the wall's depth from its centre line, or if less
    than `MIN_OPENING_WIDTH` is left.
    """
    length = float(np.linalg.norm(end - start))
    way = (end - start) / length
    ends = np.array([opening.start, opening.end], float) - start
    along, off = np.sort(ends @ way), abs(ends @ np.array([-way[1], way[0]]))
    left, right = np.clip(along, 0, length).tolist()
    if off.max() > WALL_DEPTH / 2 or right - left < MIN_OPENING_WIDTH:
        return None
    return left, right, opening.low, opening.high
