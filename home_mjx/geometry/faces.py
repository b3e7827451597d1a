"""Triangulation of the faces of mesh files: planar or bent polygons, convex or not, with bridges to their holes."""

from collections.abc import Iterator

import mapbox_earcut
import numpy as np
from jaxtyping import Bool, Float, Int

MAX_FAN_STARTS = 8  # corners from which a fan is tried before ear clipping
MAX_EAR_CORNERS = 1 << 17  # maximum corners of all polygons of a mesh that need ear clipping; they take some seconds
MAX_POLYGON_CORNERS = 1 << 13  # maximum corners of one of them; clipping takes quadratic time at worst
AREA_TOLERANCE = 1e-9  # of the squared extent of a polygon: rounding errors of areas
MIN_TWIST = 0.05  # minimum distance of a twisted polygon's corners from a plane, as a fraction of its radius
ANGLE_TOLERANCE = 1e-6  # [rad]
EAR_TOLERANCE = 1e-6  # maximum relative difference between a polygon's area and that of its triangles

Points = Float[np.ndarray, "n 3"]


class FaceError(ValueError):
    """A polygon without a triangulation.

    Attributes:
        face: Index of the polygon.
    """

    def __init__(self, face: int, message: str) -> None:
        super().__init__(message)
        self.face = face


def triangulate_faces(
    points: Float[np.ndarray, "c 3"], sides: Int[np.ndarray, " f"], tolerant: bool = False
) -> tuple[Int[np.ndarray, "t 3"], Int[np.ndarray, " t"]]:
    """Split polygons into triangles of the same winding, in the order of the polygons.

    A polygon that is star-shaped about its first corner, as all convex ones, becomes the fan (0, k, k + 1), degenerate
    triangles included. Others become the fan of another corner or, by `mapbox_earcut`, clipped ears. Non-planar
    polygons are projected along their vector area (Newell's method). A bridge to a hole, in both directions, is an edge
    like others. A twisted polygon is far from any plane and crosses itself in this projection. It becomes the fan of
    its first corner; SUNCG has such quads of millimetres.

    Args:
        points: Corners of all polygons, one after another [m].
        sides: Number of corners of each polygon; at least 3.
        tolerant: Take the fan of the first corner for polygons that cannot be cut, instead of raising an error.

    Returns:
        Indices into `points`, and the polygon of each triangle. Each polygon has `sides` - 2 triangles if it is a fan,
        and may have fewer if its ears are clipped.

    Raises:
        FaceError: A polygon crosses itself, or ear clipping would take too long. Corners all on a line never raise.

    Example:
        >>> notch = np.array([[0.0, 0, 0], [2, 0, 0], [1, 1, 0], [2, 2, 0], [0, 2, 0]])
        >>> triangulate_faces(notch, np.array([5]))[0].tolist()
        [[0, 1, 2], [0, 2, 3], [0, 3, 4]]
    """
    first = np.cumsum(sides) - sides
    start = np.zeros(len(sides), np.int64)  # corner of each polygon's fan; -1 if no fan is right
    for count in np.unique(sides[sides > 3]).tolist():
        rows = np.flatnonzero(sides == count)
        start[rows] = _fan_starts(points[first[rows][:, None] + np.arange(count)])
    found, face = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
    for row, corners in _ears(points, first, sides, np.flatnonzero(start < 0), tolerant):
        if corners is None:
            start[row] = 0
        else:
            found.append(corners + first[row])
            face.append(np.full(len(corners), row))
    return _in_order(_fans(sides, start), (np.concatenate(found), np.concatenate(face)))


def _fan_starts(polygons: Float[np.ndarray, "m n 3"]) -> Int[np.ndarray, " m"]:
    """Return the first of `MAX_FAN_STARTS` corners whose fan covers the polygon, see `_is_fan`; -1 if none does.

    Later corners are not tried.
    """
    count = polygons.shape[1]
    found = np.full(len(polygons), -1)
    for corner in range(min(count, MAX_FAN_STARTS)):
        left = np.flatnonzero(found < 0)
        if not len(left):
            break
        found[left[_is_fan(np.roll(polygons[left], -corner, axis=1))]] = corner
    return found


