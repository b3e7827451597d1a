"""Where what an agent carries would meet something."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.environment.handling import carried_ids
from home_mjx.tasks.sensors.reaching import footprints, plan_radius

AROUND = 0.05  # [m], between what is carried and what stands beside the way


def has_hands(snapshot: Snapshot) -> bool:
    """Whether agents have hands and houses have things for them."""
    return snapshot.config.hands and snapshot.bank.spec.num_bodies > 0


def carried_radius(snapshot: Snapshot, agent: Int[Array, ""]) -> Float[Array, ""]:
    """How far what an agent carries reaches from its own middle in the plan [m]; 0: it carries nothing."""
    body, physics = jnp.maximum(snapshot.held[agent], 0), snapshot.bank.physics
    radius = plan_radius(physics.body_size[snapshot.house, body], physics.body_quat[snapshot.house, body])
    return jnp.where(snapshot.held[agent] >= 0, radius + jnp.float32(AROUND), 0.0)


def meets(snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    """Whether what an agent carries before it, as high as now, would come near anything on its way through some places.

    Args:
        snapshot: The environment; agents have hands.
        agent: Number of the agent.
        place: The places [m].
    """
    held, radius = snapshot.held[agent], carried_radius(snapshot, agent)
    body = jnp.maximum(held, 0)
    boxes = footprints(snapshot.scene, carried_ids(snapshot)[agent])
    low, high = snapshot.scene.moving.box[body, :, 2]
    boxes = jax.tree.map(lambda x: x[None], boxes)
    x, y = place[:, :1] - boxes.x, place[:, 1:2] - boxes.y
    u = jnp.abs(boxes.cos * x + boxes.sin * y) - boxes.half_u
    v = jnp.abs(boxes.cos * y - boxes.sin * x) - boxes.half_v
    away = jnp.hypot(jnp.maximum(u, 0.0), jnp.maximum(v, 0.0))
    met = (away < radius) & (boxes.top > low) & (boxes.bottom < high)
    return (held >= 0) & jnp.any(met, axis=1)
