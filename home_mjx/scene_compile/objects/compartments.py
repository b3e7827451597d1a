"""Compartments of furniture: hollows in a closed body behind its fronts, with shelves between them."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.kept_results import find_model
from home_mjx.geometry.box_fit import triangle_components
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, make_boxes
from home_mjx.geometry.meshes import bounds, make_model
from home_mjx.schema.compiled import Model

BOARD = 0.018  # [m], thickness of walls, backs and shelves
MIN_POCKET = 0.05  # [m], minimum extent of a compartment
MAX_POCKET_HEIGHT = 0.4  # [m], maximum height of a compartment; shelves divide higher ones
MAX_INSET, MAX_GAP = 0.07, 0.03  # [m], maximum depth of a front in its body, and maximum gap between both
MIN_COVER = 0.5  # minimum share of a front that is before the face of its body
FLATNESS = 1e-4  # [m], maximum distance of corners from the plane of a face
CLEARANCE_DEPTH = 0.15  # [m], depth before a face in which collision boxes leave room for its fronts
CLEARANCE_GAP = 0.005  # [m], the same around the fronts

Corners = Float[np.ndarray, "2 3"]  # minimum and maximum [m]


@dataclass(frozen=True)
class Pocket:
    """A compartment in its model's frame: a box that is open on one side."""

    corners: tuple[tuple[float, ...], tuple[float, ...]]  # minimum and maximum [m]
    front: tuple[tuple[float, ...], tuple[float, ...]]  # the same of its front
    axis: int  # of the open side, 0 or 1
    side: int  # 1 if the open side is the maximum along it, -1 if the minimum

    @property
    def box(self) -> Corners:
        """Minimum and maximum corner [m]."""
        return np.array(self.corners)

    @property
    def cutters(self) -> Float[np.ndarray, "2 2 3"]:
        """What is cut out of collision boxes: the compartment, and the room for the front before the face."""
        end, before = (self.side + 1) // 2, np.array(self.front)
        before += np.array([[-CLEARANCE_GAP], [CLEARANCE_GAP]])
        plane = self.corners[end][self.axis]
        before[end, self.axis], before[1 - end, self.axis] = plane + self.side * CLEARANCE_DEPTH, plane
        return np.stack([self.box, before])


@dataclass(frozen=True)
class _Face:
    """A flat rectangular face of a closed piece of a model."""

    piece: int
    axis: int
    side: int
    plane: float  # [m], coordinate along the axis
    extent: Corners  # of the face
    depth: float  # [m], thickness of the piece behind it
    triangles: Bool[np.ndarray, " t"]


def cut_pockets(
    body: Model, fronts: Sequence[Model], drawers: Collection[int] = ()
) -> tuple[Model, tuple[Pocket, ...]]:
    """Return a body with compartments behind its fronts, and the compartments.

    Behind a front, the piece whose flat and rectangular face it covers is hollowed: the compartment is as large as the
    front without a board on each side, and as deep as the piece without a back. Shelves divide it by
    `MAX_POCKET_HEIGHT`. Nothing is cut where there is no such face, for example since the body is hollow already.

    Args:
        body: Furniture without its fronts, front along x or y of its frame.
        fronts: Its fronts, shut.
        drawers: Indices of fronts whose compartments have no shelves.
    """
    triangles = body.triangle.astype(np.float64)
    piece = triangle_components(triangles)
    pockets: dict[tuple[int, int, int], list[Pocket]] = {}
    faces: dict[tuple[int, int, int], _Face] = {}
    for number, front in enumerate(fronts):
        face = _find_face(triangles, piece, front.box.astype(np.float64))
        if face is not None:
            key = face.piece, face.axis, face.side
            faces[key] = face
            pockets.setdefault(key, []).extend(_pockets(face, front.box.astype(np.float64), number in drawers))
    found = [(faces[key], own) for key, own in pockets.items() if own]
    if not found:
        return body, ()
    kept = ~np.any([face.triangles for face, _ in found], axis=0)
    new = [(_quads(face, own), face) for face, own in found]
    stem = body.key.split(":")[0].rpartition("/")[0]
    return _rebuilt(f"{stem}/hollow", body, kept, new), tuple(p for _, own in found for p in own)