def _is_fan(polygons: Float[np.ndarray, "m n 3"]) -> Bool[np.ndarray, " m"]:
    """Return whether the fan of the first corner covers each polygon once.

    It is True if no triangle of the fan has an area, but False if areas cancel, as in a bow tie.
    """
    away = polygons[:, 1:] - polygons[:, :1]
    areas = np.cross(away[:, :-1], away[:, 1:])  # twice the area vectors of the fan's triangles
    total = areas.sum(axis=1, keepdims=True)
    length = np.linalg.norm(total, axis=2, keepdims=True)
    along = (areas * np.divide(total, length, out=np.zeros_like(total), where=length > 0)).sum(axis=2)
    extent = (away**2).sum(axis=2).max(axis=1)
    is_flat = np.linalg.norm(areas, axis=2).max(axis=1) <= AREA_TOLERANCE * extent
    has_area = length[:, 0, 0] > AREA_TOLERANCE * extent
    found = is_flat | (has_area & (along.min(axis=1) >= -AREA_TOLERANCE * extent))
    if polygons.shape[1] > 4:
        rows = np.flatnonzero(found & ~is_flat)
        found[rows] = _winds_once(away[rows], along[rows])
    return found


def _winds_once(away: Float[np.ndarray, "m k 3"], along: Float[np.ndarray, "m j"]) -> Bool[np.ndarray, " m"]:
    """Return whether polygons make at most one turn around their first corner and do not return to it in between.

    Corners equal to the first may only be directly after it or at the end; if all are, the result is False. Angles are
    not signed: `along` must not be negative but for rounding errors, and is clipped to 0.

    `away` are the other corners relative to the first, `along` twice the area of each fan triangle along the vector
    area.
    """
    # An edge through the first corner is half a turn, whatever the sign of its rounding error.
    turn = np.arctan2(np.maximum(along, 0), (away[:, :-1] * away[:, 1:]).sum(axis=2)).sum(axis=1)
    is_away = np.pad((away != 0).any(axis=2), ((0, 0), (1, 0)))
    return (turn < 2 * np.pi + ANGLE_TOLERANCE) & ((is_away[:, 1:] & ~is_away[:, :-1]).sum(axis=1) == 1)


def _fans(
    sides: Int[np.ndarray, " f"], start: Int[np.ndarray, " f"]
) -> tuple[Int[np.ndarray, "t 3"], Int[np.ndarray, " t"]]:
    """Return the fans (indices of points, polygon) of all polygons, in order; none if `start` is -1.

    `start` is the corner of each polygon, from 0, at which its fan begins.
    """
    count = np.where(start < 0, 0, sides - 2)
    face = np.repeat(np.arange(len(sides)), count)
    step = np.arange(len(face)) - (np.cumsum(count) - count)[face]
    ring = np.stack([np.zeros_like(step), step + 1, step + 2], axis=1) + start[face, None]
    return (np.cumsum(sides) - sides)[face, None] + ring % sides[face, None], face


def _ears(
    points: Float[np.ndarray, "c 3"],
    first: Int[np.ndarray, " f"],
    sides: Int[np.ndarray, " f"],
    rows: np.ndarray,
    tolerant: bool,
) -> Iterator[tuple[int, Int[np.ndarray, "t 3"] | None]]:
    """Yield polygons of `rows` with triangles of their own corners by ear clipping; None: fan of the first corner.

    None is for twisted polygons and, if `tolerant`, all that are not cut; for these, `FaceError` is raised otherwise.
    No polygon of more than `MAX_POLYGON_CORNERS` corners is cut. If `rows` have more than `MAX_EAR_CORNERS` in all,
    none is. Beyond these limits twisted ones raise, too.
    """
    is_small = bool(sides[rows].sum() <= MAX_EAR_CORNERS)
    for row in rows.tolist():
        polygon = points[first[row] : first[row] + sides[row]]
        corners = _clip_ears(polygon) if is_small and sides[row] <= MAX_POLYGON_CORNERS else None
        if corners is None and not tolerant:
            _check_twisted(row, polygon, is_small)
        yield row, corners


