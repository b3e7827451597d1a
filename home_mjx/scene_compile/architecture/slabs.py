"""Walls as upright slabs: local frame, extents and solid boxes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from home_mjx.geometry.box_fit import SAMPLE_SPACING, sample_surface
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, make_boxes
from home_mjx.geometry.meshes import facing_axis
from home_mjx.geometry.rectangle_cover import (
    cell_centers,
    cover_with_rectangles,
    is_in_triangles,
    merge_close_values,
    split_rectangles,
)
from home_mjx.geometry.rotations import yaw_matrix

SCAN_CELL = 0.1  # [m], cells of the walls of scans
MAX_CELL_RATIO = 4  # number of cells between all corners re that of `SCAN_CELL`, above which a wall is that of a scan
EDGE_MERGE_DISTANCE = 0.03  # [m], opening edges closer than this are merged; copies in neighbouring walls differ less


@dataclass(frozen=True)
class Slab:
    """An upright slab; local axes are along, across and up, with the world's origin."""

    yaw: float  # [rad], direction of the local x axis
    low: Float[np.ndarray, "3"]  # [m], local minimum corner
    high: Float[np.ndarray, "3"]  # [m], local maximum corner
    faces: Float[np.ndarray, "f 3 3"]  # [m], local triangles of the two large sides

    @property
    def length(self) -> float:
        """Length of the slab [m]."""
        return float(self.high[0] - self.low[0])

    @property
    def middle(self) -> float:
        """Local coordinate of the middle plane across the slab [m]."""
        return float((self.low[1] + self.high[1]) / 2)

    def to_world(self, local: Float[np.ndarray, "*p 3"]) -> Float[np.ndarray, "*p 3"]:
        """Rotate points or directions from the local to the world frame; both have the same origin."""
        return local @ yaw_matrix(self.yaw).T


def fit_slab(triangles: Float[np.ndarray, "t 3 3"]) -> Slab:
    """Return the slab around a wall's triangles [m]; its across axis is along the dominant horizontal normal."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
    area = np.linalg.norm(normal, axis=1)
    across = facing_axis(normal[:, :2], area)
    return fit_slab_at_yaw(float(np.arctan2(-across[0], across[1])), triangles, normal)


def fit_slab_at_yaw(yaw: float, triangles: Float[np.ndarray, "t 3 3"], normal: Float[np.ndarray, "t 3"]) -> Slab:
    """Return the slab with this yaw [rad] around triangles [m] with normals of any length.

    Its `faces` are the triangles that face across, within 45 degrees, to either side.
    """
    turn = yaw_matrix(yaw)
    local = triangles @ turn
    facing = abs((normal @ turn)[:, 1]) > 0.7 * np.linalg.norm(normal, axis=1)
    flat = local.reshape(-1, 3)
    return Slab(yaw, flat.min(axis=0), flat.max(axis=0), local[facing])


def is_same_wall(a: Slab, b: Slab, gap: float = 0.08, overlap: float = 0.2) -> bool:
    """Return whether two slabs are copies of one physical wall, or one overlaps the other as its continuation.

    Both must be parallel and have at least 0.5 m of height in common. Their middle planes are less than `gap` [m]
    apart, and their common length is above `overlap` [m], which exceeds the overlap of walls at corners.
    """
    if abs(np.sin(a.yaw - b.yaw)) > 0.03 or min(a.high[2], b.high[2]) - max(a.low[2], b.low[2]) < 0.5:
        return False
    ends = b.to_world(np.array([[b.low[0], b.middle, 0], [b.high[0], b.middle, 0]])) @ yaw_matrix(a.yaw)
    along = np.sort(ends[:, 0])
    common = min(a.high[0], along[1]) - max(a.low[0], along[0])
    return bool(common > overlap and abs(ends[:, 1].mean() - a.middle) < gap)


def wall_boxes(slabs: Sequence[Slab], max_length: float) -> BoxSet:
    """Return boxes that fill one physical wall except for its openings; empty if no triangle faces across.

    The boxes have the yaw of the longest prism and are as thick as all prisms together.

    Args:
        slabs: Prisms of the wall: copies in neighbouring rooms, inner and outer layers.
        max_length: Maximum length of a box [m].
    """
    main = max(slabs, key=lambda s: s.length)
    turn = yaw_matrix(main.yaw)
    corners = np.concatenate([s.to_world(np.stack([s.low, s.high])) for s in slabs]) @ turn
    faces = np.concatenate([s.to_world(s.faces) for s in slabs]) @ turn
    if not len(faces):
        return empty_boxes()
    across = corners[:, 1].min(), corners[:, 1].max()
    u, v, solid = _solid_cells(faces[..., [0, 2]])
    pieces = split_rectangles(cover_with_rectangles(u, v, solid), max_length)
    return concat_boxes(_piece(piece, across, main.yaw) for piece in pieces)


def _solid_cells(
    faces: Float[np.ndarray, "f 3 2"],
) -> tuple[Float[np.ndarray, " nu"], Float[np.ndarray, " nv"], Bool[np.ndarray, "_ _"]]:
    """Return grid lines along and up [m], and the cells (row = up) that the faces of a wall cover.

    Lines are through all corners. Walls whose corners are as dense as those of scans have cells of `SCAN_CELL` instead,
    and holes up to two cells wide are closed.
    """
    u, v = (merge_close_values(faces[..., axis], EDGE_MERGE_DISTANCE) for axis in (0, 1))
    low, high = faces.min(axis=(0, 1)), faces.max(axis=(0, 1))
    count = np.maximum(np.round((high - low) / SCAN_CELL), 1).astype(int)
    if len(u) * len(v) <= MAX_CELL_RATIO * count.prod():
        return u, v, is_in_triangles(faces, cell_centers(u, v))
    points = sample_surface(np.dstack([faces, np.zeros(faces.shape[:2])]), SAMPLE_SPACING * SCAN_CELL)[:, :2]
    column, row = np.clip((points - low) / (high - low) * count, 0, count - 1).astype(int).T
    solid = np.zeros((count[1] + 2, count[0] + 2), bool)
    solid[row + 1, column + 1] = True
    solid = np.asarray(ndimage.binary_closing(solid, np.ones((3, 3))))[1:-1, 1:-1]
    u, v = (np.linspace(low[axis], high[axis], count[axis] + 1) for axis in (0, 1))
    return u, v, solid


def _piece(piece: Float[np.ndarray, "4"], across: tuple[float, float], yaw: float) -> BoxSet:
    """Return the box of a rectangle (along and up: u0, v0, u1, v1) with an extent `across`, in a slab's axes [m]."""
    low, high = np.array([piece[0], across[0], piece[1]]), np.array([piece[2], across[1], piece[3]])
    return make_boxes(yaw_matrix(yaw) @ ((low + high) / 2), (high - low) / 2, yaw)
