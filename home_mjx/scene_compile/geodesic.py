"""Shortest paths over a grid of free cells."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra


def distance_fields(
    free: Bool[np.ndarray, "ny nx"], goals: Int[np.ndarray, "g 2"], cell: float
) -> Float[np.ndarray, "g ny nx"]:
    """Length of the shortest 8-connected path over free cells to each goal; no corner is cut.

    Args:
        free: Cells that may be crossed.
        goals: Row and column of each goal; free cells.
        cell: [m].

    Returns:
        [m]; inf where there is no path.
    """
    index = np.arange(free.size).reshape(free.shape)
    sources, targets, lengths = [], [], []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a, b = _shifted(index, dy, dx)
        open_ = _shifted(free, dy, dx)
        ways = open_[0] & open_[1]
        if dy and dx:
            corner = _shifted_corners(free, dx)
            ways &= corner[0] & corner[1]
        sources.append(a[ways])
        targets.append(b[ways])
        lengths.append(np.full(ways.sum(), cell * np.hypot(dy, dx)))
    edges = (np.concatenate(sources), np.concatenate(targets))
    graph = csr_matrix((np.concatenate(lengths), edges), shape=(free.size, free.size))
    rows = np.ravel_multi_index(goals.T, free.shape)
    return dijkstra(graph, directed=False, indices=rows).reshape(len(goals), *free.shape)


def _shifted(grid: np.ndarray, dy: int, dx: int) -> tuple[np.ndarray, np.ndarray]:
    """Two views of equal shape whose entries are neighbours by (dy, dx)."""
    ny, nx = grid.shape
    if dx < 0:
        return grid[: ny - dy, -dx:], grid[dy:, : nx + dx]
    return grid[: ny - dy, : nx - dx], grid[dy:, dx:]


def _shifted_corners(free: np.ndarray, dx: int) -> tuple[np.ndarray, np.ndarray]:
    """The two cells that a diagonal step passes between."""
    if dx < 0:
        return free[:-1, :-1], free[1:, 1:]
    return free[:-1, 1:], free[1:, :-1]
