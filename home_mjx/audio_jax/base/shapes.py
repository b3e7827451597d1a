"""Filters that paths share: weighted sums of a few causal ones stand for octave gains, and for ears.

The spectrum of a causal filter follows from its real part. So a filter whose real part runs straight between its values
at some frequencies is the sum of one fixed causal filter per frequency, each weighted with that value. As sums of
sounds may be filtered instead of each sound, any number of paths takes no more transforms than there are frequencies.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.base.delays import HALF_WIDTH, windowed_sinc
from home_mjx.audio_jax.base.filters import causal_octaves, octave_gains
from home_mjx.schema.compiled import BANDS

LOW, STEP = 1100.0, 540.0  # [Hz]: up to the one there are two frequencies per octave, beyond it one per so many
RINGING = 0.032  # [s], for which filters ring: it resolves octaves from 125 Hz on
FINER = 4  # times the sample rate, at which they are made
FINE = 1 << 16  # samples for that
QUIETEST = 1e-3  # gain of an octave re the loudest of a path, below which it is taken as this
SOFTEST = 1e-30  # gain of a path below which it is silent
ROUNDS = 2  # in which octaves are brought to their gains


class Shapes(NamedTuple):
    """Fixed filters, one per frequency between which a real part runs straight."""

    frequency: Float[np.ndarray, " s"]  # [Hz]
    kernel: Float[np.ndarray, "s t"]  # from HALF_WIDTH samples before time 0 on, limited in band
    value: Complex[np.ndarray, "s s"]  # of filter i at frequency j, before it is limited
    octaves: Complex[np.ndarray, "bands s"]  # logarithm of the least-phase filter of each octave at these frequencies
    centers: Complex[np.ndarray, "s c"]  # of filters at the centres of the octaves that are told apart


def num_taps(sample_rate: int) -> int:
    """Samples of a shape's kernel after time 0."""
    return round(RINGING * sample_rate)


@functools.cache
def shapes(sample_rate: int) -> Shapes:
    """The filters of a sample rate.

    Args:
        sample_rate: [Hz].

    Example:
        >>> s = shapes(16000)
        >>> s.kernel.shape, bool(abs(s.kernel.sum(axis=0)[HALF_WIDTH] - 1) < 0.02)  # together they change nothing
        ((20, 544), True)
    """
    low = BANDS[0] * 2 ** (np.arange(2 * np.log2(LOW / BANDS[0])) / 2)
    low = low[low < sample_rate / 2]
    count = round((sample_rate / 2 - low[-1]) / STEP)
    frequency = np.concatenate([low, np.linspace(low[-1], sample_rate / 2, count + 1)[1:]])
    fine = np.fft.rfftfreq(FINE, 1 / (FINER * sample_rate))
    place = np.interp(np.log2(np.maximum(fine, 1)), np.log2(frequency), np.arange(frequency.size))
    hats = np.clip(1 - np.abs(place[None] - np.arange(frequency.size)[:, None]), 0, 1)
    kernel = _causal(hats, sample_rate)
    centers = np.array([band for band in BANDS if band < 0.45 * sample_rate])
    return Shapes(
        frequency=frequency,
        kernel=_limited(kernel, sample_rate).astype(np.float32),
        value=_at(kernel, frequency, sample_rate),
        octaves=_at(_causal(octave_gains(fine), sample_rate), frequency, sample_rate),
        centers=_at(kernel, centers, sample_rate),
    )


def octave_shapes(gain: Float[Array, "*p bands"], sample_rate: int) -> Complex[Array, "*p s"]:
    """Causal filters with the given gain at the centre of each octave: their values at the frequencies of `shapes`.

    The level runs from octave to octave in decibels; the phase is the least that goes with it, so nothing comes before
    the pulse: from the cepstrum, whose negative half is folded upon its positive one, as in Oppenheim and Schafer,
    Discrete-Time Signal Processing, 13.5. Real parts are the weights of `shapes`.

    Args:
        gain: 0 and more.
        sample_rate: [Hz].

    Example:
        >>> octave_shapes(jnp.full((1, 7), 0.5), 16000).real.round(3)[0, :3].tolist()
        [0.5, 0.5, 0.5]
    """
    table = shapes(sample_rate)
    loudest = jnp.max(gain, axis=-1, keepdims=True)
    wanted = jnp.log(jnp.maximum(gain, jnp.maximum(QUIETEST * loudest, SOFTEST)))
    level, told = wanted, table.centers.shape[1]
    for _ in range(ROUNDS):
        here = jnp.abs(_product(jnp.real(_filter(level, table)), table.centers))
        more = wanted[..., :told] - jnp.log(jnp.maximum(here, SOFTEST))
        level = level.at[..., :told].add(jnp.clip(more, -1.0, 1.0))
    return jnp.where(loudest > SOFTEST, _filter(level, table), 0)


