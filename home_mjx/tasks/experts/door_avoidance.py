"""Conflicts of agents with door leaves, which they would push shut, and with one another."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.transforms import wrap_angle
from home_mjx.navigation.grid import row_of_cell
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.carry_clearance import carried_discs, has_hands, would_collide
from home_mjx.tasks.rules.cell_graph import (
    BRUSH_COST_FACTOR,
    MIN_LEAF_CLEARANCE,
    PUSH_COST_FACTOR,
)

# [steps]: a period, and its last steps, in which agents may brush leaves. Fields do not contain these: an agent may
# turn round at one, lose sight of it and come back, for ever. No leaf is ever ignored: agents would shut it for good.
PATIENCE_PERIOD, NUM_IMPATIENT_STEPS = 200, 40
CARRY_COST_FACTOR = 1.5  # cost factor where a carried object collides; small, because fields of rows ignore it
OPEN_DISTANCE = 0.4  # [m], distance of a shut leaf at which an agent with hands opens it
CARRY_OPEN_DISTANCE = 0.95  # [m], the same for an agent that carries something, so that the leaf swings clear
SWING_CLEARANCE_ANGLE = 0.35  # [rad], angle from the leaf at which an agent is clear of it and can reach it


def leaf_distances(
    snapshot: Snapshot, place: Float[Array, "n 3"], selected: Bool[Array, " h"] | None = None
) -> Float[Array, " n"]:
    """Return plan distances of feet at `place` to the nearest leaf at an agent's height [m]; 0 inside, inf without one.

    `selected` is a mask of leaves; None: all.
    """
    away, _ = _leaf_offsets(snapshot, place, selected)
    return jnp.min(away, axis=1, initial=jnp.inf)


def _leaf_offsets(
    snapshot: Snapshot, place: Float[Array, "n 3"], which: Bool[Array, " h"] | None
) -> tuple[Float[Array, "n h"], Float[Array, "n h 2"]]:
    """Return plan distances of feet to leaves [m], inf for leaves above or below an agent, and offsets (x, y) [m].

    An offset leads from the feet to the nearest point of the leaf. `which` is a mask of leaves; None: all.
    """
    leaves = _house_leaves(snapshot)
    pos, cos, sin = _leaf_frames(snapshot, leaves)
    away, half = place[:, None] - pos[None], leaves.size[None]
    u, v = _offset_from_leaf(away[..., 0], away[..., 1], cos, sin, half)
    counts = (leaves.valid if which is None else leaves.valid & which)[None] & _is_as_high(
        snapshot, away[..., 2], half[..., 2]
    )
    way = -jnp.stack([u * cos - v * sin, u * sin + v * cos], axis=-1)
    return jnp.where(counts, jnp.hypot(u, v), jnp.inf), way


def _leaf_frames(
    snapshot: Snapshot, leaves: DoorLeaves
) -> tuple[Float[Array, "h 3"], Float[Array, " h"], Float[Array, " h"]]:
    """Return the middles of leaves at their current angles [m], and cosine and sine of their headings."""
    pos, quat = leaves.pose_at(snapshot.door_angle)
    yaw = 2 * jnp.arctan2(quat[:, 3], quat[:, 0])
    return pos, jnp.cos(yaw), jnp.sin(yaw)


def _offset_from_leaf(x: Array, y: Array, cos: Array, sin: Array, half: Float[Array, "... 3"]) -> tuple[Array, Array]:
    """Return offsets from a leaf's nearest point along and across it [m]; 0 inside. x and y are re its middle [m]."""
    along, across = x * cos + y * sin, y * cos - x * sin
    return along - jnp.clip(along, -half[..., 0], half[..., 0]), across - jnp.clip(across, -half[..., 1], half[..., 1])


def _is_as_high(
    snapshot: Snapshot, rise: Float[Array, "n h"], half: Float[Array, "#n h"] | Float[Array, ""] | float
) -> Bool[Array, "n h"]:
    """Return whether upright boxes overlap the height range of an agent.

    Feet are `rise` above the middle of a box, which has half the height `half` [m].
    """
    return (rise < half) & (rise > -half - jnp.float32(snapshot.bank.spec.agent_height))


