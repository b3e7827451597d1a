"""Delays by fractions of a sample: read from a signal at twice its rate by short polynomials."""

import functools

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

HALF_WIDTH = 16  # [samples]: no kernel rings for longer before its middle; 1 ms at 16 kHz
SHAPE = 6.0  # of the Kaiser window: flat within 0.01 dB up to 0.44 of the sample rate
READ = 8  # half samples that are read for one value
FIRST = -3  # the first of them, from the one before the value
DEGREE = 5  # of the polynomials: up to 0.44 of the sample rate they err by less than -70 dB
WIDTH = 2 * HALF_WIDTH + READ  # of a kernel [samples]


def windowed_sinc(offset: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Band-limited pulse at times from its middle [samples]: sinc in a Kaiser window.

    Kaiser, Nonrecursive digital filter design using the I0-sinh window function, 1974.

    Example:
        >>> windowed_sinc(np.array([0.0, 0.5])).round(3).tolist()
        [1.0, 0.635]
    """
    inside = np.maximum(1 - (offset / HALF_WIDTH) ** 2, 0.0)
    return np.sinc(offset) * np.where(inside > 0, np.i0(SHAPE * np.sqrt(inside)) / np.i0(SHAPE), 0.0)


def at_twice_the_rate(signal: Float[Array, " n"]) -> Float[Array, " m"]:
    """A signal with `windowed_sinc` between each two of its samples; silence before and after it.

    Example:
        >>> [round(float(x), 3) for x in at_twice_the_rate(jnp.array([1.0, 0.0]))[:2]]
        [1.0, 0.635]
    """
    taps = windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5).astype(np.float32)
    count = signal.shape[0]
    padded = jnp.pad(signal, (HALF_WIDTH - 1, HALF_WIDTH))
    between = jnp.zeros_like(signal)
    for i, tap in enumerate(taps):
        between = between + tap * padded[i : i + count]
    return jnp.stack([signal, between], axis=1).reshape(-1)


def read_weights(rest: Float[Array, "*n"]) -> list[Float[Array, "*n"]]:
    """Weights of half samples `FIRST`, `FIRST` + 1, ... for the value so many half samples after number 0.

    Args:
        rest: 0 .. 1.

    Example:
        >>> round(float(sum(read_weights(jnp.float32(0.3)))), 2)
        1.0
    """
    weights = []
    for row in read_polynomials():
        weight = jnp.full_like(rest, row[-1])
        for coefficient in row[-2::-1]:
            weight = weight * rest + jnp.float32(coefficient)
        weights.append(weight)
    return weights


def delay_kernel(delay: Float[Array, "*n"]) -> Float[Array, "*n k"]:
    """What reading a pulse with a delay of 0 .. 1 samples gives, from `HALF_WIDTH` + 3 samples before it on.

    Example:
        >>> int(delay_kernel(jnp.array([0.0]))[0].argmax()) == HALF_WIDTH + 3
        True
    """
    back = jnp.floor(-2 * delay)
    rows = jnp.asarray(_pulses())[-back.astype(jnp.int32)]
    weights = jnp.stack(read_weights(-2 * delay - back), axis=-1)
    return jnp.sum(weights[..., None] * rows, axis=-2)


@functools.cache
def _pulses() -> Float[np.ndarray, "three read k"]:
    """What each half sample that is read has of a pulse, by how many half samples before the sample itself."""
    sample = np.arange(WIDTH) - HALF_WIDTH - 3
    at = 2 * sample[None, None] - np.arange(3)[:, None, None] + (FIRST + np.arange(READ))[None, :, None]
    return windowed_sinc(at / 2).astype(np.float32)


@functools.cache
def read_polynomials() -> Float[np.ndarray, "read degree"]:
    """Of `read_weights`, lowest power first: the least squares over all frequencies up to 0.45 of the sample rate."""
    rest = (np.arange(32) + 0.5) / 32
    angle = np.pi * 0.45 * np.concatenate([(np.arange(64) + 0.5) / 64, 1 - np.geomspace(1e-3, 0.1, 16)])
    power = rest[:, None] ** np.arange(DEGREE + 1)
    wave = np.exp(1j * angle[:, None] * (FIRST + np.arange(READ)))
    rows = np.einsum("am,rd->armd", wave, power).reshape(angle.size * rest.size, -1)
    wanted = np.exp(1j * angle[:, None] * rest).ravel()
    joined = (np.concatenate([np.real(x), np.imag(x)]) for x in (rows, wanted))
    return np.linalg.lstsq(*joined, rcond=None)[0].reshape(READ, DEGREE + 1).astype(np.float32)
