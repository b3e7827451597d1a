"""Reader of the `vn` lines of an OBJ."""

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.suncg.formats.polygons import Rows

MIN_NORMAL_DEVIATION = 1e-3  # minimum deviation from face normals of useful vertex normals


def smooth_normals(
    rows: Rows, index: Int[np.ndarray, "f 3"], triangles: Float[np.ndarray, "f 3 3"]
) -> Float[np.ndarray, "f 3 3"] | None:
    """Return unit normals per corner; None if one is missing or not finite, or if all equal their face normals.

    Broken normals do not invalidate a model: exporters write them for faces without area.

    Args:
        rows: Lines of `vn`.
        index: One-based normal index of each corner; 0 none.
        triangles: Corners of the faces [m].
    """
    table = _numbers(rows)
    if table is None or (index == 0).any():
        return None
    normals = _unit(table)[index - 1]
    faces = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    sized = np.linalg.norm(faces, axis=1) > 0
    return normals if (abs(normals - faces[:, None])[sized] > MIN_NORMAL_DEVIATION).any() else None


def _numbers(rows: Rows) -> Float[np.ndarray, "n 3"] | None:
    try:
        table = np.array([[float(word) for word in rest.split()[:3]] for _, rest in rows]).reshape(len(rows), 3)
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _unit(vectors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-12)
