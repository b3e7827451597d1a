"""Path to the nearest of a set of cells that is known only at run time."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.distance_fields import distance_field
from home_mjx.navigation.grid import cell_at_feet, is_home_cell, is_passable_cell, row_of_cell, stored_distance
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.door_avoidance import cell_cost_factors
from home_mjx.tasks.experts.field_descent import descend_field
from home_mjx.tasks.experts.path_follower import to_actions, turn_towards

NEIGHBOUR_OFFSETS = np.array([-1, 0, 1])  # [cells], neighbourhood of an agent


def seek_nearest_cell(
    snapshot: Snapshot, targets: Bool[Array, "levels rows columns"], unvisited: Bool[Array, "levels rows columns"]
) -> Array:
    """Return actions of all agents towards cells, by `turns_to_nearest_cell`; `stop` where there is none to go to.

    With continuous actions, which have no `stop`, they turn on the spot instead.
    """
    pose = snapshot.pose
    error, done = turns_to_nearest_cell(snapshot, targets, unvisited)
    return to_actions(snapshot.config, jnp.where(done, 1.0, error), -pose.pitch, hold=done, stop=done)


def turns_to_nearest_cell(
    snapshot: Snapshot,
    targets: Bool[Array, "levels rows columns"],
    unvisited: Bool[Array, "levels rows columns"],
    num_agents: int = -1,
) -> tuple[Float[Array, " n"], Bool[Array, " n"]]:
    """Return turns of agents towards the nearest cell of `targets` [rad, to the left], and which have none to go to.

    On the agent's level the path follows a distance field computed for the purpose, past door leaves at their current
    angles. Without such a path, an agent goes to the nearest of the house's goals in `unvisited`.

    Args:
        snapshot: The environment.
        targets: Cells of the house's grids; those that are not walkable do not count.
        unvisited: Cells of the grids; the house's goals in them are worth a visit.
        num_agents: Number of agents, the first ones; -1: all.
    """
    bank, house = snapshot.bank, snapshot.house
    agents = jnp.arange(snapshot.config.num_agents)[slice(None) if num_agents < 0 else slice(num_agents)]
    navigation, numbers = bank.navigation, bank.navigation.cell[house]
    home = is_home_cell(bank, house, numbers)
    goals = jax.vmap(lambda at: cell_at_feet(bank, house, at))(navigation.goal[house])
    is_left = unvisited[goals[:, 0], goals[:, 1], goals[:, 2]]

    def one(agent: Int[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        """Return one agent's waypoint (x, y) [m], and whether it has no cell to go to."""
        level, row, column = cell_at_feet(bank, house, snapshot.feet[agent])
        height = navigation.height[row_of_cell(numbers[level])]
        passable = is_passable_cell(bank, house, numbers[level])
        slow = cell_cost_factors(snapshot, level)
        near = distance_field(home[level], targets[level], bank.spec.cell, slow, height, passable)
        y, x = (
            jnp.clip(at + NEIGHBOUR_OFFSETS, 0, most - 1) for at, most in zip((row, column), near.shape, strict=True)
        )
        is_near = jnp.any(jnp.isfinite(near[y[:, None], x[None]]))
        way = navigation.field[row_of_cell(numbers[level, row, column])]
        other = jnp.argmin(jnp.where(is_left, way.astype(jnp.float32), jnp.inf))

        def far(place: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            """Return distances [m] to the nearest target on the agent's level, else to the house's goal."""
            there = stored_distance(navigation.field, cell, other)
            here = jnp.where(place[:, 0] == level, near[place[:, 1], place[:, 2]], jnp.inf)
            return jnp.where(is_near, here, there)

        return descend_field(snapshot, agent, far)[0], ~is_near & ~jnp.any(is_left)

    aim, done = jax.vmap(one)(agents)
    return turn_towards(snapshot, aim, agents), done
