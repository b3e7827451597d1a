"""Fallback floors, ceilings and walls for missing room meshes, from other sources of the room's outline."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.mesh_pieces import CUT_MATERIAL, MeshPiece, join_pieces, wall_pieces
from home_mjx.geometry.meshes import facing_axis
from home_mjx.geometry.polygons import outline
from home_mjx.geometry.slabs import offset_outwards, simplify, slab, triangulate
from home_mjx.geometry.wall_prisms import WALL_DEPTH, WALL_EXTRA_HEIGHT, Hole, WallSegment
from home_mjx.schema.house import Material, Mesh, RoomNode

# All in [m]; dimensions of SUNCG's own meshes.
SLAB_THICKNESS = 0.05  # of floors and ceilings
SLAB_OUTSET = WALL_DEPTH / 5  # of floors and ceilings beyond the centre lines of walls
WALL_OUTER_EXTENT = WALL_DEPTH / 2 - WALL_DEPTH / 19  # extent of walls beyond their centre lines
CEILING_OFFSET = 0.01  # offset of a ceiling's underside below the nominal height
HOLE_INSET = 0.02  # inset of a hole relative to the box of its door or window
DEFAULT_HEIGHT = 2.7  # default height of walls
HEIGHT_RANGE = (1.5, 12.0)  # plausible heights of walls; others come from wrong boxes
MAX_LEAF_SWING = 0.75  # maximum enlargement of a room's box by an open door leaf
MAX_OPENING_OFFSET = 0.15  # maximum distance of an opening from the centre line of its wall
MIN_OPENING_WIDTH = 0.05  # minimum width of an opening along a wall
MIN_CORNER_SINE = 0.1  # minimum sine of the angle between two adjacent walls

FLOOR_COLOR, PLASTER_COLOR = (0.62, 0.52, 0.42), (0.88, 0.87, 0.84)  # sRGB
Polygon = Float[np.ndarray, "n 2"]  # (x, z), counter-clockwise with x right and z up


@dataclass(frozen=True)
class OpeningSpan:
    """Span of a door, window or arch, which makes a hole in every wall along it.

    Attributes:
        start: (x, z) of one end [m].
        end: (x, z) of the other end [m].
        low: Height of its lower edge [m].
        high: Height of its upper edge [m].
    """

    start: Float[np.ndarray, "2"]
    end: Float[np.ndarray, "2"]
    low: float
    high: float


@dataclass(frozen=True)
class RoomShape:
    """Outline and height of a room.

    Attributes:
        corners: Corners of the centre lines of its walls [m].
        low: Height of the walls' base [m].
        height: Nominal height of the walls [m].
        source: Source of the outline, in words.
    """

    corners: Polygon
    low: float
    height: float
    source: str


def find_room_shape(room: RoomNode, gaps: Sequence[OpeningSpan]) -> RoomShape | None:
    """Determine the outline of a room from its floor, ceiling, walls or box, in this order; None if none is usable.

    Outlines are those of the walls' centre lines: that of a floor or ceiling is shrunk by `SLAB_OUTSET`.

    Args:
        room: Room with its existing meshes.
        gaps: Openings of its level. The open doors of a room enlarge its box, so a side near a door is moved to
            the door's position.
    """
    low, height = _heights(room)
    for mesh, source in ((room.floor, "its floor"), (room.ceiling, "its ceiling")):
        if mesh is not None and (corners := _sound(offset_outwards(_slab_outline(mesh), -SLAB_OUTSET))) is not None:
            return RoomShape(corners, low, height, source)
    if room.walls is not None and (corners := _sound(_wall_lines(room.walls))) is not None:
        return RoomShape(corners, low, height, "its walls")
    if room.bbox is None:
        return None
    corners = _sound(_box_lines(room.bbox, gaps))
    return None if corners is None else RoomShape(corners, low, height, "its bounding box")


def build_fallback_part(
    kind: str, shape: RoomShape, room: RoomNode, path: Path, gaps: Sequence[OpeningSpan], materials: Sequence[Material]
) -> Mesh:
    """Build the mesh [m, Y up] of a room's missing `Floor`, `Ceiling` or `Wall` (`kind`).

    `gaps` are the openings of its level, which make holes in walls. `path` is that of the missing OBJ. `materials` are
    those of its MTL, empty if that is missing too: a slab has the first, walls the first inside and the third outside.
    """
    if kind == "Wall":
        return _walls(shape, room.id, path, gaps, materials)
    low = shape.low if kind == "Floor" else shape.low + shape.height - CEILING_OFFSET
    plain = Material("", FLOOR_COLOR if kind == "Floor" else PLASTER_COLOR, None, 1.0)
    return slab_mesh(f"{kind}#{room.id}", shape.corners, (low, low + SLAB_THICKNESS), path, materials, plain)


def slab_mesh(
    group: str,
    corners: Polygon,
    heights: tuple[float, float],
    path: Path,
    materials: Sequence[Material],
    plain: Material,
    outset: float = SLAB_OUTSET,
) -> Mesh:
    """Build a closed horizontal slab over a polygon (x, z), enlarged by `outset`, between two `heights`; all [m].

    Its material is the first of `materials`, else `plain`. `path` and `group` are recorded only.
    """
    vertices, faces, uv = slab([corners], *heights, outset)
    return join_pieces(
        path, [MeshPiece(group, vertices, faces, uv, np.zeros(len(faces), int))], [*materials, plain][:1]
    )


def _walls(
    shape: RoomShape, room_id: str, path: Path, gaps: Sequence[OpeningSpan], materials: Sequence[Material]
) -> Mesh:
    """Build the walls of a room with holes at `gaps`; without holes if these would remove all walls.

    Inner faces have the first of `materials`, outer ones the third; all have plaster if there are fewer than three.
    """
    plain = Material("", PLASTER_COLOR, None, 1.0)
    inside, outside = (materials[0], materials[2]) if len(materials) > 2 else (plain, plain)
    pieces: list[MeshPiece] = []
    for number, (start, end) in enumerate(zip(shape.corners, np.roll(shape.corners, -1, axis=0), strict=True)):
        holes = tuple(hole for gap in gaps if (hole := _hole(gap, start, end, shape)) is not None)
        first, last = (np.array([x, shape.low, z]) for x, z in (start, end))
        wall = WallSegment(first, last, shape.height, holes)
        pieces += [replace(p, slot=p.slot + 3 * number) for p in wall_pieces(wall, f"{room_id}_{number}")]
    solid = [piece for piece in pieces if len(piece.faces)]
    if not solid:  # holes cover all walls
        return _walls(shape, room_id, path, (), materials)
    return join_pieces(path, solid, [inside, CUT_MATERIAL, outside] * len(shape.corners))


def _hole(
    gap: OpeningSpan, start: Float[np.ndarray, "2"], end: Float[np.ndarray, "2"], shape: RoomShape
) -> Hole | None:
    """Return (left, right, low, high) of an opening, from `start` and the wall's base [m]; None if not in this wall.

    It is `HOLE_INSET` smaller on each side and may reach beyond the wall. In this wall means: both ends at most
    `MAX_OPENING_OFFSET` from its line, at least `MIN_OPENING_WIDTH` between its ends, and partly between base and top.
    """
    length = float(np.linalg.norm(end - start))
    way = (end - start) / length
    ends = np.stack([gap.start, gap.end]) - start
    along, off = np.sort(ends @ way), abs(ends @ np.array([-way[1], way[0]]))
    left, right = float(along[0]) + HOLE_INSET, float(along[1]) - HOLE_INSET
    low, high = gap.low - shape.low + HOLE_INSET, gap.high - shape.low - HOLE_INSET
    inside = min(right, length) - max(left, 0.0) >= MIN_OPENING_WIDTH and high > max(low, 0.0) and low < shape.height
    return (left, right, low, high) if off.max() <= MAX_OPENING_OFFSET and inside else None


def _heights(room: RoomNode) -> tuple[float, float]:
    """Return the y of the walls' base and their height above it [m].

    The base is that of the walls, else the floor, else the box; the top that of the walls, else the ceiling, else the
    box. A height outside `HEIGHT_RANGE`, or without a known top, is `DEFAULT_HEIGHT`.
    """
    lows = [m.vertices[:, 1].min() for m in (room.walls, room.floor) if m is not None]
    tops = [] if room.walls is None else [room.walls.vertices[:, 1].max() - WALL_EXTRA_HEIGHT]
    tops += [] if room.ceiling is None else [room.ceiling.vertices[:, 1].min() + CEILING_OFFSET]
    if room.bbox is not None:
        lows.append(room.bbox[0, 1])
        tops.append(room.bbox[1, 1] - SLAB_THICKNESS + CEILING_OFFSET)
    top = float(tops[0]) if tops else None
    low = float(lows[0]) if lows else (top or 0.0) - DEFAULT_HEIGHT
    height = DEFAULT_HEIGHT if top is None else top - low
    return low, height if HEIGHT_RANGE[0] <= height <= HEIGHT_RANGE[1] else DEFAULT_HEIGHT


def _slab_outline(mesh: Mesh) -> Polygon:
    """Return the outline (x, z) of a floor or ceiling [m], counter-clockwise with x right and z up."""
    x, y, z = mesh.vertices[mesh.faces].transpose(2, 0, 1)
    upright = outline(np.stack([x, -z, y], axis=-1))
    return (upright * (1, -1))[::-1]


def _sound(corners: Polygon | None) -> Polygon | None:
    """Return the polygon after `simplify`; None if it is None or cannot be triangulated."""
    if corners is None:
        return None
    try:
        corners = simplify(corners)
        triangulate(corners)
    except ValueError:
        return None
    return corners


def _wall_lines(walls: Mesh) -> Polygon:
    """Return the intersections (x, z) of successive walls' centre lines.

    If two are nearly parallel or the polygon is unusable, return a rectangle: the box of all walls, shrunk by
    `WALL_OUTER_EXTENT`.
    """
    lines = [_middle_line(walls.vertices[walls.faces[faces]]) for faces in walls.faces_by_part()]
    corners = [_meeting(a, b) for a, b in zip([lines[-1], *lines[:-1]], lines, strict=True)]
    found = np.array([corner for corner in corners if corner is not None])
    if len(found) == len(lines) >= 3 and _sound(found) is not None:
        return found
    points = walls.vertices[:, [0, 2]]
    return _rectangle(points.min(axis=0) + WALL_OUTER_EXTENT, points.max(axis=0) - WALL_OUTER_EXTENT)


def _middle_line(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[Float[np.ndarray, "2"], float]:
    """Return the unit (x, z) across a wall, and the offset of its middle plane from the origin along it [m]."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    across = facing_axis(normal[:, [0, 2]], np.linalg.norm(normal, axis=1))
    off = triangles[..., [0, 2]] @ across
    return across, float(off.min() + off.max()) / 2


