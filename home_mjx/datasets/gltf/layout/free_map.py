"""Map of a storey: cells with a floor, and cells with walls, from points on its triangles."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.gltf.layout.storey_search import UPRIGHT_SLOPE
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet
from home_mjx.geometry.box_fit import SAMPLE_SPACING, sample_surface
from home_mjx.geometry.rotations import plane_matrix

MIN_CELL = 0.05  # [m], minimum edge of a cell
MAX_CELLS = 1 << 21  # maximum number of cells; larger storeys have larger cells
MAX_POINTS = 6_000_000  # maximum number of sampled points; more would need larger cells
FLOOR_BAND = (-0.3, 0.3)  # [m] around the storey's height: faces that agents walk on
FURNITURE_BAND = (0.3, 1.0)  # [m], heights at which low things are found
WALL_BAND = (1.2, 1.8)  # [m], heights at which walls are found
LINTEL_BAND = (1.9, 2.3)  # [m], heights of walls above windows
MARGIN = 3  # [cells] around the map


@dataclass(frozen=True)
class FreeMap:
    """Cells of one storey on a grid along its walls.

    Attributes:
        yaw: Direction of the first axis in the plan (x, -z) [rad].
        low: Minimum corner in the grid's axes [m].
        cell: Edge of a cell [m].
        free: Cells in which rooms may be; rows are along the second axis.
    """

    yaw: float
    low: Float[np.ndarray, "2"]
    cell: float
    free: Bool[np.ndarray, "ny nx"]

    def lines(self, axis: int) -> Float[np.ndarray, " n"]:
        """Return the grid lines along an axis [m], 0 for that of columns."""
        return self.low[axis] + self.cell * np.arange(self.free.shape[1 - axis] + 1)


def map_storey(triangles: TriangleSet, storey: float) -> FreeMap | None:
    """Return the map of the storey whose floor is at height `storey` [m]; None if it has no floor.

    Cells are free if they have a floor or low things, but no wall. A cell has a wall if it has surface in `WALL_BAND`,
    or both below and above it, as a window has.
    """
    near = triangles[triangles.within(storey + FLOOR_BAND[0], storey + LINTEL_BAND[1])]
    yaw = wall_direction(near)
    low, cell = _grid(near, yaw)
    spacing = _spacing(near, SAMPLE_SPACING * cell)
    cell = max(cell, spacing / SAMPLE_SPACING)
    is_flat = abs(near.slope) > 0.7
    flat, steep = (_sample(near[rows], yaw, spacing) for rows in (is_flat, ~is_flat))
    points = flat.within(storey, FLOOR_BAND)
    if not len(points):
        return None
    size = np.ceil((points.max(axis=0) - low) / cell).astype(int) + 2 * MARGIN
    low = low - MARGIN * cell

    def cells(band: tuple[float, float], *parts: _Samples) -> Bool[np.ndarray, "ny nx"]:
        """Return the cells with surface at heights `band` above the storey's floor."""
        found = np.zeros((size[1], size[0]), bool)
        for part in parts:
            index = np.floor((part.within(storey, band) - low) / cell).astype(int)
            x, y = index[((index >= 0) & (index < size)).all(axis=1)].T
            found[y, x] = True
        return found

    things = cells(FURNITURE_BAND, flat, steep)
    walls = cells(WALL_BAND, flat, steep) | (things & cells(LINTEL_BAND, flat, steep))
    return FreeMap(yaw, low, cell, (cells(FLOOR_BAND, flat) | things) & ~walls)


def wall_direction(triangles: TriangleSet) -> float:
    """Return the yaw in the plan (x, -z) [rad], from -45 to 45 degrees, parallel or perpendicular to most walls."""
    upright = abs(triangles.slope) < UPRIGHT_SLOPE
    x, _, z = triangles.doubled_normal[upright].T
    total = (np.hypot(x, z) * np.exp(4j * np.arctan2(-z, x))).sum()
    return float(np.angle(total) / 4) if abs(total) > 1e-9 else 0.0


def to_plan(points: Float[np.ndarray, "*p 3"], yaw: float) -> Float[np.ndarray, "*p 2"]:
    """Return points, Y up, in the plan (x, -z) in axes turned by `yaw` [rad]."""
    turn = plane_matrix(yaw) * [[1.0], [-1.0]]
    return np.stack([points[..., 0] * turn[0, axis] + points[..., 2] * turn[1, axis] for axis in (0, 1)], axis=-1)


def _grid(triangles: TriangleSet, yaw: float) -> tuple[Float[np.ndarray, "2"], float]:
    """Return the minimum corner of a grid around triangles, and the edge of its cells [m]."""
    plan = to_plan(triangles.corners.reshape(-1, 3), yaw)
    if not len(plan):
        return np.zeros(2), MIN_CELL
    extent = np.maximum(np.ptp(plan, axis=0), MIN_CELL)
    return plan.min(axis=0), max(MIN_CELL, float(np.sqrt(extent.prod() / MAX_CELLS)), float(extent.max()) / MAX_CELLS)


def _spacing(triangles: TriangleSet, spacing: float) -> float:
    """Return a spacing [m], at least the given one, that needs at most `MAX_POINTS` points of `sample_surface`."""
    edge = np.linalg.norm(triangles.corners - np.roll(triangles.corners, 1, axis=1), axis=2).max(axis=1, initial=0)
    while ((steps := np.maximum(np.ceil(edge / spacing), 1)) * (steps + 3) / 2 + 1).sum() > MAX_POINTS:
        if spacing > edge.max(initial=0):
            break
        spacing *= 1.5
    return spacing


@dataclass(frozen=True)
class _Samples:
    """Points on triangles: their heights [m], and their places in the plan."""

    height: Float[np.ndarray, " p"]
    plan: Float[np.ndarray, "p 2"]

    def within(self, storey: float, band: tuple[float, float]) -> Float[np.ndarray, "p 2"]:
        """Return the places of the points at heights `band` above a storey's floor."""
        low, high = storey + band[0], storey + band[1]
        return self.plan[(self.height >= low) & (self.height <= high)]


def _sample(triangles: TriangleSet, yaw: float, spacing: float) -> _Samples:
    """Return points on triangles."""
    points = sample_surface(triangles.corners, spacing) if len(triangles) else np.zeros((0, 3))
    return _Samples(points[:, 1], to_plan(points, yaw))
