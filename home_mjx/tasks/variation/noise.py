"""Noise of moves and of images, as strong as sampled for the episode."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.images.noise import kinect_depth, sensor_rgb, stereo_depth

# LoCoBot with the ILQR controller: mean and variance of the errors forward, to the right [m] and in yaw [rad]; first
# row of moves, second row of turns. A. Murali et al., "PyRobot", 2019 (arXiv:1906.08236), as measured for Habitat.
ERROR_MEAN = np.array([[0.014, 0.009, 0.008], [0.003, 0.003, 0.023]], np.float32)
ERROR_VARIANCE = np.array([[0.006, 0.005, 0.004], [0.002, 0.003, 0.012]], np.float32)
MAX_DEVIATIONS = 3.0  # [standard deviations], maximum error
MIN_MOVE_FRACTION = 0.05  # minimum fraction of a move that is carried out, so that errors never reverse it


def add_move_noise(
    level: Float[Array, ""], key: Array, drive: Float[Array, "a 3"], max_displacement: Float[Array, "a 3"]
) -> Float[Array, "a 3"]:
    """Add errors of a real robot to moves; agents that neither move nor turn have no error.

    As in Habitat the errors are Gaussian, truncated at three standard deviations and before they reverse a move, times
    a multiplier. Moves that would exceed the maximum speed are clipped.

    Source: M. Savva et al., "Habitat", 2019 (arXiv:1904.01201), `pyrobot_noisy_controls`.

    Args:
        level: Habitat's `noise_multiplier`.
        key: Random key of the step.
        drive: Forward, left and turn left, as fractions of the maximum rates.
        max_displacement: Displacements at the maximum rates in a step [m], [m], [rad].

    Example:
        >>> still = jnp.zeros((1, 3))
        >>> bool((add_move_noise(jnp.float32(1.0), jax.random.key(0), still, still + 1) == still).all())
        True
    """
    turn = drive[:, 2]
    turns = (turn != 0)[:, None]
    mean, deviation = (jnp.where(turns, x[1][None], x[0][None]) for x in (ERROR_MEAN, np.sqrt(ERROR_VARIANCE)))
    amount = jnp.abs(drive * max_displacement)
    meant = jnp.stack([~turns[:, 0], jnp.zeros_like(turns[:, 0]), turns[:, 0]], axis=-1)
    floor = jnp.where(meant, (-(1 - MIN_MOVE_FRACTION) * amount - mean) / deviation, -MAX_DEVIATIONS)
    unit = jax.random.truncated_normal(
        key, jnp.maximum(floor, -MAX_DEVIATIONS), MAX_DEVIATIONS, drive.shape, jnp.float32
    )
    side = jnp.stack([jnp.ones_like(turn), -jnp.ones_like(turn), jnp.where(turn < 0, -1.0, 1.0)], axis=-1)
    error = level * (mean + deviation * unit) * side
    noisy = jnp.clip(drive + error / max_displacement, -1.0, 1.0)
    return jnp.where(jnp.any(drive != 0, axis=-1, keepdims=True), noisy, drive)


def add_depth_noise(
    level: Float[Array, ""], key: Array, depth: Float[Array, "h w 1"], depth_max: float
) -> Float[Array, "h w 1"]:
    """Add Kinect noise (`kinect_depth`) of strength `level` to depth [m]; unchanged for level 0.

    Values from `depth_max` on stay; noisy ones are at most `depth_max`.
    """
    read = kinect_depth(key, depth, near=0.0, far=depth_max, strength=level)
    read = jnp.where(depth < depth_max, jnp.minimum(read, depth_max), depth)
    return jnp.where(level > 0, read, depth)


def add_stereo_noise(
    level: Float[Array, ""],
    key: Array,
    depth: Float[Array, "h w 1"],
    fovy: Float[Array, ""] | float,
    depth_max: float,
) -> Float[Array, "h w 1"]:
    """Add the noise of a stereo camera (`stereo_depth`) of strength `level` to depth [m]; unchanged for level 0.

    Values from `depth_max` on stay; noisy ones are at most `depth_max`, which is also that of missing readings.
    """
    read = stereo_depth(key, depth, fovy, near=0.0, far=depth_max, strength=level)
    read = jnp.where(depth < depth_max, jnp.minimum(read, depth_max), depth)
    return jnp.where(level > 0, read, depth)


def add_rgb_noise(level: Float[Array, ""], key: Array, rgb: UInt8[Array, "h w 3"]) -> UInt8[Array, "h w 3"]:
    """Add noise of an image sensor to colours, see `sensor_rgb`; `level` multiplies both variances, 0: unchanged."""
    return jnp.where(level > 0, sensor_rgb(key, rgb, 0.002 * level, 0.0001 * level), rgb)
