"""Corner normals of a mesh, smooth across its blunt edges."""

import numpy as np
from jaxtyping import Float, Int

# Cosine of the maximum angle across a smooth edge; an eight-sided rod is smooth.
SMOOTH_EDGE_COSINE = np.cos(np.deg2rad(47.0))
_DECIMALS = 4  # enough for shading, with far fewer distinct lines in a file


def corner_normals(vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Float[np.ndarray, "f 3 3"]:
    """Compute unit normals by corner: the area-weighted sum over the vertex's faces within the crease angle.

    Args:
        vertices: Positions [m]; faces with a common vertex belong to one surface.
        faces: Indices, counter-clockwise seen from outside.
    """
    return unit_normals(rounded_normals(vertices, faces)).reshape(-1, 3, 3)


def unit_normals(rounded: Int[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return the unit vectors of the result of `rounded_normals`."""
    normals = np.round(rounded / 10.0**_DECIMALS, _DECIMALS)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def rounded_normals(vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Int[np.ndarray, "c 3"]:
    """Compute the normals of `corner_normals` by corner, in units of 1e-4."""
    corners = vertices[faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-30)
    corner, other = _pairs(faces.reshape(-1))
    face = corner // 3
    joined = np.einsum("ni,ni->n", flat[face], flat[other]) > SMOOTH_EDGE_COSINE
    total = np.stack([np.bincount(corner[joined], area[other[joined], k], 3 * len(faces)) for k in range(3)], -1)
    unit = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)
    return np.round(unit * 10.0**_DECIMALS).astype(np.int64)


def _pairs(vertex: Int[np.ndarray, " c"]) -> tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]:
    """Return pairs of each corner with every face at its vertex, its own included."""
    order = np.argsort(vertex, kind="stable")
    count = np.bincount(vertex)
    start = np.cumsum(count) - count
    mine = count[vertex]
    corner = np.repeat(np.arange(len(vertex)), mine)
    step = np.arange(len(corner)) - np.repeat(np.cumsum(mine) - mine, mine)
    return corner, order[start[vertex[corner]] + step] // 3
