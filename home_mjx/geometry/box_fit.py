"""Approximation of meshes by a few boxes, as collision shapes of objects."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError

from home_mjx.geometry.boxes import MIN_HALF_EXTENT, BoxSet, bounding_box, make_boxes
from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.rotations import yaw_matrix

MAX_CELLS = 16  # maximum number of cells along the longest side of an object
MIN_CELL_SIZE = 0.03  # [m], minimum cell size
SAMPLE_SPACING = 0.7  # distance of surface samples in cells; a face cannot cross a cell without a sample
MAX_OPTIONAL_WASTE = 0.02  # maximum empty volume that an optional merge may add, as a fraction of the bounding box
WELD_DISTANCE = 1e-4  # [m], corners in the same grid cell of this size are merged


def fit_boxes(triangles: Float[np.ndarray, "t 3 3"], yaw: float, max_boxes: int) -> BoxSet:
    """Cover the surface and the inside of a mesh with at most `max_boxes` boxes of one yaw.

    The surface is sampled into voxels, and enclosed ones are filled (the floor closes the mesh from below). The voxels
    are grouped into disjoint boxes. Then boxes are merged, each time the pair that adds the least empty volume. Below
    `max_boxes`, pairs are merged if they add at most `MAX_OPTIONAL_WASTE` of the bounding box. Results may overlap.
    Sides are then moved inwards to the surface, by at most a cell. Half extents are at least `MIN_HALF_EXTENT`.

    Args:
        triangles: Corners of the mesh, Z up [m], of either winding; at least one triangle, which may have no area.
        yaw: Yaw of the boxes about +z [rad].
        max_boxes: Maximum number of boxes; values below 1 count as 1.
    """
    turn = yaw_matrix(yaw)
    points = triangles @ turn
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    cell = max((high - low).max() / MAX_CELLS, MIN_CELL_SIZE)
    counts = np.maximum(np.round((high - low) / cell), 1).astype(int)
    size = np.maximum((high - low) / counts, 1e-9)
    occupied, surface = _voxels(sample_surface(points, SAMPLE_SPACING * cell), low, size, counts)
    boxes = merge_boxes(cover_cells(_fill(occupied)), max_boxes, MAX_OPTIONAL_WASTE * occupied.size)
    edges = low + boxes * size
    tight = np.array([_tighten(e, b, size, surface, occupied) for e, b in zip(edges, boxes, strict=True)])
    return make_boxes(tight.mean(axis=1) @ turn.T, np.maximum(np.diff(tight, axis=1)[:, 0] / 2, MIN_HALF_EXTENT), yaw)


def _voxels(
    points: Float[np.ndarray, "p 3"], low: Float[np.ndarray, "3"], size: Float[np.ndarray, "3"], counts: np.ndarray
) -> tuple[Bool[np.ndarray, "x y z"], Float[np.ndarray, "x y z 2 3"]]:
    """Return a mask of cells with points, and the points' min and max in each cell (inf and -inf in empty cells).

    The grid begins at `low` and has `counts` cells of sides `size` [m]. Points outside it count for the nearest cell.
    """
    index = np.clip(((points - low) / size).astype(int), 0, counts - 1)
    flat = np.asarray(np.ravel_multi_index(tuple(index.T), tuple(counts)))
    order = np.argsort(flat)
    cells, first = np.unique(flat[order], return_index=True)
    occupied = np.zeros(counts.prod(), bool)
    occupied[cells] = True
    inner = np.tile(np.array([[[np.inf], [-np.inf]]]), (counts.prod(), 1, 3))
    inner[cells, 0] = np.minimum.reduceat(points[order], first)
    inner[cells, 1] = np.maximum.reduceat(points[order], first)
    return occupied.reshape(counts), inner.reshape(*counts, 2, 3)


def _fill(occupied: Bool[np.ndarray, "x y z"]) -> Bool[np.ndarray, "x y z"]:
    """Return a voxel mask with enclosed cavities filled; the plane below the grid counts as occupied.

    A cavity is enclosed if its only openings are across edges or corners of voxels. One open to a side or the top is
    not.
    """
    floor = np.ones_like(occupied[:, :, :1])
    return np.asarray(ndimage.binary_fill_holes(np.concatenate([floor, occupied], axis=2)))[:, :, 1:]


def _tighten(
    edge: Float[np.ndarray, "2 3"],
    box: Int[np.ndarray, "2 3"],
    size: Float[np.ndarray, "3"],
    surface: Float[np.ndarray, "x y z 2 3"],
    occupied: Bool[np.ndarray, "x y z"],
) -> Float[np.ndarray, "2 3"]:
    """Return the corners `edge` [m] of a box of cells (first, one past the last), moved inwards to the surface in it.

    A side is not moved if that would be by more than a cell, or if any cell directly beyond it is `occupied`.
    `surface` and `occupied` are those of `_voxels`: cells with surface, not the filled ones.
    """
    inner = surface[_block(box[0], box[1])]
    tight = np.stack([inner[..., 0, :].min(axis=(0, 1, 2)), inner[..., 1, :].max(axis=(0, 1, 2))])
    for side, axis in np.ndindex(2, 3):
        # A distance above one cell means a filled interior without surface; or the surface continues in the next cell.
        deep = abs(tight[side, axis] - edge[side, axis]) > size[axis]
        if deep or _surface_continues(box, side, axis, occupied):
            tight[side, axis] = edge[side, axis]
    return tight


def _surface_continues(box: Int[np.ndarray, "2 3"], side: int, axis: int, occupied: Bool[np.ndarray, "x y z"]) -> bool:
    """Return whether any cell of the grid adjacent to a box's `side` (0 low, 1 high) along `axis` is occupied.

    Rows of `box` are its first cell and one past its last. Beyond the grid nothing is occupied.
    """
    start, stop = box.copy()
    start[axis] = box[1, axis] if side else box[0, axis] - 1
    stop[axis] = start[axis] + 1
    return bool(0 <= start[axis] < occupied.shape[axis] and occupied[_block(start, stop)].any())


def sample_surface(triangles: Float[np.ndarray, "t 3 3"], spacing: float) -> Float[np.ndarray, "p 3"]:
    """Return points on at least one triangle, such that neighbours on a triangle are at most `spacing` [m] apart.

    Each triangle is divided into n^2 similar ones, n = ceil(longest edge / `spacing`), and has all their corners.
    Points are in order of n, not of the triangles; those on common edges, or of triangles without area, are repeated.
    """
    edge = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1).max(axis=1)
    steps = np.maximum(np.ceil(edge / spacing), 1).astype(int)
    samples = []
    for n in np.unique(steps):
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
        keep = i + j <= n
        weights = np.stack([i[keep], j[keep], n - i[keep] - j[keep]], axis=-1) / n
        samples.append(np.einsum("wc,tcx->twx", weights, triangles[steps == n]).reshape(-1, 3))
    return np.concatenate(samples)


def cover_cells(occupied: Bool[np.ndarray, "x y z"]) -> Int[np.ndarray, "n 2 3"]:
    """Cover exactly the occupied cells with disjoint boxes, given by their first cell and one past their last.

    Boxes are grown greedily from the first cell in C order, along z, then y, then x, so they may be more than needed.
    Without occupied cells the result has no rows.
    """
    left, boxes = occupied.copy(), []
    for start in np.argwhere(occupied):
        if left[tuple(start)]:
            stop = start + 1
            for axis in (2, 1, 0):
                stop[axis] = _stretch(left, start, stop, axis)
            left[_block(start, stop)] = False
            boxes.append((start, stop))
    return np.array(boxes).reshape(-1, 2, 3)


def _stretch(left: Bool[np.ndarray, "x y z"], start: np.ndarray, stop: np.ndarray, axis: int) -> int:
    """Return one past the last index along `axis` to which the cells [start, stop) can grow within `left`."""
    end = stop.copy()
    while end[axis] < left.shape[axis]:
        layer = start.copy()
        layer[axis] = end[axis]
        end[axis] += 1
        if not left[_block(layer, end)].all():
            return int(end[axis] - 1)
    return int(end[axis])


def _block(start: np.ndarray, stop: np.ndarray) -> tuple[slice, ...]:
    """Return the index of the cells from `start` to one before `stop`."""
    return tuple(slice(a, b) for a, b in zip(start, stop, strict=True))


def merge_boxes(boxes: Int[np.ndarray, "n 2 3"], max_boxes: int, max_waste: float) -> Int[np.ndarray, "m 2 3"]:
    """Merge pairs of boxes, and any inside their hull, least added volume first, to `max_boxes` and further if cheap.

    A hull may overlap the boxes that remain. The added volume is that of the hull less those of the pair, negative if
    these overlap much.

    Args:
        boxes: First cell and one past the last, see `cover_cells`; not modified.
        max_boxes: Maximum number of boxes in the result; values below 1 count as 1.
        max_waste: Maximum volume [cells] added by each merge after `max_boxes` is reached.
    """
    boxes = boxes.copy()
    while len(boxes) > 1:
        low = np.minimum(boxes[:, None, 0], boxes[None, :, 0])
        high = np.maximum(boxes[:, None, 1], boxes[None, :, 1])
        volume = (boxes[:, 1] - boxes[:, 0]).prod(axis=-1)
        added = (high - low).prod(axis=-1) - volume[:, None] - volume[None]
        added = added.astype(float)
        np.fill_diagonal(added, np.inf)
        i, j = np.unravel_index(added.argmin(), added.shape)
        if len(boxes) <= max_boxes and added[i, j] > max_waste:
            break
        hull = np.stack([low[i, j], high[i, j]])
        inside = ((boxes[:, 0] >= hull[0]) & (boxes[:, 1] <= hull[1])).all(axis=-1)
        boxes = np.concatenate([boxes[~inside], hull[None]])
    return boxes


def triangle_components(triangles: Float[np.ndarray, "t 3 3"]) -> Int[np.ndarray, " t"]:
    """Return the connected component of each of at least one triangle, numbered from 0 in any order.

    Triangles are connected that share a corner; corners in one grid cell of `WELD_DISTANCE` count as one. Triangles
    that touch or cross elsewhere are not connected.
    """
    corner = unique_cells(np.round(triangles.reshape(-1, 3) / WELD_DISTANCE).astype(np.int64))[1].reshape(-1, 3)
    count = int(corner.max()) + 1
    links = coo_matrix(
        (np.ones(2 * len(corner)), (np.repeat(corner[:, 0], 2), corner[:, 1:].ravel())), shape=(count, count)
    )
    return connected_components(links, directed=False)[1][corner[:, 0]]


def narrowest_box(points: Float[np.ndarray, "n 3"]) -> BoxSet:
    """Return a set of one box: the upright one of least plan area around at least one point [m].

    One of its sides lies on an edge of the points' convex hull in plan. The box's x axis is along this side, which may
    be the shorter one; yaw is in [-pi, pi]. If all points are on one line in plan, yaw is 0, whatever the line's
    direction. Half extents may be 0.
    """
    try:
        hull = points[ConvexHull(points[:, :2]).vertices]
    except (QhullError, ValueError):  # all points on one line
        return bounding_box(points)
    side = np.roll(hull, -1, axis=0) - hull
    yaws = np.arctan2(side[:, 1], side[:, 0]).tolist()
    columns = np.stack([np.ascontiguousarray((points @ yaw_matrix(yaw)).T) for yaw in yaws])
    half = (columns.max(axis=2) - columns.min(axis=2)) / 2
    return bounding_box(points, yaws[int((half[:, 0] * half[:, 1]).argmin())])
