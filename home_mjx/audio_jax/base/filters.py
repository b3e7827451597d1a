"""Octave filters as gains over frequency; host side, so that compiled steps hold them as constants."""

import functools

import numpy as np
from jaxtyping import Complex, Float

from home_mjx.schema.compiled import BANDS

TRANSITION = 0.25  # [octaves], width of the overlap of neighbouring bands
HIGH_PASS = 20.0  # [Hz], half-power point
RINGING = 0.030  # [s], for which causal filters may ring: it resolves octaves from 125 Hz on
CAUSAL_SECONDS = 0.048  # in which all but 1e-9 of their energy comes
FINE = 1 << 15  # samples of the grid on which cepstra are computed


def octave_gains(frequency: Float[np.ndarray, " f"]) -> Float[np.ndarray, "bands f"]:
    """Gains of the octave bands 125 .. 8000 Hz that add up to one at every frequency.

    The first band reaches down to 0 Hz, the last up without end. Bands meet at fc sqrt(2) in sin² ramps, as in Antoni,
    Orthogonal-like fractional-octave-band filters, JASA 127 (2010). The gains are for amplitudes of deterministic
    paths; their square roots add up to one in energy, which noise needs.

    Args:
        frequency: [Hz].

    Returns:
        Gain of each band.

    Example:
        >>> octave_gains(np.array([500.0, 500.0 * 2**0.5]))[2].round(6).tolist()
        [1.0, 0.5]
    """
    octaves = np.log2(np.maximum(frequency, 1e-9) / BANDS[0])
    edges = np.arange(1, len(BANDS)) - 0.5
    ramp = np.clip((octaves[None] - edges[:, None]) / TRANSITION + 0.5, 0, 1)
    above = np.sin(np.pi / 2 * ramp) ** 2
    ones = np.ones((1, frequency.size))
    return np.concatenate([ones, above]) - np.concatenate([above, 0 * ones])


def high_pass(frequency: Float[np.ndarray, " f"]) -> Float[np.ndarray, " f"]:
    """Amplitude of a zero-phase high-pass of second order, for noise, whose first band would reach down to 0 Hz."""
    square = frequency**2
    return square / (square + (np.sqrt(2) - 1) * HIGH_PASS**2)


@functools.cache
def causal_octaves(size: int, sample_rate: int) -> Complex[np.ndarray, "bands f"]:
    """Logarithms of the spectra of causal octave filters: exp(log(gain) @ these) has the given gain in each octave.

    The level runs from octave to octave as `octave_gains` does, in decibels; the phase is the least that goes with it
    (minimum phase), so nothing comes before the pulse. From the cepstrum, whose negative half is folded upon its
    positive one, as in Oppenheim and Schafer, Discrete-Time Signal Processing, 13.5, and which ends softly after
    `RINGING`. As cepstra of products add up, one product with this table serves any gains.

    Args:
        size: Samples of the transform that will use it, at least `RINGING`.
        sample_rate: [Hz].

    Example:
        >>> flat = np.exp(np.log(np.full(7, 0.5)) @ causal_octaves(1024, 16000))
        >>> bool(np.allclose(flat, 0.5))
        True
    """
    cepstrum = np.fft.irfft(octave_gains(np.fft.rfftfreq(FINE, 1 / sample_rate)), FINE)
    kept = round(RINGING * sample_rate)
    fade = np.cos(np.pi / 2 * np.arange(kept) / kept) ** 2
    return np.fft.rfft(cepstrum[:, :kept] * np.where(np.arange(kept) > 0, 2 * fade, 1), size)
