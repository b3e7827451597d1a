"""Transforms and visibility of glTF nodes."""

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue
from home_mjx.geometry.rotations import quat_matrix

Matrix = Float[np.ndarray, "4 4"]


def read_rotation(turn: JsonValue) -> Float[np.ndarray, "3 3"]:
    """Return the matrix of a quaternion x y z w; raise the value's error if it has no length."""
    x, y, z, w = turn.vector(4).tolist()
    if x * x + y * y + z * z + w * w < 1e-12:
        raise turn.error("quaternion has no length")
    return quat_matrix(np.array([[w, x, y, z]]))[0]


def node_matrix(value: JsonValue) -> Matrix:
    """Return parent from node: the matrix (column-major), else translation, rotation (x y z w) and scale.

    Raises:
        DatasetError: A value has another type or is not finite, or the matrix is not affine.
    """
    whole = value.member("matrix")
    if whole.has_value:
        matrix = whole.vector(16).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
            raise whole.error(f"expected an affine matrix, its last row is {matrix[3].tolist()}")
        return matrix
    place, turn, scale = (value.member(key) for key in ("translation", "rotation", "scale"))
    matrix = np.eye(4)
    if turn.has_value:
        matrix[:3, :3] = read_rotation(turn)
    if scale.has_value:
        matrix[:3, :3] *= scale.vector(3)
    if place.has_value:
        matrix[:3, 3] = place.vector(3)
    return matrix


def is_usable(matrix: Matrix) -> bool:
    """Return whether a transform has a volume and moves nothing beyond all limits."""
    return bool(abs(np.linalg.det(matrix[:3, :3])) > 1e-15 and abs(matrix).max() <= MAX_COORDINATE)


def is_hidden(value: JsonValue) -> bool:
    """Return whether a node and all below it are hidden by `KHR_node_visibility`."""
    extensions = value.member("extensions")
    shown = extensions.member("KHR_node_visibility") if extensions.has_value else extensions
    return shown.has_value and shown.member("visible").data is False
