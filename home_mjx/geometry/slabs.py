"""Slabs for floors, ceilings and grounds: polygons with a thickness; clipping of convex polygons by triangles."""

from collections.abc import Sequence

import mapbox_earcut
import numpy as np
from jaxtyping import Bool, Float, Int

# [m], corners closer than this to a corner, or to the line between their neighbours, are dropped
MIN_CORNER_DISTANCE = 1e-6
MAX_MITRE = 2.0  # maximum movement of an acute corner, in outsets: that of a corner of 60 degrees
MAX_SIMPLIFY_PASSES = 100  # maximum passes that drop corners; each may make others collinear

MIN_PIECE_AREA = 1e-7  # [m^2], clipped pieces smaller than this are dropped

Polygon = Float[np.ndarray, "n 2"]  # (x, z) [m]
PlanPolygon = Float[np.ndarray, "_ 2"]  # in either pair of plan axes [m]


def slab(
    polygons: Sequence[Polygon], low: float, high: float, outset: float
) -> tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"], Float[np.ndarray, "f 3 2"]]:
    """Build closed, outward-wound slabs over polygons of either winding.

    Args:
        polygons: Corners (x, z) [m], at least one polygon. Each becomes a slab of its own, also where they overlap.
            Repeated and collinear corners are dropped, see `simplify`. A bridge must join each hole to the edge, as in
            `polygons.outline`; the slab has faces on both sides of it.
        low: Height of the underside [m].
        high: Height of the upper side [m]; must exceed `low`, which is not checked.
        outset: Distance by which the sides extend beyond the polygon [m]; 0 for one that would then cross itself.

    Returns:
        Vertices [m], Y up; triangles; texture coordinates in metres from the polygon's minimum x and z, also on the
        sides, where they do not depend on height.

    Raises:
        ValueError: A polygon has no area or crosses itself.
    """
    pieces = [_piece(polygon, low, high, outset) for polygon in polygons]
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in pieces)])
    faces = np.concatenate([faces + start for (_, faces, _), start in zip(pieces, starts, strict=False)])
    return np.concatenate([p[0] for p in pieces]), faces, np.concatenate([p[2] for p in pieces])


def _piece(
    polygon: Polygon, low: float, high: float, outset: float
) -> tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"], Float[np.ndarray, "f 3 2"]]:
    """Build the closed slab of one polygon of corners (x, z) [m]: vertices [m], Y up, triangles, and their corners' UV.

    See `slab`. UV are x and z in metres from the minimum of `polygon`, so negative in the outset. The outset falls back
    to 0 if the grown outline would cross itself.

    Raises:
        ValueError: The polygon has no area or crosses itself.
    """
    outline, top = _outline(simplify(polygon), outset)
    count = len(outline)
    here, after = np.arange(count), np.roll(np.arange(count), -1)
    sides = np.concatenate(
        [np.stack([here, here + count, after], 1), np.stack([after, here + count, after + count], 1)]
    )
    faces = np.concatenate([top + count, top[:, ::-1], sides])
    x, z = np.tile(outline, (2, 1)).T
    vertices = np.stack([x, np.repeat([low, high], count), z], axis=1)
    return vertices, faces, vertices[faces][..., [0, 2]] - polygon.min(axis=0)


def _outline(polygon: Polygon, outset: float) -> tuple[Polygon, Int[np.ndarray, "t 3"]]:
    """Return a counter-clockwise polygon, grown by `outset` [m] unless it then crosses itself, and its triangles.

    The polygon (x, z) [m] is one of `simplify`. Triangles face +y.

    Raises:
        ValueError: The polygon crosses itself even without the outset, or is clockwise.
    """
    grown = offset_outwards(polygon, outset)
    try:
        return grown, triangulate(grown)
    except ValueError:
        return polygon, triangulate(polygon)


def signed_area(polygon: Polygon) -> float:
    """Return the signed area [m^2] (shoelace), positive if counter-clockwise in a plot with x right and z up.

    With Y up, such a polygon (x, z) is clockwise seen from above. Corners (x, y) with Z up are counter-clockwise.
    """
    x, z = polygon.T
    return float((x * np.roll(z, -1) - np.roll(x, -1) * z).sum() / 2)


