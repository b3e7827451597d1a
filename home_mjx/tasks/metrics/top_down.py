"""Top-down map of an agent's storey with its goal, its path and the area it has seen, as Habitat's `top_down_map`.

A measure for evaluation, visualization and debugging, not an observation: it has information that agents lack. Savva et
al., "Habitat: A Platform for Embodied AI Research", 2019 (arXiv:1904.01201).
"""

import math
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from home_mjx.core.named_enum import NamedIntEnum
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import wrap_angle
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import cell_at_feet, is_home_cell
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.metrics.goal_cells import goal_cells
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position

NUM_RAYS = 64  # number of rays across the horizontal field of view
OTHER_STOREY = -1  # row and column of positions on another storey


class CellOccupancy(NamedIntEnum):
    """Class of a map cell."""

    OUTSIDE = 0  # outside of all rooms, or within a wall
    BLOCKED = 1  # in a room, but too narrow for an agent
    FREE = 2  # agents can go there in the house as compiled; later moves of objects do not count


class MapMemory(Pytree):
    """Map data accumulated over an episode; A agents, the cells of all storeys of the house."""

    start: Float[Array, "a 3"]  # [m], first position of each agent's feet
    last: Float[Array, "a 3"]  # [m], last position of its feet
    visited: Bool[Array, "a levels rows columns"]  # cells that the agent's centre has passed through
    seen: Bool[Array, "a levels rows columns"]  # cells that have been in its view, unoccluded at eye height


class TopDownMap(Pytree):
    """Map of the storey of one agent, of A.

    Cells have the edge `bank.spec.cell`; rows go along +y, columns along +x.
    """

    occupancy: UInt8[Array, "rows columns"]  # `CellOccupancy`
    goal: Bool[Array, "rows columns"]  # of the present stage: cells of its rooms, under its objects, of its point
    visited: Bool[Array, "rows columns"]  # by this agent
    seen: Bool[Array, "rows columns"]  # by this agent; all other cells are in the fog of war
    start: Int[Array, "2"]  # row and column; -1 on another storey
    agents: Int[Array, "a 2"]  # row and column of every agent; -1 on another storey
    yaw: Float[Array, " a"]  # [rad], from +x to +y
    level: Int[Array, ""]


def update_map_memory(snapshot: Snapshot, memory: MapMemory | None = None) -> MapMemory:
    """Return the updated map memory; to be called after each reset and step, for one environment, inside `jit`.

    Args:
        snapshot: The environment. At the first step of an episode, also after an automatic reset, memory is cleared.
        memory: Memory of the previous step; None if there is none.

    Example:
        >>> memory = update_map_memory(core.snapshot(params, state))  # doctest: +SKIP
        >>> state = core.step(params, state, action)  # doctest: +SKIP
        >>> memory = update_map_memory(core.snapshot(params, state), memory)  # doctest: +SKIP
    """
    feet = snapshot.feet
    if memory is None:
        nothing = jnp.zeros((feet.shape[0], *snapshot.bank.navigation.room.shape[1:]), bool)
        memory = MapMemory(start=feet, last=feet, visited=nothing, seen=nothing)
    first = snapshot.step == 0
    last = jnp.where(first, feet, memory.last)
    return MapMemory(
        start=jnp.where(first, feet, memory.start),
        last=feet,
        visited=(memory.visited & ~first) | _passed_cells(snapshot, last),
        seen=(memory.seen & ~first) | _visible_cells(snapshot),
    )


def top_down_map(snapshot: Snapshot, task: Any, memory: MapMemory, agent: int = 0) -> TopDownMap:
    """Return the map of one agent's storey.

    Args:
        snapshot: The environment.
        task: State of the task, `State.task`. PointNav and tasks of a task bank's rows have goals.
        memory: Map memory, see `update_map_memory`.
        agent: Index of the agent.

    Raises:
        ConfigError: The agent does not exist.

    Example:
        >>> found = top_down_map(core.snapshot(params, state), state.task, memory)  # doctest: +SKIP
        >>> share_seen = found.seen[found.occupancy == CellOccupancy.FREE].mean()  # doctest: +SKIP
    """
    if not 0 <= agent < memory.start.shape[0]:
        raise ConfigError(f"there are agents 0 to {memory.start.shape[0] - 1}, asked for the map of {agent}")
    bank, house = snapshot.bank, snapshot.house
    places, start = (jax.vmap(lambda at: cell_at_feet(bank, house, at))(x) for x in (snapshot.feet, memory.start))
    level = places[agent, 0]
    room, number = bank.navigation.room[house, level], bank.navigation.cell[house, level]
    ground = jnp.where(
        is_home_cell(bank, house, number),
        CellOccupancy.FREE,
        jnp.where(room >= 0, CellOccupancy.BLOCKED, CellOccupancy.OUTSIDE),
    )
    return TopDownMap(
        occupancy=ground.astype(jnp.uint8),
        goal=goal_cells(snapshot, task, level),
        visited=memory.visited[agent, level],
        seen=memory.seen[agent, level],
        start=_on_level(level, start[agent]),
        agents=_on_level(level, places),
        yaw=wrap_angle(snapshot.pose.yaw),
        level=level,
    )


