"""Shortest paths over grids of free cells."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

# Neighbouring cells are joined if their heights differ by less than `MAX_RISE` [m], or less than along a slope of
# `MAX_SLOPE`. A floor under stairs, or a flight above another one, is not joined to them.
MAX_RISE, MAX_SLOPE = 0.35, 1.5
NEIGHBOUR_OFFSETS = ((0, 1), (1, 0), (1, 1), (1, -1))  # (row, column) offsets of half of a cell's 8 neighbours


@dataclass(frozen=True)
class GridLink:
    """A connection between two cells that are not neighbours, such as stairs."""

    start: tuple[int, int, int]  # grid, row, column
    end: tuple[int, int, int]
    length: float  # [m]


def distance_fields(
    free: Bool[np.ndarray, "l ny nx"],
    goals: Int[np.ndarray, "g 3"],
    cell: float,
    links: Sequence[GridLink] = (),
    height: Float[np.ndarray, "l ny nx"] | None = None,
    passable: Bool[np.ndarray, "l ny nx"] | None = None,
) -> Float[np.ndarray, "c g"]:
    """Compute geodesic distances from free cells to goals over the 8-connected graph of `grid_edges` and `links`.

    Args:
        free: Mask of walkable cells, by grid, row and column.
        goals: Grid, row and column of each goal; must be free, or the distances of another cell are returned.
        cell: Cell size [m].
        links: Two-way connections between cells; ignored if an end is not free. No two may have the same ends, and
            none may join neighbours: lengths would be added.
        height: Floor height of each cell [m]; None: flat.
        passable: Cells at the corners of diagonal steps, see `grid_edges`; None: `free`.

    Returns:
        Distances [m], one row per free cell in C order (grid, row, column) and one column per goal; inf without path.
    """
    number = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    edges = [grid_edges(free, np.zeros(free.shape) if height is None else height, cell, passable)]
    edges += [(number[link.start][None], number[link.end][None], np.array([link.length])) for link in links]
    sources, targets, lengths = (np.concatenate(parts) for parts in zip(*edges, strict=True))
    known = (sources >= 0) & (targets >= 0)
    graph = csr_matrix((lengths[known], (sources[known], targets[known])), shape=(int(free.sum()),) * 2)
    return dijkstra(graph, directed=False, indices=number[tuple(goals.T)]).T


def grid_edges(
    free: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    cell: float,
    passable: Bool[np.ndarray, "l ny nx"] | None = None,
) -> tuple[Int[np.ndarray, " e"], Int[np.ndarray, " e"], Float[np.ndarray, " e"]]:
    """Return the edges (source, target, length [m]) of the 8-connected graph of free cells, each pair of cells once.

    Free cells are numbered from 0 in C order. Lengths include the difference in height; edges whose rise is not
    `is_walkable_rise` are omitted, and so are those between grids. Corners are not cut: a diagonal step needs both
    cells beside it passable, and walkable from both of its ends. Edges are in no particular order.

    Args:
        free: Mask of walkable cells, by grid, row and column.
        height: Floor height of each cell [m].
        cell: Cell size [m].
        passable: Cells that may be at the corners of a diagonal step, see `has_clear_diagonals`; None: `free`.
    """
    number = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    corners = free if passable is None else passable
    edges = [_neighbours(free, corners, number, height, step, cell) for step in NEIGHBOUR_OFFSETS]
    sources, targets, lengths = (np.concatenate(parts) for parts in zip(*edges, strict=True))
    return sources, targets, lengths


def _neighbours(
    free: Bool[np.ndarray, "l ny nx"],
    passable: Bool[np.ndarray, "l ny nx"],
    number: Int[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    step: tuple[int, int],
    cell: float,
) -> tuple[Int[np.ndarray, " e"], Int[np.ndarray, " e"], Float[np.ndarray, " e"]]:
    """Return the edges (source, target, length [m]) from free cells to their free neighbours at offset `step`.

    `step` is (rows, columns), each -1, 0 or 1. Edges that rise too steeply or cut a corner are omitted, and lengths
    include the rise, see `grid_edges`. `number` is the number of each free cell.
    """
    here, there = _shifted(*step)
    away = cell * float(np.hypot(*step))
    way = free[here] & free[there] & is_walkable_rise(height[here] - height[there], away)
    if all(step):
        for corner in (_corner(step, (step[0], 0)), _corner(step, (0, step[1]))):
            way &= passable[corner]
            for end in (here, there):
                way &= is_walkable_rise(height[end] - height[corner], cell)
    length = np.hypot(away, height[here][way] - height[there][way])
    return number[here][way], number[there][way], length


def has_clear_diagonals(cell: float, radius: float) -> bool:
    """Return whether no obstacle is between two diagonal neighbours that both have a clearance of `radius` [m].

    That is so if 2 `radius`² >= `cell`². Then the two cells beside a diagonal step may lack the margin, but must still
    be passable, see `grid_edges`. With a clearance of r + m at both ends, it is at least sqrt((r + m)² - cell² / 2)
    along the step: 0.132 m for agents of 0.1 m with the default margin.
    """
    return 2 * radius**2 >= cell**2


def is_walkable_rise(rise: Float[Any, "*s"], away: float) -> Bool[Any, "*s"]:
    """Return whether |rise| < max(`MAX_RISE`, `MAX_SLOPE` * away), for cells a plan distance `away` apart; both [m].

    Heights alone are compared: walls, obstacles and free cells are checked elsewhere.
    """
    return abs(rise) < max(MAX_RISE, MAX_SLOPE * away)


def _shifted(dy: int, dx: int) -> tuple[tuple, tuple]:
    """Return slices (level, row, column) of cells with a neighbour at offset (dy, dx), and of those neighbours."""
    return (slice(None), _span(0, dy), _span(0, dx)), (slice(None), _span(dy, dy), _span(dx, dx))


def _corner(step: tuple[int, int], corner: tuple[int, int]) -> tuple:
    """Return slices (level, row, column) of the cells at offset `corner` from those with a neighbour at `step`."""
    return slice(None), _span(corner[0], step[0]), _span(corner[1], step[1])


def _span(at: int, step: int) -> slice:
    """Return the slice, shifted by `at`, of the positions on an axis that have a neighbour at offset `step`.

    Offsets are -1, 0 or 1; `at` is 0 or `step`.
    """
    low, high = max(0, -step), min(0, -step)
    return slice(low + at, high + at or None)