def simplify(polygon: Polygon) -> Float[np.ndarray, "_ 2"]:
    """Return the polygon (x, z) [m] counter-clockwise (see `signed_area`), without repeated and collinear corners.

    Corners of a hole's bridge are kept, as equal ones are not neighbours. A spike, whose sides return along themselves,
    is dropped. The first corner may be another one than before.
    A polygon that crosses itself is not rejected; `triangulate` does that.

    Raises:
        ValueError: Fewer than 3 corners remain, or their area is at most 1e-6 m^2.
    """
    turned = polygon if signed_area(polygon) > 0 else polygon[::-1]
    for _ in range(MAX_SIMPLIFY_PASSES):
        turned = turned[np.linalg.norm(turned - np.roll(turned, 1, 0), axis=1) > MIN_CORNER_DISTANCE]
        before, after = turned - np.roll(turned, 1, 0), np.roll(turned, -1, 0) - turned
        bend = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        straight = abs(bend) <= MIN_CORNER_DISTANCE * np.maximum(
            np.linalg.norm(before + after, axis=1), MIN_CORNER_DISTANCE
        )
        if not straight.any():
            break
        turned = turned[~_every_second(straight)]
    if len(turned) < 3 or signed_area(turned) <= MIN_CORNER_DISTANCE:
        raise ValueError("polygon has no area")
    return turned


