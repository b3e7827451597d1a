"""Doors as the physics sees them: a leaf that turns about a vertical axis or slides, as one row of numbers."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree


class Leaf(Pytree):
    """Leaves of doors, of any leading shape, each with one coordinate.

    A hinged leaf's is the angle [rad] about +z from as placed, a sliding one's the way [m] from there along `slide`.
    `low` and `high` are in the same unit.
    """

    pivot: Float[Array, "*h 2"]  # [m]
    arm: Float[Array, "*h 2"]  # [m], from the pivot to the middle of the leaf, as placed; 0: it slides
    slide: Float[Array, "*h 2"]  # unit direction in the plan; 0: it is hinged
    height: Float[Array, "*h"]  # [m], of its middle
    yaw: Float[Array, "*h"]  # [rad], of its box, as placed
    size: Float[Array, "*h 3"]  # [m], half extents; negative: there is no such leaf
    mass: Float[Array, "*h"]  # [kg]
    low: Float[Array, "*h"]
    high: Float[Array, "*h"]

    @classmethod
    def of(cls, physics: Physics) -> "Leaf":
        """The leaves of all houses (house, door)."""
        quat = physics.door_quat
        valid = physics.door_valid[..., None]
        return cls(
            pivot=physics.door_pivot,
            slide=physics.door_slide,
            arm=physics.door_pos[..., :2] - physics.door_pivot,
            height=physics.door_pos[..., 2],
            yaw=2 * jnp.arctan2(quat[..., 3], quat[..., 0]),
            size=jnp.where(valid, physics.door_size, jnp.float32(-1.0)),
            mass=physics.door_mass,
            low=physics.door_low,
            high=physics.door_high,
        )

    @property
    def valid(self) -> Array:
        """Whether there is such a leaf."""
        return self.size[..., 0] >= 0

    @property
    def turns(self) -> Float[Array, "*h"]:
        """1: the leaf is hinged; 0: it slides."""
        return jnp.where(jnp.any(self.slide != 0, axis=-1), 0.0, jnp.float32(1.0))

    @property
    def own_inertia(self) -> Float[Array, "*h 3"]:
        """Of a solid box about its own axes [kg m^2]."""
        x, y, z = (self.size[..., k] ** 2 for k in range(3))
        return self.mass[..., None] / 3 * jnp.stack([y + z, x + z, x + y], axis=-1)

    @property
    def far(self) -> Float[Array, "*h"]:
        """Square of the distance from the hinge to the middle [m^2]."""
        return jnp.sum(self.arm * self.arm, axis=-1)

    @property
    def inertia(self) -> Float[Array, "*h"]:
        """About the hinge [kg m^2], by Steiner's theorem; of a sliding leaf its mass [kg]."""
        return jnp.where(self.turns > 0, self.own_inertia[..., 2] + self.mass * self.far, self.mass)

    @property
    def inverse_weight(self) -> Float[Array, "*h"]:
        """MuJoCo's `body_invweight0`: the mean over x, y and z of what a force at the middle moves it by [1/kg]."""
        return jnp.where(self.turns > 0, self.far, 1.0) / self.inertia / 3

    @property
    def inverse_spin_weight(self) -> Float[Array, "*h"]:
        """The same of torques [1/(kg m^2)], which do not turn a sliding leaf."""
        return self.turns / self.inertia / 3

    def moved(self, coordinate: Float[Array, "*h"]) -> tuple[Float[Array, "*h 3"], Float[Array, "*h 4"]]:
        """Middle [m] and orientation (wxyz) of leaves at their coordinates."""
        angle = self.turns * coordinate
        cos, sin = jnp.cos(angle), jnp.sin(angle)
        x = self.pivot[..., 0] + cos * self.arm[..., 0] - sin * self.arm[..., 1] + self.slide[..., 0] * coordinate
        y = self.pivot[..., 1] + sin * self.arm[..., 0] + cos * self.arm[..., 1] + self.slide[..., 1] * coordinate
        half, zero = (angle + self.yaw) / 2, jnp.zeros_like(angle)
        quat = jnp.stack([jnp.cos(half), zero, zero, jnp.sin(half)], axis=-1)
        return jnp.stack([x, y, jnp.broadcast_to(self.height, x.shape)], axis=-1), quat


def door_table(leaves: Leaf) -> Float[Array, "*h 16"]:
    """One row per leaf.

    Pivot, arm, height, yaw, half extents, inertia, inverse weight, least and greatest coordinate, direction in which it
    slides, whether it turns. Units are those of `Leaf`.
    """
    valid = leaves.valid
    inertia = jnp.where(valid, leaves.inertia, jnp.float32(1.0))
    inverse = jnp.where(valid, leaves.inverse_weight, jnp.float32(1.0))
    parts = (leaves.height, leaves.yaw), (inertia, inverse, leaves.low, leaves.high)
    first, last = (jnp.stack(part, axis=-1) for part in parts)
    turns = leaves.turns[..., None]
    return jnp.concatenate([leaves.pivot, leaves.arm, first, leaves.size, last, leaves.slide, turns], axis=-1)
