"""Reset, step and state queries, common to all implementations."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_shape
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics.base.control import FORWARD_SPEED, TURN_RATE
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.servo import GRAVITY, NOT_DRIVEN
from home_mjx.physics.base.state import MIN_AWAKE_ACCELERATION, NOTHING, BodyScale, PhysicsState
from home_mjx.physics.fused import step_fused
from home_mjx.physics.kinematic.native import step_kinematic
from home_mjx.physics.mjx.house_model import movable_bodies
from home_mjx.physics.mjx.mjx_step import step_mjx
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mujoco.step import step_mujoco

STEPS = {"fused": step_fused, "jax": step_mjx, "c": step_mujoco, "kinematic": step_kinematic}
MIN_DEPTH_BELOW_FLOOR = 0.05  # [m], minimum depth below the ground floor that counts; contact penetration is smaller
MAX_VALID_MAGNITUDE = 1e6  # maximum magnitude of a valid pose or speed [m], [rad], [m/s], [rad/s]


def reset(
    template: Template,
    bank: HouseBank,
    house: Int[Array, ""],
    agent_pos: Float[Array, "a 3"],
    agent_yaw: Float[Array, " a"],
    door_angle: Float[Array, " h"] | None = None,
    arrangement: Int[Array, ""] | int | None = None,
    scale: BodyScale | None = None,
) -> PhysicsState:
    """Return the initial state of one environment: everything at rest, hands empty, doors not driven.

    Bodies and doors are awake, so bodies settle in the first steps. Poses are not checked for collisions.

    Bodies and doors are awake: their `qacc` is not 0. Unused bodies are parked.

    Args:
        template: Model of the bank's capacity.
        bank: Houses.
        house: Index of the house, clipped to the bank.
        agent_pos: Position of each agent's feet in the world, on the floor [m]; not checked for collisions.
        agent_yaw: [rad], counter-clockwise from +x.
        door_angle: Rotation of each door about +z from its authored pose [rad], or displacement of a sliding door [m];
            not clipped to its range. None: the authored pose.
        arrangement: Index of one of the house's arrangements, see `arrangements.with_arrangements`; too large ones
            give the last. Negative, None, or a bank without arrangements: the authored poses.
        scale: Factors for the friction and mass of movable bodies in this episode. None: the house's values. Steps with
            `impl="c"` reject it, kinematic ones ignore it.

    Raises:
        ConfigError: Positions or angles do not have one row per agent or door.
    """
    _check_initial_poses(template.layout, agent_pos, agent_yaw, door_angle)
    house = bank.clip_house_index(house)
    layout, bodies = template.layout, movable_bodies(bank.physics, house)
    half = jnp.array([body.height / 2 for body in template.config.agents], jnp.float32)
    agents = jnp.concatenate([agent_pos.at[:, 2].add(half), agent_yaw[:, None]], axis=-1)
    placed = jnp.concatenate([bodies.pos, bodies.quat], axis=-1)
    if arrangement is not None and bank.physics.arrangement_pose.shape[1]:
        number = jnp.asarray(arrangement, jnp.int32)
        arranged = bank.physics.arrangement_pose[house, jnp.maximum(number, 0)]
        placed = jnp.where((bodies.valid & (number >= 0))[:, None], arranged, placed)
    angle = jnp.zeros(layout.num_doors, jnp.float32) if door_angle is None else door_angle
    still = jnp.zeros(layout.num_dofs, jnp.float32)
    nothing = jnp.full(layout.num_agents, -1, jnp.int32)
    upright = jnp.array([[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]], jnp.float32)
    return PhysicsState(
        qpos=jnp.concatenate([agents.reshape(-1), placed.reshape(-1), angle]),
        qvel=still,
        qacc=_awake_accelerations(layout),
        held=nothing,
        grip=jnp.tile(upright, (layout.num_agents, 1)),
        place_target=jnp.full((layout.num_agents, 3), jnp.inf, jnp.float32),
        hand_steps=jnp.zeros(layout.num_agents, jnp.int32),
        door_goal=jnp.full(layout.num_doors, NOT_DRIVEN, jnp.float32),
        num_contacts=jnp.zeros(layout.num_agents, jnp.int32),
        contact_impulse=jnp.zeros(layout.num_dynamic, jnp.float32),
        contact_pos=jnp.zeros((layout.num_dynamic, 3), jnp.float32),
        contact_partner=jnp.full(layout.num_dynamic, NOTHING, jnp.int32),
        scale=scale,
    )


def _check_initial_poses(layout: Layout, agent_pos: Array, agent_yaw: Array, door_angle: Array | None) -> None:
    """Raise `ConfigError` unless positions (a, 3), yaws (a) and door coordinates (h) or None have these shapes."""
    check_shape("agent_pos", jnp.shape(agent_pos), (layout.num_agents, 3))
    check_shape("agent_yaw", jnp.shape(agent_yaw), (layout.num_agents,))
    if door_angle is not None:
        check_shape("door_angle", jnp.shape(door_angle), (layout.num_doors,))


def _awake_accelerations(layout: Layout) -> Float[Array, " v"]:
    """Return the initial `qacc`: bodies fall by gravity, doors have `MIN_AWAKE_ACCELERATION`, agents 0.

    Unused bodies and doors have the same values as used ones. Bodies and doors whose velocity and acceleration are both
    zero would be asleep.
    """
    bodies = jnp.zeros((layout.num_bodies, 6), jnp.float32).at[:, 2].set(-GRAVITY)
    agents = jnp.zeros(4 * layout.num_agents, jnp.float32)
    doors = jnp.full(layout.num_doors, MIN_AWAKE_ACCELERATION, jnp.float32)
    return jnp.concatenate([agents, bodies.reshape(-1), doors])


def step(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> PhysicsState:
    """Advance the state by one control step, which is `config.timing.substeps` physics steps.

    `action` is the forward, left and counter-clockwise command of each agent in its own frame, clipped to [-1, 1]. It
    is a fraction of maximum speeds. In force control (`PhysicsConfig.control`), forward and left are fractions of
    `max_push_force` instead; kinematic physics has no force control.

    `house` is clipped to the bank. Held bodies follow their grips, and doors their goals; these fields of the state are
    unchanged, see `hand_control`. Overflows and NaN are not reported.

    Raises:
        ConfigError: The action does not have three numbers per agent, or the program is compiled for a platform that
            `PhysicsConfig.impl` does not support. Or `impl` is "c" and the state has scaled bodies.
    """
    return step_checked(template, bank, house, state, action)[0]


def step_checked(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Step as `step` does, with the same errors, and also report overflows of fixed-size contact buffers.

    Returns:
        The new state and the overflow flags. MJX reports overflow of contact pairs and contact points for the last
        physics step only; all other flags cover the whole control step. C MuJoCo reports all dropped contacts as
        contact points. A flag that an implementation lacks is False.
    """
    check_shape("action", jnp.shape(action), (template.layout.num_agents, 3))
    return STEPS[template.config.impl](template, bank.physics, bank.clip_house_index(house), state, action)


