"""Path to the nearest of a set of cells that is known only at run time."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.fields import distance_field
from home_mjx.navigation.grid import cell_of, is_home, row_of_cell, stored_distance
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.descent import descend
from home_mjx.tasks.experts.leaves import slow_cells
from home_mjx.tasks.experts.walk import to_actions, turn_towards

AROUND = np.array([-1, 0, 1])  # [cells], neighbourhood of an agent


def seek(
    snapshot: Snapshot, wanted: Bool[Array, "levels rows columns"], left: Bool[Array, "levels rows columns"]
) -> Array:
    """Return actions of all agents towards their nearest wanted cell, see `ways_to`; `stop` if there is none.

    With continuous actions, which have no `stop`, they turn on the spot instead.
    """
    pose = snapshot.pose
    error, done = ways_to(snapshot, wanted, left)
    return to_actions(snapshot.config, jnp.where(done, 1.0, error), -pose.pitch, near=done, stop=done)


def ways_to(
    snapshot: Snapshot,
    wanted: Bool[Array, "levels rows columns"],
    left: Bool[Array, "levels rows columns"],
    num: int = -1,
) -> tuple[Float[Array, " n"], Bool[Array, " n"]]:
    """Return turns of agents towards the nearest wanted cell [rad, to the left], and whether there is none.

    On the agent's level the path follows a distance field computed for the purpose, past door leaves at their current
    angles. Without such a path, an agent goes to the nearest of the house's goals in `left`.

    Args:
        snapshot: The environment.
        wanted: Cells of the house's grids; those that are not walkable do not count.
        left: Cells whose goals are worth a visit.
        num: Number of agents, the first ones; -1: all.
    """
    bank, house = snapshot.bank, snapshot.house
    agents = jnp.arange(snapshot.config.num_agents)[slice(None) if num < 0 else slice(num)]
    navigation, numbers = bank.navigation, bank.navigation.cell[house]
    home, slow = is_home(bank, house, numbers), slow_cells(snapshot)
    goals = jax.vmap(lambda at: cell_of(bank, house, at))(navigation.goal[house])
    is_left = left[goals[:, 0], goals[:, 1], goals[:, 2]]

    def one(agent: Int[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        level, row, column = cell_of(bank, house, snapshot.pose.pos[agent])
        near = distance_field(home[level], wanted[level], bank.spec.cell, slow[level])
        y, x = (jnp.clip(at + AROUND, 0, most - 1) for at, most in zip((row, column), near.shape, strict=True))
        is_near = jnp.any(jnp.isfinite(near[y[:, None], x[None]]))
        way = navigation.field[row_of_cell(numbers[level, row, column])]
        other = jnp.argmin(jnp.where(is_left, way.astype(jnp.float32), jnp.inf))

        def far(place: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            there = stored_distance(navigation.field, cell, other)
            return jnp.where(is_near, near[place[:, 1], place[:, 2]], there)

        return descend(snapshot, agent, far)[0], ~is_near & ~jnp.any(is_left)

    aim, done = jax.vmap(one)(agents)
    return turn_towards(snapshot, aim, agents), done
