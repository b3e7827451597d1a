"""Rotations in NumPy (host); `core.transforms` has the device versions. Angles in radians, quaternions wxyz."""

import numpy as np
from jaxtyping import Float


def yaw_quat(yaw: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 4"]:
    """Return unit quaternions wxyz of rotations by `yaw` [rad] about +z, counter-clockwise seen from above."""
    zero = np.zeros_like(yaw)
    return np.stack([np.cos(yaw / 2), zero, zero, np.sin(yaw / 2)], axis=-1)


def yaw_matrix(yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation of column vectors by `yaw` [rad] about +z, from rotated to world axes.

    Rows of points are rotated by `points @ yaw_matrix(yaw).T`; without the transpose, by -`yaw`.

    Example:
        >>> yaw_matrix(np.pi / 2).round().tolist()
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def quat_matrix(quat: Float[np.ndarray, "n 4"]) -> Float[np.ndarray, "n 3 3"]:
    """Return the rotation matrices, for column vectors, of quaternions wxyz, which are normalised first; NaN for zero.

    Example:
        >>> quat_matrix(np.array([[0.0, 0.0, 0.0, 2.0]]))[0].tolist()
        [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    w, x, y, z = (quat / np.linalg.norm(quat, axis=-1, keepdims=True)).T
    rows = (
        (x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def plane_matrix(angle: float) -> Float[np.ndarray, "2 2"]:
    """Return the counter-clockwise rotation of column vectors (x, y) in the plane by `angle` [rad].

    Rows of points are rotated by `points @ plane_matrix(angle).T`.
    """
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
