"""Control step without dynamics."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.transforms import quat_matrix, quat_multiply, yaw_quat
from home_mjx.errors import ConfigError
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.control import FORWARD_SPEED, HALF_LENGTH, RADIUS, TURN_RATE
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.kinematic.contact_stop import move_and_stop
from home_mjx.physics.kinematic.doors import drive_doors, leaf_boxes, push_doors
from home_mjx.physics.kinematic.footprints import AgentCapsules, Footprints, move_and_slide
from home_mjx.physics.kinematic.support import MAX_SUPPORT_OVERLAP, drop_released_bodies, support_height
from home_mjx.physics.mjx.contact_slots import OrientedBoxes
from home_mjx.physics.mjx.house_model import house_doors
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template

MAX_SUBSTEPS = 100  # maximum number of substeps, which are unrolled in the program
# [m], maximum height above an agent's feet of boxes that do not stop it, and on which it steps. It exceeds the rounding
# of float32: the floor on which an agent stands is never an obstacle.
MAX_STEP_HEIGHT = MAX_SUPPORT_OVERLAP


def step_in_jax(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Advance agents, doors and held or released bodies by one control step; see `dynamics.step_checked`.

    Agents have their commanded speeds at once, and the height of their support after each substep: they never fall.
    They slide along obstacles, or stop at contact without `allow_sliding`.
    `control`, forces, masses, friction and `state.scale` are ignored. `house` must be a valid index, as it is not
    clipped.

    Drawers are boxes around front and tray. Doors are driven first and then pushed by agents, which move in substeps;
    see `num_substeps`. Held bodies are set to their grips and released ones dropped at the end. Velocities are
    displacements divided by the step's length; only agents have one. `qacc` is 0. `num_contacts` is the maximum over
    substeps of the obstacles that an agent touches at once. Contacts have no impulses: these fields are unchanged.
    Nothing overflows.
    """
    config, layout = template.config, template.layout
    agents, leaves = state.qpos[layout.agent_qpos].reshape(-1, 4), house_doors(physics, house, trays=True)
    angle = drive_doors(leaves, state.qpos[layout.door_qpos], state.door_goal, config.timing.ctrl_dt)
    fixed, steps = _obstacles(template, physics, house, state), num_substeps(config)
    table = jnp.asarray(template.agents, jnp.float32)
    fastest, sizes = table[:, FORWARD_SPEED : TURN_RATE + 1], (table[:, RADIUS], table[:, HALF_LENGTH])
    wanted = jnp.clip(action, -1.0, 1.0) * fastest * jnp.float32(config.timing.ctrl_dt / steps)
    level = _static_footprints(physics, house)
    half, floor, ramps = table[:, RADIUS] + table[:, HALF_LENGTH], physics.floor[house], physics.ramp[house]
    stand = jax.vmap(lambda at, h: support_height(level, ramps, floor, at, at[2] - h))
    step_up = stand(agents[:, :3], half)[1]
    move = move_and_slide if config.allow_sliding else move_and_stop
    pos, yaw, touched = agents[:, :3], agents[:, 3], jnp.zeros(layout.num_agents, jnp.int32)
    for _ in range(steps):
        yaw = yaw + wanted[:, 2]
        cos, sin = jnp.cos(yaw), jnp.sin(yaw)
        x, y = cos * wanted[:, 0] - sin * wanted[:, 1], sin * wanted[:, 0] + cos * wanted[:, 1]
        way = jnp.stack([x, y, jnp.zeros_like(x)], axis=-1)
        angle = push_doors(leaves, angle, pos + way, sizes[0], half)
        boxes = jax.tree.map(lambda *x: jnp.concatenate(x), fixed, Footprints.from_boxes(leaf_boxes(leaves, angle)))
        one = jax.vmap(
            lambda me, old, way, pos=pos, boxes=boxes, step_up=step_up: move(
                boxes.without_boxes_below(old[2] - half[me] + jnp.maximum(step_up[me], jnp.float32(MAX_STEP_HEIGHT))),
                AgentCapsules(pos, *sizes, me),
                old,
                way,
            )
        )
        pos, count = one(jnp.arange(layout.num_agents, dtype=jnp.int32), pos, way)
        ground, step_up = stand(pos, half)
        pos = pos.at[:, 2].set(ground + half)
        touched = jnp.maximum(touched, count)
    after = jnp.concatenate([pos, yaw[:, None]], axis=-1)
    speed = (after - agents) / jnp.float32(config.timing.ctrl_dt)
    still = jnp.zeros_like(state.qvel)
    qpos = state.qpos.at[layout.agent_qpos].set(after.reshape(-1)).at[layout.door_qpos].set(angle)
    qvel = still.at[layout.agent_qpos].set(speed.reshape(-1))
    no = jnp.zeros((), bool)
    qpos = _place_held_bodies(template, state, qpos)
    if layout.num_bodies:
        qpos = drop_released_bodies(template, physics, house, state, qpos, fixed)
    moved = state.replace(qpos=qpos, qvel=qvel, qacc=still, num_contacts=touched)
    return moved, Overflow(no, no, no)


