"""Lookups in a house's navigation grids, on the device."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE, MAX_DEPTH_BELOW_FLOOR

# The shortest path from a point may begin over a neighbour of its cell.
_OFFSETS = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
_MIDDLE = _OFFSETS.index((0, 0))
HOME_RANK, UNREACHABLE_RANK = 0, 3  # ranks of cells, see `_rank`


def cell_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Int[Array, "3"]:
    """Return level, row and column of the cell that contains a point, clipped to the grid.

    The level is that of the highest floor that is not above the point, up to a tolerance of `MAX_DEPTH_BELOW_FLOOR`.
    """
    navigation, house = bank.navigation, bank.clip_house_index(house)
    levels, rows, columns = navigation.room.shape[1:]
    above = pos[2] >= navigation.floor[house] - jnp.float32(MAX_DEPTH_BELOW_FLOOR)
    level = jnp.maximum(jnp.sum(above.astype(jnp.int32)) - 1, 0)
    index = jnp.floor((pos[:2] - navigation.origin[house]) / jnp.float32(bank.spec.cell)).astype(jnp.int32)
    return jnp.clip(jnp.stack([level, index[1], index[0]]), 0, jnp.array([levels, rows, columns], jnp.int32) - 1)


def room_of(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Int[Array, ""]:
    """Return the index of the room that contains a point; -1 outside."""
    level, row, column = cell_of(bank, house, pos)
    return bank.navigation.room[bank.clip_house_index(house), level, row, column].astype(jnp.int32)


def geodesic_distance(
    bank: HouseBank,
    house: Int[Array, ""],
    goal: Int[Array, "*n"] | None,
    pos: Float[Array, "3"],
    field: UInt16[Array, "cell goals"] | None = None,
) -> Float[Array, "..."]:
    """Compute the length of the shortest path from a point to one goal, several goals, or all goals.

    It is the minimum over the 3 × 3 cells around the point of the cell's distance plus that to its centre. Near
    obstacles, and where an object was moved away, distances of the home region are extrapolated continuously, see
    `geometry.extrapolation`. Elsewhere it is the distance of the nearest cell plus the straight line to it.

    Args:
        bank: The houses.
        house: Index of the house.
        goal: Index or indices of goals; None: all goals.
        pos: The point [m], world frame.
        field: Distances of all cells to other goals, stored as in `NavigationArrays.field`; None: the bank's field.

    Returns:
        Distances [m], in the shape of `goal`; finite with the bank's field, because its goals are in the home region.
    """
    navigation, house = bank.navigation, bank.clip_house_index(house)
    level, y, x = _neighbourhood(bank, cell_of(bank, house, pos))
    cell = navigation.cell[house, level, y, x]
    rank = _rank(bank, house, cell)
    # Cells inside an obstacle have other distances than free cells beside it, so cells of a higher rank are excluded.
    usable = (rank <= rank[_MIDDLE]) & (rank < UNREACHABLE_RANK)
    usable = usable.at[_MIDDLE].set(True)
    nearest = navigation.cell_coords[row_of_cell(cell[_MIDDLE])]
    plan = jnp.stack([x, y], axis=-1).at[_MIDDLE].set(nearest[:0:-1].astype(jnp.int32))
    centre = (plan.astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    way = jnp.linalg.norm(centre + (navigation.origin[house] - pos[:2])[None], axis=-1)
    way = jnp.where(usable, way, jnp.float32(jnp.inf))
    around = stored_distance(bank.navigation.field if field is None else field, cell, goal)
    return jnp.min(around + way.reshape(way.shape + (1,) * (around.ndim - 1)), axis=0)


def is_near_home_region(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> Bool[Array, ""]:
    """Return whether a point is in or next to a cell of the home region, from which all goals are reachable.

    Args:
        bank: The houses.
        house: Index of the house.
        pos: The point [m], world frame.
    """
    house = bank.clip_house_index(house)
    level, y, x = _neighbourhood(bank, cell_of(bank, house, pos))
    return jnp.any(_rank(bank, house, bank.navigation.cell[house, level, y, x]) == HOME_RANK)


def _neighbourhood(
    bank: HouseBank, place: Int[Array, "3"]
) -> tuple[Int[Array, ""], Int[Array, " n"], Int[Array, " n"]]:
    """Return level, rows and columns of the 3 × 3 cells around a cell, clipped to the grid."""
    rows, columns = bank.navigation.room.shape[2:]
    offsets = jnp.array(_OFFSETS, jnp.int32)
    return place[0], jnp.clip(place[1] + offsets[:, 0], 0, rows - 1), jnp.clip(place[2] + offsets[:, 1], 0, columns - 1)


def _rank(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "*n"]) -> Int[Array, "*n"]:
    """Return ranks of cells: `HOME_RANK`, 1 free near obstacles, 2 in a movable object, `UNREACHABLE_RANK`."""
    navigation = bank.navigation
    number = cell - navigation.first_cell[house]
    ends = jnp.stack([navigation.num_cells[house], navigation.num_free_cells[house]])
    rank = jnp.sum((number[..., None] >= ends.reshape((1,) * number.ndim + (2,))).astype(jnp.int32), axis=-1)
    return jnp.where(cell >= 0, rank, UNREACHABLE_RANK)


def is_home_cell(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "*n"]) -> Bool[Array, "*n"]:
    """Return whether entries of `NavigationArrays.cell` are in the home region, where agents can walk."""
    return (cell >= 0) & (cell - bank.navigation.first_cell[house] < bank.navigation.num_cells[house])


def row_of_cell(cell: Int[Array, "*n"]) -> Int[Array, "*n"]:
    """Return the row of `field` and `cell_coords` for entries of `NavigationArrays.cell`.

    Negative entries mark unreachable cells; their row is that of the nearest reachable cell.
    """
    return jnp.where(cell >= 0, cell, ~cell)


def stored_distance(
    field: UInt16[Array, "cell goals"], cell: Int[Array, " n"], goal: Int[Array, "*g"] | None
) -> Float[Array, "n ..."]:
    """Return distances of `NavigationArrays.cell` entries to one, several or all (None) goals [m]; inf if no path."""
    rows = row_of_cell(cell)
    stored = field[rows] if goal is None else field[rows.reshape(-1, *[1] * goal.ndim), goal]
    metres = stored.astype(jnp.float32) * jnp.float32(FIELD_UNIT)
    return jnp.where(stored == jnp.uint16(FIELD_UNREACHABLE), jnp.float32(jnp.inf), metres)


def ground_fields(bank: HouseBank, house: int) -> Float[np.ndarray, "g ny nx"]:
    """Return the geodesic distance of every cell of a house's ground floor to each goal [m], on the host.

    It is inf outside the home region, where agents cannot be unless an object is moved.
    """
    cell = bank.navigation.cell[house, 0]
    stored = np.asarray(stored_distance(bank.navigation.field, cell.ravel(), None))
    known = np.asarray(_rank(bank, jnp.asarray(house), cell) == HOME_RANK).ravel()
    return np.where(known[:, None], stored, np.inf).T.reshape(-1, *cell.shape)


def random_position(bank: HouseBank, house: Int[Array, ""], key: Array, margin: float = 0.05) -> Float[Array, "3"]:
    """Sample a navigable point on the floor, uniformly over the home region.

    Args:
        bank: The houses.
        house: Index of the house.
        key: Random key.
        margin: Clearance with which the houses were compiled, `NavigationOptions.margin` [m].

    Returns:
        Point [m], at most `margin` / 2 from a cell's centre in x and y, so obstacles are outside the agent's radius.
    """
    which, shift = jax.random.split(key)
    navigation, house = bank.navigation, bank.clip_house_index(house)
    cell = navigation.first_cell[house] + jax.random.randint(which, (), 0, navigation.num_cells[house])
    return cell_position(bank, house, cell) + jnp.concatenate(
        [jax.random.uniform(shift, (2,), jnp.float32, -margin / 2, margin / 2), jnp.zeros(1, jnp.float32)]
    )


def cell_position(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, ""]) -> Float[Array, "3"]:
    """Return the centre of the cell with a given row number, on its floor or ramp [m]."""
    middle = grid_position(bank, house, bank.navigation.cell_coords[cell].astype(jnp.int32))
    return middle.at[2].set(bank.navigation.height[cell])


def grid_position(bank: HouseBank, house: Int[Array, ""], place: Int[Array, "3"]) -> Float[Array, "3"]:
    """Return the centre of the cell at (level, row, column), as from `cell_of`, on its level's floor [m]."""
    house = bank.clip_house_index(house)
    level, row, column = place
    plan = (jnp.stack([column, row]).astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    return jnp.append(plan + bank.navigation.origin[house], bank.navigation.floor[house, level])
