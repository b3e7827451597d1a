"""From an agent's action to the forces of its motors."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.physics.base.config import PhysicsConfig


def motor_forces(
    config: PhysicsConfig,
    yaw_inertia: float,
    action: Float[Array, "3"],
    yaw: Float[Array, ""],
    velocity: Float[Array, "4"],
) -> Float[Array, "3"]:
    """Forces that drive an agent towards its target velocity.

    A velocity controller, `f = m (v_target - v) / response_time`, whose horizontal force is cut to `push_force` in
    any direction. This force, against friction, decides which objects an agent can push.

    Args:
        config: Options.
        yaw_inertia: [kg m^2] about the vertical axis.
        action: Forward, strafe to the left and turn to the left, in [-1, 1]; clipped.
        yaw: [rad]
        velocity: World frame x, y, z [m/s] and yaw rate [rad/s].

    Returns:
        Force along world x and y [N], torque about z [N m].
    """
    fastest = jnp.array([config.forward_speed, config.strafe_speed, config.turn_rate], jnp.float32)
    forward, left, turn = jnp.clip(action, -1.0, 1.0) * fastest
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    error = jnp.stack([cos * forward - sin * left, sin * forward + cos * left]) - velocity[:2]
    force = error * jnp.float32(config.body.mass / config.response_time)
    size = jnp.sqrt(jnp.sum(force * force) + jnp.float32(1e-12))
    force = force * jnp.minimum(jnp.float32(1.0), jnp.float32(config.push_force) / size)
    torque = (turn - velocity[3]) * jnp.float32(yaw_inertia / config.response_time)
    return jnp.concatenate([force, torque[None]])
