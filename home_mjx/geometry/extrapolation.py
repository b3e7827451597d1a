"""Extrapolation of distance fields beyond the home region: close to walls, and at positions of movable objects.

The shortest paths of the home region end at its border. Beyond it, the distance to a goal is the harmonic function with
the border's distances as boundary values, plus the distance to the border. Each cell has the mean of its neighbours,
weighted by 1 / length. Unlike the distance through the nearest cell, it is continuous if the paths around an object
differ in length. Otherwise, neighbouring cells of generated houses differed by up to 12 m.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import csr_matrix, diags
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.sparse.linalg import splu

from home_mjx.geometry.geodesic import grid_edges


def extrapolate_fields(
    home: Bool[np.ndarray, "l ny nx"],
    extensions: Sequence[Bool[np.ndarray, "l ny nx"]],
    standable: Bool[np.ndarray, "l ny nx"],
    room: Int[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    field: Float[np.ndarray, "c g"],
    cell: float,
) -> list[tuple[Int[np.ndarray, "_ 3"], Float[np.ndarray, "_ g"]]]:
    """Extrapolate distances from the home region to the cells of each extension that are connected with it.

    A distance is a harmonic function plus the path length to the border of the known cells. The function's boundary
    values are the distances at this border.

    Args:
        home: Mask of the home region, by grid, row and column as all masks and maps here.
        extensions: Additional masks of cells for an agent's axis, in priority order. Later masks never change distances
            in earlier ones, so distances next to a movable object ignore the shortcut through its position.
        standable: Cells where agents can go from room to room; elsewhere there may be a wall thinner than a cell.
        room: Room of each cell; -1 outside, which counts as one more room.
        height: Floor height of each cell [m].
        field: Distances [m], one row per home cell in C order and one column per goal; inf where there is no path.
        cell: Cell size [m].

    Returns:
        For each mask of `extensions`: grid, row and column of the cells not found by earlier masks, and their distances
        [m]. Home cells, and cells that are not connected, are left out. Cells connected to a border of inf have inf or
        NaN, even if another part of that border is finite.
    """
    found = []
    values = np.full((*home.shape, field.shape[1]), np.nan)
    values[home], known = field, home
    for cells in extensions:
        cells = cells | known
        graph, inner = _extend(known, cells, standable, room, height, cell)
        border = known[cells]
        place = np.argwhere(cells)[inner]
        if inner.any():
            way = dijkstra(graph, indices=np.flatnonzero(border), min_only=True)[inner]
            values[tuple(place.T)] = _harmonic(graph, inner, border, values[known]) + way[:, None]
        found.append((place, values[tuple(place.T)]))
        known = known.copy()
        known[tuple(place.T)] = True
    return found


def passable_cells(
    home: Bool[np.ndarray, "l ny nx"],
    extension: Bool[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, "l ny nx"],
    room: Int[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    cell: float,
) -> Bool[np.ndarray, "l ny nx"]:
    """Return the mask of home cells, and those of `extension` that `extrapolate_fields` reaches as its first mask.

    Arguments are those of `extrapolate_fields`; no distances are needed.
    """
    found = home.copy()
    cells = home | extension
    found[tuple(np.argwhere(cells)[_extend(home, cells, standable, room, height, cell)[1]].T)] = True
    return found


def _extend(
    known: Bool[np.ndarray, "l ny nx"],
    cells: Bool[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, "l ny nx"],
    room: Int[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    cell: float,
) -> tuple[csr_matrix, Bool[np.ndarray, " n"]]:
    """Return the graph of `cells`, see `_graph`, and which of these are not `known`, but connected to known ones.

    Two neighbours by `grid_edges` have an edge, its length in metres, if they are in one room or both standable.
    Nodes and mask are in the order of `np.argwhere(cells)`; `cells` include the known ones.
    """
    graph, border = _graph(cells, standable[cells], room[cells], height, cell), known[cells]
    _, patch = connected_components(graph, directed=False)
    return graph, ~border & np.isin(patch, patch[border])


def _graph(
    cells: Bool[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, " n"],
    room: Int[np.ndarray, " n"],
    height: Float[np.ndarray, "l ny nx"],
    cell: float,
) -> csr_matrix:
    """Return a symmetric sparse matrix of `grid_edges` lengths [m] between cells in one room, or both standable.

    Its rows are the True entries of `cells` in C order, as are `standable` and `room`; `height` covers the whole grid.
    Cells outside all rooms (-1) count as one room.
    """
    sources, targets, lengths = grid_edges(cells, height, cell)
    kept = (room[sources] == room[targets]) | (standable[sources] & standable[targets])
    half = csr_matrix((lengths[kept], (sources[kept], targets[kept])), shape=(int(cells.sum()),) * 2)
    return csr_matrix(half + half.T)


def _harmonic(
    graph: csr_matrix, inner: Bool[np.ndarray, " n"], border: Bool[np.ndarray, " n"], known: Float[np.ndarray, "b g"]
) -> Float[np.ndarray, "e g"]:
    """Return the discrete harmonic function at inner nodes: each is the mean of its neighbours, weighted by 1 / length.

    Values at border nodes, in their order, are fixed to `known`. Inner nodes must have no neighbours but inner and
    border ones, and a path to the border; otherwise the matrix may be singular. `graph` has lengths [m].
    """
    weight = graph.copy()
    weight.data = 1 / weight.data
    laplacian = (diags(np.asarray(weight.sum(axis=1)).ravel()) - weight).tocsr()[inner][:, inner]
    return splu(laplacian.tocsc()).solve(np.asarray(weight[inner][:, border] @ known))


def nearest_cell_numbers(
    number: Int[np.ndarray, "l ny nx"], room: Int[np.ndarray, "l ny nx"]
) -> Int[np.ndarray, "l ny nx"]:
    """Return the number of each cell or, if it has none, of the nearest numbered cell in plan; at least one must exist.

    The nearest cell is searched in the same room and level. If none has a number, or outside all rooms, it is searched
    in the level. If none has a number there, it is searched in the level of the closest index, the lower of two.
    Distances are straight, through walls; ties go to either.

    Args:
        number: Numbers of cells; -1 if none.
        room: Room of each cell; -1 outside.
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
    """Return for each cell the number of the nearest cell (Euclidean) with a number >= 0; at least one must exist.

    Ties go to either.
    """
    y, x = np.asarray(ndimage.distance_transform_edt(number < 0, return_distances=False, return_indices=True))
    return number[y, x]
