"""Operands, sizes and scalar parameters of the fused step, shared by the kernels for CPUs and GPUs and their caller.

`cuda/base.cuh` repeats the sizes, and a test compares both.
"""

from typing import NamedTuple, TypeVar

import jax
import numpy as np

from home_mjx.physics.base import servo
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.state import NOTHING
from home_mjx.physics.mjx.template_mjcf import CORNER_RADIUS
from home_mjx.schema.mjcf import DOOR_DAMPING_RATE, SOLIMP, TIME_CONSTANT

Values = TypeVar("Values", jax.Array, np.ndarray)  # (*batch, 5)
MAX_NEWTON_ITERATIONS = 50  # maximum number of Newton iterations; most physics steps converge in one to three
FORCE_CONTROL = 1.0  # value of `control` for force control
# Maximum speeds and acceleration of a body at rest; a body below them for a whole control step may fall asleep.
MAX_REST_SPEED, MAX_REST_SPIN, MAX_REST_ACCELERATION = 2e-3, 1e-2, 0.1  # [m/s], [rad/s], [m/s^2]
# Operands in order. Shared by all environments: arrays of houses, agents and template parameters.
COLLIDER_POS, COLLIDER_QUAT, COLLIDER_HALF, BODY_VALID, BODY_SIZE, BODY_MASS, BODY_INERTIA, BODY_SURFACE = range(8)
DOOR, RAMP, FLOOR, AGENT, PARAMS = range(8, 13)
NUM_SHARED = 13
# One row per environment.
HOUSE, QPOS, QVEL, QACC, ACTION, HELD, GRIP, GOAL, SCALE = range(NUM_SHARED, 22)
# Results.
NEW_QPOS, NEW_QVEL, NEW_QACC, NUM_AGENT_CONTACTS, OVERFLOW, CONTACT_IMPULSE, CONTACT_PARTNER = range(7)
NUM_RESULTS = 7
AGENT_DOFS, BODY_DOFS, DOOR_DOFS = 3, 6, 1  # DoFs that contacts act on; an agent's yaw is independent of contacts
JOINT_LIMIT = NOTHING  # code of a contact's second side if a door is at its joint limit
SLEEPING_BODY = -1_000_000  # code of a contact's second body m if that sleeps: SLEEPING_BODY - m
MAX_NEAR_BOXES = 24  # maximum number of listed static boxes per dynamic body
POINTS_PER_BODY = 24  # contact points per dynamic body that the buffer holds
AGENT_COLUMNS, RAMP_COLUMNS, SURFACE_COLUMNS = 8, 8, 5


class StepParams(NamedTuple):
    """Parameters in [m], [kg], [s], [N] and their products; arrays have the same order.

    Counts, flags and codes are floats, too. `hand_time` is also the velocity time constant of door drives, and
    `door_time` that of their position.
    """

    sim_dt: float
    substeps: float
    gravity: float
    control: float  # FORCE_CONTROL, or 0 for velocity control
    response_time: float
    max_body_speed: float
    max_body_spin: float
    stiffness: float  # of agents' contacts and door limits: reference acceleration per depth and impedance
    damping: float  # of the same: reference acceleration per velocity
    impedance_low: float
    impedance_high: float
    impedance_width: float
    iterations: float
    corner_radius: float
    sleep: float  # 1: bodies at rest are skipped
    rest_speed: float
    rest_spin: float
    rest_pull: float
    on_ramp: float
    hand_time: float
    hand_speed: float
    hand_spin: float
    hand_twist: float
    hand_acceleration: float
    hand_force: float
    hand_stiffness: float
    hand_slack: float
    hand_leash: float
    door_drag: float
    door_time: float
    door_speed: float
    door_torque: float


def step_params(config: PhysicsSetup) -> StepParams:
    """Return the parameters of the fused step for these options and the constants of `base.servo`.

    Stiffness and damping of agents' contacts and door limits are 1 / (d T)² and 2 / (d T), with d = `SOLIMP[1]`. The
    time constant T is the larger of `TIME_CONSTANT` and two physics steps; the damping ratio is 1.
    """
    dt = config.timing.sim_dt
    constant = max(TIME_CONSTANT, 2 * dt)  # see MuJoCo's "Solver parameters"; the damping ratio is 1
    return StepParams(
        sim_dt=dt,
        substeps=config.timing.substeps,
        gravity=servo.GRAVITY,
        control=FORCE_CONTROL if config.control == "force" else 0.0,
        response_time=config.response_time,
        max_body_speed=config.max_body_speed,
        max_body_spin=config.max_body_spin,
        stiffness=1 / (SOLIMP[1] * constant) ** 2,
        damping=2 / (SOLIMP[1] * constant),
        impedance_low=SOLIMP[0],
        impedance_high=SOLIMP[1],
        impedance_width=SOLIMP[2],
        iterations=MAX_NEWTON_ITERATIONS,
        corner_radius=CORNER_RADIUS,
        sleep=float(config.sleep),
        rest_speed=MAX_REST_SPEED,
        rest_spin=MAX_REST_SPIN,
        rest_pull=MAX_REST_ACCELERATION,
        on_ramp=servo.MAX_RAMP_GAP,
        hand_time=servo.hand_time_constant(config),
        hand_speed=servo.MAX_HAND_SPEED,
        hand_spin=servo.MAX_HAND_SPIN,
        hand_twist=servo.MAX_HAND_ANGULAR_ACCELERATION,
        hand_acceleration=servo.MAX_HAND_ACCELERATION,
        hand_force=servo.MAX_HAND_FORCE,
        hand_stiffness=servo.HAND_STIFFNESS,
        hand_slack=servo.MIN_SPRING_LAG,
        hand_leash=servo.MAX_SPRING_LAG,
        door_drag=DOOR_DAMPING_RATE,
        door_time=servo.DOOR_TIME_CONSTANT,
        door_speed=servo.MAX_DOOR_SPEED,
        door_torque=servo.MAX_DOOR_TORQUE,
    )


def reference_surfaces(surfaces: Values) -> Values:
    """Return a copy of rows of `base.surfaces` with stiffness over `SOLIMP[1]` ** 2 and damping over `SOLIMP[1]`.

    The reference acceleration is then `stiffness * impedance * depth - damping * velocity`. Apply it once.
    """
    factor = np.array([1, SOLIMP[1] ** -2, 1 / SOLIMP[1], 1, 1], surfaces.dtype)
    return surfaces * factor.reshape((1,) * (surfaces.ndim - 1) + (-1,))
