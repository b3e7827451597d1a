"""Sensor noise models, as pure functions of a key and an image."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.lighting.texture import SRGB_TO_LINEAR, encode_srgb

DISPARITY_SCALE = 351.3  # [m], disparity times depth; the published model has 35130 with centimetres
SHIFT_STD = 0.5  # [px], standard deviation of the shift of a reading
DISPARITY_STD = 1 / 6  # [step], standard deviation of a disparity


def kinect_depth(
    key: Array,
    depth: Float[Array, "h w 1"],
    near: float = 0.5,
    far: float = 8.0,
    strength: Float[Array, ""] | float = 1.0,
) -> Float[Array, "h w 1"]:
    """Apply the noise of a structured-light depth sensor: shifted edges, noisy and quantised disparities.

    Each pixel reads the depth at a Gaussian offset of half a pixel, rounded to whole pixels and clipped to the image.
    `near` and `far`, inclusive, apply to that. Its disparity, 351.3 m over the depth, gets Gaussian noise of a sixth of
    a step and is rounded to whole steps, at least one. Errors therefore grow with the square of the distance.

    Source: J. T. Barron and J. Malik, "Intrinsic scene properties from a single RGB-D image", CVPR 2013,
    as used by A. Handa et al., "A benchmark for RGB-D visual odometry, 3D reconstruction and SLAM", ICRA 2014.

    Args:
        key: Random key.
        depth: [m], not clipped; the model was made for 640 x 480 but accepts any size.
        near: Minimum distance of a reading [m].
        far: Maximum distance of a reading [m].
        strength: Factor of both Gaussians; disparities are rounded for any value.

    Returns:
        Depth [m]; inf where there is no reading.

    Example:
        >>> noisy = kinect_depth(jax.random.key(0), jnp.full((4, 4, 1), 2.0))
        >>> bool((abs(noisy - 2) < 0.05).all())
        True
    """
    shift_key, jitter_key = jax.random.split(key)
    height, width, _ = depth.shape
    shift = jnp.round(jax.random.normal(shift_key, (2, height, width), jnp.float32) * (SHIFT_STD * strength)).astype(
        jnp.int32
    )
    rows, columns = jnp.meshgrid(jnp.arange(height), jnp.arange(width), indexing="ij")
    seen = depth[jnp.clip(rows + shift[0], 0, height - 1), jnp.clip(columns + shift[1], 0, width - 1)]
    inside = (seen >= near) & (seen <= far)
    disparity = DISPARITY_SCALE / jnp.where(inside, seen, 1.0)
    disparity = jnp.round(disparity + DISPARITY_STD * strength * jax.random.normal(jitter_key, seen.shape, jnp.float32))
    return jnp.where(inside, DISPARITY_SCALE / jnp.maximum(disparity, 1.0), jnp.inf)


def sensor_rgb(
    key: Array,
    rgb: UInt8[Array, "h w 3"],
    shot: Float[Array, ""] | float = 0.002,
    read: Float[Array, ""] | float = 0.0001,
) -> UInt8[Array, "h w 3"]:
    """Apply the noise of an image sensor: shot noise that grows with the light, and read noise.

    In linear light, 0 to 1, the variance is `shot` times the signal, plus `read`. Results are clipped sRGB.

    Source: A. Foi, M. Trimeche, V. Katkovnik and K. Egiazarian, "Practical Poissonian-Gaussian noise modeling and
    fitting for single-image raw-data", IEEE Transactions on Image Processing 17(10), 2008.

    Args:
        key: Random key.
        rgb: sRGB.
        shot: Variance per unit of signal.
        read: Variance in the dark.

    Example:
        >>> sensor_rgb(jax.random.key(0), jnp.zeros((4, 4, 3), jnp.uint8)).dtype
        dtype('uint8')
    """
    linear = jnp.asarray(SRGB_TO_LINEAR)[rgb.astype(jnp.int32)]
    deviation = jnp.sqrt(shot * linear + read)
    return encode_srgb(linear + deviation * jax.random.normal(key, rgb.shape, jnp.float32))
