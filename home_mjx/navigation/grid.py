"""Lookups in a house's navigation grids, on the device.

The home region of a house is its largest connected walkable region on the ground floor, with all levels that stairs
connect to it. `house` is an index into the bank, `feet` the lowest point of an agent or a point on a floor [m] in the
world frame.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.geodesic import has_clear_diagonals
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE, MAX_DEPTH_BELOW_FLOOR

# The shortest path from a point may begin over a neighbour of its cell.
_OFFSETS = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
_MIDDLE = _OFFSETS.index((0, 0))
# Of each offset, the two cells that a diagonal step passes between.
_BESIDE = np.array([[_OFFSETS.index((dy, 0)) for dy, _ in _OFFSETS], [_OFFSETS.index((0, dx)) for _, dx in _OFFSETS]])
HOME_RANK, NARROW_RANK, UNREACHABLE_RANK = 0, 1, 3  # ranks of cells, see `_rank`
MAX_SLOPE = 1.5  # maximum slope of stairs between cells, with the rounding of cells
MAX_SHARED_GAP = 0.05  # [m], maximum height difference of cells of two levels that are one place on a ramp


def cell_at_feet(bank: HouseBank, house: Int[Array, ""], feet: Float[Array, "3"]) -> Int[Array, "3"]:
    """Return grid (level from the lowest), row (y) and column (x) of the cell under `feet`, clipped to the grid.

    Of the cells above one another, one per level, it is that whose floor or ramp is nearest in height. Cells outside
    the home region count as `MAX_DEPTH_BELOW_FLOOR` farther: their height may be a neighbour's. The grids of two levels
    share cells where they meet on a ramp (heights within `MAX_SHARED_GAP`). There it is the upper level's cell if the
    feet are at most `MAX_DEPTH_BELOW_FLOOR` below its floor, else the lower level's. `house` is clipped to the bank.
    """
    house = bank.clip_house_index(house)
    row, column = _plan_cell(bank, house, feet)
    gap = jnp.abs(_heights(bank, house, row, column) - feet[2])
    home = is_home_cell(bank, house, bank.navigation.cell[house, :, row, column])
    gap = jnp.where(home, gap, gap + jnp.float32(MAX_DEPTH_BELOW_FLOOR))
    number = jnp.arange(len(gap), dtype=jnp.int32)
    above = feet[2] >= bank.navigation.floor[house] - jnp.float32(MAX_DEPTH_BELOW_FLOOR)
    rank = jnp.where(above, len(gap) + number, len(gap) - 1 - number)
    level = jnp.argmax(jnp.where(gap <= jnp.min(gap) + jnp.float32(MAX_SHARED_GAP), rank, -1))
    return jnp.stack([level.astype(jnp.int32), row, column])


def cell_below(bank: HouseBank, house: Int[Array, ""], point: Float[Array, "3"]) -> Int[Array, "3"]:
    """Return grid (level), row (y) and column (x) of the cell below a free `point` [m], such as an eye or a source.

    Of the cells above one another, one per level, it is the highest walkable one less than an agent's height below the
    point: over stairs the ramp, not the opening in the floor above. Else it is the highest one in a room below the
    point, else the highest one below it, else the lowest one. Floors up to `MAX_SHARED_GAP` above the point count as
    below. Points outside of the grid are clipped to it, and `house` to the bank.
    """
    house = bank.clip_house_index(house)
    row, column = _plan_cell(bank, house, point)
    height = _heights(bank, house, row, column)
    under = (height <= point[2] + jnp.float32(MAX_SHARED_GAP)) & jnp.isfinite(bank.navigation.floor[house])
    inside = under & (bank.navigation.room[house, :, row, column] >= 0)
    near = under & (bank.navigation.cell[house, :, row, column] >= 0)
    near &= point[2] - height < jnp.float32(bank.spec.agent_height)
    chosen = jnp.where(jnp.any(near), near, jnp.where(jnp.any(inside), inside, under))
    highest = jnp.argmax(jnp.where(chosen, height, -jnp.inf))
    level = jnp.where(jnp.any(under), highest, jnp.argmin(height)).astype(jnp.int32)
    return jnp.stack([level, row, column])


def _plan_cell(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "3"]) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Return row (y) and column (x) of the cell at a point [m], clipped to the grid; `house` must be a valid index."""
    rows, columns = bank.navigation.room.shape[2:]
    index = jnp.floor((pos[:2] - bank.navigation.origin[house]) / jnp.float32(bank.spec.cell)).astype(jnp.int32)
    return jnp.clip(index[1], 0, rows - 1), jnp.clip(index[0], 0, columns - 1)


