"""Triangles of boxes."""

import numpy as np

from home_mjx.geometry.meshes import box_triangles
from home_mjx.geometry.rotations import yaw_matrix


def cuboid(low, high) -> np.ndarray:
    low, high = np.array(low, float), np.array(high, float)
    return box_triangles((low + high) / 2, (high - low) / 2)


def turned(triangles: np.ndarray, yaw: float, shift=(0.0, 0.0, 0.0)) -> np.ndarray:
    return triangles @ yaw_matrix(yaw).T + shift
