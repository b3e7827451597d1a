"""Motor forces from an agent's action."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.physics.base.config import PhysicsSetup

# Columns of `agent_table`.
RADIUS, HALF_LENGTH, MASS, YAW_INERTIA, FORWARD_SPEED, STRAFE_SPEED, TURN_RATE, PUSH_FORCE = range(8)


def agent_table(config: PhysicsSetup, yaw_inertia: Float[np.ndarray, " a"]) -> Float[np.ndarray, "a 8"]:
    """Pack a row per agent: radius, half length of the axis, mass, yaw inertia, maximum speeds (3) and push force [SI].

    The speeds are forward, left and turning. `yaw_inertia` has that of each agent [kg m^2]. The array is NumPy float64.
    Of `config`, only `agents` are used.

    Raises:
        ValueError: `yaw_inertia` has not one element per agent.
    """
    rows = [
        (b.radius, b.half_length, b.mass, inertia, b.forward_speed, b.strafe_speed, b.turn_rate, b.max_push_force)
        for b, inertia in zip(config.agents, yaw_inertia, strict=True)
    ]
    return np.array(rows)


def motor_forces(
    config: PhysicsSetup,
    agent: Float[Array, "8"],
    action: Float[Array, "3"],
    yaw: Float[Array, ""],
    velocity: Float[Array, "4"],
) -> Float[Array, "3"]:
    """Compute the motor forces of one agent along world x and y [N], and its torque about z [N m].

    In velocity control, `f = m (v_target - v) / response_time`. The length of its horizontal part is clipped to
    `max_push_force`. In force control, `f = max_push_force (action - v / max_speed)`, for forward and left separately.
    It is not clipped, so a force against a motion can be larger than `max_push_force`. In both, the torque is
    `yaw_inertia (rate_target - rate) / response_time`, without a limit.

    Args:
        config: Options; only `control` and `response_time` are used.
        agent: Row of `agent_table`.
        action: Forward, left and counter-clockwise fractions of the maximum speeds, clipped to [-1, 1]. In force
            control, forward and left are fractions of `max_push_force`.
        yaw: [rad]
        velocity: World frame x, y, z [m/s] and yaw rate [rad/s]; z is ignored.
    """
    part = jnp.clip(action, -1.0, 1.0)
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    forward, left = cos * velocity[0] + sin * velocity[1], cos * velocity[1] - sin * velocity[0]
    miss = jnp.stack([part[0] * agent[FORWARD_SPEED] - forward, part[1] * agent[STRAFE_SPEED] - left])
    if config.control == "force":
        miss = miss / jnp.stack([agent[FORWARD_SPEED], agent[STRAFE_SPEED]]) * agent[PUSH_FORCE]
    else:
        miss = miss * (agent[MASS] / jnp.float32(config.response_time))
        size = jnp.sqrt(jnp.sum(miss * miss) + jnp.float32(1e-12))
        miss = miss * jnp.minimum(jnp.float32(1.0), agent[PUSH_FORCE] / size)
    x, y = cos * miss[0] - sin * miss[1], sin * miss[0] + cos * miss[1]
    torque = (part[2] * agent[TURN_RATE] - velocity[3]) * (agent[YAW_INERTIA] / jnp.float32(config.response_time))
    return jnp.stack([x, y, torque])
