"""Rotations of the host against SciPy's."""

import numpy as np
from scipy.spatial.transform import Rotation

from home_mjx.geometry.rotations import plane_matrix, yaw_matrix, yaw_quat

YAW = np.linspace(-7, 7, 41)


def test_yaws_are_those_of_scipy():
    wanted = Rotation.from_euler("z", YAW[:, None])
    np.testing.assert_allclose([yaw_matrix(float(yaw)) for yaw in YAW], wanted.as_matrix(), atol=1e-15)
    np.testing.assert_allclose([plane_matrix(float(yaw)) for yaw in YAW], wanted.as_matrix()[:, :2, :2], atol=1e-15)
    np.testing.assert_allclose(
        Rotation.from_quat(yaw_quat(YAW), scalar_first=True).as_matrix(), wanted.as_matrix(), atol=1e-15
    )
    np.testing.assert_allclose(np.linalg.norm(yaw_quat(YAW), axis=1), 1)