def _find_face(triangles: Float[np.ndarray, "t 3 3"], piece: np.ndarray, front: Corners) -> _Face | None:
    """Return the face that a front covers most; None if there is none."""
    axis = int(np.ptp(front, axis=0)[:2].argmin())
    found = [
        face
        for number in np.unique(piece).tolist()
        for side in (-1, 1)
        if (face := _covered_face(triangles, piece == number, number, axis, side, front)) is not None
    ]
    return max(found, key=lambda face: _cover(face.extent, front, axis) * face.depth, default=None)


def _covered_face(
    triangles: Float[np.ndarray, "t 3 3"],
    own: Bool[np.ndarray, " t"],
    number: int,
    axis: int,
    side: int,
    front: Corners,
) -> _Face | None:
    """Return the face of a piece at one side along an axis, if it is a flat rectangle that the front covers."""
    box = bounds(triangles[own])
    end = (side + 1) // 2
    plane, depth = float(box[end, axis]), float(np.ptp(box[:, axis]))
    gap = side * (float(front[1 - end, axis]) - plane)  # from the face to the back of the front
    if depth < MIN_POCKET + BOARD or not -MAX_INSET <= gap <= MAX_GAP or _cover(box, front, axis) < MIN_COVER:
        return None
    flat = own & (np.abs(triangles[:, :, axis] - plane) < FLATNESS).all(axis=1)
    if not flat.any():
        return None
    extent = bounds(triangles[flat])
    a, b, c = triangles[flat].transpose(1, 0, 2)
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    rectangle = float(np.prod(np.delete(np.ptp(extent, axis=0), axis)))
    if abs(area - rectangle) > 0.01 * rectangle or _cover(extent, front, axis) < MIN_COVER:
        return None
    return _Face(number, axis, side, plane, extent, depth, flat)


def _cover(box: Corners, front: Corners, axis: int) -> float:
    """Return the share of a front that is before a box, seen along an axis."""
    shared = np.minimum(box[1], front[1]) - np.maximum(box[0], front[0])
    return float(np.prod(np.delete(np.maximum(shared, 0) / np.maximum(np.ptp(front, axis=0), 1e-9), axis)))


def _pockets(face: _Face, front: Corners, is_drawer: bool) -> Iterator[Pocket]:
    """Yield the compartments behind a front, the lowest first; none if they would be too small.

    That of a drawer has no shelves.
    """
    low = np.maximum(face.extent[0], front[0]) + BOARD
    high = np.minimum(face.extent[1], front[1]) - BOARD
    near, far = face.plane, face.plane - face.side * (face.depth - BOARD)
    low[face.axis], high[face.axis] = min(near, far), max(near, far)
    if (high - low).min() < MIN_POCKET:
        return
    count = 1 if is_drawer else int(np.ceil((high[2] - low[2]) / MAX_POCKET_HEIGHT))
    each = (high[2] - low[2] - (count - 1) * BOARD) / count
    for i in range(count):
        bottom = low[2] + i * (each + BOARD)
        corners = (*low[:2].tolist(), float(bottom)), (*high[:2].tolist(), float(bottom + each))
        yield Pocket(corners, (tuple(front[0].tolist()), tuple(front[1].tolist())), face.axis, face.side)


