"""Pinhole cameras in MuJoCo's convention: looking along -z, +y up, `fovy` the vertical field of view."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.raycast_render.transforms import quat_matrix
from home_mjx.scene_compile.pytree import Pytree


class Camera(Pytree):
    """A camera in the world.

    Example:
        >>> upright = jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0])  # level, looking along +y
        >>> camera = Camera(jnp.array([0.0, 0.0, 1.5]), upright, jnp.deg2rad(90.0))
    """

    pos: Float[Array, "3"]  # [m]
    quat: Float[Array, "4"]  # w, x, y, z, unit
    fovy: Float[Array, ""]  # [rad]


def camera_rays(camera: Camera, width: int, height: int) -> Float[Array, "h w 3"]:
    """World directions through the pixel centres, row 0 at the top.

    Their length is such that t is the depth along the optical axis. Pixels are square.
    """
    x = (jnp.arange(width, dtype=jnp.float32) + 0.5) * (2 / width) - 1
    y = 1 - (jnp.arange(height, dtype=jnp.float32) + 0.5) * (2 / height)
    slope = jnp.tan(camera.fovy / 2)
    x, y = jnp.meshgrid(x * slope * (width / height), y * slope)
    local = jnp.stack([x, y, -jnp.ones_like(x)], axis=-1)
    # Not a matrix product: accelerators may round those to few bits.
    return jnp.sum(quat_matrix(camera.quat)[None, None] * local[:, :, None, :], axis=-1)
