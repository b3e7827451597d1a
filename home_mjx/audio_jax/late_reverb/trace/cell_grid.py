"""Lookup of the cell at a point, on the device."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.late_reverb.trace.cells import Cells
from home_mjx.core.pytree import Pytree, static


class CellGrid(Pytree):
    """`Cells` on the device."""

    lookup: Int[Array, "levels rows columns"]
    origin: Float[Array, " 2"]
    low: Float[Array, " n"]
    high: Float[Array, " n"]
    volume: Float[Array, " n"]
    room: Int[Array, " n"]
    joined: Bool[Array, "r r"]  # pairs of rooms that share a portal
    rooms: int = static()
    step: float = static()  # [m]


def make_grid(cells: Cells, free: Float[np.ndarray, " n"], joined: Bool[np.ndarray, "r r"]) -> CellGrid:
    """Put a house's cells on the device, padded so that houses of similar size share a program.

    Args:
        cells: Cells of the house.
        free: Free fraction of each cell's volume.
        joined: Pairs of rooms that share a portal.
    """
    more = -len(joined) % 8
    count, (_, rows, columns) = len(cells.room), cells.lookup.shape
    beyond = -count % 32
    lookup = np.pad(cells.lookup, ((0, 0), (0, -rows % 32), (0, -columns % 32)), constant_values=-1)

    def padded(values: np.ndarray, fill: float, kind: type = np.float32) -> Array:
        return jnp.asarray(np.pad(values, (0, beyond), constant_values=fill).astype(kind))

    return CellGrid(
        lookup=jnp.asarray(lookup, jnp.int32),
        origin=jnp.asarray(cells.origin, jnp.float32),
        low=padded(cells.low, np.inf),
        high=padded(cells.high, -np.inf),
        volume=padded(cells.volume * free, 1.0),
        room=padded(cells.room, 0, np.int32),
        joined=jnp.asarray(np.pad(joined, ((0, more), (0, more)))),
        rooms=len(joined) + more,
        step=float(cells.step),
    )
