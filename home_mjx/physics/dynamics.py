"""How bodies are put into a house and stepped, and what there is to know of them."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_shape
from home_mjx.physics.base.control import FORWARD_SPEED, TURN_RATE
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.servo import FREE, GRAVITY
from home_mjx.physics.base.state import AWAKE, PhysicsState, Scale
from home_mjx.physics.base.touch import NOTHING
from home_mjx.physics.fused import step_fused
from home_mjx.physics.kinematic.step import step_kinematic
from home_mjx.physics.mjx.house_model import movable_bodies
from home_mjx.physics.mjx.overflow import Lost
from home_mjx.physics.mjx.step import step_mjx
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mujoco.step import step_c

STEPS = {"fused": step_fused, "jax": step_mjx, "c": step_c, "kinematic": step_kinematic}
ABSURD = 1e6  # [m], [rad] and per second


def reset(
    template: Template,
    bank: HouseBank,
    house: Int[Array, ""],
    agent_pos: Float[Array, "a 3"],
    agent_yaw: Float[Array, " a"],
    door_angle: Float[Array, " h"] | None = None,
    arrangement: Int[Array, ""] | int | None = None,
    scale: Scale | None = None,
) -> PhysicsState:
    """Agents, movable bodies and doors at rest at their starting poses, hands empty.

    Args:
        template: The model.
        bank: The houses.
        house: Index of the house.
        agent_pos: [m], feet on the floor.
        agent_yaw: [rad], counter-clockwise from +x.
        door_angle: [rad], about +z from as placed, or [m] of what slides; None: as placed.
        arrangement: Which of the house's settled poses bodies have, see `arrangements.settled_poses`; -1 or None: they
            are where the house has them.
        scale: Of friction and mass of bodies in this episode; None: as the house has them.

    Raises:
        ConfigError: Positions or angles are not one per agent or door.
    """
    _check_places(template.layout, agent_pos, agent_yaw, door_angle)
    layout, bodies = template.layout, movable_bodies(bank.physics, house)
    half = jnp.array([body.height / 2 for body in template.config.agents], jnp.float32)
    agents = jnp.concatenate([agent_pos.at[:, 2].add(half), agent_yaw[:, None]], axis=-1)
    placed = jnp.concatenate([bodies.pos, bodies.quat], axis=-1)
    if arrangement is not None and bank.physics.arrangement.shape[1]:
        number = jnp.asarray(arrangement, jnp.int32)
        arranged = bank.physics.arrangement[house, jnp.maximum(number, 0)]
        placed = jnp.where((bodies.valid & (number >= 0))[:, None], arranged, placed)
    angle = jnp.zeros(layout.num_doors, jnp.float32) if door_angle is None else door_angle
    still = jnp.zeros(layout.num_dofs, jnp.float32)
    nothing = jnp.full(layout.num_agents, -1, jnp.int32)
    upright = jnp.array([[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]], jnp.float32)
    return PhysicsState(
        qpos=jnp.concatenate([agents.reshape(-1), placed.reshape(-1), angle]),
        qvel=still,
        qacc=_falling(layout),
        held=nothing,
        grip=jnp.tile(upright, (layout.num_agents, 1)),
        spot=jnp.full((layout.num_agents, 3), jnp.inf, jnp.float32),
        tries=jnp.zeros(layout.num_agents, jnp.int32),
        goal=jnp.full(layout.num_doors, FREE, jnp.float32),
        touched=jnp.zeros(layout.num_agents, jnp.int32),
        impulse=jnp.zeros(layout.num_mobiles, jnp.float32),
        place=jnp.zeros((layout.num_mobiles, 3), jnp.float32),
        other=jnp.full(layout.num_mobiles, NOTHING, jnp.int32),
        scale=scale,
    )


def _check_places(layout: Layout, agent_pos: Array, agent_yaw: Array, door_angle: Array | None) -> None:
    check_shape("agent_pos", jnp.shape(agent_pos), (layout.num_agents, 3))
    check_shape("agent_yaw", jnp.shape(agent_yaw), (layout.num_agents,))
    if door_angle is not None:
        check_shape("door_angle", jnp.shape(door_angle), (layout.num_doors,))


def _falling(layout: Layout) -> Float[Array, " v"]:
    """Accelerations of what has not come to rest yet: what has zeros sleeps."""
    bodies = jnp.zeros((layout.num_bodies, 6), jnp.float32).at[:, 2].set(-GRAVITY)
    agents, doors = jnp.zeros(4 * layout.num_agents, jnp.float32), jnp.full(layout.num_doors, AWAKE, jnp.float32)
    return jnp.concatenate([agents, bodies.reshape(-1), doors])


def step(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> PhysicsState:
    """One control step: `config.timing.substeps` physics steps.

    Args:
        template: The model.
        bank: The houses.
        house: Index of the house.
        state: The state before.
        action: Forward, strafe to the left, turn to the left in the agent's own frame, in [-1, 1] of its fastest rate.

    Returns:
        The state after.

    Raises:
        ConfigError: The action has not three numbers per agent, or the program is made for something that
            `PhysicsConfig.impl` does not work on.
    """
    return step_checked(template, bank, house, state, action)[0]


def step_checked(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Lost]:
    """`step`, and what it left out because it did not fit: of contacts, in the last physics step."""
    check_shape("action", jnp.shape(action), (template.layout.num_agents, 3))
    return STEPS[template.config.impl](template, bank.physics, house, state, action)


def with_agent_speed(template: Template, state: PhysicsState, action: Float[Array, "a 3"]) -> PhysicsState:
    """The state with agents that have the speed that an action asks for; those that fall go on falling.

    In free space a step with the same action then takes them exactly as far as that speed does.

    Args:
        template: The model.
        state: The state.
        action: As for `step`.
    """
    fastest = jnp.asarray(template.agents[:, FORWARD_SPEED : TURN_RATE + 1], jnp.float32)
    forward, left, turn = (action * fastest).T
    yaw, rows = agent_pose(template, state)[1], template.layout.agent_qpos
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    falling = state.qvel[rows].reshape(-1, 4)[:, 2]
    velocity = jnp.stack([cos * forward - sin * left, sin * forward + cos * left, falling, turn], axis=-1)
    return state.replace(qvel=state.qvel.at[rows].set(velocity.reshape(-1)))


def undo_where(broken: Bool[Array, ""], state: PhysicsState, before: PhysicsState) -> PhysicsState:
    """The state before a step where the step has broken it."""
    return jax.tree.map(lambda new, old: jnp.where(broken, old, new), state, before)


def is_broken(state: PhysicsState) -> Bool[Array, ""]:
    """Whether a pose or a speed is not a number, or one that nothing in a house can have."""
    return ~(jnp.all(jnp.abs(state.qpos) < ABSURD) & jnp.all(jnp.abs(state.qvel) < ABSURD))


def agent_pose(template: Template, state: PhysicsState) -> tuple[Float[Array, "a 3"], Float[Array, " a"]]:
    """Centre of each agent's capsule [m] and its yaw [rad]."""
    agents = state.qpos[template.layout.agent_qpos].reshape(-1, 4)
    return agents[:, :3], agents[:, 3]


def agent_velocity(template: Template, state: PhysicsState) -> Float[Array, "a 3"]:
    """Each agent's velocity forward and to the left [m/s] and its yaw rate [rad/s]."""
    _, yaw = agent_pose(template, state)
    velocity = state.qvel[template.layout.agent_qpos].reshape(-1, 4)
    x, y = velocity[:, 0], velocity[:, 1]
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([cos * x + sin * y, cos * y - sin * x, velocity[:, 3]], axis=-1)


def body_pose(template: Template, state: PhysicsState) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Centre [m] and orientation (wxyz) of each movable body; unused ones are parked high above the house."""
    bodies = state.qpos[template.layout.body_qpos].reshape(-1, 7)
    return bodies[:, :3], bodies[:, 3:]


def door_angle(template: Template, state: PhysicsState) -> Float[Array, " h"]:
    """How far each door's leaf is turned about +z from as placed [rad]; of a sliding one how far it is shifted [m]."""
    return state.qpos[template.layout.door_qpos]


def agent_contact(template: Template, state: PhysicsState) -> Bool[Array, " a"]:
    """Whether each agent touched anything but the floor during the last control step."""
    return state.touched > 0
