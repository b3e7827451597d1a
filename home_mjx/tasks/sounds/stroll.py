"""Going down a field of distances without a body: from cell to cell, to the neighbour that is nearest to the goal."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_of, is_home, row_of_cell
from home_mjx.schema.compiled import FIELD_FAR

PARTS = 4  # of a way: none goes farther than to the next cell


def strolled(
    bank: HouseBank,
    house: Int[Array, ""],
    field: UInt16[Array, "cell f"],
    goal: Int[Array, ""],
    pos: Float[Array, "3"],
    way: Float[Array, ""],
    height: Float[Array, ""],
) -> Float[Array, "3"]:
    """A point above the floor after a way along the shortest path.

    Args:
        bank: The houses.
        house: Index of the house.
        field: Distances of all cells to goals, stored as in `Navigation.field`.
        goal: Column of the field.
        pos: Where it is [m].
        way: How far it goes at most [m]; of a way longer than `PARTS` cells the rest is not gone.
        height: Of the point above the floor [m].
    """
    navigation, numbers = bank.navigation, bank.navigation.cell[house]
    around = jnp.array([(0, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)], jnp.int32)
    limits = jnp.array(numbers.shape, jnp.int32) - 1
    for _ in range(PARTS):
        # As an agent's, whose middle says on which level it is.
        at = cell_of(bank, house, pos.at[2].add(jnp.float32(bank.spec.agent_height / 2) - height))
        near = jnp.clip(at + around, 0, limits)
        cell = numbers[near[:, 0], near[:, 1], near[:, 2]]
        home = is_home(bank, house, cell)
        row = row_of_cell(cell)
        best = jnp.argmin(jnp.where(home, field[row, goal].astype(jnp.int32), FIELD_FAR + 1))
        plan = (near[best, :0:-1].astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) + navigation.origin[house]
        aim = jnp.append(plan, navigation.height[row[best]] + height)
        aim = jnp.where(jnp.any(home), aim, pos)
        length = jnp.linalg.norm(aim - pos)
        pos = pos + (aim - pos) * jnp.minimum(1.0, way / PARTS / jnp.maximum(length, 1e-6))
    return pos
