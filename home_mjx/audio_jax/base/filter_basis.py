"""Basis of causal filters shared by all paths; weighted sums of it approximate octave gains and ear filters.

The spectrum of a causal filter follows from its real part. A filter with a piecewise linear real part is therefore a
sum of fixed causal filters, one per knot frequency, weighted with the real part there. Paths are mixed with these
weights before filtering, so the number of transforms is the number of knots, whatever the number of paths.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.base.delays import HALF_WIDTH, windowed_sinc
from home_mjx.audio_jax.base.filters import causal_octave_log_spectra, causal_responses, octave_gains
from home_mjx.schema.compiled import BANDS

DENSE_KNOT_LIMIT, KNOT_STEP = 1100.0, 540.0  # [Hz], knots: two per octave up to the limit, then one every step
BASIS_SECONDS = 0.032  # [s], length of basis filters: resolves octaves from 125 Hz on
OVERSAMPLING = 4  # oversampling factor at which the basis is computed
FINE_SIZE = 1 << 16  # samples of the transform for that
MIN_RELATIVE_GAIN = 1e-3  # minimum octave gain re the loudest octave of a path; lower gains are raised to it
MIN_GAIN = 1e-30  # gain at or below which a path is silent
NUM_CORRECTIONS = 2  # iterations that correct filters to the required octave gains


class FilterBasis(NamedTuple):
    """Basis filters, one per knot frequency; their real parts are hat functions over the knots."""

    frequency: Float[np.ndarray, " s"]  # [Hz], knots
    kernel: Float[np.ndarray, "s t"]  # band-limited impulse responses from HALF_WIDTH samples before time 0 on
    value: Complex[np.ndarray, "s s"]  # of filter i at knot j, before band limiting
    octaves: Complex[np.ndarray, "bands s"]  # log spectrum of each octave's minimum-phase filter at the knots
    centers: Complex[np.ndarray, "s c"]  # of filters at the octave centres below 0.45 of the sample rate


def num_basis_taps(sample_rate: int) -> int:
    """Return the samples of a basis filter from time 0 on; `FilterBasis.kernel` has 2 `HALF_WIDTH` more."""
    return round(BASIS_SECONDS * sample_rate)


@functools.cache
def filter_basis(sample_rate: int) -> FilterBasis:
    """Compute the filter basis of a sample rate [Hz]; it is cached.

    Example:
        >>> s = filter_basis(16000)
        >>> s.kernel.shape, bool(abs(s.kernel.sum(axis=0)[HALF_WIDTH] - 1) < 0.02)  # together they are the identity
        ((20, 544), True)
    """
    low = BANDS[0] * 2 ** (np.arange(2 * np.log2(DENSE_KNOT_LIMIT / BANDS[0])) / 2)
    low = low[low < sample_rate / 2]
    count = round((sample_rate / 2 - low[-1]) / KNOT_STEP)
    frequency = np.concatenate([low, np.linspace(low[-1], sample_rate / 2, count + 1)[1:]])
    fine = np.fft.rfftfreq(FINE_SIZE, 1 / (OVERSAMPLING * sample_rate))
    place = np.interp(np.log2(np.maximum(fine, 1)), np.log2(frequency), np.arange(frequency.size))
    hats = np.clip(1 - np.abs(place[None] - np.arange(frequency.size)[:, None]), 0, 1)
    kept = OVERSAMPLING * num_basis_taps(sample_rate)
    kernel = causal_responses(hats, FINE_SIZE, kept)
    centers = np.array([band for band in BANDS if band < 0.45 * sample_rate])
    return FilterBasis(
        frequency=frequency,
        kernel=_downsample(kernel, sample_rate).astype(np.float32),
        value=_spectra_at(kernel, frequency, sample_rate),
        octaves=_spectra_at(causal_responses(octave_gains(fine), FINE_SIZE, kept), frequency, sample_rate),
        centers=_spectra_at(kernel, centers, sample_rate),
    )


def octave_filters_at_knots(gain: Float[Array, "*p bands"], sample_rate: int) -> Complex[Array, "*p s"]:
    """Compute spectra of minimum-phase filters with a pressure gain per octave, at the knots of `filter_basis`.

    Levels in dB are interpolated between octaves. The minimum phase follows from folding the cepstrum, as in Oppenheim
    and Schafer, Discrete-Time Signal Processing, 13.5. Real parts of the result are the weights of `filter_basis`.
    `NUM_CORRECTIONS` iterations correct levels until these weighted sums have the gains at the octave centres.

    Args:
        gain: At least 0; values below `MIN_RELATIVE_GAIN` re the path's loudest octave are raised to it.
        sample_rate: [Hz].

    Returns:
        Spectra at the knots; 0 for silent paths, whose gains are at most `MIN_GAIN`.

    Example:
        >>> octave_filters_at_knots(jnp.full((1, 7), 0.5), 16000).real.round(3)[0, :3].tolist()
        [0.5, 0.5, 0.5]
    """
    table = filter_basis(sample_rate)
    wanted, sounds = octave_levels(gain)
    level, num_centers = wanted, table.centers.shape[1]
    for _ in range(NUM_CORRECTIONS):
        here = jnp.abs(_matmul_complex(jnp.real(_minimum_phase_spectra(level, table.octaves)), table.centers))
        more = wanted[..., :num_centers] - jnp.log(jnp.maximum(here, MIN_GAIN))
        level = level.at[..., :num_centers].add(jnp.clip(more, -1.0, 1.0))
    return jnp.where(sounds[..., None] > 0, _minimum_phase_spectra(level, table.octaves), 0)


def _minimum_phase_spectra(
    level: Float[Array, "*p bands"], octaves: Complex[np.ndarray, "bands s"]
) -> Complex[Array, "*p s"]:
    """Return minimum-phase spectra from natural log gains per octave, and log spectra of each octave's filter."""
    both = _matmul_complex(level, octaves)
    amplitude, phase = jnp.exp(jnp.real(both)), jnp.imag(both)
    return jax.lax.complex(amplitude * jnp.cos(phase), amplitude * jnp.sin(phase))


