"""Storeys of a scene without rooms: heights with large level areas and walls above them."""

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet

LEVEL_SLOPE = 0.9  # minimum vertical component of the unit normal of floors
UPRIGHT_SLOPE = 0.3  # maximum vertical component of the unit normal of walls
BIN = 0.05  # [m], height of the bins of the histograms
MIN_STOREY_HEIGHT = 2.0  # [m], minimum distance of two storeys
MIN_FLOOR_AREA = 1.0  # [m^2], minimum level area of a storey
WALL_BAND = (0.3, 1.8)  # [m], heights above a floor between which walls are measured
MIN_WALL_SHARE = 0.2  # minimum area of a storey's walls, as a share of that with the most
MIN_UP_SHARE = 0.49  # minimum share of level faces that face up, as of slabs; scans may have floors that face down
FLOOR_TOLERANCE = 0.5  # [m], maximum distance of a room's floor from the height of its storey


def dominant_height(heights: Float[np.ndarray, " n"], areas: Float[np.ndarray, " n"], upper: bool = True) -> float:
    """Return the height of a large level area [m]: the highest, or lowest, of those at least half the largest.

    Args:
        heights: Heights of faces [m], at least one.
        areas: Their areas [m^2].
        upper: Whether the highest one is returned.
    """
    number = np.round(heights / BIN).astype(int)
    first = number.min()
    area = np.bincount(number - first, areas)
    large = np.flatnonzero(area >= area.max() / 2) + first
    near = abs(number - (large.max() if upper else large.min())) <= 1
    return float(np.average(heights[near], weights=np.maximum(areas[near], 1e-12)))


def find_storeys(triangles: TriangleSet) -> list[float]:
    """Return the heights of the storeys' floors [m], ascending; none without level areas.

    Faces of either side count, since scans and drawn blocks may have floors that face down.

    A storey is a height with at least `MIN_FLOOR_AREA` of level faces and, unless it is the only one, with walls above.
    """
    flat = triangles[abs(triangles.slope) > LEVEL_SLOPE]
    if not len(flat):
        return []
    number = np.round(flat.middle[:, 1] / BIN).astype(int)
    area = np.bincount(number - number.min(), flat.area)
    area = np.convolve(area, np.ones(3), "same")
    peaks = np.flatnonzero(area >= MIN_FLOOR_AREA)
    heights = (peaks + number.min()) * BIN
    walls = np.array([_wall_area(triangles, height) for height in heights])
    good = walls >= MIN_WALL_SHARE * walls.max(initial=0)
    found: list[float] = []
    for peak in np.argsort(-area[peaks[good]], kind="stable"):
        height = float(heights[good][peak])
        if all(abs(height - other) >= MIN_STOREY_HEIGHT for other in found):
            found.append(height)
    return sorted(_refined(flat, height) for height in found)


def _wall_area(triangles: TriangleSet, floor: float) -> float:
    """Return the area of upright faces within `WALL_BAND` above a height [m^2]."""
    upright = abs(triangles.slope) < UPRIGHT_SLOPE
    low, high = triangles.heights[upright].T
    common = np.minimum(high, floor + WALL_BAND[1]) - np.maximum(low, floor + WALL_BAND[0])
    return float(triangles.area[upright] @ np.clip(common / np.maximum(high - low, 1e-9), 0, 1))


def _refined(flat: TriangleSet, height: float) -> float:
    """Return the dominant height of level faces near the peak of the histogram."""
    return _upper_height(flat[abs(flat.middle[:, 1] - height) < FLOOR_TOLERANCE])


def _upper_height(flat: TriangleSet) -> float:
    """Return the dominant height of at least one level face: of those that face up if they are half of all."""
    up = flat[flat.slope > 0]
    seen = up if len(up) and up.area.sum() >= MIN_UP_SHARE * flat.area.sum() else flat
    return dominant_height(seen.middle[:, 1], seen.area)


def floor_height(triangles: TriangleSet, storey: float) -> float:
    """Return the height of the floor of triangles in a room [m]; that of its storey without level faces near it."""
    near = (abs(triangles.slope) > LEVEL_SLOPE) & (abs(triangles.middle[:, 1] - storey) < FLOOR_TOLERANCE)
    return _upper_height(triangles[near]) if near.any() else storey
