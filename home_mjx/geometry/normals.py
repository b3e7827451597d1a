"""Vertex normals of triangles, smooth across edges of curved surfaces."""

import numpy as np
from jaxtyping import Float, Int

MIN_CREASE_COSINE = np.cos(np.deg2rad(40.0))  # cosine of the crease angle; sharper edges are not smoothed
WELD_DISTANCE = 1e-4  # [m], corners in the same grid cell of this size are merged
MAX_CORNER_FACES = 64  # maximum faces around a smoothed corner; more indicate foliage, not a surface


def crease_normals(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "t 3 3"]:
    """Compute unit normals of corners: the mean of adjacent faces that differ by less than the crease angle.

    Faces are weighted by area. A face without area has zero normals.

    Args:
        triangles: Corners, counter-clockwise outwards [m].

    Example:
        >>> flat = crease_normals(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
        >>> flat[0, 0].tolist()
        [0.0, 0.0, 1.0]
    """
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(area, axis=1, keepdims=True)
    flat = np.divide(area, length, out=np.zeros_like(area), where=length > 0)
    corner, other = _neighbours(triangles)
    face = corner // 3
    joined = np.einsum("ni,ni->n", flat[face], flat[other]) > MIN_CREASE_COSINE
    total = np.zeros((len(triangles) * 3, 3))
    for axis in range(3):
        total[:, axis] = np.bincount(corner[joined], area[other[joined], axis], len(total))
    size = np.linalg.norm(total, axis=1, keepdims=True)
    smooth = np.divide(total, size, out=np.repeat(flat, 3, axis=0), where=size > 1e-12)
    return smooth.reshape(-1, 3, 3)


def _neighbours(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]:
    """Return pairs of a corner (face * 3 + k) and a face with a corner at the same position, itself included."""
    places = np.round(triangles.reshape(-1, 3) / WELD_DISTANCE).astype(np.int64)
    place = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
    order = np.argsort(place, kind="stable")
    count = np.bincount(place)
    start = np.cumsum(count) - count
    mine = np.where(count[place] <= MAX_CORNER_FACES, count[place], 0)
    corner = np.repeat(np.arange(len(place)), mine)
    step = np.arange(len(corner)) - np.repeat(np.cumsum(mine) - mine, mine)
    return corner, order[start[place[corner]] + step] // 3


def facing_axis(normal: Float[np.ndarray, "t 2"], area: Float[np.ndarray, " t"]) -> Float[np.ndarray, "2"]:
    """Return the horizontal axis, of either sign, that most of a wall's area faces.

    It is the first principal axis of the normals, weighted by area.

    Args:
        normal: Horizontal part of each triangle's normal, scaled by its area [m^2].
        area: Area of each triangle [m^2].
    """
    flat = normal / np.sqrt(np.maximum(area, 1e-12))[:, None]
    return np.linalg.eigh(flat.T @ flat)[1][:, -1]
