"""Agents without dynamics: they move as told and slide along what is in the way. Things stay unless held.

What pure navigation needs, and what Habitat's agents do by default, at a small part of the cost of contacts.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import body_quat, quat_matrix, quat_multiply
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.physics.base.control import FORWARD_SPEED, HALF_LENGTH, RADIUS, TURN_RATE
from home_mjx.physics.base.servo import DOOR_SPEED, FREE
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.reference.house_model import house_doors
from home_mjx.physics.reference.lost import Lost
from home_mjx.physics.reference.slots import Boxes
from home_mjx.physics.reference.template import Template

ROUNDS = 3  # obstacles that an agent is moved out of, one after the other: a wall, a second one in a corner, a box
STEP_HEIGHT = 0.05  # [m], what agents step over
SLOP = 1e-3  # [m], that an agent may be in something after all rounds


class Footprints(Pytree):
    """Boxes with vertical sides; in the horizontal plane a box's own axes are u and v."""

    x: Float[Array, "*n"]  # [m], centre
    y: Float[Array, "*n"]
    cos: Float[Array, "*n"]  # of the heading of u
    sin: Float[Array, "*n"]
    half_u: Float[Array, "*n"]  # [m]
    half_v: Float[Array, "*n"]
    bottom: Float[Array, "*n"]  # [m]
    top: Float[Array, "*n"]

    @classmethod
    def of(cls, boxes: Boxes) -> "Footprints":
        """Exact for boxes with a vertical axis; others get the smallest such box around them with the same heading."""
        axes, half = boxes.axes, [boxes.half[..., k] for k in range(3)]
        x, y, steep = axes[0][0], axes[0][1], jnp.abs(axes[0][2])
        for axis in axes[1:]:  # the heading is that of the most level axis
            level = jnp.abs(axis[2]) < steep
            x, y = jnp.where(level, axis[0], x), jnp.where(level, axis[1], y)
            steep = jnp.minimum(steep, jnp.abs(axis[2]))
        length = jnp.sqrt(x * x + y * y)
        cos, sin = x / length, y / length
        half_u, half_v, rise = (jnp.zeros_like(cos) for _ in range(3))
        for axis, size in zip(axes, half, strict=True):
            half_u = half_u + jnp.abs(cos * axis[0] + sin * axis[1]) * size
            half_v = half_v + jnp.abs(cos * axis[1] - sin * axis[0]) * size
            rise = rise + jnp.abs(axis[2]) * size
        pos = [boxes.pos[..., k] for k in range(3)]
        return cls(pos[0], pos[1], cos, sin, half_u, half_v, pos[2] - rise, pos[2] + rise)


class Agents(Pytree):
    """Where agents are [m], and which of them is to move: the others are its obstacles."""

    pos: Float[Array, "a 3"]
    radius: Float[Array, " a"]  # [m]
    length: Float[Array, " a"]  # [m], half of the capsule's axis
    me: Int[Array, ""]

    @property
    def size(self) -> tuple[Array, Array]:
        """Radius and half length of the one that moves."""
        return self.radius[self.me], self.length[self.me]


