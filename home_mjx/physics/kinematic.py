"""Agents without dynamics: they move as told and slide along what is in the way. Things stay where they are.

What pure navigation needs, and what Habitat's agents do by default, at a small part of the cost of contacts.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.physics.base.state import PhysicsState
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


class Push(Pytree):
    """How deep an agent is in an obstacle [m], negative outside, and the way out."""

    depth: Float[Array, "*n"]
    x: Float[Array, "*n"]
    y: Float[Array, "*n"]


def step_kinematic(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Lost]:
    """One control step; see `dynamics.step_checked`. Nothing is lost, and only agents move."""
    config, layout = template.config, template.layout
    agents = state.qpos[layout.agent_qpos].reshape(-1, 4)
    obstacles = _obstacles(template, physics, house, state)
    steps = _num_steps(config)
    fastest = jnp.array([config.forward_speed, config.strafe_speed, config.turn_rate], jnp.float32)
    wanted = jnp.clip(action, -1.0, 1.0) * fastest[None] * jnp.float32(config.timing.ctrl_dt / steps)
    pos, yaw, touched = agents[:, :3], agents[:, 3], jnp.zeros(layout.num_agents, jnp.int32)
    for _ in range(steps):
        yaw = yaw + wanted[:, 2]
        cos, sin = jnp.cos(yaw), jnp.sin(yaw)
        x, y = cos * wanted[:, 0] - sin * wanted[:, 1], sin * wanted[:, 0] + cos * wanted[:, 1]
        others = pos
        moved = jax.vmap(lambda number, old, x, y: _slide(config, obstacles, others, number, old, x, y))  # noqa: B023
        pos, count = moved(jnp.arange(layout.num_agents), pos, x, y)
        touched = jnp.maximum(touched, count)
    after = jnp.concatenate([pos, yaw[:, None]], axis=-1)
    speed = (after - agents) / jnp.float32(config.timing.ctrl_dt)
    qpos = state.qpos.at[layout.agent_qpos].set(after.reshape(-1))
    still = jnp.zeros_like(state.qvel)
    qvel = still.at[layout.agent_qpos].set(speed.reshape(-1))
    no = jnp.zeros((), bool)
    return PhysicsState(qpos=qpos, qvel=qvel, qacc=still, touched=touched), Lost(no, no, no)


def _num_steps(config: PhysicsConfig) -> int:
    """So many that an agent moves by less than its radius in each: it cannot pass through anything."""
    farthest = math.hypot(config.forward_speed, config.strafe_speed) * config.timing.ctrl_dt
    return max(math.ceil(farthest / config.body.radius), 1)


def _obstacles(template: Template, physics: Physics, house: Array, state: PhysicsState) -> Footprints:
    """Static boxes and movable bodies that agents do not step over."""
    every = Footprints.of(Boxes(physics.collider_pos, physics.collider_quat, physics.collider_size))
    static = jax.tree.map(lambda x: x[house], every)
    bodies = state.qpos[template.layout.body_qpos].reshape(-1, 7)
    movable = Footprints.of(Boxes(bodies[:, :3], bodies[:, 3:], physics.body_size[house]))
    both = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), static, movable)
    low = both.top < physics.floor[house] + jnp.float32(STEP_HEIGHT)
    return both.replace(bottom=jnp.where(low, jnp.inf, both.bottom))


def _slide(
    config: PhysicsConfig, obstacles: Footprints, others: Array, number: Array, old: Array, x: Array, y: Array
) -> tuple[Float[Array, "3"], Int[Array, ""]]:
    """An agent's position after a short way, and how many obstacles it ran into."""
    pos = old + jnp.stack([x, y, jnp.zeros_like(x)])
    aside = jnp.arange(others.shape[0]) == number

    def pushes(pos: Array) -> Push:
        boxes, agents = _out_of_boxes(config, obstacles, pos), _out_of_agents(config, others, aside, pos)
        return jax.tree.map(lambda a, b: jnp.concatenate([a, b]), boxes, agents)

    push = pushes(pos)
    count = jnp.sum(push.depth > 0, dtype=jnp.int32)
    for _ in range(ROUNDS):
        worst = jnp.argmax(push.depth)
        way = jnp.maximum(push.depth[worst], 0.0)
        pos = pos + jnp.stack([way * push.x[worst], way * push.y[worst], jnp.zeros_like(way)])
        push = pushes(pos)
    # In a gap that is too narrow it stays where it was, unless that was worse.
    deepest = push.depth.max()
    stays = (deepest > SLOP) & (pushes(old).depth.max() <= deepest)
    return jnp.where(stays, old, pos), count


def _out_of_boxes(config: PhysicsConfig, boxes: Footprints, pos: Float[Array, "3"]) -> Push:
    radius, length = jnp.float32(config.body.radius), jnp.float32(config.body.half_length)
    above = jnp.maximum(boxes.bottom - (pos[2] + length), pos[2] - length - boxes.top)
    above = jnp.clip(above, 0.0, radius)
    reach = jnp.sqrt(radius * radius - above * above)  # of the capsule at the box's height
    x, y = pos[0] - boxes.x, pos[1] - boxes.y
    u, v = boxes.cos * x + boxes.sin * y, boxes.cos * y - boxes.sin * x
    beyond_u, beyond_v = jnp.abs(u) - boxes.half_u, jnp.abs(v) - boxes.half_v
    out_u, out_v = jnp.maximum(beyond_u, 0.0), jnp.maximum(beyond_v, 0.0)
    square = out_u * out_u + out_v * out_v
    inside, along_u = square == 0, jnp.where(beyond_u > beyond_v, 1.0, 0.0)
    distance = jnp.sqrt(jnp.where(inside, 1.0, square))
    normal_u = jnp.sign(u) * jnp.where(inside, along_u, out_u / distance)
    normal_v = jnp.sign(v) * jnp.where(inside, 1.0 - along_u, out_v / distance)
    depth = reach - jnp.where(inside, jnp.maximum(beyond_u, beyond_v), distance)
    depth = jnp.where(above < radius, depth, -1.0)
    return Push(depth, boxes.cos * normal_u - boxes.sin * normal_v, boxes.sin * normal_u + boxes.cos * normal_v)


def _out_of_agents(config: PhysicsConfig, others: Float[Array, "a 3"], aside: Bool[Array, " a"], pos: Array) -> Push:
    away = pos[None] - others
    square = away[:, 0] ** 2 + away[:, 1] ** 2
    distance = jnp.sqrt(jnp.where(square > 0, square, 1.0))
    apart = aside | (jnp.abs(away[:, 2]) > config.body.height)
    depth = jnp.where(apart, -1.0, 2 * jnp.float32(config.body.radius) - jnp.sqrt(square))
    return Push(depth, away[:, 0] / distance, away[:, 1] / distance)
