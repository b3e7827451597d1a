"""Distances in a window of the grid around an agent, recomputed for obstacles at their current poses."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

HALF = 14  # [cells], from the centre of a window to its edge; enough to get round a leaf
WIDTH = 2 * HALF + 1
ROUNDS = 64  # [cells], maximum length of a path within a window
SHORTER, SHORTEST = 0.05, 20.0  # cost of distance to the end [cells/m], and the distance up to which it counts [m]
WALL = 10.0  # [cells], extra cost of a cell in another room: a wall may be in between
# [m]: distance of unreachable cells, and advantage of the current cell, so that agents stay put on ties.
BEYOND, STAYS = 1e4, 1e-2
OFFSETS = np.array([(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)])


def window_places(at: Int[Array, "3"], shape: tuple[int, ...]) -> tuple[Int[Array, "n 3"], Bool[Array, " n"]]:
    """Return level, row and column of the cells around a cell, clipped to the grid, and which are inside it."""
    y, x = (a.reshape(-1) for a in np.meshgrid(np.arange(-HALF, HALF + 1), np.arange(-HALF, HALF + 1), indexing="ij"))
    places = at + jnp.asarray(np.stack([0 * y, y, x], axis=-1), jnp.int32)
    known = jnp.clip(places, 0, jnp.array(shape, jnp.int32) - 1)
    return known, jnp.all(known == places, axis=1)


def window_distances(known: Float[Array, " n"], length: Float[Array, " n"]) -> Float[Array, "w w"]:
    """Return distances along the cells of a window, continued by the known distances beyond it.

    Cells without a nearer neighbour keep their known distance: the end itself, and cells where paths leave the window.
    Other cells at the edge do not: known distances ignore current obstacles, and such a path could lead back through
    them. Paths cut no corners.

    Args:
        known: Distances that ignore current obstacles [m]; inf where agents cannot walk.
        length: Length of a step out of each cell [m].

    Example:
        >>> far = window_distances(jnp.zeros(WIDTH**2), jnp.full(WIDTH**2, 0.1))
        >>> far.shape
        (29, 29)
    """
    known, length = known.reshape(WIDTH, WIDTH), length.reshape(WIDTH, WIDTH)
    cost = _costs(jnp.isfinite(known), length)
    around = jnp.where(jnp.isfinite(cost), _neighbours(known, jnp.inf), jnp.inf)
    begin = jnp.where(known <= jnp.min(around, axis=0), known, jnp.inf)

    def relax(_: Array, far: Array) -> Array:
        return jnp.minimum(far, jnp.min(_neighbours(far, jnp.inf) + cost, axis=0))

    return jax.lax.fori_loop(0, ROUNDS, relax, begin)


def _costs(free: Bool[Array, "w w"], length: Float[Array, "w w"]) -> Float[Array, "9 w w"]:
    """Return the length of a step out of each cell to each of the 3 × 3 around it [m]; inf if blocked."""
    sides = _neighbours(free, False)
    steps = []
    for index, (y, x) in enumerate(OFFSETS.tolist()):
        open_ = free & sides[index] & sides[_number(y, 0)] & sides[_number(0, x)]
        steps.append(jnp.where(open_, length * jnp.float32(np.hypot(y, x)), jnp.inf))
    return jnp.stack(steps)


def nearest_free(known: Float[Array, " n"], elsewhere: Bool[Array, " n"]) -> Int[Array, "2"]:
    """Return row and column of the walkable cell that is nearest to the centre of a window.

    An agent may be outside walkable cells: close to furniture, or at an object that it has pushed aside.

    Args:
        known: Distances of cells [m]; inf where agents cannot walk.
        elsewhere: Mask of cells in another room than the centre.
    """
    away = jnp.asarray(np.hypot(*np.meshgrid(*[np.arange(WIDTH) - HALF] * 2)), jnp.float32).reshape(-1)
    rank = away + SHORTER * jnp.minimum(known, SHORTEST) + WALL * elsewhere
    rank = jnp.where(jnp.isfinite(known), rank, jnp.inf)
    best = jnp.argmin(rank.at[WIDTH * HALF + HALF].add(-1.0)).astype(jnp.int32)
    return jnp.stack([best // WIDTH, best % WIDTH])


def descend_window(far: Float[Array, "w w"], begin: Int[Array, "2"], steps: int) -> Int[Array, "k 3"]:
    """Return level, row and column of the next cells down a window's distances, relative to its centre, which is first.

    Args:
        far: The distances [m].
        begin: Row and column of the first cell if no neighbour of the centre has a finite distance.
        steps: Number of cells after the centre.
    """
    middle = jnp.full(2, HALF, jnp.int32)
    beside = _lowest(far, middle)
    path = [middle, jnp.where(jnp.isfinite(far[beside[0], beside[1]]), beside, begin)]
    for _ in range(steps - 1):
        path.append(_lowest(far, path[-1]))
    places = jnp.stack(path) - HALF
    return jnp.concatenate([jnp.zeros((len(path), 1), jnp.int32), places], axis=1)


def _lowest(far: Float[Array, "w w"], at: Int[Array, "2"]) -> Int[Array, "2"]:
    """Return the cell with the smallest distance among a cell and its neighbours."""
    around = jnp.clip(at + jnp.asarray(OFFSETS, jnp.int32), 0, WIDTH - 1)
    known = jnp.minimum(far[around[:, 0], around[:, 1]], jnp.float32(BEYOND))
    return around[jnp.argmin(known.at[_number(0, 0)].add(-STAYS))]


def _number(y: int, x: int) -> int:
    return int(3 * (y + 1) + x + 1)


def _neighbours(values: Array, beyond: float | bool) -> Array:
    """Stack the values of the 3 × 3 cells around each cell, in the order of `OFFSETS`."""
    wide = jnp.pad(values, 1, constant_values=beyond)
    return jnp.stack([wide[y + 1 : y + 1 + WIDTH, x + 1 : x + 1 + WIDTH] for y, x in OFFSETS.tolist()])
