"""Projection of points into images: the inverse of `camera_rays`."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.core.transforms import quat_matrix
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import Camera, Lens, half_height
from home_mjx.raycast_render.cameras.distortion import distort

MIN_DEPTH = 1e-3  # [m], of points in front of a pinhole


def project(camera: Camera, lens: Lens, points: Float[Array, "*n 3"]) -> tuple[Float[Array, "*n 2"], Bool[Array, "*n"]]:
    """Return pixel coordinates (right and down from the top left corner) of world points, and whether they have any.

    Points behind a pinhole have none; their coordinates are arbitrary, but finite.

    Raises:
        ConfigError: The lens is a cube or a lidar.

    Example:
        >>> level = jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0])  # looks along +y
        >>> camera = Camera(jnp.zeros(3), level, jnp.float32(jnp.pi / 2))
        >>> project(camera, Lens(64, 64), jnp.array([1.0, 2.0, 0.0]))[0].round().tolist()
        [48.0, 32.0]
    """
    offset = points - camera.pos
    x, y, back = (jnp.sum(offset * axis, axis=-1) for axis in quat_matrix(camera.quat).T)
    if lens.model == "panorama":
        level = jnp.hypot(x, back)
        column, row = 0.5 + jnp.arctan2(x, -back) / (2 * np.pi), 0.5 - jnp.arctan2(y, level) / np.pi
        return jnp.stack([column * lens.width, row * lens.height], axis=-1), jnp.ones_like(x, bool)
    if lens.model not in ("pinhole", "fisheye", "orthographic"):
        raise ConfigError(f"points cannot be projected by a camera of model `{lens.model}`")
    x, y, seen = _image_plane(lens, x, y, -back)
    scale = lens.height / 2 / (camera.fovy / 2 if lens.model == "orthographic" else half_height(camera, lens))
    return jnp.stack([lens.width / 2 + x * scale, lens.height / 2 - y * scale], axis=-1), seen


def _image_plane(lens: Lens, x: Array, y: Array, depth: Array) -> tuple[Array, Array, Array]:
    """Return coordinates over focal length of points right, up and ahead, and whether they have any."""
    if lens.model == "orthographic":
        return x, y, jnp.ones_like(x, bool)
    radius = jnp.maximum(jnp.hypot(x, y), 1e-12)
    if lens.model == "fisheye":
        bent = distort(jnp.arctan2(radius, depth), lens.distortion)
        return x * (bent / radius), y * (bent / radius), jnp.ones_like(x, bool)
    ahead = jnp.maximum(depth, MIN_DEPTH)
    bent = distort(radius / ahead, lens.distortion) / radius
    return x * bent, y * bent, depth > MIN_DEPTH