def _filter(level: Float[Array, "*p bands"], table: Shapes) -> Complex[Array, "*p s"]:
    both = _product(level, table.octaves)
    amplitude, phase = jnp.exp(jnp.real(both)), jnp.imag(both)
    return jax.lax.complex(amplitude * jnp.cos(phase), amplitude * jnp.sin(phase))


def _product(left: Float[Array, "*p n"], right: Complex[np.ndarray, "n m"]) -> Complex[Array, "*p m"]:
    """Of a real and a complex matrix."""
    parts = [jnp.asarray(x, jnp.float32) for x in (np.real(right), np.imag(right))]
    return jax.lax.complex(*(jnp.matmul(left, x, precision="highest") for x in parts))


def _causal(real: Float[np.ndarray, "n f"], sample_rate: int) -> Float[np.ndarray, "n t"]:
    """Causal kernels with these real parts at `FINER` times the rate, which end softly."""
    kept = FINER * num_taps(sample_rate)
    fade = np.cos(np.pi / 2 * np.arange(kept) / kept) ** 2
    return np.fft.irfft(real, FINE)[:, :kept] * np.where(np.arange(kept) > 0, 2 * fade, 1)


def _limited(kernel: Float[np.ndarray, "n u"], sample_rate: int) -> Float[np.ndarray, "n t"]:
    """The same at the sample rate, by a filter that looks ahead by `HALF_WIDTH` samples."""
    place = np.minimum(np.arange(FINE), FINE - np.arange(FINE)) / FINER
    low_pass = np.fft.rfft(windowed_sinc(np.minimum(place, HALF_WIDTH)))
    whole = np.fft.irfft(np.fft.rfft(kernel, FINE) * low_pass, FINE)
    return whole[:, FINER * np.arange(-HALF_WIDTH, num_taps(sample_rate) + HALF_WIDTH) % FINE]


def _at(
    kernel: Float[np.ndarray, "n u"], frequency: Float[np.ndarray, " m"], sample_rate: int
) -> Complex[np.ndarray, "n m"]:
    """Spectra of kernels at `FINER` times the rate."""
    time = np.arange(kernel.shape[1]) / (FINER * sample_rate)
    return kernel @ np.exp(-2j * np.pi * time[:, None] * frequency[None])


def octave_levels(gain: Float[Array, "p bands"]) -> tuple[Float[Array, "p bands"], Float[Array, " p"]]:
    """Logarithms of gains per octave, none far below the loudest; and 1 where something sounds, else 0."""
    loudest = jnp.max(gain, axis=1, keepdims=True)
    level = jnp.log(jnp.maximum(gain, jnp.maximum(QUIETEST * loudest, SOFTEST)))
    return level, (loudest[:, 0] > SOFTEST).astype(jnp.float32)


def octave_spectra(gain: Float[Array, "p bands"], size: int, sample_rate: int) -> Complex[Array, "p f"]:
    """Causal filters with these gains per octave, at the frequencies of a transform of `size` samples."""
    level, sounds = octave_levels(gain)
    table = causal_octaves(size, sample_rate)
    real, phase = (
        jnp.matmul(level, jnp.asarray(t, jnp.float32), precision="highest") for t in (np.real(table), np.imag(table))
    )
    amplitude = jnp.where(sounds[:, None] > 0, jnp.exp(real), 0.0)
    return jax.lax.complex(amplitude * jnp.cos(phase), amplitude * jnp.sin(phase))