def cost_factors(
    snapshot: Snapshot, place: Float[Array, "n 3"], agent: Int[Array, ""] | None = None
) -> Float[Array, " n"]:
    """Return cost factors (1: free) of path length at feet positions, from leaves, agents and the carried object now.

    An agent there that would touch a leaf or agent pays `PUSH_COST_FACTOR`, within `MIN_LEAF_CLEARANCE` of touching
    `BRUSH_COST_FACTOR`. Of several factors the largest counts. Brushing a leaf costs nothing in the last
    `NUM_IMPATIENT_STEPS` of every `PATIENCE_PERIOD`; pushing it, or brushing an agent, always does.

    Args:
        snapshot: The environment.
        place: The positions of feet [m].
        agent: Index of the agent that goes there: other agents count, and collisions of its carried object. None:
            neither.
    """
    radius = jnp.float32(snapshot.bank.spec.agent_radius)
    others = jnp.full(place.shape[0], jnp.inf, jnp.float32)
    if agent is not None and snapshot.config.num_agents > 1:
        feet = snapshot.feet
        away = place[:, None] - feet[None]
        here = jnp.abs(away[..., 2]) < jnp.float32(snapshot.bank.spec.agent_height)
        here &= (jnp.arange(len(feet)) != agent)[None]
        others = jnp.min(jnp.where(here, jnp.hypot(away[..., 0], away[..., 1]) - radius, jnp.inf), axis=1)
    slow = _slow_down(snapshot, leaf_distances(snapshot, place), others)
    if agent is None or not has_hands(snapshot):
        return slow
    return jnp.maximum(slow, jnp.where(would_collide(snapshot, agent, place), CARRY_COST_FACTOR, 1.0))


def _slow_down(
    snapshot: Snapshot, leaf: Float[Array, "*n"], agent: Float[Array, "*n"] | float = jnp.inf
) -> Float[Array, "*n"]:
    """Return the `cost_factors` for plan distances [m] to the nearest leaf and to the nearest other agent's surface."""
    radius, margin = jnp.float32(snapshot.bank.spec.agent_radius), jnp.float32(MIN_LEAF_CLEARANCE)
    is_patient = snapshot.step % PATIENCE_PERIOD < PATIENCE_PERIOD - NUM_IMPATIENT_STEPS
    gap = jnp.minimum(jnp.where(is_patient | (leaf < radius), leaf, jnp.inf), agent)
    return jnp.where(gap < radius, PUSH_COST_FACTOR, jnp.where(gap < radius + margin, BRUSH_COST_FACTOR, 1.0))


def is_shut(snapshot: Snapshot) -> Bool[Array, " h"]:
    """Return which leaves of doors are less than half open; False for fronts of furniture and padding."""
    physics, house = snapshot.bank.physics, snapshot.house
    wide, closed = physics.door_fully_open[house], physics.door_closed[house]
    shut = physics.door_valid[house] & (jnp.abs(snapshot.door_angle - wide) > jnp.abs(closed - wide) / 2)
    fronts = snapshot.bank.fronts
    return shut if fronts.is_empty else shut & ~fronts.mask(physics, house)


def is_facing_shut_leaf(snapshot: Snapshot, way: Float[Array, " a"]) -> Bool[Array, " a"]:
    """Return whether a leaf less than half open is near the point `OPEN_DISTANCE` ahead of each agent.

    Near is within half that distance; `way` is the heading [rad].
    """
    ahead = jnp.stack([jnp.cos(way), jnp.sin(way), jnp.zeros_like(way)], axis=-1) * jnp.float32(OPEN_DISTANCE)
    return leaf_distances(snapshot, snapshot.feet + ahead, is_shut(snapshot)) < jnp.float32(OPEN_DISTANCE / 2)


def is_swept(snapshot: Snapshot, place: Float[Array, "n 3"], radius: Float[Array, " n"]) -> Bool[Array, "n h"]:
    """Return which hinged leaves that are less than half open would sweep over discs when opened wide.

    Discs have centres `place` [m], with z at an agent's feet, and a `radius` [m].
    """
    away, turn, arc = _hinge_coordinates(snapshot, place)
    wide = jnp.arcsin(jnp.clip(radius[:, None] / away, 0.0, 1.0))  # half of the angle that the disc subtends
    leaves = _house_leaves(snapshot)
    swept = (turn > -wide) & (turn < arc + wide) & (away < 2 * jnp.sqrt(leaves.hinge_distance_sq) + radius[:, None])
    swept |= away < radius[:, None]  # the disc covers the hinge
    here = _is_as_high(snapshot, place[:, None, 2] - leaves.height, leaves.size[None, :, 2])
    return swept & here & is_shut(snapshot) & (leaves.hinge_mask > 0)


