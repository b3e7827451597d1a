"""Distances in the small part of a house's grid around an agent, made anew for what is in the way there just now."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

HALF = 14  # cells, from the middle of a window to its edge: more than it takes to get round a leaf
WIDTH = 2 * HALF + 1
ROUNDS = 48  # cells of the longest way within a window
DETOUR = 3.0  # [m]: rather than pushing a leaf on the way to an end that is near, agents go out of the window
SHORTER, SHORTEST = 0.5, 20.0  # cells that a way shorter by 1 m is worth, and the way up to which that counts [m]
OFFSETS = np.array([(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)])


def window_places(at: Int[Array, "3"], shape: tuple[int, ...]) -> tuple[Int[Array, "n 3"], Bool[Array, " n"]]:
    """Level, row and column of the cells of the window around a cell, clipped to the grid, and which are inside it."""
    y, x = (a.reshape(-1) for a in np.meshgrid(np.arange(-HALF, HALF + 1), np.arange(-HALF, HALF + 1), indexing="ij"))
    places = at + jnp.asarray(np.stack([0 * y, y, x], axis=-1), jnp.int32)
    known = jnp.clip(places, 0, jnp.array(shape, jnp.int32) - 1)
    return known, jnp.all(known == places, axis=1)


def window_distances(known: Float[Array, " n"], length: Float[Array, " n"]) -> Float[Array, "w w"]:
    """Distances within a window, along its cells, to where they are least, or else to its edge and on as known.

    The edge counts if no such end is in the window, or it is farther there by more than `DETOUR`: what is known does
    not know what is in the way, and a way by the edge could lead back through it. No corner is cut.

    Args:
        known: As if nothing were in the way [m]; inf where agents cannot stand.
        length: Of a step out of each cell [m].

    Example:
        >>> far = window_distances(jnp.zeros(WIDTH**2), jnp.full(WIDTH**2, 0.1))
        >>> far.shape
        (29, 29)
    """
    known, length = known.reshape(WIDTH, WIDTH), length.reshape(WIDTH, WIDTH)
    edge = np.ones((WIDTH, WIDTH), bool)
    edge[1:-1, 1:-1] = False
    ends = (known <= jnp.min(_neighbours(known, jnp.inf), axis=0)) & ~jnp.asarray(edge)
    cost = _costs(jnp.isfinite(known), length)
    to_end, to_edge = (_relaxed(jnp.where(begin, known, jnp.inf), cost) for begin in (ends, jnp.asarray(edge)))
    begin = nearest_free(to_end)
    return jnp.where(to_end[begin] < to_edge[begin] + jnp.float32(DETOUR), to_end, to_edge)


def _costs(free: Bool[Array, "w w"], length: Float[Array, "w w"]) -> Float[Array, "9 w w"]:
    """Of a step out of each cell to each of the 3 × 3 around it [m]; inf where it cannot be made."""
    sides = _neighbours(free, False)
    steps = []
    for index, (y, x) in enumerate(OFFSETS.tolist()):
        open_ = free & sides[index] & sides[_number(y, 0)] & sides[_number(0, x)]
        steps.append(jnp.where(open_, length * jnp.float32(np.hypot(y, x)), jnp.inf))
    return jnp.stack(steps)


def _relaxed(begin: Float[Array, "w w"], cost: Float[Array, "9 w w"]) -> Float[Array, "w w"]:
    def relax(_: Array, far: Array) -> Array:
        return jnp.minimum(far, jnp.min(_neighbours(far, jnp.inf) + cost, axis=0))

    return jax.lax.fori_loop(0, ROUNDS, relax, begin)


def nearest_free(far: Float[Array, "w w"]) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Row and column of the cell of a window from which there is a way that is nearest to the middle.

    An agent may stand beside the cells that agents can cross: at what it has pushed aside, or close to furniture.
    """
    y, x = np.meshgrid(np.arange(WIDTH) - HALF, np.arange(WIDTH) - HALF, indexing="ij")
    away = jnp.asarray(np.hypot(y, x), jnp.float32)
    rank = jnp.where(jnp.isfinite(far), away + SHORTER * jnp.minimum(far, SHORTEST), jnp.inf)
    best = jnp.argmin(rank.at[HALF, HALF].add(-1e-3)).astype(jnp.int32)
    return best // WIDTH, best % WIDTH


def descend_window(far: Float[Array, "w w"], steps: int) -> Int[Array, "k 3"]:
    """Level, row and column of the next cells down from the middle of a window, relative to it; the middle first."""
    offsets = jnp.asarray(OFFSETS, jnp.int32)
    path = [jnp.zeros(2, jnp.int32), jnp.stack(nearest_free(far)) - HALF]
    for _ in range(steps - 1):
        around = path[-1] + offsets
        lower = far[around[:, 0] + HALF, around[:, 1] + HALF]
        path.append(around[jnp.argmin(lower.at[_number(0, 0)].add(-1e-4))])
    places = jnp.stack(path)
    return jnp.concatenate([jnp.zeros((len(path), 1), jnp.int32), places], axis=1)


def _number(y: int, x: int) -> int:
    return int(3 * (y + 1) + x + 1)


def _neighbours(values: Array, beyond: float | bool) -> Array:
    """The 3 × 3 cells around each cell, by number."""
    wide = jnp.pad(values, 1, constant_values=beyond)
    return jnp.stack([wide[y + 1 : y + 1 + WIDTH, x + 1 : x + 1 + WIDTH] for y, x in OFFSETS.tolist()])
