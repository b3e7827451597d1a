"""Fallback floors, ceilings and walls for missing room meshes, from other sources of the room's outline."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.outline import outline
from home_mjx.geometry.pieces import CUT, Piece, join_pieces, wall_pieces
from home_mjx.geometry.slabs import grow, simplify, slab, triangulate
from home_mjx.geometry.wall_groups import direction_across, wall_faces
from home_mjx.geometry.wall_prisms import DEPTH, RISE, Hole, Wall
from home_mjx.schema.house import Material, Mesh, Room

# All in [m]; dimensions of SUNCG's own meshes.
THICKNESS = 0.05  # of floors and ceilings
OUTSET = DEPTH / 5  # of floors and ceilings beyond the centre lines of walls
OUTER = DEPTH / 2 - DEPTH / 19  # extent of walls beyond their centre lines
CEILING_LOW = 0.01  # offset of a ceiling's underside below the nominal height
SHRINK = 0.02  # inset of a hole relative to the box of its door or window
HEIGHT = 2.7  # default height of walls
HEIGHTS = (1.5, 12.0)  # plausible heights of walls; others come from wrong boxes
SWUNG = 0.75  # maximum enlargement of a room's box by an open door leaf
OFF = 0.15  # maximum distance of an opening from the centre line of its wall
LEAST = 0.05  # minimum width of an opening along a wall
SOUND = 0.1  # minimum sine of the angle between two adjacent walls

FLOOR, PLASTER = (0.62, 0.52, 0.42), (0.88, 0.87, 0.84)  # sRGB
Polygon = Float[np.ndarray, "n 2"]  # (x, z), counter-clockwise with x right and z up


@dataclass(frozen=True)
class Gap:
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
class Shape:
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


def room_shape(room: Room, gaps: Sequence[Gap]) -> Shape | None:
    """Determine the outline of a room from its floor, ceiling, walls or box, in this order; None if all are missing.

    Args:
        room: Room with its existing meshes.
        gaps: Openings of its level. The open doors of a room enlarge its box, so a side near a door is moved to
            the door's position.
    """
    low, height = _heights(room)
    for mesh, source in ((room.floor, "its floor"), (room.ceiling, "its ceiling")):
        if mesh is not None and (corners := _sound(grow(_slab_outline(mesh), -OUTSET))) is not None:
            return Shape(corners, low, height, source)
    if room.walls is not None and (corners := _sound(_wall_lines(room.walls))) is not None:
        return Shape(corners, low, height, "its walls")
    if room.bbox is None:
        return None
    corners = _sound(_box_lines(room.bbox, gaps))
    return None if corners is None else Shape(corners, low, height, "its bounding box")


def stand_in_part(
    kind: str, shape: Shape, room: Room, path: Path, gaps: Sequence[Gap], materials: Sequence[Material]
) -> Mesh:
    """Build the fallback floor, ceiling or walls of a room.

    Args:
        kind: `Floor`, `Ceiling` or `Wall`.
        shape: Outline and height of the room.
        room: The room.
        path: Path of the missing OBJ.
        gaps: Openings of its level.
        materials: Materials of the missing mesh, if its MTL exists.
    """
    if kind == "Wall":
        return _walls(shape, room.id, path, gaps, materials)
    low = shape.low if kind == "Floor" else shape.low + shape.height - CEILING_LOW
    plain = Material("", FLOOR if kind == "Floor" else PLASTER, None, 1.0)
    return slab_mesh(f"{kind}#{room.id}", shape.corners, (low, low + THICKNESS), path, materials, plain)


def slab_mesh(
    group: str,
    corners: Polygon,
    heights: tuple[float, float],
    path: Path,
    materials: Sequence[Material],
    plain: Material,
    outset: float = OUTSET,
) -> Mesh:
    """Build a slab over a polygon with the outset of SUNCG's floors.

    Args:
        group: Group name of the mesh.
        corners: Corners (x, z) [m].
        heights: Heights of its lower and its upper side [m].
        path: Path of the mesh.
        materials: The first one is used, if any.
        plain: Material used otherwise.
        outset: Distance by which the slab reaches beyond the polygon [m].
    """
    vertices, faces, uv = slab([corners], *heights, outset)
    return join_pieces(path, [Piece(group, vertices, faces, uv, np.zeros(len(faces), int))], [*materials, plain][:1])


def _walls(shape: Shape, room_id: str, path: Path, gaps: Sequence[Gap], materials: Sequence[Material]) -> Mesh:
    plain = Material("", PLASTER, None, 1.0)
    inside, outside = (materials[0], materials[2]) if len(materials) > 2 else (plain, plain)
    pieces: list[Piece] = []
    for number, (start, end) in enumerate(zip(shape.corners, np.roll(shape.corners, -1, axis=0), strict=True)):
        holes = tuple(hole for gap in gaps if (hole := _hole(gap, start, end, shape)) is not None)
        first, last = (np.array([x, shape.low, z]) for x, z in (start, end))
        wall = Wall(first, last, shape.height, holes)
        pieces += [replace(p, slot=p.slot + 3 * number) for p in wall_pieces(wall, f"{room_id}_{number}")]
    solid = [piece for piece in pieces if len(piece.faces)]
    if not solid:  # holes cover all walls
        return _walls(shape, room_id, path, (), materials)
    return join_pieces(path, solid, [inside, CUT, outside] * len(shape.corners))


def _hole(gap: Gap, start: Float[np.ndarray, "2"], end: Float[np.ndarray, "2"], shape: Shape) -> Hole | None:
    """Compute the hole of an opening in a wall; None if the wall does not run along it."""
    length = float(np.linalg.norm(end - start))
    way = (end - start) / length
    ends = np.stack([gap.start, gap.end]) - start
    along, off = np.sort(ends @ way), abs(ends @ np.array([-way[1], way[0]]))
    left, right = float(along[0]) + SHRINK, float(along[1]) - SHRINK
    low, high = gap.low - shape.low + SHRINK, gap.high - shape.low - SHRINK
    inside = min(right, length) - max(left, 0.0) >= LEAST and high > max(low, 0.0) and low < shape.height
    return (left, right, low, high) if off.max() <= OFF and inside else None


def _heights(room: Room) -> tuple[float, float]:
    """Return base and nominal height of the walls [m], from existing meshes, else from the box."""
    lows = [m.vertices[:, 1].min() for m in (room.walls, room.floor) if m is not None]
    tops = [] if room.walls is None else [room.walls.vertices[:, 1].max() - RISE]
    tops += [] if room.ceiling is None else [room.ceiling.vertices[:, 1].min() + CEILING_LOW]
    if room.bbox is not None:
        lows.append(room.bbox[0, 1])
        tops.append(room.bbox[1, 1] - THICKNESS + CEILING_LOW)
    top = float(tops[0]) if tops else None
    low = float(lows[0]) if lows else (top or 0.0) - HEIGHT
    height = HEIGHT if top is None else top - low
    return low, height if HEIGHTS[0] <= height <= HEIGHTS[1] else HEIGHT


def _slab_outline(mesh: Mesh) -> Polygon:
    """Return the outline of a floor or ceiling, counter-clockwise."""
    x, y, z = mesh.vertices[mesh.faces].transpose(2, 0, 1)
    upright = outline(np.stack([x, -z, y], axis=-1))
    return (upright * (1, -1))[::-1]


def _sound(corners: Polygon | None) -> Polygon | None:
    """Return the simplified polygon if a floor can be made of it; else None."""
    if corners is None:
        return None
    try:
        corners = simplify(corners)
        triangulate(corners)
    except ValueError:
        return None
    return corners


def _wall_lines(walls: Mesh) -> Polygon:
    """Return the intersections of successive walls' centre lines; if incomplete, the rectangle around all walls."""
    lines = [_middle_line(walls.vertices[walls.faces[faces]]) for faces in wall_faces(walls)]
    corners = [_meeting(a, b) for a, b in zip([lines[-1], *lines[:-1]], lines, strict=True)]
    found = np.array([corner for corner in corners if corner is not None])
    if len(found) == len(lines) >= 3 and _sound(found) is not None:
        return found
    points = walls.vertices[:, [0, 2]]
    return _rectangle(points.min(axis=0) + OUTER, points.max(axis=0) - OUTER)