def plan_opening(snapshot: Snapshot) -> tuple[Bool[Array, " a"], Bool[Array, " a"], Float[Array, " a"]]:
    """Plan how agents that carry something open the nearest leaf that is less than half open; requires `has_hands`.

    If its swing would hit them or the object, they first go beyond its free edge, within reach but clear of the swing.

    Returns:
        Whether each agent is busy with that; whether it is in place to open the leaf; heading to turn to [rad]. An
        agent is not busy if no such leaf is near, or it carries nothing.
    """
    pos, holds = snapshot.feet, snapshot.held >= 0
    if not snapshot.door_angle.shape[0]:
        return jnp.zeros_like(holds), jnp.zeros_like(holds), snapshot.pose.yaw
    away, way = _leaf_offsets(snapshot, pos, is_shut(snapshot))
    leaf, agents = jnp.argmin(away, axis=1), jnp.arange(pos.shape[0])
    _, turn, arc = _hinge_coordinates(snapshot, pos)
    before = ((turn > 0) & (turn < arc + SWING_CLEARANCE_ANGLE))[agents, leaf]  # not behind it, nor behind a wall
    near, towards = (away[agents, leaf] < jnp.float32(CARRY_OPEN_DISTANCE)) & before, way[agents, leaf]
    face = jnp.arctan2(towards[:, 1], towards[:, 0])
    place, radius = carried_discs(snapshot, face)
    own = jnp.full_like(radius, snapshot.bank.spec.agent_radius)
    discs = (pos, own), (jnp.concatenate([place, pos[:, 2:]], axis=1), radius)
    swept = jnp.any(jnp.stack([is_swept(snapshot, *disc)[agents, leaf] for disc in discs]), axis=0)
    reach = jnp.linalg.norm(place - pos[:, :2], axis=-1) + radius
    beyond = _edge_positions(snapshot, leaf, reach) - pos[:, :2]
    face = jnp.where(swept, jnp.arctan2(beyond[:, 1], beyond[:, 0]), face)
    return holds & (swept | near), holds & near & ~swept, face


def _house_leaves(snapshot: Snapshot) -> DoorLeaves:
    """Return the door leaves of the snapshot's house."""
    return jax.tree.map(lambda x: x[snapshot.house], DoorLeaves.from_physics(snapshot.bank.physics))


def _swing_angles(snapshot: Snapshot, leaves: DoorLeaves) -> tuple[Float[Array, " h"], Float[Array, " h"]]:
    """Return world headings of leaves from hinge to free edge, and signed angles until they are wide open [rad]."""
    now = jnp.arctan2(leaves.arm[:, 1], leaves.arm[:, 0]) + snapshot.door_angle
    return now, snapshot.bank.physics.door_fully_open[snapshot.house] - snapshot.door_angle


def _hinge_coordinates(
    snapshot: Snapshot, place: Float[Array, "n 3"]
) -> tuple[Float[Array, "n h"], Float[Array, "n h"], Float[Array, " h"]]:
    """Return plan distances of positions to hinges [m], and two angles by which leaves open from now [rad].

    The first one turns the leaf to the position, and is negative behind it; the second until it is wide open.
    """
    leaves = _house_leaves(snapshot)
    offset = place[:, None, :2] - leaves.pivot[None]
    now, opens = _swing_angles(snapshot, leaves)
    turn = wrap_angle(jnp.arctan2(offset[..., 1], offset[..., 0]) - now) * jnp.sign(opens)
    return jnp.maximum(jnp.linalg.norm(offset, axis=-1), 1e-3), turn, jnp.abs(opens)


def _edge_positions(snapshot: Snapshot, leaf: Int[Array, " a"], spare: Float[Array, " a"]) -> Float[Array, "a 2"]:
    """Return positions `spare` [m] beyond the free edge of a leaf per agent, a little to its opening side [m]."""
    leaves = _house_leaves(snapshot)
    now, opens = _swing_angles(snapshot, leaves)
    angle = now + jnp.sign(opens) * SWING_CLEARANCE_ANGLE
    far = 2 * jnp.sqrt(leaves.hinge_distance_sq)[leaf] + spare
    way = jnp.stack([jnp.cos(angle), jnp.sin(angle)], axis=-1)[leaf]
    return leaves.pivot[leaf] + way * far[:, None]


def cell_cost_factors(snapshot: Snapshot, level: Int[Array, ""]) -> Float[Array, "rows columns"]:
    """Return the `cost_factors` of all cells of one level of the house's grids, from door leaves only.

    Agents and carried objects do not count. Cells without a number have the height of the nearest numbered one. Leaves
    are handled one after the other, by squared distances, which is several times as fast for so many cells.
    """
    bank, house, leaves = snapshot.bank, snapshot.house, _house_leaves(snapshot)
    rows, columns = bank.navigation.room.shape[2:]
    y, x = ((jnp.arange(n, dtype=jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) for n in (rows, columns))
    origin = bank.navigation.origin[house]
    y, x = (y + origin[1])[:, None], (x + origin[0])[None]
    z = bank.navigation.height[row_of_cell(bank.navigation.cell[house, level])]
    pos, cos, sin = _leaf_frames(snapshot, leaves)

    def nearer(gap: Float[Array, "rows columns"], leaf: tuple[Array, ...]) -> tuple[Array, None]:
        """Return the minimum of `gap` and the squared plan distances to one leaf [m^2]."""
        pos, cos, sin, half, counts = leaf
        u, v = _offset_from_leaf(x - pos[0], y - pos[1], cos, sin, half)
        here = counts & _is_as_high(snapshot, z - pos[2], half[2])
        return jnp.minimum(gap, jnp.where(here, u * u + v * v, jnp.inf)), None

    none = jnp.full((rows, columns), jnp.inf, jnp.float32)
    gap, _ = jax.lax.scan(nearer, none, (pos, cos, sin, leaves.size, leaves.valid))
    return _slow_down(snapshot, jnp.sqrt(gap))
