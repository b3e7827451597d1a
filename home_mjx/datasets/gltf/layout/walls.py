"""Walls among the triangles of a storey: upright plane pieces, with the room that each one faces."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.datasets.gltf.layout.free_map import wall_direction
from home_mjx.datasets.gltf.layout.storey_search import UPRIGHT_SLOPE
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet
from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.polygons import is_inside_polygon

ANGLE_STEP = np.deg2rad(5.0)  # normals within about this angle are of one plane
OFFSET_STEP = 0.03  # [m], faces within about this distance are of one plane
MAX_GAP = 0.3  # [m], maximum gap along a wall
MIN_LENGTH, MIN_HEIGHT, MIN_AREA = 0.4, 1.0, 0.4  # [m], [m], [m^2], minimum size of a wall
MIN_COVER = 0.1  # minimum share of a wall's rectangle that is covered; edges around an open side are no wall
MAX_WALL_TRIANGLES = 400  # walls of more triangles are of a scan, whose faces are found along outlines
SCAN_REACH = 0.28  # [m], maximum distance of a scan's wall from an outline
SCAN_COSINE = 0.7  # minimum cosine between the normals of a scan's face and its wall
PROBE_DISTANCE = 0.1  # [m], distance in front of a wall at which its room is looked up
MAX_THICKNESS = 0.45  # [m], maximum distance of the outer layer behind the inner one


@dataclass(frozen=True)
class WallFace:
    """One side of a wall.

    Attributes:
        rows: Its triangles.
        angle: Direction of its normal in the plan (x, z) [rad].
        offset: Distance of its plane from the origin along the normal [m].
        along: Minimum and maximum along the wall [m].
        room: Index of the room that it faces; -1 if none.
    """

    rows: Int[np.ndarray, " r"]
    angle: float
    offset: float
    along: tuple[float, float]
    room: int

    def is_back_of(self, other: "WallFace") -> bool:
        """Return whether this is the other side of the same wall: behind it, and at least half beside it."""
        if np.cos(self.angle - other.angle) > -0.99:
            return False
        low, high = -self.along[1], -self.along[0]
        common = min(high, other.along[1]) - max(low, other.along[0])
        return 0 <= other.offset + self.offset <= MAX_THICKNESS and common > (high - low) / 2


def find_walls(
    triangles: TriangleSet, rooms: Sequence[Float[np.ndarray, "_ 2"]], heights: tuple[float, float]
) -> dict[int, list[Int[np.ndarray, " _"]]]:
    """Return the walls of each room by its index, each as rows of triangles.

    A wall's outer layer is part of it. Faces that no room is in front of are not walls. Rough walls of scans are those
    along the sides of outlines.

    Args:
        triangles: Triangles of the architecture.
        rooms: Outlines (x, z) of the rooms of one storey [m].
        heights: Minimum and maximum height of the storey [m].
    """
    faces = _wall_faces(triangles, rooms, heights)
    walls: dict[int, list] = {}
    backs = [face for face in faces if face.room < 0]
    for face in faces:
        if face.room >= 0:
            mine = [back for back in backs if back.is_back_of(face)]
            backs = [back for back in backs if not back.is_back_of(face)]
            walls.setdefault(face.room, []).append(np.concatenate([face.rows, *(back.rows for back in mine)]))
    rest = np.flatnonzero(~mask_of(walls, len(triangles)) & triangles.within(*heights))
    for room, rows in _scan_walls(triangles[rest], rooms):
        walls.setdefault(room, []).append(rest[rows])
    return walls


def _scan_walls(
    triangles: TriangleSet, rooms: Sequence[Float[np.ndarray, "_ 2"]]
) -> Iterator[tuple[int, Int[np.ndarray, " _"]]]:
    """Yield the room and the triangles of each wall of a scan; a triangle is in one wall at most."""
    upright = np.flatnonzero((abs(triangles.slope) < SCAN_COSINE) & (triangles.area > 0))
    normal = triangles.doubled_normal[upright][:, [0, 2]]
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    middle = triangles.middle[upright][:, [0, 2]]
    faced = _room_in_front(middle + PROBE_DISTANCE * normal, rooms)
    left = np.ones(len(upright), bool)
    for room, corners in enumerate(rooms):
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            length = float(np.linalg.norm(end - start))
            if length > MIN_LENGTH:
                way = (end - start) / length
                across = np.array([-way[1], way[0]])
                along, off = (middle - start) @ way, abs((middle - start) @ across)
                near = (along > -PROBE_DISTANCE) & (along < length + PROBE_DISTANCE) & (off < SCAN_REACH)
                near &= left & (abs(normal @ across) > SCAN_COSINE) & ((faced == room) | (faced < 0))
                rows = upright[near]
                if len(rows) > MAX_WALL_TRIANGLES and _is_large(triangles, rows):
                    left &= ~near
                    yield room, rows


def _wall_faces(
    triangles: TriangleSet, rooms: Sequence[Float[np.ndarray, "_ 2"]], heights: tuple[float, float]
) -> list[WallFace]:
    """Return the plane upright pieces of a storey that are large enough for walls."""
    middle = triangles.middle
    here = (abs(triangles.slope) < UPRIGHT_SLOPE) & (middle[:, 1] > heights[0]) & (middle[:, 1] < heights[1])
    rows = np.flatnonzero(here & (triangles.area > 1e-9))
    x, _, z = triangles.doubled_normal[rows].T
    first = -wall_direction(triangles[rows])  # so that planes of most walls are exactly of one angle
    turn = np.round((np.arctan2(z, x) - first) / ANGLE_STEP).astype(int) % round(2 * np.pi / ANGLE_STEP)
    angle = first + turn * ANGLE_STEP
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    plan = triangles.corners[rows][..., [0, 2]]
    offset = np.einsum("tci,ti->tc", plan, normal).mean(axis=1)
    along = np.einsum("tci,ti->tc", plan, normal[:, ::-1] * [-1, 1])
    room = _room_in_front(middle[rows][:, [0, 2]] + PROBE_DISTANCE * normal, rooms)
    key = np.stack([turn, np.floor(offset / OFFSET_STEP + 0.5).astype(int), room], axis=1)
    _, group = unique_cells(key)
    order = np.argsort(group, kind="stable")
    found = []
    for part in np.split(order, np.flatnonzero(np.diff(group[order])) + 1) if len(order) else []:
        for piece in _connected(part, along):
            if len(piece) <= MAX_WALL_TRIANGLES and _is_large(triangles, rows[piece]):
                ends = float(along[piece].min()), float(along[piece].max())
                at = float(angle[piece[0]]), float(offset[piece].mean())
                found.append(WallFace(rows[piece], *at, ends, int(room[piece[0]])))
    return found


def _room_in_front(
    points: Float[np.ndarray, "p 2"], rooms: Sequence[Float[np.ndarray, "_ 2"]]
) -> Int[np.ndarray, " p"]:
    """Return the last room that contains each point (x, z); -1 if none does."""
    found = np.full(len(points), -1)
    for number, corners in enumerate(rooms):
        found[is_inside_polygon(corners, points)] = number
    return found


def _connected(part: Int[np.ndarray, " n"], along: Float[np.ndarray, "t 3"]) -> list[Int[np.ndarray, " _"]]:
    """Return rows of one plane split where they leave a gap along it."""
    low, high = along[part].min(axis=1), along[part].max(axis=1)
    order = np.argsort(low, kind="stable")
    reach = np.maximum.accumulate(high[order])
    starts = np.flatnonzero(low[order][1:] > reach[:-1] + MAX_GAP) + 1
    return np.split(part[order], starts)


def _is_large(triangles: TriangleSet, rows: Int[np.ndarray, " r"]) -> bool:
    """Return whether triangles are long, high and large enough for a wall."""
    size = np.ptp(triangles.corners[rows].reshape(-1, 3), axis=0)
    length = float(np.hypot(size[0], size[2]))
    min_area = max(MIN_AREA, MIN_COVER * length * size[1])
    return bool(length > MIN_LENGTH and size[1] > MIN_HEIGHT and triangles.area[rows].sum() > min_area)


def mask_of(walls: dict[int, list[Int[np.ndarray, " _"]]], count: int) -> Bool[np.ndarray, " _"]:
    """Return a mask of the triangles, of `count`, that are in a wall."""
    mask = np.zeros(count, bool)
    for parts in walls.values():
        for rows in parts:
            mask[rows] = True
    return mask
