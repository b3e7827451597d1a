"""Assignment of overlapping floor and ceiling areas to rooms: the smallest room owns each point.

This is the rule of `find_smallest_room`, which navigation, collision and sound use as well. Real houses often nest
rooms with coplanar floors. Without the rule, rounding would decide which of the floors a ray hits.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.polygons import polygon_area
from home_mjx.geometry.slabs import offset_outwards, simplify, triangulate
from home_mjx.schema.compiled import RoomTable

IGNORED_OVERLAP_WIDTH = 0.05  # [m], overlaps up to this are ignored: floors extend 2 cm beyond the middle of walls
MIN_OVERLAP_AREA = 0.01  # [m^2], minimum area of an overlap that is removed
MIN_PIECE_AREA = 1e-7  # [m^2], pieces smaller than this are dropped
MIN_NORMAL_Z = 0.7  # minimum vertical component of a floor's or ceiling's unit normal

Polygon = Float[np.ndarray, "_ 2"]


@dataclass(frozen=True)
class ClippedSurface:
    """Triangles of a surface after clipping.

    Attributes:
        triangles: Corners [m].
        uv: Texture coordinates of the corners.
        triangle_index: Index of the original triangle.
    """

    triangles: Float[np.ndarray, "t 3 3"]
    uv: Float[np.ndarray, "t 3 2"]
    triangle_index: Int[np.ndarray, " t"]


def find_owner_outlines(room: int, others: Sequence[int], rooms: RoomTable) -> list[list[Polygon]]:
    """Return the plan triangles [m] of each smaller room that covers more than `MIN_OVERLAP_AREA` of this room.

    For this test only, the smaller outline is shrunk by `IGNORED_OVERLAP_WIDTH`; without area then, it is ignored.
    Larger owners are first; of equal rooms, the later one counts as smaller.

    Args:
        room: Index of the room.
        others: Indices of the rooms with a surface of the same kind; those of other levels are ignored.
        rooms: Outlines.
    """
    here = np.flatnonzero(rooms.level == rooms.level[room]).tolist()
    order = sorted(here, key=lambda r: -polygon_area(rooms.polygon[r]))
    smaller = [r for r in order[order.index(room) + 1 :] if r in others]
    found = [(_triangles(rooms.polygon[r], 0.0), _triangles(rooms.polygon[r], -IGNORED_OVERLAP_WIDTH)) for r in smaller]
    mine = _triangles(rooms.polygon[room], 0.0)
    return [whole for whole, inner in found if _covered_area(mine, inner) > MIN_OVERLAP_AREA]


def _triangles(polygon: Polygon, outset: float) -> list[Polygon]:
    """Return the triangles of a polygon whose sides are offset outwards by `outset` [m], or inwards if it is negative.

    The list is empty if the polygon has no area or crosses itself, also after the offset.
    """
    try:
        corners = simplify(polygon)
        grown = corners if outset == 0 else offset_outwards(corners, outset)
        return [grown[t] for t in triangulate(grown)]
    except ValueError:
        return []


def _covered_area(a: Sequence[Polygon], b: Sequence[Polygon]) -> float:
    """Return the area [m^2] of `a`, whose triangles are disjoint, that triangles of `b` cover."""
    area = sum(polygon_area(piece) for piece in a)
    return area - sum(polygon_area(piece) for piece in _without(a, b))


def _without(pieces: Sequence[Polygon], cutters: Sequence[Polygon]) -> list[Polygon]:
    """Return convex pieces of the convex polygons `pieces` that are outside all triangles `cutters`.

    Cutters have either winding. Pieces of at most `MIN_PIECE_AREA` are dropped, see `_outside`.
    """
    left = list(pieces)
    for cutter in cutters:
        (x0, y0), (x1, y1), (x2, y2) = cutter
        ccw = cutter if (x1 - x0) * (y2 - y0) > (x2 - x0) * (y1 - y0) else cutter[::-1]
        left = [rest for piece in left for rest in _outside(piece, ccw)]
    return left


def _outside(piece: Polygon, cutter: Polygon) -> list[Polygon]:
    """Return the part of a convex polygon outside a counter-clockwise triangle as convex polygons, maybe none.

    Parts of at most `MIN_PIECE_AREA` are dropped. If only so much would be cut off, the polygon is returned unchanged.
    """
    if (piece.max(axis=0) <= cutter.min(axis=0)).any() or (piece.min(axis=0) >= cutter.max(axis=0)).any():
        return [piece]
    found, inside = [], piece
    for start, end in zip(cutter, np.roll(cutter, -1, axis=0), strict=True):
        way = end - start
        side = way[0] * (inside[:, 1] - start[1]) - way[1] * (inside[:, 0] - start[0])
        beyond, inside = _clip(inside, -side), _clip(inside, side)
        if polygon_area(beyond) > MIN_PIECE_AREA:
            found.append(beyond)
        if polygon_area(inside) <= MIN_PIECE_AREA:
            return found if polygon_area(piece) - sum(map(polygon_area, found)) > MIN_PIECE_AREA else [piece]
    return found


def _clip(polygon: Polygon, side: Float[np.ndarray, " n"]) -> Polygon:
    """Return the part of a convex polygon where a linear function, `side` at its corners, is not negative.

    Without such a part, the result has no corners.
    """
    corners = []
    for i, (here, value) in enumerate(zip(polygon, side, strict=True)):
        before, earlier = polygon[i - 1], side[i - 1]
        if (value < 0) != (earlier < 0):
            corners.append(before + (here - before) * earlier / (earlier - value))
        if value >= 0:
            corners.append(here)
    return np.array(corners).reshape(-1, 2)


def clip_surface(
    triangles: Float[np.ndarray, "t 3 3"],
    uv: Float[np.ndarray, "t 3 2"],
    side: float,
    owners: Sequence[list[Polygon]],
) -> ClippedSurface:
    """Return a slab without other rooms' areas on its visible side; unchanged if that would remove the whole side.

    Only triangles that face that side (`MIN_NORMAL_Z`) are cut; others stay whole. The result is in their order.

    Args:
        triangles: Corners of the slab [m].
        uv: Their texture coordinates.
        side: 1 if the slab is seen from above, -1 from below.
        owners: Output of `find_owner_outlines`.
    """
    cutters = [triangle for owner in owners for triangle in owner]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    seen = side * normal[:, 2] > MIN_NORMAL_Z * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    found, left = [], 0
    for number, (triangle, corners) in enumerate(zip(triangles, uv, strict=True)):
        rest = _without([triangle[:, :2]], cutters) if seen[number] else [triangle[:, :2]]
        left += len(rest) if seen[number] else 0
        if len(rest) == 1 and rest[0].shape == (3, 2) and np.array_equal(rest[0], triangle[:, :2]):
            found.append((triangle[None], corners[None], [number]))
        else:
            fans = [_fan(piece, triangle, corners) for piece in rest]
            found += [(*fan, [number] * len(fan[0])) for fan in fans]
    if not left:
        return ClippedSurface(triangles, uv, np.arange(len(triangles)))
    return ClippedSurface(*(np.concatenate([item[k] for item in found]) for k in range(3)))


def _fan(
    piece: Polygon, triangle: Float[np.ndarray, "3 3"], uv: Float[np.ndarray, "3 2"]
) -> tuple[Float[np.ndarray, "n 3 3"], Float[np.ndarray, "n 3 2"]]:
    """Return corners and uv of triangles that fill a convex plan piece of a triangle, in its plane and winding.

    Triangles almost without area are left out.
    """
    weight = np.linalg.solve(np.vstack([triangle[:, :2].T, np.ones(3)]), np.vstack([piece.T, np.ones(len(piece))])).T
    order = np.array([[0, k, k + 1] for k in range(1, len(piece) - 1)])
    order = order[[polygon_area(piece[k]) > MIN_PIECE_AREA / 100 for k in order]]
    return (weight @ triangle)[order], (weight @ uv)[order]
