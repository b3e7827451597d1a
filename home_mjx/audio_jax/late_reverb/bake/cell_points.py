"""Points in cells and visibility between them."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse.csgraph import dijkstra

from home_mjx.audio_jax.late_reverb.bake.decay_fit import horizontal_distance, weigh_cells
from home_mjx.audio_jax.late_reverb.trace.cells import CELLS_PER_PLACE, Cells
from home_mjx.audio_jax.late_reverb.trace.house_rays import SightLines
from home_mjx.schema.compiled import CompiledHouse

CELL_REACH = 1.7  # [cell sizes], distance at which a cell's weight becomes zero
LATTICE_STEP = 0.2  # [m], spacing of the lattice on which weights are stored
EAR_HEIGHT = 1.4  # [m], height of lattice points above the floor
NUM_WITNESS_CELLS = 5  # nearest cells whose centres are tested for a view of a cell's points
NUM_WITNESS_POINTS = 6  # free points per such cell that are tested next, for points hidden from the centres
MAX_ROUNDS = 4  # maximum rounds of that search, and so of corners on the way
MIN_TRIED_POINTS = 800  # minimum points per cell by which its free fraction is estimated
NUM_CANDIDATES = 8  # points of a cell among which an unobstructed one is chosen


def choose_points(rays: SightLines, cells: Cells, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Choose a point of each cell: of its centre and random ones, that which sees most of these points of its room.

    Of equal points the first is chosen, the centre before random ones.
    """
    tried = np.stack([sample_points(cells, cell, NUM_CANDIDATES, rng) for cell in range(len(cells.room))])
    tried[:, 0] = cells.center
    flat, room = tried.reshape(-1, 3), np.repeat(cells.room, NUM_CANDIDATES)
    start, end = np.nonzero(room[:, None] == room[None])
    score = np.bincount(start, ~rays.occluded(flat[start], flat[end]), len(flat))
    return tried[np.arange(len(tried)), np.argmax(score.reshape(tried.shape[:2]), axis=1)]


