"""Connected regions of the free space of all levels."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.geodesic import GridLink, grid_edges
from home_mjx.scene_compile.objects.stairs import Staircase

LINK_LENGTH = 1e-4  # [m], length of a link between copies of a cell; sparse graphs cannot store zero


def label_regions(
    standable: Bool[np.ndarray, "l ny nx"],
    links: Sequence[GridLink],
    cell: float,
    height: Float[np.ndarray, "l ny nx"] | None = None,
    on_ramp: Bool[np.ndarray, "l ny nx"] | None = None,
) -> tuple[Int[np.ndarray, "l ny nx"], Float[np.ndarray, " n"]]:
    """Label connected regions: first the home region, then by decreasing area.

    The home region is the one with most floor on the lowest level, or else with most floor on all levels.

    Args:
        standable: Cells where agents can stand, lowest level first.
        links: Connections between cells that join their regions.
        cell: Cell size [m].
        height: Height of the cells [m], which are joined as in `grid_edges`; None: equal heights.
        on_ramp: Cells on ramps, which are no floor; None: none.

    Returns:
        Region of each cell, -1 if not standable; area of each region [m^2].
    """
    node, count = np.where(standable, np.cumsum(standable).reshape(standable.shape) - 1, -1), int(standable.sum())
    sources, targets, _ = grid_edges(standable, np.zeros(standable.shape) if height is None else height, cell)
    ends = np.array([(node[link.start], node[link.end]) for link in links], int).reshape(-1, 2)
    ends = np.concatenate([np.stack([sources, targets], axis=-1), ends[(ends >= 0).all(axis=1)]])
    joined = coo_matrix((np.ones(len(ends), bool), ends.T), shape=(count, count))
    number, merged = connected_components(joined, directed=False)
    floor = np.ones(standable.shape, bool) if on_ramp is None else ~on_ramp
    ground = floor & (np.arange(len(standable)) == 0)[:, None, None]
    area, floor, ground = (
        np.bincount(merged[cells[standable]], minlength=number) for cells in (standable, floor, ground)
    )
    order = np.argsort(-area, kind="stable")
    if number:
        home = int((ground if ground.any() else floor).argmax())
        order = np.concatenate([[home], order[order != home]])
    rank = np.empty(number, np.int64)
    rank[order] = np.arange(number)
    region = np.full(standable.shape, -1, np.int16)
    region[standable] = rank[merged]
    return region, area[order] * cell**2


def stair_links(
    stairs: Sequence[Staircase],
    standable: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[list[GridLink]]:
    """Return the links of each staircase between its levels, one per cell standable and equally high in both grids.

    Args:
        stairs: Stairs of the house.
        standable: Cells where agents can stand.
        height: Height of the cells [m]; where stairs are above one another, the grids may differ.
        centres: x and y of the cells [m].
    """
    points = np.stack(np.meshgrid(*centres), axis=-1)
    found = []
    for one in stairs:
        both = one.contains(points) & standable[one.lower] & standable[one.upper]
        both &= np.isclose(height[one.lower], height[one.upper])
        cells = np.argwhere(both).tolist()
        found.append([GridLink((one.lower, y, x), (one.upper, y, x), LINK_LENGTH) for y, x in cells])
    return found
