"""Assignment of overlapping floor and ceiling areas to rooms: the smallest room owns each point.

This is the rule of `find_smallest_room`, which navigation, collision and sound use as well. Real houses often nest
rooms with coplanar floors. Without the rule, rounding would decide which of the floors a ray hits.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.polygons import polygon_area
from home_mjx.geometry.slabs import fan_triangles, offset_outwards, remove_triangles, simplify, triangulate
from home_mjx.schema.compiled import RoomTable

IGNORED_OVERLAP_WIDTH = 0.05  # [m], overlaps up to this are ignored: floors extend 2 cm beyond the middle of walls
MIN_OVERLAP_AREA = 0.01  # [m^2], minimum area of an overlap that is removed
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
    return area - sum(polygon_area(piece) for piece in remove_triangles(a, b))


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
        rest = remove_triangles([triangle[:, :2]], cutters) if seen[number] else [triangle[:, :2]]
        left += len(rest) if seen[number] else 0
        if len(rest) == 1 and rest[0].shape == (3, 2) and np.array_equal(rest[0], triangle[:, :2]):
            found.append((triangle[None], corners[None], [number]))
        else:
            fans = [fan_triangles(piece, triangle, corners) for piece in rest]
            found += [(*fan, [number] * len(fan[0])) for fan in fans]
    if not left:
        return ClippedSurface(triangles, uv, np.arange(len(triangles)))
    return ClippedSurface(*(np.concatenate([item[k] for item in found]) for k in range(3)))
