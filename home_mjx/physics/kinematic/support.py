"""Support heights: below released bodies, and below agents on stairs and upper floors."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics.base.servo import MAX_RAMP_GAP, ramp_coordinates
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.physics.mjx.template import Template

# [m], maximum height of a support above the bottom of what it carries; also the step height of agents
MAX_SUPPORT_OVERLAP = 0.05
MAX_SUPPORT_REACH = 0.01  # [m], by which supports reach beyond their edges: floors consist of parts with cracks between


def drop_released_bodies(
    template: Template,
    physics: Physics,
    house: Int[Array, ""],
    state: PhysicsState,
    qpos: Float[Array, " q"],
    boxes: Footprints,
) -> Float[Array, " q"]:
    """Return `qpos` with released bodies dropped straight down onto their highest support, at most one per agent.

    `state` is that before the step. Each body with a nonzero velocity there counts as released, even one held again by
    now. `boxes` are possible supports: the static boxes, then the movable bodies. Doors are no supports, ramps of the
    house are. One supports a body if the body's centre is over it or at most `MAX_SUPPORT_REACH` beside it. Its top
    must be at most `MAX_SUPPORT_OVERLAP` above the body's bottom. The top of a ramp is its height at the body's centre.
    A body without a support rests on the ground floor. Other tilted boxes support at the height of their highest corner
    only. If more bodies were released than there are agents, the fastest drop and the others stay in the air. Only z
    changes, also of thrown bodies. There must be at least one movable body.
    """
    layout = template.layout
    rows = qpos[layout.body_qpos].reshape(-1, 7)
    speed = jnp.max(jnp.abs(state.qvel[layout.body_qvel].reshape(-1, 6)), axis=-1)
    for _ in range(layout.num_agents):
        body = jnp.argmax(speed)
        pos, quat = rows[body, :3], rows[body, 3:]
        half = jnp.matmul(jnp.abs(quat_matrix(quat)), physics.body_size[house, body], precision="highest")[2]
        own = jnp.arange(boxes.x.shape[0], dtype=jnp.int32) == boxes.x.shape[0] - layout.num_bodies + body
        others = boxes.replace(top=jnp.where(own, jnp.inf, boxes.top))
        bottom = pos[2] - half
        surface = _ramp_heights(physics.ramp[house], pos)
        below = jnp.where(surface <= bottom + jnp.float32(MAX_SUPPORT_OVERLAP), surface, -jnp.inf)
        height = jnp.maximum(_box_support(others, pos, bottom), jnp.max(below))
        height = jnp.maximum(height, physics.floor[house])
        rows = rows.at[body, 2].set(jnp.where(speed[body] > 0, height + half, pos[2]))
        speed = speed.at[body].set(0.0)
    return qpos.at[layout.body_qpos].set(rows.reshape(-1))


def support_height(
    boxes: Footprints,
    ramps: Float[Array, "r 8"],
    floor: Float[Array, ""],
    pos: Float[Array, "3"],
    foot: Float[Array, ""],
) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Return the height of the highest support under one agent's centre: ground floor, ramp, or box to step on.

    `ramps` are rows of `bank.physics.ramp`, `floor` is the ground floor's height, `pos` the agent's centre, `foot` its
    lowest height [m]. Ramps count within `MAX_RAMP_GAP` of that, boxes up to `MAX_SUPPORT_OVERLAP` above it and at any
    depth below. Both reach `MAX_SUPPORT_REACH` beyond their edges, level with these. The ground floor is everywhere, so
    the height is never below it. There must be at least one box and one row of `ramps`; padding there is no support.

    Returns:
        Height of the support [m], and an extra step height below which obstacles do not stop the agent [m]. The latter
        is `MAX_RAMP_GAP` on ramps, else 0. An agent meets the edge of a ramp's upper floor before it is that high.
    """
    surface = _ramp_heights(ramps, pos)
    on = jnp.abs(surface - foot) < jnp.float32(MAX_RAMP_GAP)
    highest = jnp.max(jnp.where(on, surface, -jnp.inf))
    height = jnp.maximum(jnp.maximum(_box_support(boxes, pos, foot), highest), floor)
    return height, jnp.where(jnp.any(on), jnp.float32(MAX_RAMP_GAP), 0.0)


def _ramp_heights(ramps: Float[Array, "r 8"], pos: Float[Array, "3"]) -> Float[Array, " r"]:
    """Return each ramp's height at a point in plan [m]; -inf for padding and more than `MAX_SUPPORT_REACH` beside it.

    Beyond its lower or upper end, a ramp is level with that end. The height of the point is ignored.
    """
    half_u, half_v, slope, reach = ramps[:, 4], ramps[:, 5], ramps[:, 7], jnp.float32(MAX_SUPPORT_REACH)
    along, across, surface = ramp_coordinates(ramps, pos)
    surface = surface - slope * (along - jnp.clip(along, -half_u, half_u))
    on = (half_u > 0) & (jnp.abs(along) <= half_u + reach) & (jnp.abs(across) <= half_v + reach)
    return jnp.where(on, surface, -jnp.inf)


def _box_support(boxes: Footprints, pos: Float[Array, "3"], bottom: Float[Array, ""]) -> Float[Array, ""]:
    """Return the highest box top under a point, up to `bottom + MAX_SUPPORT_OVERLAP` [m]; -inf if there is none.

    A box is under points at most `MAX_SUPPORT_REACH` beyond its edges, too. The point's own height is ignored. There
    must be at least one box.
    """
    reach = jnp.float32(MAX_SUPPORT_REACH)
    x, y = pos[0] - boxes.x, pos[1] - boxes.y
    u, v = boxes.cos * x + boxes.sin * y, boxes.cos * y - boxes.sin * x
    under = (
        (jnp.abs(u) <= boxes.half_u + reach)
        & (jnp.abs(v) <= boxes.half_v + reach)
        & (boxes.top <= bottom + jnp.float32(MAX_SUPPORT_OVERLAP))
    )
    return jnp.max(jnp.where(under, boxes.top, -jnp.inf))
