"""Cells of a house's rooms, between which late sound is baked (host only)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import CompiledHouse

CELL_FLOOR_GAP = 0.9  # [m], height of cells above the floor, above most furniture
CELL_CEILING_GAP = 0.2  # [m], from the top of cells to the ceiling
MAX_CELLS = 160  # maximum per house; all pairs then fit into 3 MB
CELLS_PER_PLACE = 4  # maximum cells per lattice point


@dataclass(frozen=True)
class Cells:
    """Upright boxes over parts of the floor, for positions of sources and listeners.

    Attributes:
        room: Room of each cell.
        center: Centre [m].
        low: Height of the bottom [m].
        high: Height of the top [m].
        volume: [m³].
        lookup: Cell over each place of the navigation grids; -1 none.
        origin: Corner of place (0, 0) of the grids [m].
        step: Spacing of places [m].
    """

    room: Int[np.ndarray, " n"]
    center: Float[np.ndarray, "n 3"]
    low: Float[np.ndarray, " n"]
    high: Float[np.ndarray, " n"]
    volume: Float[np.ndarray, " n"]
    lookup: Int[np.ndarray, "levels rows columns"]
    origin: Float[np.ndarray, " 2"]
    step: float


def divide_rooms(house: CompiledHouse, size: float = 1.0) -> Cells:
    """Divide each room into equal rows and columns of about `size` metres.

    Cells reach from `CELL_FLOOR_GAP` above the floor to `CELL_CEILING_GAP` below the ceiling, at least over 0.2 m.

    Args:
        house: House to divide.
        size: Target edge length of a cell [m]; increased if there would be more than `MAX_CELLS` cells.

    Raises:
        ConfigError: The house has no room.
    """
    grid = house.navigation.room
    if not (grid >= 0).any():
        raise ConfigError(f"house {house.id} has no room: there is nothing to bake sound for")
    lookup = _number_cells(grid, house.navigation.cell, size)
    while lookup.max() >= MAX_CELLS:
        size *= 1.1
        lookup = _number_cells(grid, house.navigation.cell, size)
    level, row, column = np.nonzero(lookup >= 0)
    cell, count = lookup[level, row, column], lookup.max() + 1
    area = np.bincount(cell, minlength=count)
    middle = [np.bincount(cell, axis + 0.5, count) / area * house.navigation.cell for axis in (column, row)]
    room = np.zeros(count, int)
    room[cell] = grid[level, row, column]
    low = house.rooms.floor[room] + CELL_FLOOR_GAP
    high = np.maximum(house.rooms.ceiling[room] - CELL_CEILING_GAP, low + 0.2)
    center = np.stack(
        [*(np.asarray(m) + o for m, o in zip(middle, house.navigation.origin, strict=True)), (low + high) / 2], 1
    )
    volume = area * house.navigation.cell**2 * (high - low)
    return Cells(room, center, low, high, volume, lookup, house.navigation.origin, house.navigation.cell)


def _number_cells(grid: Int[np.ndarray, "l ny nx"], step: float, size: float) -> Int[np.ndarray, "l ny nx"]:
    """Number cells room by room; return the index at each place, -1 none. `step`, `size`: edge of places, cells [m].

    A room's bounding box is divided into round(extent / `size`) equal rows and columns, at least one; all its storeys
    share them. Parts without a place have no number.
    """
    lookup, first = np.full(grid.shape, -1), 0
    for room in np.unique(grid[grid >= 0]):
        level, row, column = np.nonzero(grid == room)
        part = []
        for axis in (row, column):
            extent = np.ptp(axis) + 1
            pieces = max(round(extent * step / size), 1)
            part.append((axis - axis.min()) * pieces // extent)
        _, number = np.unique(part[0] * 10_000 + part[1], return_inverse=True)
        lookup[level, row, column] = first + number
        first += number.max() + 1
    return lookup
