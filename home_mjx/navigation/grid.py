"""Look-ups in a house's navigation grids, on the device."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.schema.compiled import FIELD_FAR, FIELD_UNIT

# The agent's axis may stand a little inside a cell that is not free, so its neighbours count as well.
_OFFSETS = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
_BELOW = 0.3  # [m]: a point this far below a floor still counts as on it


def cell_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Int[Array, "3"]:
    """Grid (level), row and column of the cell that holds a point, clipped to the grid.

    The grid is the one of the highest floor that is not above the point.
    """
    navigation, house = bank.navigation, bank.known_house(house)
    levels, rows, columns = navigation.room.shape[1:]
    above = pos[2] >= navigation.floor[house] - jnp.float32(_BELOW)
    level = jnp.maximum(jnp.sum(above.astype(jnp.int32)) - 1, 0)
    index = jnp.floor((pos[:2] - navigation.origin[house]) / jnp.float32(bank.spec.cell)).astype(jnp.int32)
    return jnp.clip(jnp.stack([level, index[1], index[0]]), 0, jnp.array([levels, rows, columns], jnp.int32) - 1)


def room_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Int[Array, ""]:
    """Index of the room that holds a point; -1 outside."""
    level, row, column = cell_of(bank, house, pos)
    return bank.navigation.room[bank.known_house(house), level, row, column].astype(jnp.int32)


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
    navigation, house = bank.navigation, bank.known_house(house)
    level, row, column = cell_of(bank, house, pos)
    rows, columns = navigation.room.shape[2:]
    offsets = jnp.array(_OFFSETS, jnp.int32)
    y = jnp.clip(row + offsets[:, 0], 0, rows - 1)
    x = jnp.clip(column + offsets[:, 1], 0, columns - 1)
    cell = navigation.cell[house, level, y, x]
    around = stored_distance(bank, cell, goal)
    centre = (jnp.stack([x, y], axis=-1).astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    way = jnp.linalg.norm(centre + (navigation.origin[house] - pos[:2])[None], axis=-1)
    return jnp.min(around + way.reshape(way.shape + (1,) * (around.ndim - 1)), axis=0)


def stored_distance(bank: HouseBank, cell: Int[Array, " n"], goal: Int[Array, ""] | None) -> Float[Array, "n ..."]:
    """Geodesic distance from numbered cells to a goal of their house, or to all [m]; inf for cell -1."""
    rows = jnp.maximum(cell, 0)
    stored = bank.navigation.field[rows] if goal is None else bank.navigation.field[rows, goal]
    none = (cell < 0).reshape(cell.shape + (1,) * (stored.ndim - 1))
    far = none | (stored == jnp.uint16(FIELD_FAR))
    return jnp.where(far, jnp.float32(jnp.inf), stored.astype(jnp.float32) * jnp.float32(FIELD_UNIT))


def ground_fields(bank: HouseBank, house: int) -> Float[np.ndarray, "g ny nx"]:
    """Geodesic distance of every cell of a house's ground floor to each goal [m], on the host; inf where no path is."""
    cell = np.asarray(bank.navigation.cell[house, 0])
    stored = np.asarray(stored_distance(bank, jnp.asarray(cell.ravel()), None))
    return stored.T.reshape(-1, *cell.shape)


def random_position(bank: HouseBank, house: Int[Array, ""], key: Array, margin: float = 0.05) -> Float[Array, "3"]:
    """A random point on the floor where an agent can stand, uniform over the free area.

    Args:
        bank: The houses.
        house: Index of the house.
        key: A random key.
        margin: Clearance with which the houses were compiled, `NavigationOptions.margin` [m].

    Returns:
        [m]; at most `margin` / 2 from a cell's centre in x and in y, so nothing is nearer than the agent's radius.
    """
    which, shift = jax.random.split(key)
    navigation, house = bank.navigation, bank.known_house(house)
    cell = navigation.first_cell[house] + jax.random.randint(which, (), 0, navigation.num_cells[house])
    return cell_position(bank, house, cell) + jnp.concatenate(
        [jax.random.uniform(shift, (2,), jnp.float32, -margin / 2, margin / 2), jnp.zeros(1, jnp.float32)]
    )


def cell_position(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, ""]) -> Float[Array, "3"]:
    """Middle of a numbered cell on the floor or ramp there [m]."""
    middle = place_position(bank, house, bank.navigation.place[cell].astype(jnp.int32))
    return middle.at[2].set(bank.navigation.height[cell])


def place_position(bank: HouseBank, house: Int[Array, ""], place: Int[Array, "3"]) -> Float[Array, "3"]:
    """Middle of a cell, given by level, row and column as by `cell_of`, on its level's floor [m]."""
    house = bank.known_house(house)
    level, row, column = place
    plan = (jnp.stack([column, row]).astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    return jnp.append(plan + bank.navigation.origin[house], bank.navigation.floor[house, level])
