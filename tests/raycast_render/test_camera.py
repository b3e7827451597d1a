"""Camera rays follow MuJoCo's convention."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from home_mjx.raycast_render import Camera
from home_mjx.raycast_render.camera import camera_rays


def rays(quat, fovy=np.pi / 2, width=4, height=4):
    camera = Camera(jnp.zeros(3), jnp.asarray(quat, jnp.float32), jnp.float32(fovy))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(camera_rays(camera, width, height))


def test_an_unturned_camera_looks_along_minus_z_with_y_up_and_x_right():
    d = rays([1, 0, 0, 0])
    np.testing.assert_allclose(d[0, 0], [-0.75, 0.75, -1], atol=1e-6)  # top left
    np.testing.assert_allclose(d[0, 3], [0.75, 0.75, -1], atol=1e-6)  # top right
    np.testing.assert_allclose(d[3, 0], [-0.75, -0.75, -1], atol=1e-6)  # bottom left


@pytest.mark.parametrize("shape", [(5, 3), (3, 5)])
def test_pixels_are_square_and_fovy_is_vertical(shape):
    height, width = shape
    d = rays([1, 0, 0, 0], fovy=1.0, width=width, height=height)
    step = 2 * np.tan(0.5) / height
    np.testing.assert_allclose(np.diff(d[..., 0], axis=1), step, rtol=1e-5)
    np.testing.assert_allclose(np.diff(d[..., 1], axis=0), -step, rtol=1e-5)
    np.testing.assert_allclose(d.mean(axis=(0, 1)), [0, 0, -1], atol=1e-6)


def test_turned_cameras_agree_with_mujoco_s_camera_frame(rng):
    quat = rng.normal(size=4)
    quat /= np.linalg.norm(quat)
    spec = mujoco.MjSpec()
    spec.worldbody.add_camera(name="eye", quat=quat)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    frame = data.cam_xmat[0].reshape(3, 3)
    np.testing.assert_allclose(rays(quat), rays([1, 0, 0, 0]) @ frame.T, atol=1e-6)