def _heights(
    bank: HouseBank, house: Int[Array, ""], row: Int[Array, ""], column: Int[Array, ""]
) -> Float[Array, " levels"]:
    """Return each level's floor or ramp height at a cell or its nearest reachable one [m]; padding: highest level's."""
    return bank.navigation.height[row_of_cell(bank.navigation.cell[house, :, row, column])]


def room_at_feet(bank: HouseBank, house: Int[Array, ""], feet: Float[Array, "3"]) -> Int[Array, ""]:
    """Return the index of the room in which an agent with its lowest point at `feet` stands; -1 outside."""
    return _room(bank, house, cell_at_feet(bank, house, feet))


def room_below(bank: HouseBank, house: Int[Array, ""], point: Float[Array, "3"]) -> Int[Array, ""]:
    """Return the index of the room that contains a free point, chosen by `cell_below`; -1 outside."""
    return _room(bank, house, cell_below(bank, house, point))


def _room(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "3"]) -> Int[Array, ""]:
    """Return the index of the room at (level, row, column) as int32; -1 outside of rooms."""
    return bank.navigation.room[bank.clip_house_index(house), cell[0], cell[1], cell[2]].astype(jnp.int32)


def geodesic_distance(
    bank: HouseBank,
    house: Int[Array, ""],
    goal: Int[Array, "*n"] | None,
    feet: Float[Array, "3"],
    field: UInt16[Array, "cell goals"] | None = None,
) -> Float[Array, "..."]:
    """Compute the length of the shortest path from `feet` to one goal, several goals, or all goals (None).

    It is the minimum over the 3 × 3 cells around the feet of the cell's distance plus the straight line to its centre.
    Neighbours across a corner, or closer to obstacles than the cell at the feet, are left out. Near obstacles, and
    where an object was moved away, distances of the home region are extrapolated continuously, see
    `geometry.extrapolation`. Elsewhere it is the distance of the nearest cell plus the straight line to it.

    Args:
        bank: The houses.
        house: Index of the house, clipped to the bank.
        goal: Index or indices of columns of `field`; None: all.
        feet: Lowest point of the agent, or a point on a floor [m], world frame.
        field: Distances of all cells to other goals, stored as in `NavigationArrays.field`; None: the bank's field.

    Returns:
        Distances [m], in the shape of `goal`, (goals,) for None. Finite with the bank's field; with others
        inf if there is no path.
    """
    navigation, house = bank.navigation, bank.clip_house_index(house)
    level, y, x = _neighbourhood(bank, house, cell_at_feet(bank, house, feet)).T
    cell = navigation.cell[house, level, y, x]
    rank = _rank(bank, house, cell)
    # Cells inside an obstacle have other distances than free cells beside it, so higher ranks are excluded.
    usable = (rank <= rank[_MIDDLE]) & (rank < UNREACHABLE_RANK)
    passable = rank <= jnp.maximum(rank[_MIDDLE], _passable_rank(bank))
    usable = usable & passable[_BESIDE[0]] & passable[_BESIDE[1]]  # paths cut no corners
    usable = usable.at[_MIDDLE].set(True)
    nearest = navigation.cell_coords[row_of_cell(cell[_MIDDLE])]
    plan = jnp.stack([x, y], axis=-1).at[_MIDDLE].set(nearest[:0:-1].astype(jnp.int32))
    plan = (plan.astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) + navigation.origin[house][None]
    centre = jnp.concatenate([plan, navigation.height[row_of_cell(cell)][:, None]], axis=1)
    way = jnp.linalg.norm(centre - feet[None], axis=-1)
    way = jnp.where(usable, way, jnp.float32(jnp.inf))
    around = stored_distance(bank.navigation.field if field is None else field, cell, goal)
    return jnp.min(around + way.reshape(way.shape + (1,) * (around.ndim - 1)), axis=0)