def _matmul_complex(left: Float[Array, "*p n"], right: Complex[np.ndarray, "n m"]) -> Complex[Array, "*p m"]:
    """Multiply a real by a complex matrix, over the last axis of `left`, in float32."""
    parts = [jnp.asarray(x, jnp.float32) for x in (np.real(right), np.imag(right))]
    return jax.lax.complex(*(jnp.matmul(left, x, precision="highest") for x in parts))


def _downsample(kernel: Float[np.ndarray, "n u"], sample_rate: int) -> Float[np.ndarray, "n t"]:
    """Downsample oversampled kernels to the rate after a low-pass, with `HALF_WIDTH` samples before time 0."""
    place = np.minimum(np.arange(FINE_SIZE), FINE_SIZE - np.arange(FINE_SIZE)) / OVERSAMPLING
    low_pass = np.fft.rfft(windowed_sinc(np.minimum(place, HALF_WIDTH)))
    whole = np.fft.irfft(np.fft.rfft(kernel, FINE_SIZE) * low_pass, FINE_SIZE)
    return whole[:, OVERSAMPLING * np.arange(-HALF_WIDTH, num_basis_taps(sample_rate) + HALF_WIDTH) % FINE_SIZE]


def _spectra_at(
    kernel: Float[np.ndarray, "n u"], frequency: Float[np.ndarray, " m"], sample_rate: int
) -> Complex[np.ndarray, "n m"]:
    """Evaluate spectra at `frequency` [Hz] of impulse responses with `OVERSAMPLING` times the sample rate."""
    time = np.arange(kernel.shape[1]) / (OVERSAMPLING * sample_rate)
    return kernel @ np.exp(-2j * np.pi * time[:, None] * frequency[None])


def octave_levels(gain: Float[Array, "*p bands"]) -> tuple[Float[Array, "*p bands"], Float[Array, "*p"]]:
    """Return natural logs of gains, raised to 1e-3 of the path's largest octave, and per path 1 if audible, else 0.

    A path is audible if its largest gain exceeds `MIN_GAIN`. Gains below `MIN_GAIN` are raised to it, too.
    """
    loudest = jnp.max(gain, axis=-1, keepdims=True)
    level = jnp.log(jnp.maximum(gain, jnp.maximum(MIN_RELATIVE_GAIN * loudest, MIN_GAIN)))
    return level, (loudest[..., 0] > MIN_GAIN).astype(jnp.float32)


def octave_spectra(gain: Float[Array, "p bands"], size: int, sample_rate: int) -> Complex[Array, "p f"]:
    """Compute `rfft` spectra of minimum-phase filters with these amplitude gains, at least 0, per octave; 0 if silent.

    `size` is that of the transform [samples], so f = size // 2 + 1.
    """
    level, sounds = octave_levels(gain)
    spectra = _minimum_phase_spectra(level, causal_octave_log_spectra(size, sample_rate))
    return jnp.where(sounds[:, None] > 0, spectra, 0)