def step_kinematic(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Lost]:
    """One control step; see `dynamics.step_checked`. Nothing is lost; agents, driven doors and held things move."""
    config, layout = template.config, template.layout
    agents = state.qpos[layout.agent_qpos].reshape(-1, 4)
    state = _turn_doors(template, physics, house, state)
    boxes = _obstacles(template, physics, house, state)
    steps = _num_steps(config)
    table = jnp.asarray(template.agents, jnp.float32)
    fastest = table[:, FORWARD_SPEED : TURN_RATE + 1]
    wanted = jnp.clip(action, -1.0, 1.0) * fastest * jnp.float32(config.timing.ctrl_dt / steps)
    sizes = table[:, RADIUS], table[:, HALF_LENGTH]
    pos, yaw, touched = agents[:, :3], agents[:, 3], jnp.zeros(layout.num_agents, jnp.int32)
    for _ in range(steps):
        yaw = yaw + wanted[:, 2]
        cos, sin = jnp.cos(yaw), jnp.sin(yaw)
        x, y = cos * wanted[:, 0] - sin * wanted[:, 1], sin * wanted[:, 0] + cos * wanted[:, 1]
        way = jnp.stack([x, y, jnp.zeros_like(x)], axis=-1)
        slide = jax.vmap(lambda me, old, way, pos=pos: _slide(boxes, Agents(pos, *sizes, me), old, way))
        pos, count = slide(jnp.arange(layout.num_agents, dtype=jnp.int32), pos, way)
        touched = jnp.maximum(touched, count)
    after = jnp.concatenate([pos, yaw[:, None]], axis=-1)
    speed = (after - agents) / jnp.float32(config.timing.ctrl_dt)
    qpos = state.qpos.at[layout.agent_qpos].set(after.reshape(-1))
    still = jnp.zeros_like(state.qvel)
    qvel = still.at[layout.agent_qpos].set(speed.reshape(-1))
    qpos = _with_held(template, state, qpos)
    no = jnp.zeros((), bool)
    return state.replace(qpos=qpos, qvel=qvel, qacc=still, touched=touched), Lost(no, no, no)


def _num_steps(config: PhysicsConfig) -> int:
    """So many that an agent moves by less than its radius in each: it cannot pass through anything."""
    dt = config.timing.ctrl_dt
    return max(max(math.ceil(math.hypot(b.forward_speed, b.strafe_speed) * dt / b.radius) for b in config.agents), 1)


def _obstacles(template: Template, physics: Physics, house: Array, state: PhysicsState) -> Footprints:
    """Static boxes and movable bodies that agents do not step over."""
    every = Footprints.of(Boxes(physics.collider_pos, physics.collider_quat, physics.collider_size))
    static = jax.tree.map(lambda x: x[house], every)
    bodies = state.qpos[template.layout.body_qpos].reshape(-1, 7)
    movable = Footprints.of(Boxes(bodies[:, :3], bodies[:, 3:], physics.body_size[house]))
    held = (jnp.arange(bodies.shape[0], dtype=jnp.int32)[:, None] == state.held[None]).any(axis=-1)
    movable = movable.replace(bottom=jnp.where(held, jnp.inf, movable.bottom))
    leaves = house_doors(physics, house)
    shut = Footprints.of(Boxes(*leaves.turned(state.qpos[template.layout.door_qpos]), leaves.size))
    every = jax.tree.map(lambda *x: jnp.concatenate(x), static, movable, shut)
    low = every.top < physics.floor[house] + jnp.float32(STEP_HEIGHT)
    return every.replace(bottom=jnp.where(low, jnp.inf, every.bottom))


def _turn_doors(template: Template, physics: Physics, house: Array, state: PhysicsState) -> PhysicsState:
    """Turns doors towards their goals."""
    at, most = template.layout.door_qpos, jnp.float32(DOOR_SPEED * template.config.timing.ctrl_dt)
    leaves, angle = house_doors(physics, house), state.qpos[at]
    goal = jnp.clip(state.goal, leaves.low, leaves.high)
    turned = angle + jnp.clip(goal - angle, -most, most)
    return state.replace(qpos=state.qpos.at[at].set(jnp.where(state.goal < FREE, turned, angle)))


def _with_held(template: Template, state: PhysicsState, qpos: Float[Array, " q"]) -> Float[Array, " q"]:
    """Puts what agents hold into their hands."""
    layout = template.layout
    if not layout.num_bodies:
        return qpos
    rows = qpos[layout.body_qpos].reshape(-1, 7)
    for a in range(layout.num_agents):
        agent, grip = qpos[4 * a : 4 * a + 4], state.grip[a]
        turn = body_quat(agent[3])
        pos = agent[:3] + jnp.matmul(quat_matrix(turn), grip[:3], precision="highest")
        row = jnp.concatenate([pos, quat_multiply(turn, grip[3:])])
        body = jnp.where(state.held[a] >= 0, state.held[a], layout.num_bodies)
        rows = rows.at[body].set(row, mode="drop")
    return qpos.at[layout.body_qpos].set(rows.reshape(-1))


