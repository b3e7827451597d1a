"""Going to the nearest of some places that are known only at run time."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.fields import distance_field
from home_mjx.navigation.grid import cell_of, row_of_cell
from home_mjx.schema.compiled import FIELD_UNIT
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.descent import descend, is_home
from home_mjx.tasks.experts.leaves import cells_at_leaves
from home_mjx.tasks.experts.walk import to_actions


def seek(snapshot: Snapshot, wanted: Bool[Array, "levels rows columns"]) -> Array:
    """Actions of all agents, each towards the nearest cell that is wanted.

    On its own storey that is by a field of distances made for the purpose, past the leaves of doors as long as there is
    something to be had without brushing one. If there is none, it goes to the nearest of the house's goals on a storey
    that has some. If there is none at all it stays where it is.

    Args:
        snapshot: The environment.
        wanted: Cells of the house's grids; those where agents cannot walk do not count.
    """
    bank, house, pose = snapshot.bank, snapshot.house, snapshot.pose
    navigation, numbers = bank.navigation, bank.navigation.cell[house]
    home = is_home(bank, house, numbers)
    clear = home & ~cells_at_leaves(snapshot)
    wanted = wanted & home
    goals = navigation.goal[house]
    storey = jax.vmap(lambda at: cell_of(bank, house, at))(goals)[:, 0]

    def one(pos: Float[Array, "3"], touches: Bool[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        level, row, column = cell_of(bank, house, pos)
        whole = distance_field(home[level], wanted[level], bank.spec.cell)
        easy = distance_field(clear[level], wanted[level], bank.spec.cell)
        near = jnp.where(jnp.isfinite(easy[row, column]), easy, whole)
        way = navigation.field[row_of_cell(numbers[level, row, column])].astype(jnp.float32)
        other = jnp.argmin(jnp.where(jnp.any(wanted, axis=(1, 2))[storey] & (storey != level), way, jnp.inf))
        is_here = jnp.any(wanted[level])

        def far(place: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            there = navigation.field[row_of_cell(cell), other].astype(jnp.float32) * jnp.float32(FIELD_UNIT)
            return jnp.where(is_here, near[place[:, 1], place[:, 2]], there)

        return descend(bank, house, pos, touches, far)

    aim, _ = jax.vmap(one)(pose.pos, snapshot.contact)
    aim, done = aim - pose.pos[:, :2], jnp.broadcast_to(~jnp.any(wanted), pose.yaw.shape)
    error = (jnp.arctan2(aim[:, 1], aim[:, 0]) - pose.yaw + jnp.pi) % (2 * jnp.pi) - jnp.pi
    error = jnp.where(done, 0.0, error)
    return to_actions(snapshot.config, error, -pose.pitch, done, jnp.zeros_like(done))