def _check_twisted(row: int, polygon: Points, is_small: bool) -> None:
    """Raise `FaceError` unless an uncut polygon is twisted (see `MIN_TWIST`) and sizes are within their limits.

    `is_small`: all polygons together have at most `MAX_EAR_CORNERS` corners.
    """
    if not is_small:
        raise FaceError(row, f"concave polygons have more than {MAX_EAR_CORNERS} corners in all")
    if len(polygon) > MAX_POLYGON_CORNERS:
        raise FaceError(row, f"concave polygon has {len(polygon)} corners, at most {MAX_POLYGON_CORNERS} are cut")
    away = polygon - polygon.mean(axis=0)
    heights = away @ np.linalg.svd(away)[2][2]
    if np.ptp(heights) < MIN_TWIST * np.linalg.norm(away, axis=1).max():
        raise FaceError(row, "polygon crosses itself")


def _in_order(
    fans: tuple[Int[np.ndarray, "t 3"], Int[np.ndarray, " t"]], ears: tuple[np.ndarray, np.ndarray]
) -> tuple[Int[np.ndarray, "n 3"], Int[np.ndarray, " n"]]:
    """Return the triangles of both, and their polygons, sorted by polygon."""
    if not len(ears[1]):
        return fans
    face = np.concatenate([fans[1], ears[1]])
    order = np.argsort(face, kind="stable")
    return np.concatenate([fans[0], ears[0]])[order], face[order]


def _clip_ears(polygon: Points) -> Int[np.ndarray, "t 3"] | None:
    """Return triangles of a polygon's corners by ear clipping, in its winding; consecutive equal corners count once.

    Return None if it has no area, winds more than once, or the areas of the triangles do not sum to its area.
    """
    rows = np.flatnonzero((polygon != np.roll(polygon, 1, axis=0)).any(axis=1))  # without corners repeated at once
    flat = _project(polygon[rows])
    if flat is None or not _turns_once(flat):
        return None
    x, y = flat.T
    area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    for turn in (0, len(rows) // 3, 2 * len(rows) // 3):  # degenerate bridges may be cut from another corner only
        order = np.roll(np.arange(len(rows)), -turn)
        ring = np.ascontiguousarray(flat[order])
        cut = mapbox_earcut.triangulate_float64(ring, np.array([len(ring)], np.uint32)).reshape(-1, 3).astype(np.int64)
        (ax, ay), (bx, by), (cx, cy) = ring[cut].transpose(1, 2, 0)
        areas = ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
        if len(cut) and abs(abs(areas).sum() - area) <= EAR_TOLERANCE * area:
            return rows[order[np.where(areas[:, None] < 0, cut[:, ::-1], cut)]]
    return None


def _turns_once(flat: Float[np.ndarray, "n 2"]) -> bool:
    """Return whether the exterior angles of a counter-clockwise polygon without repeated corners can sum to one turn.

    Ears of a polygon that winds twice around a point sum to its area as well. A reversal (180 degrees) has either sign.
    """
    way = np.roll(flat, -1, axis=0) - flat
    before = np.roll(way, 1, axis=0)
    angles = np.arctan2(before[:, 0] * way[:, 1] - before[:, 1] * way[:, 0], (before * way).sum(axis=1))
    is_back = abs(angles) > np.pi - ANGLE_TOLERANCE
    return bool(abs(angles[~is_back].sum() - 2 * np.pi) <= np.pi * is_back.sum() + np.pi / 2)


def _project(polygon: Points) -> Float[np.ndarray, "n 2"] | None:
    """Return the polygon projected along its vector area, counter-clockwise from its first corner at (0, 0) [m].

    Return None if it has no vector area, as a bow tie, or fewer than 3 corners.
    """
    if len(polygon) < 3:
        return None
    away = polygon - polygon[0]
    normal = np.cross(away, np.roll(away, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(normal)
    if length <= AREA_TOLERANCE * (away**2).sum(axis=1).max():
        return None
    normal /= length
    across = np.cross(normal, np.eye(3)[abs(normal).argmin()])
    across /= np.linalg.norm(across)
    return away @ np.stack([across, np.cross(normal, across)], axis=1)
