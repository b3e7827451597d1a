"""The `vn` lines of an OBJ."""

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.suncg.formats.polygons import Rows

FLAT = 1e-3  # normals that differ less from those of their faces add nothing


def smooth_normals(
    rows: Rows, index: Int[np.ndarray, "f 3"], triangles: Float[np.ndarray, "f 3 3"]
) -> Float[np.ndarray, "f 3 3"] | None:
    """Unit normals of the corners; None if one is missing or not finite, or if all equal the normals of their faces.

    Broken normals are no reason to refuse a model: exporters write them for faces without area.

    Args:
        rows: The `vn` lines.
        index: One-based normal of each corner, 0 for none.
        triangles: Corners [m].
    """
    table = _numbers(rows)
    if table is None or (index == 0).any():
        return None
    normals = _unit(table)[index - 1]
    faces = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    sized = np.linalg.norm(faces, axis=1) > 0
    return normals if (abs(normals - faces[:, None])[sized] > FLAT).any() else None


def _numbers(rows: Rows) -> Float[np.ndarray, "n 3"] | None:
    try:
        table = np.array([[float(word) for word in rest.split()[:3]] for _, rest in rows]).reshape(len(rows), 3)
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _unit(vectors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-12)
