"""Polygons of the floor plan, and outlines of slabs."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.slabs import signed_area
from home_mjx.schema.compiled import RoomTable

MERGE_DISTANCE = 1e-4  # [m], distance below which corners are merged
MAX_BEND = 1e-3  # [m], maximum distance of removed corners from an outline
MIN_HOLE_RADIUS = 0.1  # [m], minimum radius of a circle in a hole; agents stand across narrower ones
HOLE_STEPS = 24  # points along each side of the grid that measures a hole
MAX_CUT_PAIRS = 1 << 24  # maximum pairs of edges and corners that are compared to cut edges at corners on them
MAX_BATCHED_POINTS = 64  # maximum number of points that are compared with all edges of a polygon at once

Edge = tuple[int, int]


def polygon_area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Return the area of a simple polygon of either winding [m^2], by the shoelace formula; never negative.

    Holes that bridges join to the polygon, see `outline`, are deducted. Without corners it is 0.
    """
    x, y = polygon.T
    following_x, following_y = np.concatenate([polygon[1:], polygon[:1]]).T
    return float(abs(np.dot(x, following_y) - np.dot(y, following_x)) / 2)


def is_inside_polygon(polygon: Float[np.ndarray, "n 2"], points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
    """Return whether points are inside a simple polygon of either winding; points on its edge may be either.

    Points in holes that bridges join to it, see `outline`, are outside. A polygon without area contains nothing.
    """
    return are_inside_polygons([polygon], points)[0, ...]


def are_inside_polygons(
    polygons: Sequence[Float[np.ndarray, "_ 2"]], points: Float[np.ndarray, "*p 2"]
) -> Bool[np.ndarray, "n *p"]:
    """Return whether points (axes `*p`) are inside each of `n` polygons (first axis), see `is_inside_polygon`.

    Polygons may overlap and differ in their number of corners; there may be none.
    """
    x, y = points[..., 0], points[..., 1]
    inside = np.zeros((len(polygons), *x.shape), bool)
    edges = np.concatenate([np.zeros((0, 4)), *(np.c_[p, np.concatenate([p[1:], p[:1]])] for p in polygons)])
    polygon = np.repeat(np.arange(len(polygons)), [len(p) for p in polygons])
    sloped = edges[:, 1] != edges[:, 3]
    edges, polygon = edges[sloped], polygon[sloped]
    if x.size > MAX_BATCHED_POINTS:
        for number, edge in zip(polygon.tolist(), edges, strict=True):
            inside[number] ^= _crosses(x, y, edge)
    elif len(edges):
        met = _crosses(x, y, edges.T.reshape(4, -1, *(1,) * x.ndim))
        first = np.flatnonzero(np.diff(polygon, prepend=-1))
        inside[polygon[first]] = np.logical_xor.reduceat(met, first, axis=0)
    return inside


def _crosses(x: np.ndarray, y: np.ndarray, edges: Float[np.ndarray, "4 ..."]) -> Bool[np.ndarray, "..."]:
    """Return whether rays from points along +x cross edges (x0, y0, x1, y1), none of which is parallel to x.

    A ray crosses an edge at its end of lower y, but not at the other end, nor if it begins on the edge. Points and
    edges broadcast.
    """
    x0, y0, x1, y1 = edges
    return ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))


def polygon_distance(polygon: Float[np.ndarray, "n 2"], point: Float[np.ndarray, "2"]) -> float:
    """Return the distance from a point (x, y) to a simple polygon [m]; 0 inside, inf if the polygon has no corners.

    In a hole it is the distance to the hole's edge.
    """
    if is_inside_polygon(polygon, point):
        return 0.0
    way = np.roll(polygon, -1, axis=0) - polygon
    along = np.sum((point - polygon) * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-12)
    nearest = polygon + np.clip(along, 0, 1)[:, None] * way
    return float(np.linalg.norm(nearest - point, axis=1).min(initial=np.inf))


