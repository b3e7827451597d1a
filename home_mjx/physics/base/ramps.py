"""Ramps over stairs, as rows of numbers."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics


def ramp_table(physics: Physics, house: Int[Array, ""]) -> Float[Array, "r 8"]:
    """The ramps of a house, see `ramp_tables`."""
    return ramp_tables(physics)[house]


def ramp_tables(physics: Physics) -> Float[Array, "h r 8"]:
    """One row per ramp of each house.

    The middle of its footprint (x, y) [m], the direction uphill (x, y), half of its length and width in plan [m], the
    height of its middle [m], and rise per length. Padding has a negative length: nobody stands there.
    """
    return jnp.zeros((physics.floor.shape[0], 1, 8), jnp.float32).at[:, :, 4].set(-1.0)