def is_near_home_region(bank: HouseBank, house: Int[Array, ""], feet: Float[Array, "3"]) -> Bool[Array, ""]:
    """Return whether the cell at `feet` or one of the 8 around it is in the home region, where all goals are.

    The cells around it are on the levels of `continue_levels`. `house` is clipped to the bank.
    """
    house = bank.clip_house_index(house)
    level, y, x = _neighbourhood(bank, house, cell_at_feet(bank, house, feet)).T
    return jnp.any(_rank(bank, house, bank.navigation.cell[house, level, y, x]) == HOME_RANK)


def _neighbourhood(bank: HouseBank, house: Int[Array, ""], place: Int[Array, "3"]) -> Int[Array, "9 3"]:
    """Return the 3 × 3 cells (level, row, column) around one, by `_OFFSETS`, clipped; levels by `continue_levels`."""
    offsets = jnp.array([(0, dy, dx) for dy, dx in _OFFSETS], jnp.int32)
    around = jnp.clip(place[None] + offsets, 0, jnp.array(bank.navigation.room.shape[1:], jnp.int32)[None] - 1)
    return continue_levels(bank, house, place, around)


def continue_levels(
    bank: HouseBank, house: Int[Array, ""], place: Int[Array, "3"], around: Int[Array, "n 3"]
) -> Int[Array, "n 3"]:
    """Return cells near `place`, each with its own level: the one to which floors and ramps lead from `place`.

    Of a cell's home cells on all levels, that nearest in height to `place` gives the level. A height difference on the
    level of `place` counts `MAX_SHARED_GAP` less; in a tie, the lower level counts. If the way there, lengthened by
    one cell, is steeper than `MAX_SLOPE`, or no level has a home cell, the level is that of `place`. A bank of one
    level returns `around`.

    Args:
        bank: The houses.
        house: Index of the house, not clipped.
        place: Level (grid), row and column.
        around: Levels, rows and columns within the grid; in a bank of several levels, the levels given here are unused.
    """
    navigation = bank.navigation
    if navigation.cell.shape[1] == 1:
        return around
    cell = navigation.cell[house, :, around[:, 1], around[:, 2]].T
    own = navigation.height[row_of_cell(cell_number(bank, house, place))]
    rise = jnp.abs(navigation.height[row_of_cell(cell)] - own)
    rise = jnp.where(is_home_cell(bank, house, cell), rise, jnp.inf)
    rise = rise.at[place[0]].add(-jnp.float32(MAX_SHARED_GAP))  # of two cells at one place, that of the own level
    away = jnp.linalg.norm((around - place[None])[:, 1:].astype(jnp.float32), axis=1) * jnp.float32(bank.spec.cell)
    reached = jnp.min(rise, axis=0) <= jnp.float32(MAX_SLOPE) * (away + jnp.float32(bank.spec.cell))
    level = jnp.where(reached, jnp.argmin(rise, axis=0).astype(jnp.int32), place[0])
    return around.at[:, 0].set(level)


def _rank(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "*n"]) -> Int[Array, "*n"]:
    """Rank cell numbers of a house: 0 home region, 1 free but near obstacles, 2 under a movable, 3 negative."""
    navigation = bank.navigation
    number = cell - navigation.first_cell[house]
    ends = jnp.stack([navigation.num_cells[house], navigation.num_free_cells[house]])
    rank = jnp.sum((number[..., None] >= ends.reshape((1,) * number.ndim + (2,))).astype(jnp.int32), axis=-1)
    return jnp.where(cell >= 0, rank, UNREACHABLE_RANK)


def _passable_rank(bank: HouseBank) -> int:
    """Return the maximum rank of the cells at both corners of a diagonal step between home cells.

    It is `NARROW_RANK` if `has_clear_diagonals` for the bank's cell and agent radius, else `HOME_RANK`.
    """
    return NARROW_RANK if has_clear_diagonals(bank.spec.cell, bank.spec.agent_radius) else HOME_RANK


