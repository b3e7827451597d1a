"""Random keys: typed and raw uint32 ones are both taken, and raw ones are kept in the state."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, UInt32

SOUND, RENEW = 1, 2  # tags of `fold`


def to_raw(key: Array) -> UInt32[Array, "2"]:
    """The two words of a threefry key, from any kind of key.

    Brax's wrappers need raw keys in the state, see its `EpisodeWrapper`.
    """
    if not jnp.issubdtype(key.dtype, jax.dtypes.prng_key):
        return key.astype(jnp.uint32)
    data = jax.random.key_data(key)
    return data if data.shape[-1] == 2 else jax.random.bits(key, (2,), jnp.uint32)


def split(raw: UInt32[Array, "2"], num: int) -> tuple[Array, ...]:
    """`num` typed threefry keys, whatever JAX's default generator is."""
    return tuple(jax.random.split(jax.random.wrap_key_data(raw, impl="threefry2x32"), num))


def fold(raw: UInt32[Array, "2"], tag: int) -> Array:
    """A typed key of its own for each `tag`, independent of every `split` of the same key."""
    return jax.random.fold_in(jax.random.wrap_key_data(raw, impl="threefry2x32"), tag)
