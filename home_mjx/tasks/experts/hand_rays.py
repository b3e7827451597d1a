"""Rays that hands test after the turns and looks that actions can make."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.core.transforms import wrap_angle
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.env.actions import PITCH_TOLERANCE
from home_mjx.tasks.env.hand_actions import NUM_AIM_ANGLES
from home_mjx.tasks.sensors.cameras import eye_position


def nearest_hand_rays(
    config: EnvConfig, pose: AgentPose, points: Float[Array, "a p 3"], spread: float
) -> Float[Array, "a p 3"]:
    """Return unit directions of the rays of hands that pass nearest to points, once the view is turned to these.

    Discrete actions turn the view by whole steps, and hands test only `aim_directions` around it: between two of these
    they miss objects of less than `max_aim_angle` / 4.

    Args:
        config: Options of the environment.
        pose: Agents' poses.
        points: World positions [m].
        spread: Maximum turn and tilt of a ray from the view centre [rad]; 0: only the centre itself.
    """
    turn, tilt = view_angles(config, pose, points)
    view = round_to_steps(config, turn, tilt, pose.pitch)
    turn, tilt = (x + _nearest_offset(y - x, spread) for x, y in zip(view, (turn, tilt), strict=True))
    yaw, pitch = pose.yaw[:, None] + turn, pose.pitch[:, None] + tilt
    level = jnp.cos(pitch)
    return jnp.stack([jnp.cos(yaw) * level, jnp.sin(yaw) * level, jnp.sin(pitch)], axis=-1)


def _nearest_offset(angle: Float[Array, "a p"], spread: float) -> Float[Array, "a p"]:
    """Return the offset of `aim_directions` from the view centre, in one direction, that is nearest to an angle."""
    if not spread:
        return jnp.zeros_like(angle)
    step = jnp.float32(2 * spread / (NUM_AIM_ANGLES - 1))
    return jnp.clip(jnp.round(angle / step) * step, -jnp.float32(spread), jnp.float32(spread))


def view_angles(
    config: EnvConfig, pose: AgentPose, points: Float[Array, "a p 3"]
) -> tuple[Float[Array, "a p"], Float[Array, "a p"]]:
    """Return the turns to the left and the tilts up that bring points [m] to the view centre [rad]."""
    offset = points - eye_position(config, pose)[:, None]
    away = jnp.linalg.norm(offset[..., :2], axis=-1)
    turn = wrap_angle(jnp.arctan2(offset[..., 1], offset[..., 0]) - pose.yaw[:, None])
    return turn, jnp.arctan2(offset[..., 2], jnp.maximum(away, 1e-3)) - pose.pitch[:, None]


def round_to_steps(
    config: EnvConfig, turn: Float[Array, "a p"], tilt: Float[Array, "a p"], pitch: Float[Array, " a"]
) -> tuple[Float[Array, "a p"], Float[Array, "a p"]]:
    """Round turns and tilts (relative to now) to the nearest ones that actions can produce within `max_pitch` [rad].

    Discrete ones are whole numbers of steps. Continuous turns stay, and tilts are only clipped.
    """
    most, pitch = jnp.float32(config.max_pitch + PITCH_TOLERANCE), pitch[:, None]
    if config.discrete is None:
        return turn, jnp.clip(pitch + tilt, -most, most) - pitch
    step, rise = (jnp.float32(math.radians(x)) for x in (config.discrete.turn_angle, config.discrete.tilt_angle or 0))
    up, down = jnp.floor((most - pitch) / rise), -jnp.floor((most + pitch) / rise)
    return jnp.round(turn / step) * step, jnp.clip(jnp.round(tilt / rise), down, up) * rise