def _slide(
    boxes: Footprints, agents: Agents, old: Float[Array, "3"], way: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Int[Array, ""]]:
    """An agent's position after a short way, and how many obstacles it ran into."""
    pos = old + way
    depth = _depths(boxes, agents, pos)
    count = jnp.sum(depth > 0, dtype=jnp.int32)
    for _ in range(ROUNDS):
        pos = pos + _way_out(boxes, agents, pos, depth)
        depth = _depths(boxes, agents, pos)
    # In a gap that is too narrow it stays where it was, unless that was worse.
    deepest = depth.max()
    stays = (deepest > SLOP) & (_depths(boxes, agents, old).max() <= deepest)
    return jnp.where(stays, old, pos), count


def _depths(boxes: Footprints, agents: Agents, pos: Float[Array, "3"]) -> Float[Array, " n"]:
    """How deep an agent is in each box and in each agent [m]; negative outside."""
    radius, length = agents.size
    above = jnp.maximum(boxes.bottom - (pos[2] + length), pos[2] - length - boxes.top)
    above = jnp.clip(above, 0.0, radius)
    reach = jnp.sqrt(jnp.maximum(radius * radius - above * above, 1e-12))  # of the capsule at the box's height
    in_box = jnp.where(above < radius, reach - _beyond(boxes, pos)[0], -1.0)
    away = pos[None] - agents.pos
    own = jnp.arange(agents.radius.shape[0], dtype=jnp.int32) == agents.me
    apart = own | (jnp.abs(away[:, 2]) > agents.length + agents.radius + length + radius)
    distance = jnp.sqrt(jnp.where(apart, 1.0, jnp.maximum(away[:, 0] ** 2 + away[:, 1] ** 2, 1e-12)))
    return jnp.concatenate([in_box, jnp.where(apart, -1.0, agents.radius + radius - distance)])


def _beyond(boxes: Footprints, pos: Float[Array, "3"]) -> tuple[Array, Array, Array]:
    """Distance from the sides of boxes [m], negative inside, and its direction along u and v."""
    x, y = pos[0] - boxes.x, pos[1] - boxes.y
    u, v = boxes.cos * x + boxes.sin * y, boxes.cos * y - boxes.sin * x
    beyond_u, beyond_v = jnp.abs(u) - boxes.half_u, jnp.abs(v) - boxes.half_v
    out_u, out_v = jnp.maximum(beyond_u, 0.0), jnp.maximum(beyond_v, 0.0)
    square = out_u * out_u + out_v * out_v
    inside, along_u = square == 0, jnp.where(beyond_u > beyond_v, 1.0, 0.0)
    distance = jnp.sqrt(jnp.where(inside, 1.0, square))
    toward_u = jnp.sign(u) * jnp.where(inside, along_u, out_u / distance)
    toward_v = jnp.sign(v) * jnp.where(inside, 1.0 - along_u, out_v / distance)
    return jnp.where(inside, jnp.maximum(beyond_u, beyond_v), distance), toward_u, toward_v


def _way_out(boxes: Footprints, agents: Agents, pos: Float[Array, "3"], depth: Float[Array, " n"]) -> Array:
    """Out of what the agent is in the deepest."""
    worst, num_boxes = jnp.argmax(depth), boxes.x.shape[0]
    box = jax.tree.map(lambda x: x[jnp.minimum(worst, num_boxes - 1)], boxes)
    _, u, v = _beyond(box, pos)
    away = pos - agents.pos[jnp.maximum(worst - num_boxes, 0)]
    length = jnp.sqrt(jnp.maximum(away[0] ** 2 + away[1] ** 2, 1e-12))
    from_box = jnp.stack([box.cos * u - box.sin * v, box.sin * u + box.cos * v, jnp.zeros_like(u)])
    from_agent = jnp.stack([away[0] / length, away[1] / length, jnp.zeros_like(u)])
    return jnp.maximum(depth[worst], 0.0) * jnp.where(worst < num_boxes, from_box, from_agent)