def boundary_edges(polygon: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "_ 2 2"]:
    """Return a polygon's edges (start, end), in order, except bridges to its holes and edges of no length.

    An edge is a bridge if the polygon has it in both directions, with exactly equal coordinates.
    """
    edges = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    return edges[~(edges[:, None] == edges[:, ::-1]).all(axis=(2, 3)).any(axis=1)]


def find_innermost_point(polygon: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "2"]:
    """Return the point of a `HOLE_STEPS` x `HOLE_STEPS` grid inside a polygon that is farthest from its edges.

    0.1 % of a point's distance to the middle of the bounds is deducted, so that ties go to the nearest one. If no grid
    point is inside, as without area, return the middle, which may be outside. The polygon must have corners.
    """
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    x, y = (np.linspace(a, b, HOLE_STEPS + 2)[1:-1] for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    points = points[is_inside_polygon(polygon, points)]
    if not len(points):
        return (low + high) / 2
    away = _edge_distance(polygon, points)
    # Ties, as along a corridor, are resolved in favour of the point nearest to the middle.
    score = away - 1e-3 * np.linalg.norm(points - (low + high) / 2, axis=1)
    return points[np.argmax(score)]


def find_smallest_room(
    rooms: RoomTable, candidates: Int[np.ndarray, " r"], points: Float[np.ndarray, "*p 2"]
) -> Int[np.ndarray, "*p"]:
    """Return the room of `candidates` of least area (the last of equal ones) that contains each point; -1 if none.

    The result is an index into `rooms`, not into `candidates`. Points are (x, y) [m]; heights and levels are not
    compared. A point on an edge may be in either room or none.
    """
    found = np.full(points.shape[:-1], -1, np.int32)
    order = sorted(candidates, key=lambda r: -polygon_area(rooms.polygon[r]))
    for room, inside in zip(order, are_inside_polygons([rooms.polygon[r] for r in order], points), strict=True):
        found[inside] = room
    return found


def bounding_outline(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "4 2"]:
    """Return the corners (x, y) of the axis-aligned rectangle around at least one Z-up triangle, counter-clockwise.

    The first is the minimum corner. The rectangle may have no area.
    """
    (x0, y0), (x1, y1) = triangles[..., :2].min(axis=(0, 1)), triangles[..., :2].max(axis=(0, 1))
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def outline(slab: Float[np.ndarray, "t 3 3"], with_holes: bool = False) -> Float[np.ndarray, "n 2"]:
    """Return the outer edge (x, y) of a slab's upper side, counter-clockwise: its largest closed boundary loop.

    Corners on a line are dropped. If no loop encloses more than 90 % of the upper side's area, or no triangle faces up,
    return the `bounding_outline` of the whole slab.

    Args:
        slab: Triangles of the slab, Z up [m], counter-clockwise seen from outside; at least one.
        with_holes: Cut out holes of at least `MIN_HOLE_RADIUS`, else fill all. A bridge along x joins each of them to
            the edge, see `boundary_edges`. It changes neither `polygon_area` nor `is_inside_polygon`, but the polygon
            then repeats corners.
    """
    polygons, area = _boundary_polygons(slab)
    largest = max(polygons, key=_area, default=np.zeros((0, 2)))
    # Triangles that do not touch yield several loops, none of which is the outline.
    if _area(largest) <= 0.9 * area or not len(largest):
        return bounding_outline(slab)
    return _cut_holes(largest, _find_holes(largest, polygons)) if with_holes else largest


def _boundary_polygons(slab: Float[np.ndarray, "t 3 3"]) -> tuple[list[Float[np.ndarray, "_ 2"]], float]:
    """Return the boundary loops (x, y) of a slab's upper side [m], and the area of its triangles in plan [m^2].

    Loops of holes are clockwise, others counter-clockwise. Corners within a grid cell of `MERGE_DISTANCE` are merged.
    Without upward triangles, there are no loops and the area is 0.
    """
    normal = np.cross(slab[:, 1] - slab[:, 0], slab[:, 2] - slab[:, 0])
    upper = (normal[:, 2] > 0.7 * np.linalg.norm(normal, axis=1)) & (normal[:, 2] > 1e-12)
    if not upper.any():
        return [], 0.0
    points = np.round(slab[upper, :, :2] / MERGE_DISTANCE).astype(np.int64).reshape(-1, 2)
    first, index = unique_cells(points)
    corners = points[first]
    loops = _boundary_loops(_cut_edges(_open_edges(index.reshape(-1, 3)), corners))
    return [straighten(corners[loop] * MERGE_DISTANCE) for loop in loops], float(normal[upper, 2].sum()) / 2


def _find_holes(
    largest: Float[np.ndarray, "n 2"], polygons: Sequence[Float[np.ndarray, "_ 2"]]
) -> list[Float[np.ndarray, "_ 2"]]:
    """Return the clockwise loops inside `largest` that contain a circle of `MIN_HOLE_RADIUS`.

    Both are tested at `find_innermost_point` only, so a loop that is partly outside may be returned.
    """
    found = [(p, find_innermost_point(p)) for p in polygons if signed_area(p) < 0]
    return [
        hole
        for hole, middle in found
        if is_inside_polygon(largest, middle) and _edge_distance(hole, middle[None])[0] >= MIN_HOLE_RADIUS
    ]


def _edge_distance(polygon: Float[np.ndarray, "n 2"], points: Float[np.ndarray, "p 2"]) -> Float[np.ndarray, " p"]:
    """Return the distances from points to the `boundary_edges` of a polygon [m], also inside; it must have some."""
    return np.min([_segment_distance(points, a, b) for a, b in boundary_edges(polygon)], axis=0)


def _cut_holes(
    polygon: Float[np.ndarray, "n 2"], holes: Sequence[Float[np.ndarray, "_ 2"]]
) -> Float[np.ndarray, "_ 2"]:
    """Join clockwise holes to a counter-clockwise polygon by bridges along +x, the one with the highest x first.

    The result repeats the ends of each bridge. A hole without an edge of the polygon at higher x is left out.
    """
    for hole in sorted(holes, key=lambda h: -h[:, 0].max()):
        # A bridge through corners would be on a line with sides of both.
        levels = np.unique(np.concatenate([polygon, hole])[:, 1].clip(hole[:, 1].min(), hole[:, 1].max()))
        widest = int(np.diff(levels).argmax())
        y = float(levels[widest] + levels[widest + 1]) / 2
        x, start = _crossings(hole, y)[-1]
        for stop, after in [c for c in _crossings(polygon, y) if c[0] > x][:1]:
            ring = [[stop, y], [x, y], *np.roll(hole, -start - 1, axis=0), [x, y], [stop, y]]
            polygon = np.concatenate([polygon[: after + 1], ring, polygon[after + 1 :]])
    return polygon


def _crossings(polygon: Float[np.ndarray, "n 2"], y: float) -> list[tuple[float, int]]:
    """Return (x, index of the start corner) of each edge of a polygon that crosses the height `y`, sorted by x.

    Edges along x do not cross it. No corner may be at `y`.
    """
    (x0, y0), (x1, y1) = polygon.T, np.roll(polygon, -1, axis=0).T
    edges = np.flatnonzero((y0 > y) != (y1 > y))
    x = x0[edges] + (y - y0[edges]) * (x1 - x0)[edges] / (y1 - y0)[edges]
    return sorted(zip(x.tolist(), edges.tolist(), strict=True))


def _open_edges(triangles: Int[np.ndarray, "t 3"]) -> list[Edge]:
    """Return the directed edges of triangles without an opposite edge, each once, in any order: their boundary.

    Rows are corner indices. Edges from a corner to itself, of degenerate triangles, are dropped.
    """
    edges = {(int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3)}
    return [(a, b) for a, b in edges if a != b and (b, a) not in edges]


def _cut_edges(edges: list[Edge], corners: Int[np.ndarray, "n 2"]) -> list[Edge]:
    """Cut edges at the ends of others that lie on them, see `_pieces`; drop repeated pieces and pairs of opposite ones.

    `corners` are in units of `MERGE_DISTANCE`. If there are more than `MAX_CUT_PAIRS` pairs of edges and ends, the
    edges are returned unchanged.
    """
    ends = np.unique(np.array(edges, np.int64))
    if len(edges) * len(ends) > MAX_CUT_PAIRS:
        return edges
    pieces = dict.fromkeys(piece for edge in edges for piece in _pieces(edge, ends, corners))
    return [(a, b) for a, b in pieces if (b, a) not in pieces]


def _pieces(edge: Edge, ends: Int[np.ndarray, " e"], corners: Int[np.ndarray, "n 2"]) -> list[Edge]:
    """Return an edge as its pieces between those of the corners `ends` that are on it, from its start.

    On it means between its own ends and at most `MERGE_DISTANCE`, the unit of `corners`, from its line.
    """
    a, b = edge
    way, away = (corners[c].astype(float) - corners[a] for c in (b, ends))
    along, square = away @ way, float(way @ way)
    aside = abs(away[:, 0] * way[1] - away[:, 1] * way[0])
    on = (along > 0) & (along < square) & (aside <= np.sqrt(square))
    chain = [a, *ends[on][along[on].argsort()].tolist(), b]
    return list(pairwise(chain))


def _boundary_loops(edges: list[Edge]) -> list[list[int]]:
    """Return closed loops of at least three edges, as corner indices in edge direction; drop open chains.

    A loop may pass a corner twice, except its first. Edges are not used again.
    """
    following: dict[int, list[int]] = {}
    for a, b in edges:
        following.setdefault(a, []).append(b)
    loops = []
    while following:
        loop = _walk(following)
        if len(loop) >= 3:
            loops.append(loop)
    return loops


def _walk(following: dict[int, list[int]]) -> list[int]:
    """Remove a chain of edges from `following`, in place, and return its corners.

    The result is [] if the chain does not return to its first corner; its edges are removed all the same.
    `following` must not be empty.
    """
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


def straighten(polygon: Float[np.ndarray, "n 2"], max_bend: float = MAX_BEND) -> Float[np.ndarray, "_ 2"]:
    """Return a polygon without corners within `max_bend` [m] of the rest; unchanged if fewer than 3 would remain.

    Each corner is compared with the sides that remain (Douglas and Peucker 1973), so that an arc keeps its shape
    however finely it is divided. The corner farthest from the centroid, and the one farthest from that, always remain.
    The order is kept.
    """
    if len(polygon) <= 3:
        return polygon
    first = int(np.linalg.norm(polygon - polygon.mean(axis=0), axis=1).argmax())
    ring = np.roll(polygon, -first, axis=0)
    other = int(np.linalg.norm(ring - ring[0], axis=1).argmax())
    ring = np.concatenate([ring, ring[:1]])
    keep, spans = {0, other}, [(0, other), (other, len(ring) - 1)]
    while spans:
        start, stop = spans.pop()
        away = _segment_distance(ring[start + 1 : stop], ring[start], ring[stop])
        if away.max(initial=0.0) > max_bend:
            middle = start + 1 + int(away.argmax())
            keep.add(middle)
            spans += [(start, middle), (middle, stop)]
    rows = np.sort((np.array(sorted(keep)) + first) % len(polygon))
    return polygon[rows] if len(rows) >= 3 else polygon


def _segment_distance(
    points: Float[np.ndarray, "n 2"], start: Float[np.ndarray, "2"], stop: Float[np.ndarray, "2"]
) -> Float[np.ndarray, " n"]:
    """Return the distances from points to a segment, ends included [m]; the ends may be equal."""
    way = stop - start
    along = np.clip((points - start) @ way / max(float(way @ way), MERGE_DISTANCE**2), 0, 1)
    return np.linalg.norm(start + along[:, None] * way - points, axis=1)


def _area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Return the area of a polygon of either winding [m^2], never negative; 0 without corners."""
    return abs(signed_area(polygon)) if len(polygon) else 0.0
