"""What decides the contacts of movable bodies: their own friction, stiffness, damping and impedance.

A body's own numbers count against the floor, static boxes and doors. Of two bodies the greater friction, stiffness and
damping count, and the means of both impedances. All contacts of agents are frictionless and alike. In
MuJoCo's words: priority 2 of agents, 1 of bodies, 0 of the rest.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.bank.records import Physics
from home_mjx.mjcf.contact import contact_numbers
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.schema.contact_materials import USUAL, damping_ratio

# Columns: sliding friction; [1/s^2], [1/s], 1 and [m], see `contact_numbers`.
FRICTION, STIFFNESS, DAMPING, LOW, WIDTH = range(5)


def body_surfaces(config: PhysicsConfig, physics: Physics) -> Float[Array, "h k 5"]:
    """Rows of every body: its material's, or what the options say."""
    friction, ratio = physics.body_friction, physics.body_damping_ratio
    if config.friction is not None:
        friction = jnp.full_like(friction, config.friction)
    if config.restitution is not None:
        ratio = jnp.full_like(ratio, damping_ratio(config.restitution))
    return jnp.stack([friction, *contact_numbers(ratio, config.timing.sim_dt, jnp)], axis=-1)


def usual_surface(config: PhysicsConfig) -> Float[np.ndarray, "5"]:
    """Of bodies that are not there; they do not bounce."""
    return np.array([USUAL.friction, *contact_numbers(np.ones(()), config.timing.sim_dt)])