def num_substeps(config: PhysicsSetup) -> int:
    """Return the number of substeps, in each of which no agent moves farther than its radius, against tunnelling.

    It is common to all agents, and at least 1. It is computed from maximum speeds, not from actions.

    Raises:
        ConfigError: It exceeds `MAX_SUBSTEPS`.
    """
    dt = config.timing.ctrl_dt
    steps = max(1, *(math.ceil(math.hypot(b.forward_speed, b.strafe_speed) * dt / b.radius) for b in config.agents))
    if steps > MAX_SUBSTEPS:
        raise ConfigError(
            f"a kinematic agent may move by {MAX_SUBSTEPS} times its radius in a control step, not by {steps} times",
            element="PhysicsSetup.body",
            hint="Lower `forward_speed` and `strafe_speed`, or `ctrl_dt`.",
        )
    return steps


def _obstacles(template: Template, physics: Physics, house: Array, state: PhysicsState) -> Footprints:
    """Return static boxes, then movable bodies, unused ones too; `bottom` and `top` of ramps and held bodies are inf.

    They are thus neither obstacles nor supports; see `support_height` for ramps. Doors are not included. Bodies are at
    their poses in `state.qpos`.
    """
    static = _static_footprints(physics, house)
    bodies = state.qpos[template.layout.body_qpos].reshape(-1, 7)
    movable = Footprints.from_boxes(OrientedBoxes(bodies[:, :3], bodies[:, 3:], physics.body_size[house]))
    held = (jnp.arange(bodies.shape[0], dtype=jnp.int32)[:, None] == state.held[None]).any(axis=-1)
    movable = movable.replace(**{side: jnp.where(held, jnp.inf, getattr(movable, side)) for side in ("bottom", "top")})
    return jax.tree.map(lambda *x: jnp.concatenate(x), static, movable)


def _static_footprints(physics: Physics, house: Array) -> Footprints:
    """Return the static boxes of a house; ramps are disabled as obstacles (`bottom` inf) and supports (`top` inf).

    Rows are those of the bank, padding far below included.
    """
    every = Footprints.from_boxes(OrientedBoxes(physics.collider_pos, physics.collider_quat, physics.collider_size))
    row = jnp.arange(every.x.shape[1], dtype=jnp.int32)
    is_ramp = jnp.any(row[None, :, None] == physics.ramp_collider[:, None], axis=-1)
    every = every.replace(**{side: jnp.where(is_ramp, jnp.inf, getattr(every, side)) for side in ("bottom", "top")})
    return jax.tree.map(lambda x: x[house], every)


def _place_held_bodies(template: Template, state: PhysicsState, qpos: Float[Array, " q"]) -> Float[Array, " q"]:
    """Return `qpos` with held bodies at their grips, by their holders' poses in it; other elements are unchanged.

    Obstacles do not stop held bodies. Of two agents that hold one body, the last has it.
    """
    layout = template.layout
    if not layout.num_bodies:
        return qpos
    rows = qpos[layout.body_qpos].reshape(-1, 7)
    for a in range(layout.num_agents):
        agent, grip = qpos[4 * a : 4 * a + 4], state.grip[a]
        turn = yaw_quat(agent[3])
        pos = agent[:3] + jnp.matmul(quat_matrix(turn), grip[:3], precision="highest")
        row = jnp.concatenate([pos, quat_multiply(turn, grip[3:])])
        body = jnp.where(state.held[a] >= 0, state.held[a], layout.num_bodies)
        rows = rows.at[body].set(row, mode="drop")
    return qpos.at[layout.body_qpos].set(rows.reshape(-1))
