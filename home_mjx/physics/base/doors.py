"""Doors in the physics: leaves that turn about a vertical axis or slide, packed as one row each, and their trays."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

DOOR_COLUMNS = 16  # of `door_table`
TRAY_BOXES, TRAY_ROWS = 4, 2  # boxes of a drawer besides its front, and the rows of `door_table` that hold them


class DoorLeaves(Pytree):
    """Door leaves of any leading shape, each with one joint coordinate.

    The coordinate of a hinged leaf is its rotation [rad] about +z from the authored pose. That of a sliding leaf is its
    displacement [m] from there along `slide`. `low` and `high` are in the same unit.
    """

    pivot: Float[Array, "*h 2"]  # [m]
    arm: Float[Array, "*h 2"]  # [m], from the pivot to the leaf's centre in the authored pose; 0 if sliding
    slide: Float[Array, "*h 2"]  # horizontal unit direction; 0 if hinged
    height: Float[Array, "*h"]  # [m], of the centre
    yaw: Float[Array, "*h"]  # [rad], of the box in the authored pose
    size: Float[Array, "*h 3"]  # [m], half extents; negative for padding
    mass: Float[Array, "*h"]  # [kg]
    low: Float[Array, "*h"]
    high: Float[Array, "*h"]

    @classmethod
    def from_physics(cls, physics: Physics) -> "DoorLeaves":
        """Gather the leaves of all houses, with leading axes (house, door).

        Padding has half extents of -1, a mass of 1 kg and the slide direction of its row's kind; the rest is 0. It is
        not parked, see `house_doors`.
        """
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
        """Mask of leaves with nonnegative half extents. Padding is False, but True once parked, see `house_doors`."""
        return self.size[..., 0] >= 0

    @property
    def hinge_mask(self) -> Float[Array, "*h"]:
        """1 for a hinged leaf, 0 for a sliding one; padding of houses has the value of its row's kind, see `valid`."""
        return jnp.where(jnp.any(self.slide != 0, axis=-1), 0.0, jnp.float32(1.0))

    @property
    def box_inertia(self) -> Float[Array, "*h 3"]:
        """Moments of inertia of each leaf, a solid box, about the box's axes through its centre [kg m^2].

        Those of padding are positive but have no meaning.
        """
        x, y, z = (self.size[..., k] ** 2 for k in range(3))
        return self.mass[..., None] / 3 * jnp.stack([y + z, x + z, x + y], axis=-1)

    @property
    def hinge_distance_sq(self) -> Float[Array, "*h"]:
        """Squared horizontal distance from the hinge to the leaf's centre [m^2].

        It is 0 for a sliding leaf, except if that is parked padding, see `house_doors`.
        """
        return jnp.sum(self.arm * self.arm, axis=-1)

    @property
    def inertia(self) -> Float[Array, "*h"]:
        """Moment of inertia about the hinge [kg m^2], by Steiner's theorem; of a sliding leaf its mass [kg].

        That of padding is positive but has no meaning.
        """
        return jnp.where(self.hinge_mask > 0, self.box_inertia[..., 2] + self.mass * self.hinge_distance_sq, self.mass)

    @property
    def inverse_weight(self) -> Float[Array, "*h"]:
        """MuJoCo's translational `body_invweight0` [1/kg]: d² / (3 I) for a hinged leaf, 1 / (3 m) if sliding.

        It is 0 for hinged padding of `from_physics`, whose arm is 0; parked padding has a positive value.
        """
        return jnp.where(self.hinge_mask > 0, self.hinge_distance_sq, 1.0) / self.inertia / 3

    @property
    def inverse_spin_weight(self) -> Float[Array, "*h"]:
        """MuJoCo's rotational `body_invweight0`, 1 / (3 `inertia`) [1/(kg m^2)]; 0 for a sliding leaf."""
        return self.hinge_mask / self.inertia / 3

    def pose_at(self, coordinate: Float[Array, "*h"]) -> tuple[Float[Array, "*h 3"], Float[Array, "*h 4"]]:
        """Return centres [m] and orientations (wxyz) in the world at joint coordinates, [rad] or [m] if sliding.

        Coordinates are not clipped to their range. There is one per leaf, also for padding. Padding of `from_physics`
        is at the origin, or on the x-axis if sliding; that of `house_doors` is parked.
        """
        angle = self.hinge_mask * coordinate
        cos, sin = jnp.cos(angle), jnp.sin(angle)
        x = self.pivot[..., 0] + cos * self.arm[..., 0] - sin * self.arm[..., 1] + self.slide[..., 0] * coordinate
        y = self.pivot[..., 1] + sin * self.arm[..., 0] + cos * self.arm[..., 1] + self.slide[..., 1] * coordinate
        half, zero = (angle + self.yaw) / 2, jnp.zeros_like(angle)
        quat = jnp.stack([jnp.cos(half), zero, zero, jnp.sin(half)], axis=-1)
        return jnp.stack([x, y, jnp.broadcast_to(self.height, x.shape)], axis=-1), quat


