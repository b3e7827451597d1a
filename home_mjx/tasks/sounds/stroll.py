"""Motion of sound sources without a body: descent of a distance field from cell to cell."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_of, is_home_cell, row_of_cell
from home_mjx.schema.compiled import FIELD_UNREACHABLE

NUM_SUBSTEPS = 4  # number of parts of a move; each one ends at the next cell at the latest


def move_along_field(
    bank: HouseBank,
    house: Int[Array, ""],
    field: UInt16[Array, "cell f"],
    goal: Int[Array, ""],
    pos: Float[Array, "3"],
    max_length: Float[Array, ""],
    height: Float[Array, ""],
) -> Float[Array, "3"]:
    """Return the position of a point above the floor after a move along the shortest path.

    Args:
        bank: The houses.
        house: Index of the house.
        field: Distances of all cells to goals, stored as in `Navigation.field`.
        goal: Column of the field.
        pos: Position before the move [m].
        max_length: Maximum length of the move [m]; the part of it beyond `NUM_SUBSTEPS` cells is dropped.
        height: Height of the point above the floor [m].
    """
    navigation, numbers = bank.navigation, bank.navigation.cell[house]
    around = jnp.array([(0, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)], jnp.int32)
    limits = jnp.array(numbers.shape, jnp.int32) - 1
    for _ in range(NUM_SUBSTEPS):
        # The level is looked up at the height of an agent's middle.
        at = cell_of(bank, house, pos.at[2].add(jnp.float32(bank.spec.agent_height / 2) - height))
        near = jnp.clip(at + around, 0, limits)
        cell = numbers[near[:, 0], near[:, 1], near[:, 2]]
        home = is_home_cell(bank, house, cell)
        row = row_of_cell(cell)
        best = jnp.argmin(jnp.where(home, field[row, goal].astype(jnp.int32), FIELD_UNREACHABLE + 1))
        plan = (near[best, :0:-1].astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) + navigation.origin[house]
        aim = jnp.append(plan, navigation.height[row[best]] + height)
        aim = jnp.where(jnp.any(home), aim, pos)
        length = jnp.linalg.norm(aim - pos)
        pos = pos + (aim - pos) * jnp.minimum(1.0, max_length / NUM_SUBSTEPS / jnp.maximum(length, 1e-6))
    return pos
