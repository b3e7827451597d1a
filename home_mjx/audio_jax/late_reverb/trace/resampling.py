"""Resampling of rays among rooms: more rays, with less energy each, in rooms with little energy."""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.schema.compiled import BANDS

SEARCH_METHOD = {"gpu": "scan_unrolled"}  # one kernel instead of several per bisection; slower on CPUs
EVENNESS = 0.7  # 0: rays in proportion to a room's energy; 1: equal numbers of rays in all rooms


def resample_rays(
    energy: Float[Array, " n"], room: Int[Array, " n"], octave: Int[Array, " n"], rooms: int, key: Array
) -> tuple[Int[Array, " n"], Float[Array, " n"]]:
    """Resample rays; return the index of the ray that each new ray continues, and its energy.

    Rays split in rooms with little energy and end where many others carry energy. In each octave, a room with the share
    E of all energy gets a share of rays in proportion to E^(1 - `EVENNESS`). All its rays have equal energy. Systematic
    sampling keeps the expected energy of every ray (Kitagawa 1996).

    Args:
        energy: Energy of each ray; octave after octave, with equal numbers per octave.
        room: Room of each ray.
        octave: Octave of each ray.
        rooms: Number of rooms.
        key: Random key.

    Example:
        >>> octave = jnp.repeat(jnp.arange(7), 100)
        >>> room = (jnp.arange(700) % 100 == 0).astype(jnp.int32)  # one ray of a hundred is in the second room
        >>> pick, energy = resample_rays(jnp.ones(700), room, octave, 2, jax.random.key(0))
        >>> int(room[pick].sum()) // 7, round(float(jnp.where(room[pick] == 1, energy, 0).sum()))
        (20, 7)
    """
    count = energy.size // len(BANDS)
    held = jnp.zeros((len(BANDS), rooms), jnp.float32).at[octave, room].add(energy)
    weight = energy / jnp.maximum(held[octave, room], 1e-30) ** EVENNESS
    parts = jnp.cumsum(weight.reshape(len(BANDS), count), axis=1)
    total = parts[:, -1:]
    place = (jnp.arange(count, dtype=jnp.float32) + jax.random.uniform(key, (len(BANDS), 1), jnp.float32)) / count
    search = partial(jnp.searchsorted, side="right", method=SEARCH_METHOD.get(jax.default_backend(), "scan"))
    pick = jax.vmap(search)(parts, place * total)
    pick = jnp.minimum(pick, count - 1).astype(jnp.int32) + count * jnp.arange(len(BANDS), dtype=jnp.int32)[:, None]
    pick = pick.reshape(-1)
    mean = jnp.repeat(total[:, 0] / count, count)
    return pick, jnp.where(weight[pick] > 0, mean * energy[pick] / jnp.maximum(weight[pick], 1e-30), 0.0)
