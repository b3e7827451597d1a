"""Servo accelerations: hands that hold bodies, door drives, and agents on ramps.

All are accelerations in addition to contact, so an obstacle stops a held or driven body. The acceleration of a held
body is limited (`MAX_HAND_ACCELERATION`), so that contact keeps it out of walls. A spring couples the lag of the body
back to its holder.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import quat_matrix, quat_multiply, yaw_quat
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.control import HALF_LENGTH, RADIUS

GRAVITY = 9.81  # [m/s^2], MuJoCo's default
HAND_TIME_CONSTANT = 0.05  # [s], velocity time constant of a hand; the position time constant is twice as long
MAX_HAND_SPEED = 2.0  # [m/s], maximum speed of a held body towards the hand
MAX_HAND_SPIN = 6.0  # [rad/s], maximum angular speed towards the grip
MAX_HAND_ANGULAR_ACCELERATION = 100.0  # [rad/s^2], maximum angular acceleration
# [m/s^2], maximum acceleration of a held body. A face that is pressed against a wall then penetrates by about 1 mm.
# For an edge along an edge, as on a door frame, MuJoCo returns one contact point that alternates between both ends.
# The penetration is then 1.5 cm; with 30 m/s^2 it would be at least 2.5 cm.
MAX_HAND_ACCELERATION = 15.0
MAX_HAND_FORCE = 300.0  # [N], maximum force of a hand
HAND_STIFFNESS = 1500.0  # [N/m], spring that pulls an agent back towards a lagging body
MIN_SPRING_LAG = 0.05  # [m], lag of the body below which that spring is slack
MAX_SPRING_LAG = 0.3  # [m], lag from which on the body is still pulled but no longer holds the agent back
DOOR_TIME_CONSTANT = 0.3  # [s], position time constant of a door drive
MAX_DOOR_SPEED = 2.0  # [rad/s], or [m/s] of a sliding door; maximum speed of a door drive
MAX_DOOR_TORQUE = 30.0  # [N m], or [N] of a sliding door; maximum torque of a door drive
MAX_RAMP_GAP = 0.15  # [m], maximum height of an agent's foot above or below the ramp that supports it
NOT_DRIVEN = 1e9  # goal of a door that is not driven


def hand_time_constant(config: PhysicsSetup) -> float:
    """Return the velocity time constant of hands [s]: the larger of `HAND_TIME_CONSTANT` and two physics steps.

    The latter is for stability. Door drives have the same velocity time constant. Of `config`, only `timing` is used.
    """
    return max(HAND_TIME_CONSTANT, 2 * config.timing.sim_dt)


class HeldBody(Pytree):
    """Held body and its holder, in the world frame; `spin` is about the body's own axes.

    `quat` must be normalised; `agent_pos` is the agent's centre [m], `agent_yaw` in [rad].
    """

    pos: Float[Array, "3"]  # [m]
    quat: Float[Array, "4"]
    velocity: Float[Array, "3"]  # [m/s]
    spin: Float[Array, "3"]  # [rad/s]
    mass: Float[Array, ""]  # [kg]
    agent_pos: Float[Array, "3"]
    agent_yaw: Float[Array, ""]
    agent_velocity: Float[Array, "4"]  # [m/s], and about z [rad/s]


def hand_accelerations(
    config: PhysicsSetup, held: HeldBody, grip: Float[Array, "7"]
) -> tuple[Float[Array, "3"], Float[Array, "3"], Float[Array, "2"]]:
    """Compute the limited accelerations of one held body towards its grip, and the reaction on its holder.

    `grip` is the body's target pose: position [m] from the agent's centre and quaternion, both rotated by the agent's
    yaw. With `t` of `hand_time_constant`, the desired velocity is that of the grip plus `gap / (2 t)`. That second part
    is at most `MAX_HAND_SPEED`. The acceleration is `(desired - velocity) / t`, in length at most the smaller of
    `MAX_HAND_ACCELERATION` and `MAX_HAND_FORCE / mass`. The angular one is likewise, with `MAX_HAND_SPIN` and
    `MAX_HAND_ANGULAR_ACCELERATION`.

    Quaternions must have unit length. Of `config`, only the length of a physics step is used.

    The reaction pulls the agent horizontally from the grip towards the body. It is `HAND_STIFFNESS` times the excess of
    the horizontal gap over `MIN_SPRING_LAG`, and 0 from a gap of `MAX_SPRING_LAG` on.

    Returns:
        Acceleration of the body in the world [m/s^2], which replaces gravity; its angular acceleration about its own
        axes [rad/s^2]; force on the agent along x and y [N].
    """
    time = jnp.float32(hand_time_constant(config))
    cos, sin = jnp.cos(held.agent_yaw), jnp.sin(held.agent_yaw)
    arm = jnp.stack([cos * grip[0] - sin * grip[1], sin * grip[0] + cos * grip[1], grip[2]])
    rate = held.agent_velocity[3]
    gap = held.agent_pos + arm - held.pos
    carried = held.agent_velocity[:3] + rate * jnp.stack([-arm[1], arm[0], jnp.zeros_like(arm[2])])
    wanted = carried + gap * _approach_rate(gap, MAX_HAND_SPEED, time) - held.velocity
    most = jnp.minimum(jnp.float32(MAX_HAND_ACCELERATION), jnp.float32(MAX_HAND_FORCE) / held.mass)
    linear = _clip_length(wanted / time, most)
    back_turn = held.quat * jnp.array([1.0, -1.0, -1.0, -1.0], jnp.float32)
    miss = quat_multiply(back_turn, quat_multiply(yaw_quat(held.agent_yaw), grip[3:]))
    miss = jnp.where(miss[0] >= 0, 2.0, -2.0) * miss[1:]
    upright = quat_matrix(held.quat)[2]
    angular = _clip_length(
        (rate * upright + miss * _approach_rate(miss, MAX_HAND_SPIN, time) - held.spin) / time,
        jnp.float32(MAX_HAND_ANGULAR_ACCELERATION),
    )
    far = _length(gap[:2])
    lag = jnp.where(far < jnp.float32(MAX_SPRING_LAG), jnp.maximum(far - jnp.float32(MIN_SPRING_LAG), 0.0), 0.0)
    back = jnp.float32(HAND_STIFFNESS) * lag / far
    return linear, angular, -back * gap[:2]


def door_acceleration(
    place: Float[Array, "h"], rate: Float[Array, "h"], goal: Float[Array, "h"], inertia: Float[Array, "h"], time: float
) -> Float[Array, "h"]:
    """Compute the drive acceleration of doors towards their goals [rad/s^2], or [m/s^2] of sliding doors.

    The desired rate is `(goal - place) / DOOR_TIME_CONSTANT`, clipped to `MAX_DOOR_SPEED` in magnitude. The
    acceleration is `(desired - rate) / time`, clipped to `MAX_DOOR_TORQUE / inertia`. It is 0 for goals of magnitude
    `NOT_DRIVEN` or more; others are not clipped. Joint limits and hinge drag are not included. `place`,
    `rate` and `goal` are in [rad] and [rad/s], or [m] and [m/s]. `inertia` is about the hinge [kg m^2], or the mass
    [kg]. `time` is the time constant of the velocity [s].
    """
    wanted = jnp.clip((goal - place) / jnp.float32(DOOR_TIME_CONSTANT), -MAX_DOOR_SPEED, MAX_DOOR_SPEED)
    most = jnp.float32(MAX_DOOR_TORQUE) / inertia
    return jnp.where(jnp.abs(goal) < NOT_DRIVEN, jnp.clip((wanted - rate) / jnp.float32(time), -most, most), 0.0)


def ramp_acceleration(
    ramps: Float[Array, "r 8"], agent: Float[Array, "8"], pos: Float[Array, "3"]
) -> Float[Array, "2"]:
    """Compute the acceleration (world x, y) that keeps one agent from sliding down a ramp [m/s^2]; 0 off ramps.

    Contacts of agents are frictionless. On a ramp, `g * slope` uphill balances the ramp's normal force. The agent is on
    a ramp if its lowest point is less than `MAX_RAMP_GAP` from its plane and over it in plan. That is from 0.3 radii
    before the lower end to radius times sine of the slope before the upper. The highest of overlapping ramps, as on
    turning stairs, applies, or the first of equal ones. Landings and padding have slope 0 and are ignored. `ramps` are
    one house's rows of `bank.physics.ramp`, at least one. `agent` is a row of `control.agent_table`, `pos` the centre
    of its capsule [m].
    """
    _, _, up_x, up_y, half_u, half_v, _, slope = ramps.T
    along, across, surface = ramp_coordinates(ramps, pos)
    sine = slope / jnp.sqrt(1 + slope * slope)
    above = pos[2] - agent[RADIUS] - agent[HALF_LENGTH] - surface
    stands = (along >= -half_u - 0.3 * agent[RADIUS]) & (along <= half_u - agent[RADIUS] * sine)
    stands &= (slope > 0) & (jnp.abs(across) <= half_v) & (jnp.abs(above) < MAX_RAMP_GAP)
    bears = stands & (surface == jnp.max(jnp.where(stands, surface, -jnp.inf)))
    first = bears & (jnp.cumsum(bears, dtype=jnp.int32) == 1)
    uphill = jnp.where(first, jnp.float32(GRAVITY) * slope, 0.0)
    return jnp.stack([jnp.sum(uphill * up_x), jnp.sum(uphill * up_y)])


def ramp_coordinates(ramps: Float[Array, "r 8"], pos: Float[Array, "3"]) -> tuple[Array, Array, Array]:
    """Return one point's offsets from each ramp's centre, uphill and to the left, and the ramp's height there [m].

    Offsets are horizontal. The height is that of the ramp's plane, also beyond its edges. It is 0 for padding, which
    the caller must mask. Columns of `ramps`: centre
    (x, y), uphill unit vector (x, y), half length and width in plan, centre height [m], slope (rise over run).
    """
    x, y, up_x, up_y, _, _, middle, slope = ramps.T
    along = (pos[0] - x) * up_x + (pos[1] - y) * up_y
    across = (pos[1] - y) * up_x - (pos[0] - x) * up_y
    return along, across, middle + along * slope


def _length(vector: Array) -> Array:
    """Return the Euclidean length of one vector, at least 1e-12, so that divisions and gradients stay finite.

    All elements are summed, so a batch would give one length.
    """
    return jnp.sqrt(jnp.sum(vector * vector) + jnp.float32(1e-24))


def _approach_rate(gap: Array, fastest: float, time: Array) -> Array:
    """Return the scalar gain `1 / (2 time)` [1/s], less where the gain times `gap`'s length exceeds `fastest`.

    `gap` is one vector, [m] or [rad], not a batch. `fastest` is in its unit per second, `time` in seconds.
    """
    return jnp.minimum(1.0, jnp.float32(fastest) * 2 * time / _length(gap)) / (2 * time)


def _clip_length(vector: Array, most: Array) -> Array:
    """Scale one vector, not a batch, down to the length `most` if it is longer; a zero vector stays zero."""
    return vector * jnp.minimum(1.0, most / _length(vector))
