"""Fractional delays: polynomial interpolation of a signal at twice its sample rate (Farrow structure)."""

import functools

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

HALF_WIDTH = 16  # [samples], half width of band-limiting kernels: 1 ms at 16 kHz
KAISER_BETA = 6.0  # beta of the Kaiser window: flat within 0.01 dB up to 0.44 of the sample rate
NUM_READ = 8  # half samples interpolated for one value
FIRST_READ = -3  # index of the first of them re the half sample before the value
POLYNOMIAL_DEGREE = 5  # of the interpolation polynomials: error below -70 dB up to 0.44 of the sample rate
KERNEL_WIDTH = 2 * HALF_WIDTH + NUM_READ  # [samples], of a delay kernel


def windowed_sinc(offset: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Evaluate a Kaiser-windowed sinc pulse at offsets from its centre [samples]; 0 from `HALF_WIDTH` on.

    Kaiser, Nonrecursive digital filter design using the I0-sinh window function, 1974.

    Example:
        >>> windowed_sinc(np.array([0.0, 0.5])).round(3).tolist()
        [1.0, 0.635]
    """
    inside = np.maximum(1 - (offset / HALF_WIDTH) ** 2, 0.0)
    return np.sinc(offset) * np.where(inside > 0, np.i0(KAISER_BETA * np.sqrt(inside)) / np.i0(KAISER_BETA), 0.0)


def upsample_twice(signal: Float[Array, " n"]) -> Float[Array, " m"]:
    """Upsample by two with `windowed_sinc` (m = 2 n): even samples are the input, odd ones follow half a sample later.

    The input counts as 0 outside its samples.

    Example:
        >>> [round(float(x), 3) for x in upsample_twice(jnp.array([1.0, 0.0]))[:2]]
        [1.0, 0.635]
    """
    taps = windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5).astype(np.float32)
    count = signal.shape[0]
    padded = jnp.pad(signal, (HALF_WIDTH - 1, HALF_WIDTH))
    between = jnp.zeros_like(signal)
    for i, tap in enumerate(taps):
        between = between + tap * padded[i : i + count]
    return jnp.stack([signal, between], axis=1).reshape(-1)


def interpolation_weights(rest: Float[Array, "*n"]) -> list[Float[Array, "*n"]]:
    """Compute the weights of half samples `FIRST_READ`, `FIRST_READ` + 1, ... that interpolate at position `rest`.

    Half samples are those of a signal upsampled by two. Weights are values of `interpolation_polynomials`.

    Args:
        rest: Position from half sample 0 (0) to half sample 1 (1); not clipped.

    Returns:
        `NUM_READ` weights, each of the shape of `rest`.

    Example:
        >>> round(float(sum(interpolation_weights(jnp.float32(0.3)))), 2)
        1.0
    """
    weights = []
    for row in interpolation_polynomials():
        weight = jnp.full_like(rest, row[-1])
        for coefficient in row[-2::-1]:
            weight = weight * rest + jnp.float32(coefficient)
        weights.append(weight)
    return weights


def delay_kernel(delay: Float[Array, "*n"]) -> Float[Array, "*n k"]:
    """Return the impulse response of a delay of 0 .. 1 samples, `KERNEL_WIDTH` taps from sample -(`HALF_WIDTH` + 3) on.

    Example:
        >>> int(delay_kernel(jnp.array([0.0]))[0].argmax()) == HALF_WIDTH + 3
        True
    """
    back = jnp.floor(-2 * delay)
    rows = jnp.asarray(_pulses())[-back.astype(jnp.int32)]
    weights = jnp.stack(interpolation_weights(-2 * delay - back), axis=-1)
    return jnp.sum(weights[..., None] * rows, axis=-2)


@functools.cache
def _pulses() -> Float[np.ndarray, "three read k"]:
    """Return `windowed_sinc` taps, as of `delay_kernel`, of each half sample read 0, 1 or 2 half samples earlier."""
    sample = np.arange(KERNEL_WIDTH) - HALF_WIDTH - 3
    at = 2 * sample[None, None] - np.arange(3)[:, None, None] + (FIRST_READ + np.arange(NUM_READ))[None, :, None]
    return windowed_sinc(at / 2).astype(np.float32)


@functools.cache
def interpolation_polynomials() -> Float[np.ndarray, "read degree"]:
    """Fit the polynomials of `interpolation_weights`, lowest power first, to tones up to 0.45 of the sample rate.

    They minimise the squared error of a complex tone, interpolated from half samples, over `rest` from 0 to 1. They are
    rounded to nine decimals, which makes them the same bits whichever library solves the least squares.
    """
    rest = (np.arange(32) + 0.5) / 32
    angle = np.pi * 0.45 * np.concatenate([(np.arange(64) + 0.5) / 64, 1 - np.geomspace(1e-3, 0.1, 16)])
    power = rest[:, None] ** np.arange(POLYNOMIAL_DEGREE + 1)
    wave = np.exp(1j * angle[:, None] * (FIRST_READ + np.arange(NUM_READ)))
    rows = np.einsum("am,rd->armd", wave, power).reshape(angle.size * rest.size, -1)
    wanted = np.exp(1j * angle[:, None] * rest).ravel()
    joined = (np.concatenate([np.real(x), np.imag(x)]) for x in (rows, wanted))
    fitted = np.linalg.lstsq(*joined, rcond=None)[0].reshape(NUM_READ, POLYNOMIAL_DEGREE + 1)
    return np.round(fitted, 9).astype(np.float32)