def with_agent_speed(template: Template, state: PhysicsState, action: Float[Array, "a 3"]) -> PhysicsState:
    """Return the state with each agent's velocity and yaw rate set to the action's target; vertical velocity is kept.

    `action` is that of `step`, but its shape is not checked and it is not clipped. It is a fraction of maximum speeds
    in force control, too. Kinematic physics does not use the velocities. In free space, a step with the same action
    then moves an agent that does not turn at exactly that velocity.
    """
    fastest = jnp.asarray(template.agents[:, FORWARD_SPEED : TURN_RATE + 1], jnp.float32)
    forward, left, turn = (action * fastest).T
    yaw, rows = agent_pose(template, state)[1], template.layout.agent_qpos
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    falling = state.qvel[rows].reshape(-1, 4)[:, 2]
    velocity = jnp.stack([cos * forward - sin * left, sin * forward + cos * left, falling, turn], axis=-1)
    return state.replace(qvel=state.qvel.at[rows].set(velocity.reshape(-1)))


def undo_where(broken: Bool[Array, ""], state: PhysicsState, before: PhysicsState) -> PhysicsState:
    """Return `before` if the scalar `broken` is True, else `state`; works inside `jit`.

    All fields are chosen together, so both states must have the same structure. Use `vmap` for a batch.
    """
    return jax.tree.map(lambda new, old: jnp.where(broken, old, new), state, before)


