"""What is baked, and how it is read: late energy between any two points of a house."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8

from home_mjx.core.pytree import Pytree

SPANS = (0, 2, 6, 14)  # bins after the first arrival at which a span of time begins; the last one never ends
NEAR = 8  # cells that matter at one place


class LateField(Pytree):
    """Late sound of one house with everything as it was compiled.

    Between cells i and j sound arrives after `distance[i, j] / c`. Its energy is kept per octave for four spans of
    time after that, as logarithms, which half precision holds. Within a span time runs as it does between their rooms,
    `shape`, which many rays have found together. In between, energies are interpolated: means of noisy logarithms would
    be too low.
    """

    distance: Float[Array, "n n"]  # [m], from cell to cell around what stands in between
    level: Float[Array, "n n spans bands"]  # ln of the energy re the free field at 1 m
    shape: Float[Array, "rooms rooms bands k"]  # ln of the energy per bin between two rooms, of which each span holds 1
    room: Int[Array, " n"]  # of each cell
    near: UInt8[Array, "levels rows columns e"]  # cells around each place
    weight: Float[Array, "levels rows columns e"]  # of these; they add up to 1
    floor: Float[Array, " levels"]  # [m]
    origin: Float[Array, " 2"]  # [m], of place (0, 0)
    step: Float[Array, ""]  # [m], between places

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(x.nbytes for x in jax.tree.leaves(self))


def late_energy(
    field: LateField, source: Float[Array, "3"], listener: Float[Array, "3"], metres: float
) -> Float[Array, "k bands"]:
    """Energy per time bin and octave between two points, without direct sound and first-order reflections.

    Args:
        field: Of the house.
        source: [m].
        listener: [m].
        metres: That sound travels in one bin.

    Returns:
        Histogram re the free field of the source at 1 m; bins count from the source's click.
    """
    from_cell, from_weight = _around(field, source)
    to_cell, to_weight = _around(field, listener)
    both = from_weight[:, None] * to_weight[None]
    pairs = jnp.exp(field.level[from_cell[:, None], to_cell[None]].astype(jnp.float32))
    level = jnp.einsum("ij,ijsb->sb", both, pairs, precision="highest")
    way = jnp.sum(both * field.distance[from_cell[:, None], to_cell[None]].astype(jnp.float32))
    way = jnp.maximum(way, jnp.linalg.norm(source - listener))

    count = field.shape.shape[-1]
    rooms = field.shape.shape[0]
    at, heard_at = (_in_rooms(field, *x, rooms) for x in ((from_cell, from_weight), (to_cell, to_weight)))
    shape = jnp.einsum("r,q,rqbk->kb", at, heard_at, jnp.exp(field.shape.astype(jnp.float32)), precision="highest")
    span = jnp.asarray(np.searchsorted(SPANS, np.arange(count), side="right") - 1)
    energy = shape * level[span]
    return _delayed(energy, way / metres)


def _around(field: LateField, point: Float[Array, "3"]) -> tuple[Int[Array, " e"], Float[Array, " e"]]:
    """Cells around a point and their weights, between the four nearest places of its storey."""
    level = jnp.argmax(jnp.where(field.floor <= point[2], field.floor, -jnp.inf))
    at = (point[:2] - field.origin) / field.step - 0.5
    whole = jnp.floor(at)
    rest = at - whole
    cells, weights = [], []
    for right in (0, 1):
        for up in (0, 1):
            share = jnp.abs(1 - right - rest[0]) * jnp.abs(1 - up - rest[1])
            column = jnp.clip(whole[0].astype(jnp.int32) + right, 0, field.near.shape[2] - 1)
            row = jnp.clip(whole[1].astype(jnp.int32) + up, 0, field.near.shape[1] - 1)
            cells.append(field.near[level, row, column].astype(jnp.int32))
            weights.append(share * field.weight[level, row, column].astype(jnp.float32))
    return jnp.concatenate(cells), jnp.concatenate(weights)


def _in_rooms(
    field: LateField, cell: Int[Array, " e"], weight: Float[Array, " e"], rooms: int
) -> Float[Array, " rooms"]:
    return jax.nn.one_hot(field.room[cell], rooms, dtype=jnp.float32).T @ weight


def _delayed(energy: Float[Array, "k bands"], bins: Float[Array, ""]) -> Float[Array, "k bands"]:
    """Energies later by some bins, shared between the two nearest ones."""
    count = energy.shape[0]
    whole = jnp.floor(bins).astype(jnp.int32)
    rest = bins - whole
    padded = jnp.concatenate([jnp.zeros_like(energy), energy])
    start = jnp.clip(count - whole, 1, count)
    first = jax.lax.dynamic_slice_in_dim(padded, start, count)
    second = jax.lax.dynamic_slice_in_dim(padded, start - 1, count)
    return (1 - rest) * first + rest * second
