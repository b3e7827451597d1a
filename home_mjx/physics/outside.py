"""Detection of agents and movable bodies that have left the playable area."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.dynamics import agent_pose, body_pose
from home_mjx.physics.mjx.template import Template

MIN_DEPTH_BELOW_FLOOR = 0.05  # [m], minimum depth below the ground floor that counts; contact penetration is smaller


def is_out_of_bounds(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState
) -> Bool[Array, " m"]:
    """Return whether each agent and movable body is outside the lot's fence or below the ground floor.

    A body that falls through an upper floor and stays above the ground floor is not reported.

    Args:
        template: Model of the bank's capacity.
        bank: Houses.
        house: Index of the house.
        state: Physics state.

    Returns:
        One flag per agent, then one per movable body. Unused bodies are False.
    """
    physics, agents = bank.physics, agent_pose(template, state)[0]
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