def is_unstable(state: PhysicsState) -> Bool[Array, ""]:
    """Return whether any element of `qpos` or `qvel` is NaN or at least `MAX_VALID_MAGNITUDE` in magnitude.

    Elements of unused bodies count, other fields do not. A batch of states gives one result: use `vmap`.
    """
    return ~(jnp.all(jnp.abs(state.qpos) < MAX_VALID_MAGNITUDE) & jnp.all(jnp.abs(state.qvel) < MAX_VALID_MAGNITUDE))


def is_out_of_bounds(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState
) -> Bool[Array, " m"]:
    """Return whether each agent, then each movable body, has left the lot by `qpos`; unused bodies are False.

    Its centre is outside the rectangle of the fence, or its lowest point more than `MIN_DEPTH_BELOW_FLOOR` below the
    ground floor. Bodies that fell through an upper floor only are not reported, nor NaN poses (see `is_unstable`).
    Doors have no element, so the length is that of agents and bodies. `house` is clipped to the bank.
    """
    physics, agents, house = bank.physics, agent_pose(template, state)[0], bank.clip_house_index(house)
    pos, quat = body_pose(template, state)
    upward = jax.vmap(quat_matrix)(quat)[:, 2]
    half = jnp.array([body.height / 2 for body in template.config.agents], jnp.float32)
    depth = jnp.concatenate([half, jnp.sum(jnp.abs(upward) * physics.body_size[house], axis=-1)])
    middle = jnp.concatenate([agents, pos])
    low, high = physics.fence_rectangle[house]
    beyond = jnp.any((middle[:, :2] < low[None]) | (middle[:, :2] > high[None]), axis=-1)
    under = middle[:, 2] - depth < physics.floor[house] - jnp.float32(MIN_DEPTH_BELOW_FLOOR)
    used = jnp.concatenate([jnp.ones(len(half), bool), physics.body_valid[house]])
    return used & (beyond | under)


def agent_pose(template: Template, state: PhysicsState) -> tuple[Float[Array, "a 3"], Float[Array, " a"]]:
    """Return a pair of each agent's centre in the world [m] and its yaw, not wrapped [rad], by `qpos`.

    The state is that of one environment: use `vmap` for a batch.
    """
    agents = state.qpos[template.layout.agent_qpos].reshape(-1, 4)
    return agents[:, :3], agents[:, 3]


def agent_velocity(template: Template, state: PhysicsState) -> Float[Array, "a 3"]:
    """Return each agent's forward and left velocity in its own frame [m/s], and its yaw rate [rad/s].

    Vertical velocity is left out. The state is that of one environment: use `vmap` for a batch.
    """
    _, yaw = agent_pose(template, state)
    velocity = state.qvel[template.layout.agent_qpos].reshape(-1, 4)
    x, y = velocity[:, 0], velocity[:, 1]
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([cos * x + sin * y, cos * y - sin * x, velocity[:, 3]], axis=-1)


def body_pose(template: Template, state: PhysicsState) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Return a pair of each movable body's centre [m] and orientation (wxyz) in the world, by `qpos`.

    Unused bodies are included, parked high above the house. Quaternions are not normalised. The state is that of one
    environment: use `vmap` for a batch.
    """
    bodies = state.qpos[template.layout.body_qpos].reshape(-1, 7)
    return bodies[:, :3], bodies[:, 3:]


def door_angle(template: Template, state: PhysicsState) -> Float[Array, " h"]:
    """Return each door's rotation about +z from its authored pose [rad], or the displacement of a sliding door [m].

    Unused doors keep the value of `reset`, but kinematic steps clip it to `PARKED_RANGE`. The state is that of one
    environment: use `vmap` for a batch.
    """
    return state.qpos[template.layout.door_qpos]


def agent_contact(template: Template, state: PhysicsState) -> Bool[Array, " a"]:
    """Return whether each agent touched anything but what carries it in the last control step; False after `reset`.

    Floors, ramps and static boxes below it carry it. Movable bodies, doors and other agents count. Kinematic physics
    ignores held bodies, and boxes that end less than its step height above the feet. `template` is not used.
    """
    return state.num_contacts > 0
