"""What hands do to the things that they hold, what drives doors, and what keeps agents on ramps.

All are accelerations besides those of contacts, so whatever is held or driven is stopped by what is in its way. A thing
in a hand is pulled so weakly (`HAND_ACCELERATION`) that it does not enter a wall, and its holder feels by a spring how
far it lags behind.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import body_quat, quat_matrix, quat_multiply
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.physics.base.control import HALF_LENGTH, RADIUS

GRAVITY = 9.81  # [m/s^2], MuJoCo's default
HAND_TIME = 0.05  # [s], in which a hand gives a thing its speed; twice as long for its place
HAND_SPEED = 2.0  # [m/s], at which a thing comes to the hand
HAND_SPIN = 6.0  # [rad/s]
HAND_TWIST = 100.0  # [rad/s^2]
# [m/s^2]; a face pressed against a wall so is about 1 mm in it. Where an edge lies along an edge, as on the frame of a
# door, MuJoCo finds one contact point, at one end and the other by turns: 1.5 cm, and 2.5 cm or more with 30 m/s^2.
HAND_ACCELERATION = 15.0
HAND_FORCE = 300.0  # [N]
HAND_STIFFNESS = 1500.0  # [N/m], of the arm that holds back an agent
HAND_SLACK = 0.05  # [m], by which a thing may lag behind without that
HAND_LEASH = 0.3  # [m]; what is farther away still comes to the hand, and holds back nobody
DOOR_TIME = 0.3  # [s]
DOOR_SPEED = 2.0  # [rad/s], or [m/s] of what slides
DOOR_TORQUE = 30.0  # [N m], or [N] of what slides
ON_RAMP = 0.15  # [m], greatest height of an agent's foot above the ramp that it stands on
FREE = 1e9  # goal of a door that nothing drives


def hand_time(config: PhysicsConfig) -> float:
    """`HAND_TIME`, or what a physics step can follow [s]."""
    return max(HAND_TIME, 2 * config.timing.sim_dt)


class Held(Pytree):
    """A thing and its holder, in the world; `spin` of the thing is about its own axes."""

    pos: Float[Array, "3"]  # [m]
    quat: Float[Array, "4"]
    velocity: Float[Array, "3"]  # [m/s]
    spin: Float[Array, "3"]  # [rad/s]
    mass: Float[Array, ""]  # [kg]
    agent_pos: Float[Array, "3"]
    agent_yaw: Float[Array, ""]
    agent_velocity: Float[Array, "4"]  # [m/s], and about z [rad/s]


def hand_accelerations(
    config: PhysicsConfig, held: Held, grip: Float[Array, "7"]
) -> tuple[Float[Array, "3"], Float[Array, "3"], Float[Array, "2"]]:
    """What a hand does to a thing, and what its holder feels.

    Args:
        config: Options.
        held: Where both are.
        grip: Where the thing shall be: position [m] and quaternion in the agent's frame, which turns with its yaw.

    Returns:
        The thing's acceleration [m/s^2], instead of gravity; its angular acceleration about its own axes [rad/s^2];
        force on the agent along x and y [N].
    """
    time = jnp.float32(hand_time(config))
    cos, sin = jnp.cos(held.agent_yaw), jnp.sin(held.agent_yaw)
    arm = jnp.stack([cos * grip[0] - sin * grip[1], sin * grip[0] + cos * grip[1], grip[2]])
    rate = held.agent_velocity[3]
    gap = held.agent_pos + arm - held.pos
    carried = held.agent_velocity[:3] + rate * jnp.stack([-arm[1], arm[0], jnp.zeros_like(arm[2])])
    wanted = carried + gap * _reach(gap, HAND_SPEED, time) - held.velocity
    most = jnp.minimum(jnp.float32(HAND_ACCELERATION), jnp.float32(HAND_FORCE) / held.mass)
    linear = _cut(wanted / time, most)
    back_turn = held.quat * jnp.array([1.0, -1.0, -1.0, -1.0], jnp.float32)
    miss = quat_multiply(back_turn, quat_multiply(body_quat(held.agent_yaw), grip[3:]))
    miss = jnp.where(miss[0] >= 0, 2.0, -2.0) * miss[1:]
    upright = quat_matrix(held.quat)[2]
    angular = _cut((rate * upright + miss * _reach(miss, HAND_SPIN, time) - held.spin) / time, jnp.float32(HAND_TWIST))
    far = _length(gap[:2])
    lag = jnp.where(far < jnp.float32(HAND_LEASH), jnp.maximum(far - jnp.float32(HAND_SLACK), 0.0), 0.0)
    back = jnp.float32(HAND_STIFFNESS) * lag / far
    return linear, angular, -back * gap[:2]


def door_acceleration(
    place: Float[Array, "h"], rate: Float[Array, "h"], goal: Float[Array, "h"], inertia: Float[Array, "h"], time: float
) -> Float[Array, "h"]:
    """What drives doors to their goals [rad/s^2], without the drag of their hinges; of sliding ones in [m/s^2].

    Args:
        place: Coordinate [rad], of sliding doors [m].
        rate: [rad/s], [m/s]
        goal: [rad], [m]; `FREE`: nothing drives it.
        inertia: About the hinge [kg m^2], or mass [kg].
        time: In which the leaf gets its speed [s].
    """
    wanted = jnp.clip((goal - place) / jnp.float32(DOOR_TIME), -DOOR_SPEED, DOOR_SPEED)
    most = jnp.float32(DOOR_TORQUE) / inertia
    return jnp.where(jnp.abs(goal) < FREE, jnp.clip((wanted - rate) / jnp.float32(time), -most, most), 0.0)


def ramp_acceleration(
    ramps: Float[Array, "r 8"], agent: Float[Array, "8"], pos: Float[Array, "3"]
) -> Float[Array, "2"]:
    """What keeps an agent, whose contacts have no friction, from sliding down a ramp [m/s^2].

    Where it stands on one, `g tan(slope)` uphill balances what the ramp's normal force does. Of several, as
    where those of stairs that turn overlap, the highest bears it; landings do not count.

    Args:
        ramps: Rows of `bank.physics.ramp`.
        agent: Row of `control.agent_table`.
        pos: Centre of its capsule [m].
    """
    _, _, up_x, up_y, half_u, half_v, _, slope = ramps.T
    along, across, surface = over_ramps(ramps, pos)
    sine = slope / jnp.sqrt(1 + slope * slope)
    above = pos[2] - agent[RADIUS] - agent[HALF_LENGTH] - surface
    stands = (along >= -half_u - 0.3 * agent[RADIUS]) & (along <= half_u - agent[RADIUS] * sine)
    stands &= (slope > 0) & (jnp.abs(across) <= half_v) & (jnp.abs(above) < ON_RAMP)
    bears = stands & (surface == jnp.max(jnp.where(stands, surface, -jnp.inf)))
    first = bears & (jnp.cumsum(bears, dtype=jnp.int32) == 1)
    uphill = jnp.where(first, jnp.float32(GRAVITY) * slope, 0.0)
    return jnp.stack([jnp.sum(uphill * up_x), jnp.sum(uphill * up_y)])


def over_ramps(ramps: Float[Array, "r 8"], pos: Float[Array, "3"]) -> tuple[Array, Array, Array]:
    """Where a point is over each ramp: uphill and across from its middle, and the height of its top there [m]."""
    x, y, up_x, up_y, _, _, middle, slope = ramps.T
    along = (pos[0] - x) * up_x + (pos[1] - y) * up_y
    across = (pos[1] - y) * up_x - (pos[0] - x) * up_y
    return along, across, middle + along * slope


def _length(vector: Array) -> Array:
    return jnp.sqrt(jnp.sum(vector * vector) + jnp.float32(1e-24))


def _reach(gap: Array, fastest: float, time: Array) -> Array:
    """Speed per distance towards a goal."""
    return jnp.minimum(1.0, jnp.float32(fastest) * 2 * time / _length(gap)) / (2 * time)


def _cut(vector: Array, most: Array) -> Array:
    return vector * jnp.minimum(1.0, most / _length(vector))
