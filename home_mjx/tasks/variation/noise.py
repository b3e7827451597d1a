"""Noise of moves and of images, as strong as an episode has drawn it."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.cameras.noise import kinect_depth, sensor_rgb

# A LoCoBot under the controller ILQR: mean and variance of the error forward, to the right [m] and of the turn [rad],
# of moves and of turns. A. Murali et al., "PyRobot", 2019 (arXiv:1906.08236), as measured for Habitat.
MEAN = np.array([[0.014, 0.009, 0.008], [0.003, 0.003, 0.023]], np.float32)
VARIANCE = np.array([[0.006, 0.005, 0.004], [0.002, 0.003, 0.012]], np.float32)
MOST = 3.0  # standard deviations
LEAST_MOVE = 0.05  # part of its move that a robot makes at least: none goes backwards by mistake


def noisy_moves(
    level: Float[Array, ""], key: Array, drive: Float[Array, "a 3"], full: Float[Array, "a 3"]
) -> Float[Array, "a 3"]:
    """Moves with errors of a real robot; who neither moves nor turns has none.

    As in Habitat the errors are Gaussians, cut at three standard deviations and where a move would go backwards, times
    a multiplier. What would need more than the fastest speed is cut.

    Source: M. Savva et al., "Habitat", 2019 (arXiv:1904.01201), `pyrobot_noisy_controls`.

    Args:
        level: Habitat's `noise_multiplier`.
        key: Of the step.
        drive: Forward, left and turn left, in parts of the fastest rates.
        full: What the fastest rates are in a step [m], [m], [rad].

    Example:
        >>> still = jnp.zeros((1, 3))
        >>> bool((noisy_moves(jnp.float32(1.0), jax.random.key(0), still, still + 1) == still).all())
        True
    """
    turns = (drive[:, 2] != 0)[:, None]
    mean, deviation = (jnp.where(turns, x[1][None], x[0][None]) for x in (MEAN, np.sqrt(VARIANCE)))
    amount = jnp.abs(drive * full)
    meant = jnp.stack([~turns[:, 0], jnp.zeros_like(turns[:, 0]), turns[:, 0]], axis=-1)
    floor = jnp.where(meant, (-(1 - LEAST_MOVE) * amount - mean) / deviation, -MOST)
    unit = jax.random.truncated_normal(key, jnp.maximum(floor, -MOST), MOST, drive.shape, jnp.float32)
    side = jnp.stack([jnp.ones_like(drive[:, 0]), -jnp.ones_like(drive[:, 0]), _sign(drive[:, 2])], axis=-1)
    error = level * (mean + deviation * unit) * side
    noisy = jnp.clip(drive + error / full, -1.0, 1.0)
    return jnp.where(jnp.any(drive != 0, axis=-1, keepdims=True), noisy, drive)


def _sign(turn: Float[Array, " a"]) -> Float[Array, " a"]:
    return jnp.where(turn < 0, -1.0, 1.0)


def noisy_depth(
    level: Float[Array, ""], key: Array, depth: Float[Array, "h w 1"], depth_max: float
) -> Float[Array, "h w 1"]:
    """Depth as a structured-light sensor reads it, see `kinect_depth`; what is as far as `depth_max` stays [m]."""
    read = kinect_depth(key, depth, near=0.0, far=depth_max, strength=level)
    read = jnp.where(depth < depth_max, jnp.minimum(read, depth_max), depth)
    return jnp.where(level > 0, read, depth)


def noisy_rgb(level: Float[Array, ""], key: Array, rgb: UInt8[Array, "h w 3"]) -> UInt8[Array, "h w 3"]:
    """Colours as an image sensor reads them, see `sensor_rgb`; the level multiplies both variances."""
    return jnp.where(level > 0, sensor_rgb(key, rgb, 0.002 * level, 0.0001 * level), rgb)
