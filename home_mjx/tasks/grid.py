"""Look-ups in a house's navigation grid, on the device."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.scene_compile.bank import HouseBank

# The agent's axis may stand a little inside a cell that is not free, so the neighbours count as well.
_OFFSETS = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]


def cell_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Row and column of the cell that holds a point, clipped to the grid."""
    rows, columns = bank.navigation.free.shape[1:]
    index = jnp.floor((pos[:2] - bank.navigation.origin[house]) / jnp.float32(bank.spec.cell)).astype(jnp.int32)
    return jnp.clip(index[1], 0, rows - 1), jnp.clip(index[0], 0, columns - 1)


def room_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Int[Array, ""]:
    """Index of the room that holds a point; -1 outside."""
    row, column = cell_of(bank, house, pos)
    return bank.navigation.room[house, row, column]


def geodesic_distance(
    bank: HouseBank, house: Int[Array, ""], goal: Int[Array, ""] | None, pos: Float[Array, "3"]
) -> Float[Array, "..."]:
    """Length of the shortest path from a point to a goal, or to every goal if `goal` is None.

    Args:
        bank: The houses.
        house: Index of the house.
        goal: Index of the goal, or None.
        pos: The point [m], world frame.

    Returns:
        [m]; the best of the 3 × 3 cells around the point plus the way to that cell's centre; inf if none is reachable.
    """
    row, column = cell_of(bank, house, pos)
    rows, columns = bank.navigation.free.shape[1:]
    offsets = jnp.array(_OFFSETS, jnp.int32)
    y = jnp.clip(row + offsets[:, 0], 0, rows - 1)
    x = jnp.clip(column + offsets[:, 1], 0, columns - 1)
    goals = bank.navigation.field[house] if goal is None else bank.navigation.field[house, goal]
    centre = (jnp.stack([x, y], axis=-1).astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    way = jnp.linalg.norm(centre + (bank.navigation.origin[house] - pos[:2])[None], axis=-1)
    around = goals[..., y, x]
    return jnp.min(around + way.reshape((1,) * (around.ndim - 1) + way.shape), axis=-1)
