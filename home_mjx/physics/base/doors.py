"""Doors as the physics sees them: a leaf that turns about a vertical axis, as one row of numbers."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree


class Leaf(Pytree):
    """Leaves of doors, of any leading shape; angles are about +z from as placed."""

    pivot: Float[Array, "*h 2"]  # [m]
    arm: Float[Array, "*h 2"]  # [m], from the hinge to the middle of the leaf, as placed
    height: Float[Array, "*h"]  # [m], of its middle
    yaw: Float[Array, "*h"]  # [rad], of its box, as placed
    size: Float[Array, "*h 3"]  # [m], half extents; negative: there is no such leaf
    mass: Float[Array, "*h"]  # [kg]
    low: Float[Array, "*h"]  # [rad]
    high: Float[Array, "*h"]  # [rad]

    @classmethod
    def of(cls, physics: Physics) -> "Leaf":
        """The leaves of all houses (house, door)."""
        quat = physics.door_quat
        valid = physics.door_valid[..., None]
        return cls(
            pivot=physics.door_pivot,
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
        """About the hinge [kg m^2]; by Steiner's theorem."""
        return self.own_inertia[..., 2] + self.mass * self.far

    @property
    def inverse_weight(self) -> Float[Array, "*h"]:
        """MuJoCo's `body_invweight0`: the mean over x, y and z of what a force at the middle moves it by [1/kg]."""
        return self.far / self.inertia / 3

    def turned(self, angle: Float[Array, "*h"]) -> tuple[Float[Array, "*h 3"], Float[Array, "*h 4"]]:
        """Middle [m] and orientation (wxyz) of leaves at angles [rad]."""
        cos, sin = jnp.cos(angle), jnp.sin(angle)
        x = self.pivot[..., 0] + cos * self.arm[..., 0] - sin * self.arm[..., 1]
        y = self.pivot[..., 1] + sin * self.arm[..., 0] + cos * self.arm[..., 1]
        half, zero = (angle + self.yaw) / 2, jnp.zeros_like(angle)
        quat = jnp.stack([jnp.cos(half), zero, zero, jnp.sin(half)], axis=-1)
        return jnp.stack([x, y, jnp.broadcast_to(self.height, x.shape)], axis=-1), quat


def door_table(leaves: Leaf) -> Float[Array, "*h 13"]:
    """One row per leaf: pivot, arm, height, yaw, half extents, inertia, inverse weight, least and greatest angle."""
    valid = leaves.valid
    inertia = jnp.where(valid, leaves.inertia, jnp.float32(1.0))
    inverse = jnp.where(valid, leaves.inverse_weight, jnp.float32(1.0))
    parts = (leaves.height, leaves.yaw), (inertia, inverse, leaves.low, leaves.high)
    first, last = (jnp.stack(part, axis=-1) for part in parts)
    return jnp.concatenate([leaves.pivot, leaves.arm, first, leaves.size, last], axis=-1)
