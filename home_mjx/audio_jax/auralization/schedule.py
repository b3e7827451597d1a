"""When sources sound."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

RAMP_SECONDS = 0.005  # sounds begin and end without a click
NEVER = 2**30  # [samples]: 18 hours at 16 kHz


def loudness(
    time: Int[Array, " n"], every: Float[Array, ""], lasts: Float[Array, ""], sample_rate: int
) -> Float[Array, " n"]:
    """How much of a clip a source gives off at some times: 0 nothing, 1 all.

    Args:
        time: Samples since the start; negative before it.
        every: See `Sounds` [s].
        lasts: See `Sounds` [s].
        sample_rate: [Hz].

    Example:
        >>> loudness(jnp.array([500, 8500, 12000]), jnp.float32(1.0), jnp.float32(0.6), 16000).tolist()
        [1.0, 1.0, 0.0]
    """
    rate = jnp.float32(sample_rate)
    period, on = (jnp.where(x * rate < NEVER, jnp.round(x * rate), NEVER).astype(jnp.int32) for x in (every, lasts))
    at = jnp.where(period < NEVER, time % jnp.maximum(period, 1), time)
    edge = jnp.minimum(at + 1, on - at).astype(jnp.float32) / jnp.float32(RAMP_SECONDS * sample_rate)
    return jnp.where(lasts >= jnp.minimum(every, NEVER / rate), 1.0, jnp.clip(edge, 0.0, 1.0))
