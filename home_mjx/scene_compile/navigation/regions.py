"""Connected regions of the free space of all levels."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.geodesic import GridLink

LEVEL_CONNECTIVITY = np.array([np.zeros((3, 3)), [[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.zeros((3, 3))])  # 4-connected


def label_regions(
    standable: Bool[np.ndarray, "l ny nx"], links: Sequence[GridLink], cell: float
) -> tuple[Int[np.ndarray, "l ny nx"], Float[np.ndarray, " n"]]:
    """Label connected regions: first the largest part of the lowest level, then by decreasing area.

    Args:
        standable: Cells where agents can stand, lowest level first.
        links: Connections between cells that join their regions.
        cell: Cell size [m].

    Returns:
        Region of each cell, -1 if not standable; area of each region [m^2].
    """
    patch = np.zeros(standable.shape, np.int32)
    count = int(ndimage.label(standable, LEVEL_CONNECTIVITY, output=patch))  # pyright: ignore[reportArgumentType]
    ends = np.array([(patch[link.start], patch[link.end]) for link in links], int).reshape(-1, 2)
    ends = ends[(ends > 0).all(axis=1)] - 1
    joined = coo_matrix((np.ones(len(ends)), ends.T), shape=(count, count))
    number, merged = connected_components(joined, directed=False)
    area, ground = (_count(merged, patch[p], number) for p in (slice(None), slice(0, 1)))
    order = np.argsort(-area, kind="stable")
    if number and ground.any():
        home = int(ground.argmax())
        order = np.concatenate([[home], order[order != home]])
    rank = np.empty(number, np.int64)
    rank[order] = np.arange(number)
    region = np.concatenate([[-1], rank[merged]])[patch]
    return region.astype(np.int16), area[order] * cell**2


def _count(merged: Int[np.ndarray, " p"], patch: Int[np.ndarray, "*s"], number: int) -> Int[np.ndarray, " n"]:
    """Count the cells of each region."""
    cells = np.bincount(patch.ravel(), minlength=len(merged) + 1)[1:]
    return np.bincount(merged, weights=cells, minlength=number).astype(np.int64)
