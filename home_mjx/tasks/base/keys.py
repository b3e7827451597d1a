"""Random keys: typed and raw uint32 keys are accepted, and raw ones are kept in the state."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, UInt32

from home_mjx.errors import ConfigError

SOUND_TAG, RENEW_TAG, DOORS_TAG, ARRANGEMENT_TAG, VARIATION_TAG = 1, 2, 3, 4, 5  # tags of `fold_key`, one per use


def to_raw_key(key: Array) -> UInt32[Array, "2"]:
    """Return the two words of a threefry key, from any kind of key.

    Brax's wrappers need raw keys in the state, see its `EpisodeWrapper`.

    Raises:
        ConfigError: Not a key, or several keys.
    """
    if not hasattr(key, "dtype"):
        raise ConfigError(f"expected a random key, got {key!r}", hint="Write jax.random.key(0).")
    if not jnp.issubdtype(key.dtype, jax.dtypes.prng_key):
        if key.shape != (2,) or not jnp.issubdtype(key.dtype, jnp.integer):
            hint = "One environment takes one key; for many, use `jax.vmap` over jax.random.split(key, n)."
            raise ConfigError(f"expected one random key, got {key.dtype} of shape {key.shape}", hint=hint)
        return key.astype(jnp.uint32)
    if key.shape:
        hint = "One environment takes one key; for many, use `jax.vmap`."
        raise ConfigError(f"expected one random key, got {key.shape}", hint=hint)
    data = jax.random.key_data(key)
    return data if data.shape[-1] == 2 else jax.random.bits(key, (2,), jnp.uint32)


def split_key(raw: UInt32[Array, "2"], num: int) -> tuple[Array, ...]:
    """Return `num` typed threefry keys, independent of JAX's default generator."""
    return tuple(jax.random.split(jax.random.wrap_key_data(raw, impl="threefry2x32"), num))


def fold_key(raw: UInt32[Array, "2"], tag: int) -> Array:
    """Return a typed key for `tag`, independent of other tags and of every `split_key` of the same key."""
    return jax.random.fold_in(jax.random.wrap_key_data(raw, impl="threefry2x32"), tag)
