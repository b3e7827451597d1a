"""Delays by fractions of a sample."""

import functools

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

HALF_WIDTH = 16  # [samples]: no kernel rings for longer before its middle; 1 ms at 16 kHz
SHAPE = 6.0  # of the Kaiser window: flat within 0.01 dB up to 0.44 of the sample rate
PHASES = 256  # per sample, between which kernels are interpolated: within 2e-5
WIDTH = 2 * HALF_WIDTH + 1  # of a kernel [samples]


def windowed_sinc(offset: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Band-limited pulse at times from its middle [samples]: sinc in a Kaiser window.

    Kaiser, Nonrecursive digital filter design using the I0-sinh window function, 1974.

    Example:
        >>> windowed_sinc(np.array([0.0, 0.5])).round(3).tolist()
        [1.0, 0.635]
    """
    inside = np.maximum(1 - (offset / HALF_WIDTH) ** 2, 0.0)
    return np.sinc(offset) * np.where(inside > 0, np.i0(SHAPE * np.sqrt(inside)) / np.i0(SHAPE), 0.0)


def delay_kernel(delay: Float[Array, "*n"]) -> Float[Array, "*n k"]:
    """`windowed_sinc` at -HALF_WIDTH + 1 .. HALF_WIDTH + 1 samples less a delay of 0 .. 2 samples, between two phases.

    Example:
        >>> int(delay_kernel(jnp.array([1.0]))[0].argmax()) == HALF_WIDTH
        True
    """
    position = delay * PHASES
    low = jnp.clip(jnp.floor(position), 0, 2 * PHASES - 1)
    rest = (position - low)[..., None]
    table, step = (jnp.asarray(t) for t in _kernels())
    index = low.astype(jnp.int32)
    return table[index] + rest * step[index]


@functools.cache
def _kernels() -> tuple[Float[np.ndarray, "phases k"], Float[np.ndarray, "phases k"]]:
    """Kernels, and what leads to the next ones."""
    delay = np.arange(2 * PHASES + 1) / PHASES
    table = windowed_sinc(np.arange(WIDTH)[None] - HALF_WIDTH + 1 - delay[:, None])
    return table[:-1].astype(np.float32), np.diff(table, axis=0).astype(np.float32)