def sample_free_points(
    rays: SightLines, cells: Cells, count: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n r 3"], Float[np.ndarray, " n"]]:
    """Sample random points in the free part of each cell; return them and the free fraction of its volume.

    A point is free if it is visible from the centre of its cell or of a nearby cell of its room, or from free points.
    So air behind a screen and above a cupboard is included. Cells without a free point use all; fractions are at
    least 0.1. Points are repeated if fewer than r = `count` are free.
    """
    points, free = [], []
    tried = np.stack(
        [sample_points(cells, cell, max(2 * count, MIN_TRIED_POINTS), rng) for cell in range(len(cells.room))]
    )
    apart = np.linalg.norm(cells.center[:, None] - cells.center[None], axis=2)
    apart[cells.room[:, None] != cells.room[None]] = np.inf
    nearest = np.argsort(apart, axis=1, kind="stable")[:, :NUM_WITNESS_CELLS]
    nearest = np.where(np.isfinite(np.take_along_axis(apart, nearest, 1)), nearest, np.arange(len(apart))[:, None])
    free_points = np.zeros(tried.shape[:2], bool)
    for column in nearest.T:
        cell, point = np.nonzero(~free_points)
        free_points[cell, point] = _is_visible(rays, cells.center[column][cell], tried[cell, point])
    free_points = _extend_free(rays, tried, free_points, nearest, rng)
    for seen, some in zip(free_points, tried, strict=True):
        good = some[seen] if seen.any() else some
        points.append(good[np.arange(count) % len(good)])
        free.append(max(seen.mean(), 0.1))
    return np.stack(points), np.array(free)


def _extend_free(
    rays: SightLines,
    points: Float[np.ndarray, "n r 3"],
    free: Bool[np.ndarray, "n r"],
    nearest: Int[np.ndarray, "n w"],
    rng: np.random.Generator,
) -> Bool[np.ndarray, "n r"]:
    """Extend the free points of cells by those visible from free points of the nearest cells, repeatedly.

    There are at most `MAX_ROUNDS` rounds, each with `NUM_WITNESS_POINTS` random free points per cell. The result is a
    copy.
    """
    free, own = free.copy(), np.arange(len(free))[:, None]
    for _ in range(MAX_ROUNDS):
        chance = np.where(free, rng.random(free.shape, np.float32), 0.0)
        drawn = np.argpartition(chance, -NUM_WITNESS_POINTS, axis=1)[:, -NUM_WITNESS_POINTS:]
        witness = points[own, drawn][nearest].reshape(len(points), -1, 3)
        known = free[own, drawn][nearest].reshape(len(points), -1)
        cell, hidden = np.nonzero(~free)
        seen = (_is_visible(rays, witness[cell], points[cell, hidden][:, None]) & known[cell]).any(axis=1)
        if not seen.any():
            break
        free[cell[seen], hidden[seen]] = True
    return free


def sample_points(cells: Cells, cell: int, count: int, rng: np.random.Generator) -> Float[np.ndarray, "r 3"]:
    """Sample `count` random points of a cell, between its bottom and top [m]."""
    _, row, column = np.nonzero(cells.lookup == cell)
    pick = rng.integers(len(row), size=count)
    plan = cells.origin + (np.stack([column[pick], row[pick]], 1) + rng.random((count, 2))) * cells.step
    return np.concatenate([plan, cells.low[cell] + rng.random((count, 1)) * (cells.high - cells.low)[cell]], axis=1)


def compute_visibility(
    rays: SightLines, start: Float[np.ndarray, "p 3"], end: Float[np.ndarray, "n 3"]
) -> Bool[np.ndarray, "p n"]:
    """Return whether the line between each pair of points is unobstructed."""
    return _is_visible(rays, start[:, None], end[None])


def shortest_paths(center: Float[np.ndarray, "n 3"], seen: Bool[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Compute shortest paths between cells [m], from centre to centre of cells of which one sees the other.

    Cells without such a path have the length of the straight line.
    """
    straight = np.linalg.norm(center[:, None] - center[None], axis=2)
    found = dijkstra(np.where(seen | seen.T, straight, 0), directed=False)
    return np.where(np.isfinite(found), found, straight)


def build_lattice(house: CompiledHouse, rays: SightLines, cells: Cells, size: float) -> dict[str, np.ndarray]:
    """Compute the lattice fields of a `LateField`: the visible cells around each lattice point, and their weights.

    Points are about `LATTICE_STEP` apart, at `EAR_HEIGHT`. `size` is the edge length of a cell [m]; cells have weight
    up to `CELL_REACH * size`. Points that see no cell so near consider all cells, see `weigh_cells`.
    """
    stride = max(round(LATTICE_STEP / cells.step), 1)
    levels, rows, columns = cells.lookup.shape
    down, across = np.arange(stride // 2, rows, stride), np.arange(stride // 2, columns, stride)
    x, y = cells.origin[0] + (across + 0.5) * cells.step, cells.origin[1] + (down + 0.5) * cells.step
    floor = house.navigation.floor[:levels]
    place = np.stack(np.broadcast_arrays(x[None, None], y[None, :, None], floor[:, None, None] + EAR_HEIGHT), -1)
    flat, reach = place.reshape(-1, 3), CELL_REACH * size
    near = np.less(horizontal_distance(cells.center, flat), reach)
    seen = np.zeros(near.shape, bool)
    seen[near] = _sees_pairs(rays, flat, cells.center, near)
    alone = np.zeros(near.shape, bool)
    alone[~seen.any(axis=1)] = True
    seen[alone] = _sees_pairs(rays, flat, cells.center, alone)
    number, weight = weigh_cells(cells.center, flat, seen, reach, CELLS_PER_PLACE)
    return {
        "near": number.reshape(*place.shape[:3], -1).astype(np.uint8),
        "weight": weight.reshape(*place.shape[:3], -1),
        "floor": floor,
        "origin": np.array([x[0], y[0]]) - stride * cells.step / 2,
        "step": np.asarray(stride * cells.step),
    }


def _sees_pairs(
    rays: SightLines, start: Float[np.ndarray, "p 3"], end: Float[np.ndarray, "n 3"], pairs: Bool[np.ndarray, "p n"]
) -> Bool[np.ndarray, " m"]:
    """Return whether the line is unobstructed for each True in `pairs`, in row-major order."""
    first, second = np.nonzero(pairs)
    return ~rays.occluded(start[first], end[second])


def _is_visible(
    rays: SightLines, start: Float[np.ndarray, "*p 3"], end: Float[np.ndarray, "*q 3"]
) -> Bool[np.ndarray, "..."]:
    """Return whether lines between points (broadcast) are unobstructed."""
    start, end = np.broadcast_arrays(start, end)
    return ~rays.occluded(start.reshape(-1, 3), end.reshape(-1, 3)).reshape(start.shape[:-1])
