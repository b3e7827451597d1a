"""Path to one of a set of cells that is known only at run time."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.distance_fields import distance_field
from home_mjx.navigation.grid import (
    cell_at_feet,
    cell_number,
    is_home_cell,
    is_passable_cell,
    row_of_cell,
    stored_distance,
)
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.door_avoidance import cell_cost_factors
from home_mjx.tasks.experts.field_descent import descend_field
from home_mjx.tasks.experts.path_follower import to_actions, turn_towards
from home_mjx.tasks.rules.cell_graph import PUSH_COST_FACTOR

NEIGHBOUR_OFFSETS = np.arange(-2, 3)  # [cells], neighbourhood of an agent, which may be beside walkable cells
STRIP_WIDTH = 3.0  # [m], maximum width of the strips in which a room is swept


def seek_cells(
    snapshot: Snapshot, targets: Bool[Array, "levels rows columns"], unvisited: Bool[Array, "levels rows columns"]
) -> Array:
    """Return actions of all agents towards cells, by `turns_to_cells`; `stop` where there is none to go to.

    With continuous actions, which have no `stop`, they turn on the spot instead.
    """
    pose = snapshot.pose
    error, done = turns_to_cells(snapshot, targets, unvisited)
    return to_actions(snapshot.config, jnp.where(done, 1.0, error), -pose.pitch, hold=done, stop=done)


def turns_to_cells(
    snapshot: Snapshot,
    targets: Bool[Array, "levels rows columns"],
    unvisited: Bool[Array, "levels rows columns"],
    num_agents: int = -1,
) -> tuple[Float[Array, " n"], Bool[Array, " n"]]:
    """Return turns of agents towards cells of `targets` [rad, to the left], and which have none to go to.

    An agent sweeps the part of a room in which it is: it goes to the nearer of the first and the last target there, in
    the order of `sweep_order`. This order depends neither on the agent nor on the targets, so that the agent does not
    turn to and fro between targets on both sides. Parts end at door leaves: an open leaf may close a narrow passage, so
    that no agent without hands gets through. In a part without targets the agent goes to the nearest one of its level.

    Paths follow distance fields computed for the purpose, past door leaves at their current angles. Without such a
    path, an agent goes to the nearest of the house's goals in `unvisited`.

    Args:
        snapshot: The environment.
        targets: Cells of the house's grids; those that are not walkable do not count.
        unvisited: Cells of the grids; the house's goals in them are worth a visit.
        num_agents: Number of agents, the first ones; -1: all.
    """
    bank, house = snapshot.bank, snapshot.house
    agents = jnp.arange(snapshot.config.num_agents)[slice(None) if num_agents < 0 else slice(num_agents)]
    navigation = bank.navigation
    goals = jax.vmap(lambda at: cell_at_feet(bank, house, at))(navigation.goal[house])
    is_left = unvisited[goals[:, 0], goals[:, 1], goals[:, 2]]

    def one(agent: Int[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        """Return one agent's waypoint (x, y) [m], and whether it has no cell to go to."""
        at = cell_at_feet(bank, house, snapshot.feet[agent])
        level = at[0]
        near = _fields_to_targets(snapshot, at, targets[level])
        y, x = (jnp.clip(n + NEIGHBOUR_OFFSETS, 0, most - 1) for n, most in zip(at[1:], near.shape, strict=True))
        is_near = jnp.any(jnp.isfinite(near[y[:, None], x[None]]))
        way = navigation.field[row_of_cell(cell_number(bank, house, at))]
        other = jnp.argmin(jnp.where(is_left, way.astype(jnp.float32), jnp.inf))

        def far(place: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            """Return distances [m] to the chosen targets on the agent's level, else to the house's goal."""
            there = stored_distance(navigation.field, cell, other)
            here = jnp.where(place[:, 0] == level, near[place[:, 1], place[:, 2]], jnp.inf)
            return jnp.where(is_near, here, there)

        return descend_field(snapshot, agent, far)[0], ~is_near & ~jnp.any(is_left)

    aim, done = jax.vmap(one)(agents)
    return turn_towards(snapshot, aim, agents), done


def sweep_order(part: Bool[Array, "rows columns"], cell: float) -> Int[Array, "rows columns"]:
    """Return the place of cells in a sweep of a part of a grid: along its longer side in strips, to and fro.

    Strips are equally wide, at most `STRIP_WIDTH`. Cells side by side across a strip have the same place.

    Args:
        part: Cells that are swept; the others may have any place.
        cell: Cell size [m].
    """

    def extent(inside: Bool[Array, " n"]) -> tuple[Int[Array, " n"], Int[Array, ""]]:
        """Return the places along an axis, counted from the part's first one, and their number within the part."""
        first = jnp.argmax(inside)
        return jnp.arange(inside.size) - first, inside.size - jnp.argmax(inside[::-1]) - first

    (row, rows), (column, columns) = (extent(jnp.any(part, axis=axis)) for axis in (1, 0))
    row, column = row[:, None], column[None]
    is_tall = rows >= columns
    along, length = jnp.where(is_tall, row, column), jnp.where(is_tall, rows, columns)
    beside, width = jnp.where(is_tall, column, row), jnp.where(is_tall, columns, rows)
    num_strips = jnp.ceil(width * jnp.float32(cell / STRIP_WIDTH)).astype(jnp.int32)
    strip = beside * num_strips // jnp.maximum(width, 1)
    return strip * length + jnp.where(strip % 2 == 0, along, length - 1 - along)


def _nearest_cell(mask: Bool[Array, "rows columns"], at: Int[Array, "3"]) -> Bool[Array, "rows columns"]:
    """Return the mask of the cell in `mask` nearest to `at` (level, row, column) in plan; empty without any.

    An agent beside furniture is in no walkable cell.
    """
    y, x = (jnp.arange(n) - here for n, here in zip(mask.shape, at[1:], strict=True))
    away = jnp.where(mask, (y**2)[:, None] + (x**2)[None], np.iinfo(np.int32).max)
    return mask & (jnp.arange(away.size).reshape(away.shape) == jnp.argmin(away))


def _fields_to_targets(
    snapshot: Snapshot, at: Int[Array, "3"], targets: Bool[Array, "rows columns"]
) -> Float[Array, "rows columns"]:
    """Return distances [m] of an agent's level to targets: two in the agent's part of its room, else all.

    The two are the first and the last in `sweep_order`, and distances to them are over that part alone.

    Args:
        snapshot: The environment.
        at: The agent's cell (level, row, column).
        targets: Cells of the level.
    """
    bank, house, level = snapshot.bank, snapshot.house, at[0]
    navigation, cell = bank.navigation, bank.navigation.cell[house, level]
    home, room = is_home_cell(bank, house, cell), navigation.room[house, level]
    height, passable = navigation.height[row_of_cell(cell)], is_passable_cell(bank, house, cell)
    slow = cell_cost_factors(snapshot, level)
    own = home & (room == room[at[1], at[2]]) & (room >= 0)
    begin = _nearest_cell(own, at)
    own &= (slow < PUSH_COST_FACTOR) | begin
    part = jnp.isfinite(distance_field(own, begin, bank.spec.cell, slow, height, passable))
    left = part & targets
    order = sweep_order(part, bank.spec.cell)
    first = left & (order == jnp.min(jnp.where(left, order, order.size)))
    last = left & (order == jnp.max(jnp.where(left, order, -1)))
    sweeps = jnp.any(left)
    ends, floor = jnp.where(sweeps, first | last, targets), jnp.where(sweeps, part, home)
    return distance_field(floor, ends, bank.spec.cell, slow, height, passable)
