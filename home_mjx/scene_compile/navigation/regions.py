"""Connected regions of the free space of all levels."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.geodesic import GridLink
from home_mjx.scene_compile.objects.stairs import Staircase

LEVEL_CONNECTIVITY = np.array([np.zeros((3, 3)), [[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.zeros((3, 3))])  # 4-connected
LINK_LENGTH = 1e-4  # [m], length of a link between copies of a cell; sparse graphs cannot store zero


def label_regions(
    standable: Bool[np.ndarray, "l ny nx"],
    links: Sequence[GridLink],
    cell: float,
    on_ramp: Bool[np.ndarray, "l ny nx"] | None = None,
) -> tuple[Int[np.ndarray, "l ny nx"], Float[np.ndarray, " n"]]:
    """Label connected regions: first the home region, then by decreasing area.

    The home region is the one with most floor on the lowest level, or else with most floor on all levels.

    Args:
        standable: Cells where agents can stand, lowest level first.
        links: Connections between cells that join their regions.
        cell: Cell size [m].
        on_ramp: Cells on ramps, which are no floor; None: none.

    Returns:
        Region of each cell, -1 if not standable; area of each region [m^2].
    """
    patch = np.zeros(standable.shape, np.int32)
    count = int(ndimage.label(standable, LEVEL_CONNECTIVITY, output=patch))  # pyright: ignore[reportArgumentType]
    ends = np.array([(patch[link.start], patch[link.end]) for link in links], int).reshape(-1, 2)
    ends = ends[(ends > 0).all(axis=1)] - 1
    joined = coo_matrix((np.ones(len(ends)), ends.T), shape=(count, count))
    number, merged = connected_components(joined, directed=False)
    flat = patch if on_ramp is None else np.where(on_ramp, 0, patch)
    area, floor, ground = (_count(merged, cells, number) for cells in (patch, flat, flat[:1]))
    order = np.argsort(-area, kind="stable")
    if number:
        home = int((ground if ground.any() else floor).argmax())
        order = np.concatenate([[home], order[order != home]])
    rank = np.empty(number, np.int64)
    rank[order] = np.arange(number)
    region = np.concatenate([[-1], rank[merged]])[patch]
    return region.astype(np.int16), area[order] * cell**2


def _count(merged: Int[np.ndarray, " p"], patch: Int[np.ndarray, "*s"], number: int) -> Int[np.ndarray, " n"]:
    """Return the cells per region, from each cell's patch (from 1; 0 none) and each patch's region (`merged`)."""
    cells = np.bincount(patch.ravel(), minlength=len(merged) + 1)[1:]
    return np.bincount(merged, weights=cells, minlength=number).astype(np.int64)


def stair_links(
    stairs: Sequence[Staircase],
    standable: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[list[GridLink]]:
    """Return the links of each staircase between its levels, at its cells standable and equally high in both grids.

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