def _meeting(a: tuple[np.ndarray, float], b: tuple[np.ndarray, float]) -> Float[np.ndarray, "2"] | None:
    """Return the intersection of two lines (unit normal, offset [m]); None if they are nearly parallel."""
    normals = np.stack([a[0], b[0]])
    if abs(np.linalg.det(normals)) < MIN_CORNER_SINE:
        return None
    return np.linalg.solve(normals, np.array([a[1], b[1]]))


def _box_lines(bbox: Float[np.ndarray, "2 3"], gaps: Sequence[OpeningSpan]) -> Polygon:
    """Return the rectangle of wall centre lines in a bounding box; sides near a parallel gap are moved to it.

    Near means at most `WALL_OUTER_EXTENT` outside of a side, or `MAX_LEAF_SWING` more than that inside, with the gap's
    middle between the two other sides. Of several gaps the outermost is taken.
    """
    low, high = bbox[0, [0, 2]] + WALL_OUTER_EXTENT, bbox[1, [0, 2]] - WALL_OUTER_EXTENT
    for axis in (0, 1):
        beside = [
            gap
            for gap in gaps
            if abs(gap.end - gap.start)[axis] < MIN_CORNER_SINE * np.linalg.norm(gap.end - gap.start)
        ]
        at = np.array([(gap.start + gap.end)[[axis, 1 - axis]] / 2 for gap in beside]).reshape(-1, 2)
        here = at[(at[:, 1] > low[1 - axis]) & (at[:, 1] < high[1 - axis]), 0]
        low[axis] = min(
            here[abs(here - low[axis] - MAX_LEAF_SWING / 2) <= MAX_LEAF_SWING / 2 + WALL_OUTER_EXTENT],
            default=low[axis],
        )
        high[axis] = max(
            here[abs(here - high[axis] + MAX_LEAF_SWING / 2) <= MAX_LEAF_SWING / 2 + WALL_OUTER_EXTENT],
            default=high[axis],
        )
    return _rectangle(low, high)


def _rectangle(low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"]) -> Polygon:
    """Return the corners of an axis-aligned rectangle, counter-clockwise from `low`."""
    (x0, z0), (x1, z1) = low, high
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
