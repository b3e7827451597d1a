"""Distances in a window of the grid around an agent, recomputed for obstacles at their current poses."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.geometry.geodesic import MAX_RISE

HALF_WIDTH = 14  # [cells], from the centre of a window to its edge; enough to get round a leaf
WIDTH = 2 * HALF_WIDTH + 1
NUM_RELAXATIONS = 64  # [cells], maximum length of a path within a window
# Cost of distance to the end [cells/m], and the distance up to which it counts [m].
DISTANCE_WEIGHT, MAX_WEIGHTED_DISTANCE = 0.05, 20.0
# [m], extra distance of an exit of the window that is farther from the end than its centre: agents would turn round at
# a leaf in the way, lose sight of it, and come back.
RETREAT_COST = 100.0
EDGE_COST = 5.0  # [m], extra distance of an exit of the window beside a leaf, of which the rest may lie beyond the edge
# Length factor of steps more than `MAX_DETOUR_RISE` [m] farther from the end than the centre. Getting round a leaf
# needs less. Beyond such a ridge is another way; halfway to it the leaf is out of sight, and agents would come back.
RIDGE_COST_FACTOR, MAX_DETOUR_RISE = 20.0, 0.5
OTHER_ROOM_COST = 10.0  # [cells], extra cost of a cell in another room: a wall may be in between
# [m]: distance of unreachable cells, and advantage of the current cell, so that agents stay put on ties.
UNREACHABLE_DISTANCE, STAY_BONUS = 1e4, 1e-2
OFFSETS = np.array([(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)])


def window_places(at: Int[Array, "3"], shape: tuple[int, ...]) -> tuple[Int[Array, "n 3"], Bool[Array, " n"]]:
    """Return (level, row, column) of `WIDTH` x `WIDTH` cells around `at`, clipped to the grid, and which are inside.

    They are in row-major order, as are all arguments of n cells here.
    """
    y, x = (
        a.reshape(-1)
        for a in np.meshgrid(
            np.arange(-HALF_WIDTH, HALF_WIDTH + 1), np.arange(-HALF_WIDTH, HALF_WIDTH + 1), indexing="ij"
        )
    )
    places = at + jnp.asarray(np.stack([0 * y, y, x], axis=-1), jnp.int32)
    known = jnp.clip(places, 0, jnp.array(shape, jnp.int32) - 1)
    return known, jnp.all(known == places, axis=1)


def window_distances(
    global_distance: Float[Array, " n"],
    length: Float[Array, " n"],
    height: Float[Array, " n"],
    passable: Bool[Array, " n"] | None = None,
) -> Float[Array, "w w"]:
    """Return remaining distances [m] of a window's cells, by paths within it and `global_distance` where they leave.

    Cells without a nearer neighbour keep their known distance: the end itself, and cells where paths leave the window.
    Other cells at the edge do not: known distances ignore current obstacles, and such a path could lead back through
    them. Where paths leave the window farther from the end than its centre is, they cost `RETREAT_COST` more, and
    beside an obstacle `EDGE_COST`. Steps over a ridge in between are longer by `RIDGE_COST_FACTOR`. Paths cut no
    corners, and do not lead from a floor to one above or below it, see `MAX_RISE`. A cell that no path reaches has inf.

    Args:
        global_distance: Distances that ignore current obstacles [m]; inf where agents cannot walk.
        length: Length of a step out of each cell [m], longer beside obstacles.
        height: Height of each cell [m].
        passable: Cells that may be at the corners of a diagonal step; None: those where agents can walk.

    Example:
        >>> far = window_distances(jnp.zeros(WIDTH**2), jnp.full(WIDTH**2, 0.1), jnp.zeros(WIDTH**2))
        >>> far.shape
        (29, 29)
    """
    global_distance, length, height = (x.reshape(WIDTH, WIDTH) for x in (global_distance, length, height))
    free = jnp.isfinite(global_distance)
    here = global_distance[HALF_WIDTH, HALF_WIDTH]
    ridge = global_distance > here + jnp.float32(MAX_DETOUR_RISE)
    slow = jnp.where(ridge, length * jnp.float32(RIDGE_COST_FACTOR), length)
    cost = _step_lengths(free, free if passable is None else passable.reshape(free.shape), slow, height)
    around = jnp.where(jnp.isfinite(cost), _neighbours(global_distance, jnp.inf), jnp.inf)
    retreats = global_distance > here
    beside = length > jnp.min(length)
    leave = global_distance + jnp.float32(RETREAT_COST) * retreats + jnp.float32(EDGE_COST) * beside
    begin = jnp.where(global_distance <= jnp.min(around, axis=0), leave, jnp.inf)

    def relax(_: Array, far: Array) -> Array:
        """Shorten distances by one step to a neighbour."""
        return jnp.minimum(far, jnp.min(_neighbours(far, jnp.inf) + cost, axis=0))

    return jax.lax.fori_loop(0, NUM_RELAXATIONS, relax, begin)


def _step_lengths(
    free: Bool[Array, "w w"], passable: Bool[Array, "w w"], length: Float[Array, "w w"], height: Float[Array, "w w"]
) -> Float[Array, "9 w w"]:
    """Return the length of a step out of each cell to each of the 3 × 3 around it [m], in the order of `OFFSETS`.

    It is the cell's `length` times 1, times √2 for a diagonal and 0 to itself. It is inf if the target is not `free`,
    or the two cells beside a diagonal are not both `passable`, or one of these is not `_is_step_away`.
    """
    rises = _is_step_away(height)
    sides, corners = _neighbours(free, False) & rises, _neighbours(passable, False) & rises
    steps = []
    for index, (y, x) in enumerate(OFFSETS.tolist()):
        open_ = free & sides[index] & corners[_offset_index(y, 0)] & corners[_offset_index(0, x)]
        steps.append(jnp.where(open_, length * jnp.float32(np.hypot(y, x)), jnp.inf))
    return jnp.stack(steps)


def _is_step_away(height: Float[Array, "w w"]) -> Bool[Array, "9 w w"]:
    """Return which of the 3 × 3 cells around each differ from it in height [m] by less than `MAX_RISE`.

    Those outside the window are False, the cell itself is True.
    """
    return jnp.abs(_neighbours(height, jnp.inf) - height) < jnp.float32(MAX_RISE)


def nearest_walkable(global_distance: Float[Array, " n"], elsewhere: Bool[Array, " n"]) -> Int[Array, "2"]:
    """Return row and column, from the window's corner, of the walkable cell nearest to its centre; (0, 0) without one.

    An agent may be outside walkable cells: close to furniture, or at an object that it has pushed aside. Cells in the
    mask `elsewhere` (another room or height) count as `OTHER_ROOM_COST` farther, and those far from the end as a little
    farther. `global_distance` [m] is inf where agents cannot walk.
    """
    away = jnp.asarray(np.hypot(*np.meshgrid(*[np.arange(WIDTH) - HALF_WIDTH] * 2)), jnp.float32).reshape(-1)
    rank = away + DISTANCE_WEIGHT * jnp.minimum(global_distance, MAX_WEIGHTED_DISTANCE) + OTHER_ROOM_COST * elsewhere
    rank = jnp.where(jnp.isfinite(global_distance), rank, jnp.inf)
    best = jnp.argmin(rank.at[WIDTH * HALF_WIDTH + HALF_WIDTH].add(-1.0)).astype(jnp.int32)
    return jnp.stack([best // WIDTH, best % WIDTH])


def descend_window(
    far: Float[Array, "w w"],
    height: Float[Array, " n"],
    begin: Int[Array, "2"],
    steps: int,
    passable: Bool[Array, " n"] | None = None,
) -> Int[Array, "k 2"]:
    """Return row and column of the next cells down a window's distances, relative to its centre, which is first.

    At a minimum the last cell is repeated.

    Args:
        far: The distances [m].
        height: Height of each cell [m].
        begin: Row and column, from the corner, of the first cell if no neighbour of the centre has a finite distance.
        steps: Number of cells after the centre.
        passable: Cells that may be at the corners of a diagonal step; None: those with a finite distance.
    """
    middle, height = jnp.full(2, HALF_WIDTH, jnp.int32), height.reshape(WIDTH, WIDTH)
    corners = jnp.isfinite(far) if passable is None else passable.reshape(WIDTH, WIDTH)
    beside = _lowest_neighbour(far, corners, height, middle)
    path = [middle, jnp.where(jnp.isfinite(far[beside[0], beside[1]]), beside, begin)]
    for _ in range(steps - 1):
        path.append(_lowest_neighbour(far, corners, height, path[-1]))
    return jnp.stack(path) - HALF_WIDTH


def _lowest_neighbour(
    far: Float[Array, "w w"], passable: Bool[Array, "w w"], height: Float[Array, "w w"], at: Int[Array, "2"]
) -> Int[Array, "2"]:
    """Return row and column of the lowest distance among a cell and its neighbours of like height; the cell on ties.

    Diagonal neighbours count only between two passable cells, unless the cell itself has no distance.
    """
    around = jnp.clip(at + jnp.asarray(OFFSETS, jnp.int32), 0, WIDTH - 1)
    row, column = around.T
    rise = jnp.abs(height[row, column] - height[at[0], at[1]])
    is_diagonal = jnp.asarray(OFFSETS.all(axis=1)) & jnp.isfinite(far[at[0], at[1]])
    is_open = ~is_diagonal | (passable[row, at[1]] & passable[at[0], column])
    known = jnp.where(is_open & (rise < jnp.float32(MAX_RISE)), far[row, column], jnp.inf)
    known = jnp.minimum(known, jnp.float32(UNREACHABLE_DISTANCE))
    return around[jnp.argmin(known.at[_offset_index(0, 0)].add(-STAY_BONUS))]


def _offset_index(y: int, x: int) -> int:
    """Return the index of an offset (-1, 0 or 1 each) in `OFFSETS`."""
    return int(3 * (y + 1) + x + 1)


def _neighbours(values: Array, beyond: float | bool) -> Array:
    """Stack the values of the 3 × 3 cells around each cell, in the order of `OFFSETS`; `beyond` outside the window."""
    wide = jnp.pad(values, 1, constant_values=beyond)
    return jnp.stack([wide[y + 1 : y + 1 + WIDTH, x + 1 : x + 1 + WIDTH] for y, x in OFFSETS.tolist()])
