"""Start positions of agents and sound in a house."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank


def spread_starts(
    bank: HouseBank, house: Int[Array, ""], num: int, apart: float, key: Array
) -> tuple[Int[Array, " a"], Float[Array, "a 3"]]:
    """Random start points of a house, each at least `apart` metres from the ones before where the house allows it."""
    points = bank.navigation.start[house]
    gumbel = jax.random.gumbel(key, (num, points.shape[0]))
    clearance = jnp.full(points.shape[:1], jnp.inf, jnp.float32)
    chosen = []
    for a in range(num):
        # Points too near an earlier agent lose to all others, but a full house still gives an answer.
        index = jnp.argmax(jnp.where(clearance < jnp.float32(apart), gumbel[a] - 1e6, gumbel[a])).astype(jnp.int32)
        chosen.append(index)
        clearance = jnp.minimum(clearance, jnp.linalg.norm(points - points[index][None], axis=-1))
    indices = jnp.stack(chosen)
    return indices, points[indices]


def random_source(bank: HouseBank, house: Int[Array, ""], height: float, key: Array) -> Float[Array, "3"]:
    """A random free point of a house, `height` metres above its floor."""
    points = bank.navigation.start[house]
    index = jax.random.randint(key, (), 0, points.shape[0])
    return points[index].at[2].add(jnp.float32(height))


def random_yaw(key: Array, shape: tuple[int, ...] = ()) -> Float[Array, "*n"]:
    """Headings, every one as likely as any other [rad]."""
    return jax.random.uniform(key, shape, jnp.float32, -jnp.pi, jnp.pi)
