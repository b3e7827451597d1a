"""Movement of agents that stop at contact instead of sliding along obstacles."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.physics.kinematic.footprints import (
    AgentCapsules,
    Footprints,
    box_gradients,
    move_and_slide,
    penetration_depths,
)

ADVANCES = 8  # maximum number of advances to the first contact; each is exact for a straight side
MIN_APPROACH = 1e-3  # minimum cosine between a way and the direction to an obstacle that stops it
CONTACT_DISTANCE = 1e-3  # [m], maximum distance along a way to the obstacles that count as touched


def move_and_stop(
    boxes: Footprints, agents: AgentCapsules, old: Float[Array, "3"], way: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Int[Array, ""]]:
    """Move agent `agents.index` from `old` by `way` [m] up to the first contact; arguments and results as for sliding.

    See `move_and_slide`. Obstacles that move into the agent, such as doors, still push it out of them.
    """
    length = jnp.sqrt(jnp.maximum(way[0] ** 2 + way[1] ** 2, 1e-24))
    ahead, gone = way / length, jnp.zeros_like(length)
    for _ in range(ADVANCES):
        gone = jnp.minimum(gone + jnp.maximum(_free_ways(boxes, agents, old + gone * ahead, ahead).min(), 0.0), length)
    stop = old + gone * ahead
    touched = (_free_ways(boxes, agents, stop, ahead) < CONTACT_DISTANCE) & (gone < length)
    pos, count = move_and_slide(boxes, agents, stop, jnp.zeros_like(way))
    return pos, jnp.maximum(count, touched.sum(dtype=jnp.int32))


def _free_ways(
    boxes: Footprints, agents: AgentCapsules, pos: Float[Array, "3"], ahead: Float[Array, "3"]
) -> Float[Array, " n"]:
    """Return how far the agent may move along a unit vector before it can touch each obstacle [m]; inf if it never can.

    Obstacles are convex, so each is beyond the line through its nearest point, at right angles to the way there.
    """
    distance, out = -penetration_depths(boxes, agents, pos), _outward(boxes, agents, pos)
    approach = -(out[:, 0] * ahead[0] + out[:, 1] * ahead[1])
    nearer = (approach > MIN_APPROACH) & _is_beside(boxes, agents, pos)
    return jnp.where(nearer, distance / jnp.where(nearer, approach, 1.0), jnp.inf)


def _outward(boxes: Footprints, agents: AgentCapsules, pos: Float[Array, "3"]) -> Float[Array, "n 2"]:
    """Return the horizontal unit vectors from obstacles to a point."""
    u, v = box_gradients(boxes, pos)
    from_box = jnp.stack([boxes.cos * u - boxes.sin * v, boxes.sin * u + boxes.cos * v], axis=-1)
    away = (pos[None] - agents.pos)[:, :2]
    square = away[:, 0] ** 2 + away[:, 1] ** 2
    return jnp.concatenate([from_box, away / jnp.sqrt(jnp.maximum(square, 1e-12))[:, None]])


def _is_beside(boxes: Footprints, agents: AgentCapsules, pos: Float[Array, "3"]) -> Bool[Array, " n"]:
    """Return a mask of the obstacles at the agent's height; it is none itself."""
    radius, length = agents.size
    above = jnp.maximum(boxes.bottom - (pos[2] + length), pos[2] - length - boxes.top)
    own = jnp.arange(agents.radius.shape[0], dtype=jnp.int32) == agents.index
    apart = jnp.abs(pos[2] - agents.pos[:, 2]) > agents.half_length + agents.radius + length + radius
    return jnp.concatenate([above < radius, ~(own | apart)])
