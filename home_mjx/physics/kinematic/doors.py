"""Doors without dynamics: they move to their goals and yield to agents that push them."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.physics.base.servo import MAX_DOOR_SPEED, NOT_DRIVEN
from home_mjx.physics.mjx.contact_slots import OrientedBoxes

MIN_PUSH_LEVER = 0.1  # [m], minimum distance from the hinge at which a leaf can be pushed


def leaf_boxes(leaves: DoorLeaves, angle: Float[Array, " h"]) -> OrientedBoxes:
    """Return the leaves' boxes in the world at joint coordinates [rad], or [m] if sliding.

    Coordinates are not clipped. Padding is included, so `leaves` should be those of `house_doors`, which parks it.
    """
    return OrientedBoxes(*leaves.pose_at(angle), leaves.size)


def drive_doors(
    leaves: DoorLeaves, angle: Float[Array, " h"], goal: Float[Array, " h"], dt: float
) -> Float[Array, " h"]:
    """Return joint coordinates moved to their goals by at most `MAX_DOOR_SPEED * dt`; unchanged where `NOT_DRIVEN`.

    Goals are clipped to the joint ranges; those of at least `NOT_DRIVEN` drive no door. Nothing blocks a leaf, not even
    an agent. `dt` is in seconds.
    """
    most = jnp.float32(MAX_DOOR_SPEED * dt)
    way = jnp.clip(jnp.clip(goal, leaves.low, leaves.high) - angle, -most, most)
    return jnp.where(goal < NOT_DRIVEN, angle + way, angle)


def push_doors(
    leaves: DoorLeaves,
    angle: Float[Array, " h"],
    pos: Float[Array, "a 3"],
    radius: Float[Array, " a"],
    half: Float[Array, " a"],
) -> Float[Array, " h"]:
    """Return joint coordinates after agents have pushed overlapping leaves away, clipped to the joint ranges.

    Agents push hinged leaves at their faces and sliding ones at their narrow ends. A hinged leaf turns by penetration
    over lever, the distance from the hinge along the leaf, if that exceeds `MIN_PUSH_LEVER`. A sliding leaf moves by
    the penetration. This is first order and summed over agents, so overlap can remain. Agents above or below a leaf do
    not push it. Bodies and walls neither push nor block leaves. Coordinates are clipped without a push, too. `leaves`
    are those of `house_doors`, with padding parked out of reach. `angle` is in [rad], of sliding leaves [m]. `pos`,
    `radius` and `half` are the agents' centres, radii and half heights [m].
    """
    turned = leaves.hinge_mask * angle + leaves.yaw
    along = leaves.size[:, 0] >= leaves.size[:, 1]  # the box's first axis is the leaf's long axis
    heading = jnp.where(along, turned, turned + jnp.float32(jnp.pi / 2))
    u = jnp.stack([jnp.cos(heading), jnp.sin(heading)], axis=-1)
    v = jnp.stack([-u[:, 1], u[:, 0]], axis=-1)
    middle = leaves.pose_at(angle)[0][:, :2]
    half_u, half_v = jnp.max(leaves.size[:, :2], axis=-1), jnp.min(leaves.size[:, :2], axis=-1)
    gap = pos[None, :, :2] - middle[:, None]
    along_u, along_v = (jnp.sum(gap * axis[:, None], axis=-1) for axis in (u, v))
    lever = jnp.sum((pos[None, :, :2] - leaves.pivot[:, None]) * u[:, None], axis=-1)
    depth = half_v[:, None] + radius[None] - jnp.abs(along_v)
    as_high = jnp.abs(pos[None, :, 2] - leaves.height[:, None]) < half[None] + leaves.size[:, 2:]
    met = as_high & (depth > 0) & (jnp.abs(along_u) <= half_u[:, None]) & (jnp.abs(lever) > MIN_PUSH_LEVER)
    turn = -jnp.sign(along_v) * depth / jnp.where(met, lever, 1.0)
    turn = jnp.where(met, turn, 0.0)
    past = half_u[:, None] + radius[None] - jnp.abs(along_u)
    at_end = as_high & (past > 0) & (jnp.abs(along_u) > half_u[:, None]) & (jnp.abs(along_v) <= half_v[:, None])
    shift = jnp.where(at_end, -jnp.sign(along_u) * past, 0.0) * jnp.sum(leaves.slide * u, axis=-1)[:, None]
    push = jnp.where(leaves.hinge_mask[:, None] > 0, turn, shift)
    return jnp.clip(angle + jnp.sum(push, axis=-1), leaves.low, leaves.high)
