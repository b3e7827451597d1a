"""Where agents would brush the leaves of doors, and so shut them."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx.physics.base.doors import Leaf
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rows.fields import MARGIN, STOREY


def at_leaves(snapshot: Snapshot, place: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    """Whether agents at some places [m] would be within `MARGIN` of a leaf as it stands now."""
    bank, house = snapshot.bank, snapshot.house
    leaves = jax.tree.map(lambda x: x[house], Leaf.of(bank.physics))
    pos, quat = leaves.moved(snapshot.door_angle)
    yaw = 2 * jnp.arctan2(quat[:, 3], quat[:, 0])
    away = place[:, None] - pos[None]
    cos, sin = jnp.cos(yaw)[None], jnp.sin(yaw)[None]
    along, across = away[..., 0] * cos + away[..., 1] * sin, away[..., 1] * cos - away[..., 0] * sin
    half = leaves.size[None]
    gap = jnp.hypot(jnp.maximum(jnp.abs(along) - half[..., 0], 0.0), jnp.maximum(jnp.abs(across) - half[..., 1], 0.0))
    near = (gap < jnp.float32(bank.spec.agent_radius + MARGIN)) & (jnp.abs(away[..., 2]) < jnp.float32(STOREY))
    return jnp.any(near & leaves.valid[None], axis=1)


def cells_at_leaves(snapshot: Snapshot) -> Bool[Array, "levels rows columns"]:
    """The same of all cells of the house's grids."""
    bank, house = snapshot.bank, snapshot.house
    levels, rows, columns = bank.navigation.room.shape[1:]
    y, x = ((jnp.arange(n, dtype=jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) for n in (rows, columns))
    origin, floor = bank.navigation.origin[house], bank.navigation.floor[house]
    z, y, x = jnp.meshgrid(floor[:levels], y + origin[1], x + origin[0], indexing="ij")
    place = jnp.stack([x, y, z], axis=-1).reshape(-1, 3)
    return at_leaves(snapshot, place).reshape(levels, rows, columns)
