"""Delays by fractions of a sample."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

HALF_WIDTH = 16  # [samples]: no kernel rings for longer before its middle; 1 ms at 16 kHz
SHAPE = 6.0  # of the Kaiser window: flat within 0.01 dB up to 0.44 of the sample rate


def windowed_sinc(offset: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Band-limited pulse at times from its middle [samples]: sinc in a Kaiser window.

    Kaiser, Nonrecursive digital filter design using the I0-sinh window function, 1974.

    Example:
        >>> windowed_sinc(jnp.array([0.0, 1.0, 16.0])).round(6).tolist()
        [1.0, -0.0, 0.0]
    """
    inside = jnp.maximum(1 - (offset / HALF_WIDTH) ** 2, 0.0)
    window = jnp.i0(SHAPE * jnp.sqrt(inside)) / float(np.i0(SHAPE))
    return jnp.sinc(offset) * jnp.where(inside > 0, window, 0.0)


def pulse_samples(offset: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """The same in double precision, on the host."""
    inside = np.maximum(1 - (offset / HALF_WIDTH) ** 2, 0.0)
    return np.sinc(offset) * np.where(inside > 0, np.i0(SHAPE * np.sqrt(inside)) / np.i0(SHAPE), 0.0)
