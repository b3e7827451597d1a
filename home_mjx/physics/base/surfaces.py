"""Contact parameters of movable bodies: friction, stiffness, damping and impedance.

Against the floor, static boxes and doors, a body's own parameters apply. Between two bodies, the larger friction,
stiffness and damping apply, and the means of both impedances. All contacts of agents are frictionless and alike. In
MuJoCo's terms, agents have priority 2, bodies 1 and all other geoms 0.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.bank.records import Physics
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.schema.contact_materials import DEFAULT_CONTACT, damping_ratio
from home_mjx.schema.mjcf import contact_parameters

FRICTION, IMPEDANCE_LOW = 0, 3  # columns of `body_surfaces`


def body_surfaces(config: PhysicsSetup, physics: Physics) -> Float[Array, "h k 5"]:
    """Return the contact parameters of all houses' movable bodies (house, body, 5); padding is included.

    Friction and restitution of `config`, unless they are None, replace those of the materials, also in padding. Factors
    of `BodyScale` are not applied. Columns: sliding friction,
    stiffness [1/s^2], damping [1/s], minimum impedance, width of the impedance curve [m]. All but friction are those of
    `contact_parameters` for the body's damping ratio and the length of a physics step.
    """
    friction, ratio = physics.body_friction, physics.body_damping_ratio
    if config.friction is not None:
        friction = jnp.full_like(friction, config.friction)
    if config.restitution is not None:
        ratio = jnp.full_like(ratio, damping_ratio(config.restitution))
    return jnp.stack([friction, *contact_parameters(ratio, config.timing.sim_dt, jnp)], axis=-1)


def default_surface(config: PhysicsSetup) -> Float[np.ndarray, "5"]:
    """Return the row of `body_surfaces` for unused bodies: default friction, critical damping, so no bounce.

    Of `config`, only the length of a physics step is used, not `friction` or `restitution`. The row is NumPy float64.
    """
    return np.array([DEFAULT_CONTACT.friction, *contact_parameters(np.ones(()), config.timing.sim_dt)])
