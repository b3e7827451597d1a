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


class Agents(Pytree):
    """Where agents are [m], as obstacles of one of them."""

    pos: Float[Array, "a 3"]
    other: Bool[Array, " a"]  # False for the one itself


def step_kinematic(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Lost]:
    """One control step; see `dynamics.step_checked`. Nothing is lost, and only agents move."""
    config, layout = template.config, template.layout
    agents = state.qpos[layout.agent_qpos].reshape(-1, 4)
    boxes = _obstacles(template, physics, house, state)
    steps = _num_steps(config)
    fastest = jnp.array([config.forward_speed, config.strafe_speed, config.turn_rate], jnp.float32)
    wanted = jnp.clip(action, -1.0, 1.0) * fastest[None] * jnp.float32(config.timing.ctrl_dt / steps)
    pos, yaw, touched = agents[:, :3], agents[:, 3], jnp.zeros(layout.num_agents, jnp.int32)
    for _ in range(steps):
        yaw = yaw + wanted[:, 2]
        cos, sin = jnp.cos(yaw), jnp.sin(yaw)
        x, y = cos * wanted[:, 0] - sin * wanted[:, 1], sin * wanted[:, 0] + cos * wanted[:, 1]
        way = jnp.stack([x, y, jnp.zeros_like(x)], axis=-1)
        slide = jax.vmap(lambda me, old, way, pos=pos: _slide(config, boxes, Agents(pos, ~me), old, way))
        pos, count = slide(jnp.eye(layout.num_agents, dtype=bool), pos, way)
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
    config: PhysicsConfig, boxes: Footprints, agents: Agents, old: Float[Array, "3"], way: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Int[Array, ""]]:
    """An agent's position after a short way, and how many obstacles it ran into."""
    pos = old + way
    depth = _depths(config, boxes, agents, pos)
    count = jnp.sum(depth > 0, dtype=jnp.int32)
    for _ in range(ROUNDS):
        pos = pos + _way_out(boxes, agents, pos, depth)
        depth = _depths(config, boxes, agents, pos)
    # In a gap that is too narrow it stays where it was, unless that was worse.
    deepest = depth.max()
    stays = (deepest > SLOP) & (_depths(config, boxes, agents, old).max() <= deepest)
    return jnp.where(stays, old, pos), count


def _depths(config: PhysicsConfig, boxes: Footprints, agents: Agents, pos: Float[Array, "3"]) -> Float[Array, " n"]:
    """How deep an agent is in each box and in each agent [m]; negative outside."""
    radius, length = jnp.float32(config.body.radius), jnp.float32(config.body.half_length)
    above = jnp.maximum(boxes.bottom - (pos[2] + length), pos[2] - length - boxes.top)
    above = jnp.clip(above, 0.0, radius)
    reach = jnp.sqrt(jnp.maximum(radius * radius - above * above, 1e-12))  # of the capsule at the box's height
    in_box = jnp.where(above < radius, reach - _beyond(boxes, pos)[0], -1.0)
    away = pos[None] - agents.pos
    apart = ~agents.other | (jnp.abs(away[:, 2]) > config.body.height)
    distance = jnp.sqrt(jnp.where(apart, 1.0, jnp.maximum(away[:, 0] ** 2 + away[:, 1] ** 2, 1e-12)))
    return jnp.concatenate([in_box, jnp.where(apart, -1.0, 2 * radius - distance)])


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
