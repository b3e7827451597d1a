"""Sensor noise models, as pure functions of a key and an image."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.lighting.texture import SRGB_TO_LINEAR, encode_srgb

DISPARITY_SCALE = 351.3  # [m], disparity times depth; the published model has 35130 with centimetres
SHIFT_STD = 0.5  # [px], standard deviation of the shift of a reading
STEREO_BASELINE, STEREO_FOCAL = 0.05, 645.0  # [m]; [px], of 848 x 480 pixels of a RealSense D435
SUBPIXEL_STD, SUBPIXEL_STEP = 0.08, 1 / 32  # [px], error of its disparities on textured walls, and their resolution
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


def stereo_depth(
    key: Array,
    depth: Float[Array, "h w 1"],
    fovy: Float[Array, ""] | float,
    near: float = 0.28,
    far: float = 10.0,
    strength: Float[Array, ""] | float = 1.0,
) -> Float[Array, "h w 1"]:
    """Apply the noise of a stereo depth camera: noisy, quantised disparities, and shadows beside what is near.

    The disparity of a RealSense D435 is `STEREO_BASELINE` times its focal length over the depth. It gets Gaussian noise
    of `SUBPIXEL_STD` pixels of that camera, and is rounded to `SUBPIXEL_STEP`. Errors therefore grow with the square
    of the distance. Points that the right camera cannot see, left of nearer surfaces, have no reading.

    Source: Intel, "Best known methods for tuning RealSense D400 depth cameras", 2019: the error of depth is its square
    times the error of the disparity, over focal length and baseline.

    Args:
        key: Random key.
        depth: [m], along the optical axis of a pinhole camera, not clipped, of any size.
        fovy: Vertical field of view of the image [rad].
        near: Minimum distance of a reading [m].
        far: Maximum distance of a reading [m].
        strength: Factor of the noise; disparities are rounded, and shadows are there, for any value.

    Returns:
        Depth [m]; inf where there is no reading.

    Example:
        >>> noisy = stereo_depth(jax.random.key(0), jnp.full((4, 64, 1), 2.0), fovy=1.0)
        >>> bool((abs(noisy - 2) < 0.05).all())
        True
    """
    height, width, _ = depth.shape
    inside = (depth >= near) & (depth <= far)
    reach = STEREO_BASELINE / jnp.where(inside, depth, jnp.inf)
    # Columns at which the right camera sees each point; a nearer one further right hides those that are not left of it.
    column = jnp.arange(width, dtype=jnp.float32)[:, None] - reach * (height / 2 / jnp.tan(fovy / 2))
    first = jax.lax.cummin(column, axis=1, reverse=True)
    beyond = jnp.concatenate([first[:, 1:], jnp.full_like(first[:, :1], jnp.inf)], axis=1)
    disparity = reach * STEREO_FOCAL + SUBPIXEL_STD * strength * jax.random.normal(key, depth.shape, jnp.float32)
    disparity = jnp.maximum(jnp.round(disparity / SUBPIXEL_STEP), 1.0) * SUBPIXEL_STEP
    return jnp.where(inside & (column < beyond), STEREO_BASELINE * STEREO_FOCAL / disparity, jnp.inf)


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