def _every_second(mask: Bool[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
    """Return a mask of the first, third, ... True of each run, from index 0, so that no two neighbours are True.

    The mask is a ring: its last entry is left out if the first one is True.
    """
    count = np.arange(len(mask))
    place = count - np.maximum.accumulate(np.where(mask, -1, count))  # place in its run, from 1
    return mask & (place % 2 == 1) & ~(np.roll(mask, -1) & (count == len(mask) - 1))


def offset_outwards(polygon: Polygon, outset: float) -> Polygon:
    """Move the sides of a counter-clockwise polygon outwards by `outset` [m], or inwards if it is negative.

    The winding is that of `signed_area`; a clockwise polygon shrinks. Corners are mitred; those of less than 60 degrees
    move by less than a mitre, at most `MAX_MITRE` outsets. The result may cross itself, which `triangulate` rejects. It
    does not detect a polygon that is moved inwards beyond its middle, as a square becomes a turned square. Corners
    repeated directly become NaN, see `simplify`; collinear ones are kept.
    """
    way = np.roll(polygon, -1, 0) - polygon
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    normal = np.stack([way[:, 1], -way[:, 0]], 1)
    other = np.roll(normal, 1, 0)
    mitre = normal + other
    stretch = np.minimum(1 / np.maximum((mitre * normal).sum(1, keepdims=True), 1e-9), MAX_MITRE**2 / 2)
    return polygon + outset * stretch * mitre


def triangulate(polygon: Polygon) -> Int[np.ndarray, "t 3"]:
    """Triangulate a counter-clockwise polygon (see `signed_area`) by earcut, as three.js does; triangles face +y.

    The polygon (x, z) has at least 3 corners; a bridge must join each hole to its edge. Corners repeated directly, also
    a last one equal to the first, must be dropped before, see `simplify`. Rows are indices of three corners.

    Raises:
        ValueError: The polygon crosses itself, is clockwise, has no area, or has corners that earcut drops.
    """
    found = mapbox_earcut.triangulate_float64(polygon, np.array([len(polygon)], np.uint32))
    triangles = found.reshape(-1, 3).astype(np.int64)
    (x0, z0), (x1, z1), (x2, z2) = polygon[triangles].transpose(1, 2, 0)
    areas = ((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / 2
    if len(triangles) != len(polygon) - 2 or abs(abs(areas).sum() - signed_area(polygon)) > 1e-6 * abs(areas).sum():
        raise ValueError("polygon crosses itself")
    # Counter-clockwise (x, z) is clockwise seen from above, with x right and z down.
    return np.where(areas[:, None] > 0, triangles[:, ::-1], triangles)


def remove_triangles(pieces: Sequence[PlanPolygon], cutters: Sequence[PlanPolygon]) -> list[PlanPolygon]:
    """Return convex pieces of the convex polygons `pieces` that are outside all triangles `cutters`.

    Cutters have either winding. Pieces of at most `MIN_PIECE_AREA` are dropped, see `_outside`.
    """
    left = list(pieces)
    for cutter in cutters:
        (x0, y0), (x1, y1), (x2, y2) = cutter
        ccw = cutter if (x1 - x0) * (y2 - y0) > (x2 - x0) * (y1 - y0) else cutter[::-1]
        left = [rest for piece in left for rest in _outside(piece, ccw)]
    return left


def _outside(piece: PlanPolygon, cutter: PlanPolygon) -> list[PlanPolygon]:
    """Return the part of a convex polygon outside a counter-clockwise triangle as convex polygons, maybe none.

    Parts of at most `MIN_PIECE_AREA` are dropped. If only so much would be cut off, the polygon is returned unchanged.
    """
    if (piece.max(axis=0) <= cutter.min(axis=0)).any() or (piece.min(axis=0) >= cutter.max(axis=0)).any():
        return [piece]
    found, inside = [], piece
    for start, end in zip(cutter, np.roll(cutter, -1, axis=0), strict=True):
        way = end - start
        side = way[0] * (inside[:, 1] - start[1]) - way[1] * (inside[:, 0] - start[0])
        beyond, inside = clip_polygon(inside, -side), clip_polygon(inside, side)
        if _plan_area(beyond) > MIN_PIECE_AREA:
            found.append(beyond)
        if _plan_area(inside) <= MIN_PIECE_AREA:
            return found if _plan_area(piece) - sum(map(_plan_area, found)) > MIN_PIECE_AREA else [piece]
    return found


def clip_polygon(polygon: PlanPolygon, side: Float[np.ndarray, " n"]) -> PlanPolygon:
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


def keep_triangles(pieces: Sequence[PlanPolygon], cutters: Sequence[PlanPolygon]) -> list[PlanPolygon]:
    """Return convex pieces of the convex polygons `pieces` that are inside one of the disjoint triangles `cutters`.

    Cutters have either winding. Pieces of at most `MIN_PIECE_AREA` are dropped.
    """
    found = []
    for cutter in cutters:
        (x0, y0), (x1, y1), (x2, y2) = cutter
        ccw = cutter if (x1 - x0) * (y2 - y0) > (x2 - x0) * (y1 - y0) else cutter[::-1]
        found += [part for piece in pieces if _plan_area(part := _inside(piece, ccw)) > MIN_PIECE_AREA]
    return found


def _inside(piece: PlanPolygon, cutter: PlanPolygon) -> PlanPolygon:
    """Return the part of a convex polygon inside a counter-clockwise triangle; maybe without corners."""
    if (piece.max(axis=0) <= cutter.min(axis=0)).any() or (piece.min(axis=0) >= cutter.max(axis=0)).any():
        return piece[:0]
    for start, end in zip(cutter, np.roll(cutter, -1, axis=0), strict=True):
        way = end - start
        piece = clip_polygon(piece, way[0] * (piece[:, 1] - start[1]) - way[1] * (piece[:, 0] - start[0]))
    return piece


def fan_triangles(
    piece: PlanPolygon, triangle: Float[np.ndarray, "3 3"], uv: Float[np.ndarray, "3 2"]
) -> tuple[Float[np.ndarray, "n 3 3"], Float[np.ndarray, "n 3 2"]]:
    """Return corners and uv of triangles that fill a convex plan piece of a triangle, in its plane and winding.

    Triangles almost without area are left out.
    """
    weight = np.linalg.solve(np.vstack([triangle[:, :2].T, np.ones(3)]), np.vstack([piece.T, np.ones(len(piece))])).T
    order = np.array([[0, k, k + 1] for k in range(1, len(piece) - 1)])
    order = order[[_plan_area(piece[k]) > MIN_PIECE_AREA / 100 for k in order]]
    return (weight @ triangle)[order], (weight @ uv)[order]


def _plan_area(polygon: PlanPolygon) -> float:
    """Return the area of a polygon of either winding [m^2]; 0 without corners."""
    return abs(signed_area(polygon)) if len(polygon) else 0.0
