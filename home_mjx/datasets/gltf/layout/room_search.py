"""Rooms of a storey: parts of its free map that are joined only by narrow passages."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.datasets.gltf.layout.free_map import FreeMap
from home_mjx.geometry.polygons import outline, straighten
from home_mjx.geometry.rectangle_cover import cover_with_rectangles
from home_mjx.geometry.rotations import plane_matrix
from home_mjx.geometry.slabs import signed_area, simplify, triangulate

NECK_WIDTH = 1.0  # [m], passages up to this width separate rooms
MIN_ROOM_AREA = 1.0  # [m^2], smaller parts are not rooms
WALL_REACH = 0.12  # [m], distance by which rooms extend into walls
CROSS = ndimage.generate_binary_structure(2, 1)  # a cell and its four neighbours
MAX_BEND = 1.2  # [cells], maximum distance of an outline from the edge of its cells


def find_outlines(free: FreeMap, split: bool) -> list[Float[np.ndarray, "n 2"]]:
    """Return the outlines (x, z) of a storey's rooms [m], largest first.

    Args:
        free: Map of the storey.
        split: Whether narrow passages separate rooms; else each connected part is one room.
    """
    label = _split(free) if split else _parts(free.free)
    label = _drop_small(label, free.cell)
    label = _extend(label, free.cell)
    numbers = np.argsort(-np.bincount(label.ravel())[1:], kind="stable") + 1
    found = [_outline(free, np.asarray(ndimage.binary_fill_holes(label == number))) for number in numbers]
    return [corners for corners in found if corners is not None]


def _parts(cells: Bool[np.ndarray, "ny nx"]) -> Int[np.ndarray, "ny nx"]:
    """Return the number of the 4-connected part of each cell, from 1; 0 elsewhere."""
    part = np.zeros(cells.shape, np.int32)
    ndimage.label(cells, output=part)
    return part


def _split(free: FreeMap) -> Int[np.ndarray, "ny nx"]:
    """Return rooms that grow from cores: connected cells farther from walls than half the width of a neck.

    Parts without a core are rooms of their own.
    """
    away = np.asarray(ndimage.distance_transform_edt(free.free)) * free.cell
    core = _parts(away > NECK_WIDTH / 2)
    whole = _parts(free.free)
    has_core = np.isin(whole, whole[core > 0])
    core = np.where(free.free & ~has_core, core.max() + whole, core)
    return _grow(core, free.free)


def _grow(label: Int[np.ndarray, "ny nx"], cells: Bool[np.ndarray, "ny nx"]) -> Int[np.ndarray, "ny nx"]:
    """Return labels spread over the cells that their parts are connected with, all at the same speed."""
    while True:
        open_cells = cells & (label == 0)
        grown = np.where(open_cells, ndimage.grey_dilation(label, footprint=CROSS), label)
        if (grown == label).all():
            return label
        label = grown


def _drop_small(label: Int[np.ndarray, "ny nx"], cell: float) -> Int[np.ndarray, "ny nx"]:
    """Join rooms below `MIN_ROOM_AREA` to a neighbour, or drop them if they have none; numbers become consecutive."""
    small = np.bincount(label.ravel()) * cell**2 < MIN_ROOM_AREA
    small[0] = False
    for number in np.flatnonzero(small):
        mine = label == number
        around = label[ndimage.binary_dilation(mine) & ~mine]
        beside = np.bincount(around[~small[around]])[1:]
        label = np.where(mine, int(beside.argmax()) + 1 if beside.sum() else 0, label)
    return np.unique(label, return_inverse=True)[1].reshape(label.shape) + (label.min() > 0)


def _extend(label: Int[np.ndarray, "ny nx"], cell: float) -> Int[np.ndarray, "ny nx"]:
    """Return rooms with the cells within `WALL_REACH`, which belong to the nearest room."""
    away, nearest = ndimage.distance_transform_cdt(label == 0, "chessboard", return_indices=True)  # type: ignore
    return np.where(away <= round(WALL_REACH / cell), label[tuple(nearest)], 0)


def _outline(free: FreeMap, cells: Bool[np.ndarray, "ny nx"]) -> Float[np.ndarray, "n 2"] | None:
    """Return the outline (x, z) of cells [m], counter-clockwise in a plot with x right and z up; None without area."""
    cells = np.asarray(ndimage.binary_opening(cells, np.ones((2, 2))))
    rows, columns = np.flatnonzero(cells.any(axis=1)), np.flatnonzero(cells.any(axis=0))
    if not len(rows):
        return None
    (y0, y1), (x0, x1) = (rows[0], rows[-1] + 1), (columns[0], columns[-1] + 1)
    boxes = cover_with_rectangles(free.lines(0)[x0 : x1 + 1], free.lines(1)[y0 : y1 + 1], cells[y0:y1, x0:x1])
    corners = boxes[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    flat = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    exact = outline(np.dstack([flat, np.zeros(flat.shape[:2])]))
    for polygon in (straighten(exact, MAX_BEND * free.cell), exact):
        plan = polygon @ plane_matrix(free.yaw).T * [1.0, -1.0]
        if is_outline(plan):
            return simplify(plan)
    return None


def is_outline(corners: Float[np.ndarray, "n 2"]) -> bool:
    """Return whether corners are a polygon with an area that does not cross itself."""
    try:
        triangulate(simplify(corners))
    except ValueError:
        return False
    return abs(signed_area(corners)) > 0