def cell_number(bank: HouseBank, house: Int[Array, ""], place: Int[Array, "*n 3"]) -> Int[Array, "*n"]:
    """Return the entries of `NavigationArrays.cell` at (level, row, column) within the grid; `house` is not clipped.

    Only these entries are read: `cell[house]` first would copy the grids of a house for every environment.
    """
    return bank.navigation.cell[house, place[..., 0], place[..., 1], place[..., 2]]


def is_passable_cell(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "*n"]) -> Bool[Array, "*n"]:
    """Return whether entries of `NavigationArrays.cell` may be at the corners of diagonal steps between home cells.

    Negative entries, which mark unreachable cells, may not.
    """
    return _rank(bank, house, cell) <= _passable_rank(bank)


def is_home_cell(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, "*n"]) -> Bool[Array, "*n"]:
    """Return whether cell numbers (entries of the house's `NavigationArrays.cell`) are in its home region.

    Negative numbers, of unreachable cells, are not.
    """
    return (cell >= 0) & (cell - bank.navigation.first_cell[house] < bank.navigation.num_cells[house])


def row_of_cell(cell: Int[Array, "*n"]) -> Int[Array, "*n"]:
    """Return the rows of `field` and `cell_coords` for cell numbers, the entries of `NavigationArrays.cell`.

    A number of at least 0 is the row itself. Negative ones mark unreachable cells: ~number is the row of the nearest
    reachable cell.
    """
    return jnp.where(cell >= 0, cell, ~cell)


def stored_distance(
    field: UInt16[Array, "cell goals"], cell: Int[Array, " n"], goal: Int[Array, "*g"] | None
) -> Float[Array, "n ..."]:
    """Return distances [m] from cell numbers (entries of `NavigationArrays.cell`) to one, several or all (None) goals.

    The goal axes follow that of cells. Unreachable cells, with negative numbers, have the distance of the nearest
    reachable one; inf if no path leads from there.
    """
    rows = row_of_cell(cell)
    stored = field[rows] if goal is None else field[rows.reshape(-1, *[1] * goal.ndim), goal]
    metres = stored.astype(jnp.float32) * jnp.float32(FIELD_UNIT)
    return jnp.where(stored == jnp.uint16(FIELD_UNREACHABLE), jnp.float32(jnp.inf), metres)


def random_position(bank: HouseBank, house: Int[Array, ""], key: Array, margin: float = 0.05) -> Float[Array, "3"]:
    """Sample a point on the floor [m], uniformly over the cells of the home region.

    It is uniform in a square of edge `margin` [m] around the cell's centre, where an agent's radius is free of
    obstacles. `margin` must be the `NavigationOptions.margin` with which the houses were compiled.
    """
    which, shift = jax.random.split(key)
    navigation, house = bank.navigation, bank.clip_house_index(house)
    cell = navigation.first_cell[house] + jax.random.randint(which, (), 0, navigation.num_cells[house])
    offset = jax.random.uniform(shift, (2,), jnp.float32, -margin / 2, margin / 2)
    return cell_position(bank, house, cell) + jnp.concatenate([offset, jnp.zeros(1, jnp.float32)])


def cell_position(bank: HouseBank, house: Int[Array, ""], cell: Int[Array, ""]) -> Float[Array, "3"]:
    """Return the centre on the floor or ramp [m] of a cell by its number, a row of `cell_coords` in this house."""
    return grid_position(bank, house, bank.navigation.cell_coords[cell].astype(jnp.int32))


def grid_position(bank: HouseBank, house: Int[Array, ""], place: Int[Array, "3"]) -> Float[Array, "3"]:
    """Return the centre of the cell at `place` = (level, row, column), within the grid, on its floor or ramp [m].

    The height of an unreachable cell is that of the nearest reachable one.
    """
    house = bank.clip_house_index(house)
    level, row, column = place
    plan = (jnp.stack([column, row]).astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell)
    height = bank.navigation.height[row_of_cell(bank.navigation.cell[house, level, row, column])]
    return jnp.append(plan + bank.navigation.origin[house], height)
