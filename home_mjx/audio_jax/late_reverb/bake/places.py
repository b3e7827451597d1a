"""Points in cells and visibility between them; on the host, except for the rays."""

from collections.abc import Callable

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int
from scipy.sparse.csgraph import dijkstra

from home_mjx.audio_jax.late_reverb.bake.fit import neighbours
from home_mjx.audio_jax.late_reverb.trace.cells import Cells
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import CompiledHouse, Ray

NEAR = 4  # maximum cells per lattice point
REACH = 1.7  # [cell sizes], distance at which a cell's weight becomes zero
PLACE = 0.2  # [m], spacing of the lattice on which weights are stored
EARS = 1.4  # [m], height of lattice points above the floor
WITNESSES = 5  # nearest cells whose centres are tested for a view of a cell's points
FROM_EACH = 6  # free points per such cell that are tested next, for points hidden from the centres
ROUNDS = 4  # maximum rounds of that search, and so of corners on the way
AT_ONCE = 1 << 15  # rays per batch
CANDIDATES = 8  # points of a cell among which an unobstructed one is chosen


def clear_points(scene: Scene, cells: Cells, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Choose an unobstructed point of each cell: the candidate that sees most others of its room."""
    tried = np.stack([random_points(cells, cell, CANDIDATES, rng) for cell in range(len(cells.room))])
    tried[:, 0] = cells.center
    flat = tried.reshape(-1, 3)
    room = np.repeat(cells.room, CANDIDATES)
    score = (in_view(scene, flat, flat) & (room[:, None] == room[None])).sum(axis=1)
    return tried[np.arange(len(tried)), np.argmax(score.reshape(tried.shape[:2]), axis=1)]


def start_points(
    scene: Scene, cells: Cells, count: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n r 3"], Float[np.ndarray, " n"]]:
    """Sample random points in the free part of each cell; return them and the free fraction of its volume.

    A point is free if it is visible from the centre of its cell or of a nearby cell of its room, or from free points.
    So air behind a screen and above a cupboard is included.
    """
    points, free = [], []
    tried = np.stack([random_points(cells, cell, 2 * count, rng) for cell in range(len(cells.room))])
    apart = np.linalg.norm(cells.center[:, None] - cells.center[None], axis=2)
    apart[cells.room[:, None] != cells.room[None]] = np.inf
    nearest = np.argsort(apart, axis=1, kind="stable")[:, :WITNESSES]
    nearest = np.where(np.isfinite(np.take_along_axis(apart, nearest, 1)), nearest, np.arange(len(apart))[:, None])
    free_points = np.zeros(tried.shape[:2], bool)
    for column in nearest.T:
        cell, point = np.nonzero(~free_points)
        free_points[cell, point] = _see(scene, cells.center[column][cell], tried[cell, point])
    free_points = _around_corners(scene, tried, free_points, nearest, rng)
    for seen, some in zip(free_points, tried, strict=True):
        good = some[seen] if seen.any() else some
        points.append(good[np.arange(count) % len(good)])
        free.append(max(seen.mean(), 0.1))
    return np.stack(points), np.array(free)


def _around_corners(
    scene: Scene,
    points: Float[np.ndarray, "n r 3"],
    free: Bool[np.ndarray, "n r"],
    nearest: Int[np.ndarray, "n w"],
    rng: np.random.Generator,
) -> Bool[np.ndarray, "n r"]:
    """Extend the free points of cells by those visible from free points of the nearest cells, repeatedly."""
    free, own = free.copy(), np.arange(len(free))[:, None]
    for _ in range(ROUNDS):
        chance = np.where(free, rng.random(free.shape, np.float32), 0.0)
        drawn = np.argpartition(chance, -FROM_EACH, axis=1)[:, -FROM_EACH:]
        witness = points[own, drawn][nearest].reshape(len(points), -1, 3)
        known = free[own, drawn][nearest].reshape(len(points), -1)
        cell, hidden = np.nonzero(~free)
        seen = (_see(scene, witness[cell], points[cell, hidden][:, None]) & known[cell]).any(axis=1)
        if not seen.any():
            break
        free[cell[seen], hidden[seen]] = True
    return free


def random_points(cells: Cells, cell: int, count: int, rng: np.random.Generator) -> Float[np.ndarray, "r 3"]:
    """Sample random points of a cell."""
    _, row, column = np.nonzero(cells.lookup == cell)
    pick = rng.integers(len(row), size=count)
    plan = cells.origin + (np.stack([column[pick], row[pick]], 1) + rng.random((count, 2))) * cells.step
    return np.concatenate([plan, cells.low[cell] + rng.random((count, 1)) * (cells.high - cells.low)[cell]], axis=1)


def in_view(scene: Scene, start: Float[np.ndarray, "p 3"], end: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "p n"]:
    """Test the visibility between all pairs of points."""
    return _see(scene, start[:, None], end[None])


def ways(center: Float[np.ndarray, "n 3"], seen: Bool[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Compute shortest paths between cells over mutually visible cells [m]; the straight line if there is no path."""
    straight = np.linalg.norm(center[:, None] - center[None], axis=2)
    found = dijkstra(np.where(seen | seen.T, straight, 0), directed=False)
    return np.where(np.isfinite(found), found, straight)


def places(house: CompiledHouse, scene: Scene, cells: Cells, size: float) -> Callable[[], dict[str, np.ndarray]]:
    """Launch rays from lattice points to cells; return a function that computes the lattice fields of a `LateField`.

    The fields are the cells around each lattice point and their weights. A GPU can do other work until that call.
    """
    stride = max(round(PLACE / cells.step), 1)
    levels, rows, columns = cells.lookup.shape
    down, across = np.arange(stride // 2, rows, stride), np.arange(stride // 2, columns, stride)
    x, y = cells.origin[0] + (across + 0.5) * cells.step, cells.origin[1] + (down + 0.5) * cells.step
    floor = house.navigation.floor[:levels]
    place = np.stack(np.broadcast_arrays(x[None, None], y[None, :, None], floor[:, None, None] + EARS), -1)
    flat = place.reshape(-1, 3)
    seen = _look(scene, flat[:, None], cells.center[None])

    def fields() -> dict[str, np.ndarray]:
        near, weight = neighbours(cells.center, flat, seen(), REACH * size, NEAR)
        return {
            "near": near.reshape(*place.shape[:3], -1).astype(np.uint8),
            "weight": weight.reshape(*place.shape[:3], -1),
            "floor": floor,
            "origin": np.array([x[0], y[0]]) - stride * cells.step / 2,
            "step": np.asarray(stride * cells.step),
        }

    return fields


def _see(scene: Scene, start: Float[np.ndarray, "*p 3"], end: Float[np.ndarray, "*q 3"]) -> Bool[np.ndarray, "..."]:
    """Test for unobstructed lines between points."""
    return _look(scene, start, end)()


def _look(
    scene: Scene, start: Float[np.ndarray, "*p 3"], end: Float[np.ndarray, "*q 3"]
) -> Callable[[], Bool[np.ndarray, "..."]]:
    """Launch rays between points; return a function that waits for them and returns the visibility.

    Batches have a fixed size, so houses of all sizes share one program.
    """
    start, end = np.broadcast_arrays(np.asarray(start, np.float32), np.asarray(end, np.float32))
    rays = np.stack([start.reshape(-1, 3), end.reshape(-1, 3)])
    chunks = np.pad(rays, ((0, 0), (0, -rays.shape[1] % AT_ONCE), (0, 0))).reshape(2, -1, AT_ONCE, 3)
    hidden = [_hidden(scene, a, b) for a, b in zip(*chunks, strict=True)]
    shape, count = start.shape[:-1], rays.shape[1]
    return lambda: ~np.concatenate([*map(np.asarray, hidden), np.zeros(0, bool)])[:count].reshape(shape)


@jax.jit
def _hidden(scene: Scene, start: Float[Array, "n 3"], end: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    return occluded(scene, start, end - start, t_max=1.0, mask=int(Ray.SOUND))
