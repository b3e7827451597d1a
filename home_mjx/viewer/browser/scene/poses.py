"""Affine poses as position, rotation and stretch, in the form that a browser's scene takes (host only)."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

MIN_SCALE = 1e-9  # minimum singular value of a pose's linear part; smaller ones are flat and become this
MAX_SHEAR = 1e-4  # off-diagonal part of a stretch, relative to its size, that counts as none


class SplitPose(NamedTuple):
    """Poses x -> R S x + t of n instances.

    Attributes:
        pos: Translations t [m].
        quat: Rotations R, wxyz.
        stretch: Symmetric maps S in the model's frame: scale, shear, and for mirrored poses a point reflection.
    """

    pos: Float[np.ndarray, "n 3"]
    quat: Float[np.ndarray, "n 4"]
    stretch: Float[np.ndarray, "n 3 3"]


def split_poses(pose: Float[np.ndarray, "n 3 4"]) -> SplitPose:
    """Split affine maps, world from model, by polar decomposition.

    Example:
        >>> split = split_poses(np.eye(3, 4)[None] * 2)
        >>> split.quat.tolist(), np.diag(split.stretch[0]).tolist()
        ([[1.0, 0.0, 0.0, 0.0]], [2.0, 2.0, 2.0])
    """
    left, scale, right = np.linalg.svd(np.asarray(pose[:, :, :3], np.float64))
    sign = np.sign(np.linalg.det(left) * np.linalg.det(right))[:, None]
    scale = np.maximum(scale, MIN_SCALE) * sign
    stretch = np.einsum("nki,nk,nkj->nij", right, scale, right)
    rotation = left @ right * sign[:, :, None]
    quat = Rotation.from_matrix(rotation).as_quat(scalar_first=True) if len(rotation) else np.zeros((0, 4))
    return SplitPose(np.asarray(pose[:, :, 3], np.float64), quat * np.where(quat[:, :1] < 0, -1, 1), stretch)


def is_plain_scale(stretch: Float[np.ndarray, "3 3"]) -> bool:
    """Return whether a stretch only scales along the model's axes, without mirroring.

    Example:
        >>> is_plain_scale(np.diag([1.0, 2.0, 3.0])), is_plain_scale(-np.eye(3))
        (True, False)
    """
    scale = np.diag(stretch)
    shear = np.abs(stretch - np.diag(scale)).max()
    return bool(scale.min() > 0 and shear <= MAX_SHEAR * np.abs(stretch).max())