def tray_table(physics: Physics) -> Float[Array, "h rows 16"]:
    """Pack the trays of all houses' sliding leaves as `TRAY_ROWS` more rows of `door_table` each; none without trays.

    They have centre and half extents of one box after the other, in the frame of the leaf's box, then zeros.

    Raises:
        ConfigError: A tray has more boxes than fit.
    """
    boxes = jnp.concatenate([physics.tray_pos, physics.tray_size], axis=-1)
    houses, slides, count = boxes.shape[:3]
    if not count:
        return jnp.zeros((houses, 0, DOOR_COLUMNS), jnp.float32)
    if count != TRAY_BOXES:
        raise ConfigError(f"trays have {TRAY_BOXES} boxes, the bank's have {count}", element="bank.physics.tray_pos")
    flat = boxes.reshape(houses, slides, 6 * TRAY_BOXES)
    padding = np.zeros((houses, slides, DOOR_COLUMNS * TRAY_ROWS - 6 * TRAY_BOXES), np.float32)
    return jnp.concatenate([flat, padding], axis=-1).reshape(houses, slides * TRAY_ROWS, DOOR_COLUMNS)


def with_trays(leaves: DoorLeaves, physics: Physics) -> DoorLeaves:
    """Return leaves of `DoorLeaves.from_physics` in which the box of a drawer encloses its tray.

    Their arm is then not 0, and masses are unchanged. Without trays, the leaves are returned as they are.
    """
    slides, count = physics.tray_size.shape[1:3]
    if not count:
        return leaves
    first = leaves.mass.shape[1] - slides
    own = leaves.size[:, first:, None]
    pos, size = physics.tray_pos, physics.tray_size
    there = size >= 0
    low = jnp.minimum(-own, jnp.where(there, pos - size, 0.0)).min(axis=2)
    high = jnp.maximum(own, jnp.where(there, pos + size, 0.0)).max(axis=2)
    used = there[:, :, :1, 0]
    middle, half = jnp.where(used, (low + high) / 2, 0.0), jnp.where(used, (high - low) / 2, own[:, :, 0])
    cos, sin = jnp.cos(leaves.yaw[:, first:]), jnp.sin(leaves.yaw[:, first:])
    x, y = cos * middle[..., 0] - sin * middle[..., 1], sin * middle[..., 0] + cos * middle[..., 1]
    return leaves.replace(
        arm=leaves.arm.at[:, first:].add(jnp.stack([x, y], axis=-1)),
        height=leaves.height.at[:, first:].add(middle[..., 2]),
        size=leaves.size.at[:, first:].set(half),
    )


def door_table(leaves: DoorLeaves) -> Float[Array, "*h 16"]:
    """Pack one row per leaf; padding of `DoorLeaves.from_physics` gets inertia and inverse weight 1.

    Its half extents stay -1, and its other columns are those of `leaves`. Padding parked by `house_doors` counts as a
    leaf. Columns: pivot (2), arm (2), height, yaw, half extents (3), inertia,
    inverse weight, minimum and maximum coordinate, slide direction (2), and 1 if the leaf is hinged, else 0. Units are
    those of `DoorLeaves`.
    """
    valid = leaves.valid
    inertia = jnp.where(valid, leaves.inertia, jnp.float32(1.0))
    inverse = jnp.where(valid, leaves.inverse_weight, jnp.float32(1.0))
    parts = (leaves.height, leaves.yaw), (inertia, inverse, leaves.low, leaves.high)
    first, last = (jnp.stack(part, axis=-1) for part in parts)
    turns = leaves.hinge_mask[..., None]
    return jnp.concatenate([leaves.pivot, leaves.arm, first, leaves.size, last, leaves.slide, turns], axis=-1)