def _quads(face: _Face, pockets: Sequence[Pocket]) -> Float[np.ndarray, "q 4 3"]:
    """Return the rectangles that replace a face: the rest of it around the compartments, and their five sides each."""
    across = 1 - face.axis
    quads = [_rectangle(face, (u0, u1), (z0, z1)) for u0, u1, z0, z1 in _rest(face, pockets, across)]
    for pocket in pockets:
        low, high = pocket.box
        inner = {face.axis: (pocket.side + 1) // 2}
        for axis, end in ((a, e) for a in range(3) for e in (0, 1) if inner.get(a) != e):
            quads.append(_side(low, high, axis, end))
    return np.array(quads)


def _rest(face: _Face, pockets: Sequence[Pocket], across: int) -> Iterator[tuple[float, float, float, float]]:
    """Yield rectangles (across, then up: minimum and maximum each) that cover a face except for its compartments."""
    (left, right), (floor, top) = face.extent[:, across].tolist(), face.extent[:, 2].tolist()
    heights = sorted({floor, top, *(float(z) for p in pockets for z in p.box[:, 2])})
    for z0, z1 in pairwise(heights):
        here = sorted(tuple(p.box[:, across].tolist()) for p in pockets if p.box[0, 2] < (z0 + z1) / 2 < p.box[1, 2])
        edges = [left, *(u for pair in here for u in pair), right]
        yield from ((u0, u1, z0, z1) for u0, u1 in zip(edges[::2], edges[1::2], strict=True) if u1 > u0)


def _rectangle(face: _Face, across: tuple[float, float], up: tuple[float, float]) -> Float[np.ndarray, "4 3"]:
    """Return a rectangle in the plane of a face, counter-clockwise from outside."""
    low, high = np.full(3, face.plane), np.full(3, face.plane)
    low[1 - face.axis], high[1 - face.axis] = across
    low[2], high[2] = up
    return _side(low, high, face.axis, 1 if face.side < 0 else 0)


def _side(low: np.ndarray, high: np.ndarray, axis: int, end: int) -> Float[np.ndarray, "4 3"]:
    """Return a side of a box, counter-clockwise from inside the box."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = np.array([np.where(np.arange(3) == axis, (low, high)[end], low) for _ in range(4)])
    corners[1, u] = corners[2, u] = high[u]
    corners[2, v] = corners[3, v] = high[v]
    return corners if end == 0 else corners[::-1]


def _rebuilt(name: str, body: Model, kept: np.ndarray, new: Sequence[tuple[np.ndarray, _Face]]) -> Model:
    """Return a body of the kept triangles and of new rectangles, which look like the face that they replace."""
    arrays = [[x[kept] for x in (body.triangle, body.uv, body.slot, body.part, body.normal)]]
    for quads, face in new:
        triangles = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        row = np.full(len(triangles), np.flatnonzero(face.triangles)[0])
        uv, normals = _texture(body, face, triangles), np.repeat(normal[:, None], 3, axis=1)
        arrays.append([triangles, uv, body.slot[row], body.part[row], normals])
    return make_model(name, *(np.concatenate(parts) for parts in zip(*arrays, strict=True)), find=find_model)


def _texture(body: Model, face: _Face, triangles: Float[np.ndarray, "n 3 3"]) -> Float[np.ndarray, "n 3 2"]:
    """Return texture coordinates of new triangles: those of the face, continued over the depth of its sides."""
    across = 1 - face.axis
    points, uv = body.triangle[face.triangles].reshape(-1, 3).astype(float), body.uv[face.triangles].reshape(-1, 2)
    columns = np.c_[points[:, [across, 2]], np.ones(len(points))]
    map_uv = np.linalg.lstsq(columns, uv.astype(float), rcond=None)[0]
    inwards = np.abs(triangles[..., face.axis] - face.plane)
    rows = np.stack([triangles[..., across] + inwards, triangles[..., 2] + inwards, np.ones_like(inwards)], axis=-1)
    return rows @ map_uv


def carve_boxes(boxes: BoxSet, cutters: Float[np.ndarray, "n 2 3"]) -> BoxSet:
    """Return boxes of yaw 0 without what is in `cutters` (minimum and maximum corners [m]), as more boxes.

    Each cut divides a box into at most six. Rests thinner than 1 mm are left out.
    """
    rest = [np.stack([c - h, c + h]) for c, h in zip(boxes.center, boxes.half, strict=True)]
    for cutter in cutters:
        rest = [part for box in rest for part in _carve(box, cutter)]
    if not rest:
        return empty_boxes()
    return concat_boxes(make_boxes(box.mean(axis=0), np.ptp(box, axis=0) / 2) for box in rest)


def _carve(box: Corners, cutter: Corners) -> Iterator[Corners]:
    """Yield the parts of a box outside of another one, the largest slabs along x, then y, then z."""
    if (np.minimum(box[1], cutter[1]) - np.maximum(box[0], cutter[0])).min() <= 1e-3:
        yield box
        return
    left = box.copy()
    for axis in range(3):
        for end, sign in ((0, -1), (1, 1)):
            if sign * (left[end, axis] - cutter[end, axis]) > 1e-3:
                part = left.copy()
                part[1 - end, axis] = cutter[end, axis]
                yield part
                left[end, axis] = cutter[end, axis]