def _on_level(level: Int[Array, ""], place: Int[Array, "*a 3"]) -> Int[Array, "*a 2"]:
    """Return row and column of cells (level, row, column); `OTHER_STOREY` for those on another level."""
    return jnp.where(place[..., :1] == level, place[..., 1:], OTHER_STOREY)


def _passed_cells(snapshot: Snapshot, last: Float[Array, "a 3"]) -> Bool[Array, "a levels rows columns"]:
    """Return cells under a straight line from each agent's last feet position to its present one, as a mask.

    Points of the line at most half a cell apart count, for moves up to full forward speed.
    """
    bank, house, config = snapshot.bank, snapshot.house, snapshot.config
    way = max(body.forward_speed for body in config.agents) * config.timing.ctrl_dt
    parts = jnp.linspace(0, 1, 2 + math.ceil(2 * way / bank.spec.cell))
    none = jnp.zeros(bank.navigation.room.shape[1:], bool)

    def one(before: Float[Array, "3"], now: Float[Array, "3"]) -> Array:
        """Return the mask of one agent."""
        passed = before + parts[:, None] * (now - before)
        level, row, column = jax.vmap(lambda at: cell_at_feet(bank, house, at))(passed).T
        return none.at[level, row, column].set(True)

    return jax.vmap(one)(last, snapshot.feet)


def _visible_cells(snapshot: Snapshot) -> Bool[Array, "a levels rows columns"]:
    """Return a mask of cells of each agent's own level that it sees at eye height, and its own cell.

    Seen are centres in the horizontal field of view of the `head` camera, straight ahead, and within `max_depth`. They
    are not behind the first hit of the nearest of `NUM_RAYS` horizontal rays.
    """
    bank, house, config, pose = snapshot.bank, snapshot.house, snapshot.config, snapshot.pose
    levels, rows, columns = bank.navigation.room.shape[1:]
    half = math.atan(math.tan(math.radians(config.fovy) / 2) * config.width / config.height)
    turns = pose.yaw[:, None] + jnp.linspace(-half, half, NUM_RAYS)
    ways = jnp.stack([jnp.cos(turns), jnp.sin(turns), jnp.zeros_like(turns)], axis=-1)
    eyes = jnp.broadcast_to(eye_position(config, pose)[:, None], ways.shape)
    own = jnp.broadcast_to(agent_ids(bank, pose.yaw.shape[0])[:, None], turns.shape)
    free = jnp.minimum(cast(snapshot.scene, eyes, ways, exclude=own).t, jnp.float32(config.max_depth))
    x, y = (
        origin + (jnp.arange(n, dtype=jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
        for origin, n in zip(bank.navigation.origin[house], (columns, rows), strict=True)
    )

    def one(feet: Float[Array, "3"], yaw: Float[Array, ""], free: Float[Array, " n"]) -> Array:
        """Return the mask of one agent, whose rays are free up to `free` [m]."""
        ahead, aside = jnp.broadcast_arrays(x[None] - feet[0], y[:, None] - feet[1])
        turn, away = wrap_angle(jnp.arctan2(aside, ahead) - yaw), jnp.hypot(ahead, aside)
        ray = jnp.round((turn / half + 1) / 2 * (NUM_RAYS - 1)).astype(jnp.int32)
        known = (jnp.abs(turn) <= half) & (away <= free[jnp.clip(ray, 0, NUM_RAYS - 1)])
        at = cell_at_feet(bank, house, feet)
        return ((jnp.arange(levels) == at[0])[:, None, None] & known[None]).at[at[0], at[1], at[2]].set(True)

    return jax.vmap(one)(snapshot.feet, pose.yaw, free)
