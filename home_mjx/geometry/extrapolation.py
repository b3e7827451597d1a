"""Distances beside the home region: close to walls, and where things stand that can be moved.

The shortest paths of the home region end at its border. Beyond it, the distance to a goal is the harmonic function with
the border's distances (each cell has the mean of its neighbours', weighted by 1 / length), plus the way to the border.
It has no step where the ways around a thing on either side are of different length, as the distance by way of the
nearest cell has: that was up to 12 m between neighbouring cells of generated houses.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import csr_matrix, diags
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.sparse.linalg import splu

from home_mjx.geometry.geodesic import grid_edges


def continued_fields(
    home: Bool[np.ndarray, "l ny nx"],
    around: Sequence[Bool[np.ndarray, "l ny nx"]],
    standable: Bool[np.ndarray, "l ny nx"],
    room: Int[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    field: Float[np.ndarray, "c g"],
    cell: float,
) -> list[tuple[Int[np.ndarray, "_ 3"], Float[np.ndarray, "_ g"]]]:
    """Cells that an agent can come to from the home region, and their distances to the goals.

    Args:
        home: The home region.
        around: Where an agent's axis may be besides. What is in the first grid does not depend on the second, and so
            on: an agent that brushes past a thing is not told of the way that its place would be.
        standable: Where agents can go from room to room; elsewhere there may be a wall thinner than a cell.
        room: Of each cell.
        height: Of the cells [m].
        field: Distances of the home cells to the goals [m].
        cell: [m].

    Returns:
        Of each grid of `around`: grid, row and column of the cells that no earlier one has; distances [m].
    """
    found = []
    values = np.full((*home.shape, field.shape[1]), np.nan)
    values[home], known = field, home
    for cells in around:
        cells = cells | known
        graph = _graph(cells, standable[cells], room[cells], height, cell)
        border = known[cells]
        _, patch = connected_components(graph, directed=False)
        inner = ~border & np.isin(patch, patch[border])
        place = np.argwhere(cells)[inner]
        if inner.any():
            way = dijkstra(graph, indices=np.flatnonzero(border), min_only=True)[inner]
            values[tuple(place.T)] = _harmonic(graph, inner, border, values[known]) + way[:, None]
        found.append((place, values[tuple(place.T)]))
        known = known.copy()
        known[tuple(place.T)] = True
    return found


def _graph(
    cells: Bool[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, " n"],
    room: Int[np.ndarray, " n"],
    height: Float[np.ndarray, "l ny nx"],
    cell: float,
) -> csr_matrix:
    """Lengths between neighbouring cells of one room, or of two where agents can stand [m]."""
    sources, targets, lengths = grid_edges(cells, height, cell)
    kept = (room[sources] == room[targets]) | (standable[sources] & standable[targets])
    half = csr_matrix((lengths[kept], (sources[kept], targets[kept])), shape=(int(cells.sum()),) * 2)
    return csr_matrix(half + half.T)


def _harmonic(
    graph: csr_matrix, inner: Bool[np.ndarray, " n"], border: Bool[np.ndarray, " n"], known: Float[np.ndarray, "b g"]
) -> Float[np.ndarray, "e g"]:
    """Values of the inner nodes, each the mean of its neighbours' by 1 / length, with known ones at the border."""
    weight = graph.copy()
    weight.data = 1 / weight.data
    laplacian = (diags(np.asarray(weight.sum(axis=1)).ravel()) - weight).tocsr()[inner][:, inner]
    return splu(laplacian.tocsc()).solve(np.asarray(weight[inner][:, border] @ known))


def nearest_numbers(number: Int[np.ndarray, "l ny nx"], room: Int[np.ndarray, "l ny nx"]) -> Int[np.ndarray, "l ny nx"]:
    """The number of each cell, and where it has none, that of the nearest cell.

    That is one of the same room, else of the same level, else the one above or below the nearest on another level.

    Args:
        number: Of the cells that have one; -1 elsewhere.
        room: Of each cell; -1 outside.
    """
    some = np.flatnonzero((number >= 0).any(axis=(1, 2)))
    found = [_nearest(number[some[abs(some - level).argmin()]]) for level in range(len(number))]
    for filled, numbers, rooms in zip(found, number, room, strict=True):
        for r, window in enumerate(ndimage.find_objects(rooms + 1)):
            if window is not None:
                inside = rooms[window] == r
                own = np.where(inside, numbers[window], -1)
                if (own >= 0).any():
                    filled[window] = np.where(inside, _nearest(own), filled[window])
    return np.stack(found)


def _nearest(number: Int[np.ndarray, "ny nx"]) -> Int[np.ndarray, "ny nx"]:
    """The number of the nearest cell that has one, by straight line."""
    y, x = np.asarray(ndimage.distance_transform_edt(number < 0, return_distances=False, return_indices=True))
    return number[y, x]
