"""Where agents would brush the leaves of doors, and so shut them, or run into one another."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.physics.base.doors import Leaf
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.carrying import has_hands, meets
from home_mjx.tasks.rows.fields import BRUSHES, MARGIN, PUSHES, STOREY

MEETS = 1.5  # where what is carried meets something: little, as fields of rows do not know of it
AHEAD = 0.4  # [m]: who meets a leaf that is shut so far ahead opens it, if it has hands


def leaf_gaps(
    snapshot: Snapshot, place: Float[Array, "n 3"], which: Bool[Array, " h"] | None = None
) -> Float[Array, " n"]:
    """How far the middles of agents at some places are from the nearest leaf of their storey as it stands now [m].

    Args:
        snapshot: The environment.
        place: The places [m].
        which: Leaves that count; None: all.
    """
    leaves = jax.tree.map(lambda x: x[snapshot.house], Leaf.of(snapshot.bank.physics))
    pos, quat = leaves.moved(snapshot.door_angle)
    yaw = 2 * jnp.arctan2(quat[:, 3], quat[:, 0])
    away = place[:, None] - pos[None]
    cos, sin = jnp.cos(yaw)[None], jnp.sin(yaw)[None]
    along, across = away[..., 0] * cos + away[..., 1] * sin, away[..., 1] * cos - away[..., 0] * sin
    half = leaves.size[None]
    gap = jnp.hypot(jnp.maximum(jnp.abs(along) - half[..., 0], 0.0), jnp.maximum(jnp.abs(across) - half[..., 1], 0.0))
    counts = (leaves.valid if which is None else leaves.valid & which)[None] & (
        jnp.abs(away[..., 2]) < jnp.float32(STOREY)
    )
    return jnp.min(jnp.where(counts, gap, jnp.inf), axis=1, initial=jnp.inf)


def at_leaves(snapshot: Snapshot, place: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    """Whether agents at some places [m] would be within `MARGIN` of a leaf as it stands now."""
    return leaf_gaps(snapshot, place) < jnp.float32(snapshot.bank.spec.agent_radius + MARGIN)


def slowness(snapshot: Snapshot, place: Float[Array, "n 3"], agent: Int[Array, ""] | None = None) -> Float[Array, " n"]:
    """So many times as long as it is counts a way through some places, as leaves, agents and furniture stand now.

    Args:
        snapshot: The environment.
        place: The places [m].
        agent: Who goes there: the others are in its way, and furniture is in that of what it carries. None: neither.
    """
    radius, margin = jnp.float32(snapshot.bank.spec.agent_radius), jnp.float32(MARGIN)
    gap = leaf_gaps(snapshot, place)
    if agent is not None and snapshot.config.num_agents > 1:
        others = snapshot.pose.pos
        away = place[:, None] - others[None]
        here = (jnp.abs(away[..., 2]) < jnp.float32(STOREY)) & (jnp.arange(len(others)) != agent)[None]
        between = jnp.hypot(away[..., 0], away[..., 1]) - radius
        gap = jnp.minimum(gap, jnp.min(jnp.where(here, between, jnp.inf), axis=1))
    slow = jnp.where(gap < radius, PUSHES, jnp.where(gap < radius + margin, BRUSHES, 1.0))
    if agent is None or not has_hands(snapshot):
        return slow
    return jnp.maximum(slow, jnp.where(meets(snapshot, agent, place), MEETS, 1.0))


def faces_shut_leaf(snapshot: Snapshot, way: Float[Array, " a"]) -> Bool[Array, " a"]:
    """Whether a leaf that is less than half open is before each agent on its way.

    Args:
        snapshot: The environment.
        way: Heading of the way [rad].
    """
    physics, house = snapshot.bank.physics, snapshot.house
    wide, closed = physics.door_wide[house], physics.door_closed[house]
    shut = jnp.abs(snapshot.door_angle - wide) > jnp.abs(closed - wide) / 2
    ahead = jnp.stack([jnp.cos(way), jnp.sin(way), jnp.zeros_like(way)], axis=-1) * jnp.float32(AHEAD)
    return leaf_gaps(snapshot, snapshot.pose.pos + ahead, shut) < jnp.float32(AHEAD / 2)


def slow_cells(snapshot: Snapshot) -> Float[Array, "levels rows columns"]:
    """The same of all cells of the house's grids, whoever goes there."""
    bank, house = snapshot.bank, snapshot.house
    levels, rows, columns = bank.navigation.room.shape[1:]
    y, x = ((jnp.arange(n, dtype=jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) for n in (rows, columns))
    origin, floor = bank.navigation.origin[house], bank.navigation.floor[house]
    z, y, x = jnp.meshgrid(floor[:levels], y + origin[1], x + origin[0], indexing="ij")
    place = jnp.stack([x, y, z], axis=-1).reshape(-1, 3)
    return slowness(snapshot, place).reshape(levels, rows, columns)