def _middle_line(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[Float[np.ndarray, "2"], float]:
    """Return the direction across a wall, and the offset of its middle plane from the origin along it [m]."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    across = direction_across(normal[:, [0, 2]], np.linalg.norm(normal, axis=1))
    off = triangles[..., [0, 2]] @ across
    return across, float(off.min() + off.max()) / 2


def _meeting(a: tuple[np.ndarray, float], b: tuple[np.ndarray, float]) -> Float[np.ndarray, "2"] | None:
    normals = np.stack([a[0], b[0]])
    if abs(np.linalg.det(normals)) < SOUND:
        return None
    return np.linalg.solve(normals, np.array([a[1], b[1]]))


def _box_lines(bbox: Float[np.ndarray, "2 3"], gaps: Sequence[Gap]) -> Polygon:
    low, high = bbox[0, [0, 2]] + OUTER, bbox[1, [0, 2]] - OUTER
    for axis in (0, 1):
        beside = [gap for gap in gaps if abs(gap.end - gap.start)[axis] < SOUND * np.linalg.norm(gap.end - gap.start)]
        at = np.array([(gap.start + gap.end)[[axis, 1 - axis]] / 2 for gap in beside]).reshape(-1, 2)
        here = at[(at[:, 1] > low[1 - axis]) & (at[:, 1] < high[1 - axis]), 0]
        low[axis] = min(here[abs(here - low[axis] - SWUNG / 2) <= SWUNG / 2 + OUTER], default=low[axis])
        high[axis] = max(here[abs(here - high[axis] + SWUNG / 2) <= SWUNG / 2 + OUTER], default=high[axis])
    return _rectangle(low, high)


def _rectangle(low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"]) -> Polygon:
    (x0, z0), (x1, z1) = low, high
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
