"""Octave filters as gains over frequency, computed in NumPy so that compiled steps embed them as constants."""

import functools

import numpy as np
from jaxtyping import Complex, Float

from home_mjx.schema.compiled import BANDS

BAND_OVERLAP = 0.25  # [octaves], width of the overlap of neighbouring bands
HIGH_PASS_FREQUENCY = 20.0  # [Hz], half-power point
CEPSTRUM_SECONDS = 0.030  # [s], length of the cepstra of causal filters: resolves octaves from 125 Hz on
MAX_RINGING_SECONDS = 0.048  # [s], contains all but 1e-9 of the energy of causal filters
FINE_SIZE = 1 << 15  # samples of the transform for cepstra


def octave_gains(frequency: Float[np.ndarray, " f"]) -> Float[np.ndarray, "bands f"]:
    """Compute gains of the octave bands 125 .. 8000 Hz, at frequencies [Hz]; they sum to one at each.

    The first band extends down to 0 Hz, the last one upwards without limit. Bands meet at fc sqrt(2) in sin² ramps over
    a quarter octave, as in Antoni, Orthogonal-like fractional-octave-band filters, JASA 127 (2010). The gains apply to
    amplitudes of deterministic paths; the squares of their square roots sum to one, as noise requires.

    Example:
        >>> octave_gains(np.array([500.0, 500.0 * 2**0.5]))[2].round(6).tolist()
        [1.0, 0.5]
    """
    octaves = np.log2(np.maximum(frequency, 1e-9) / BANDS[0])
    edges = np.arange(1, len(BANDS)) - 0.5
    ramp = np.clip((octaves[None] - edges[:, None]) / BAND_OVERLAP + 0.5, 0, 1)
    above = np.sin(np.pi / 2 * ramp) ** 2
    ones = np.ones((1, frequency.size))
    return np.concatenate([ones, above]) - np.concatenate([above, 0 * ones])


def high_pass(frequency: Float[np.ndarray, " f"]) -> Float[np.ndarray, " f"]:
    """Return the amplitude gain at frequencies [Hz] of a zero-phase second-order high-pass with half power at 20 Hz."""
    square = frequency**2
    return square / (square + (np.sqrt(2) - 1) * HIGH_PASS_FREQUENCY**2)


@functools.cache
def causal_octave_log_spectra(size: int, sample_rate: int) -> Complex[np.ndarray, "bands f"]:
    """Compute a table such that exp(log(gain) @ table) is the `rfft` of a filter with amplitude gains per octave.

    Levels in dB are interpolated between octaves by `octave_gains`. The filter has minimum phase, by folding the
    cepstrum, as in Oppenheim and Schafer, Discrete-Time Signal Processing, 13.5; the cepstrum fades out within
    `CEPSTRUM_SECONDS`. Cepstra of products add, so one product with this table serves any gains.

    Args:
        size: Samples of the transform that will use it, at least `CEPSTRUM_SECONDS`.
        sample_rate: [Hz].

    Example:
        >>> flat = np.exp(np.log(np.full(7, 0.5)) @ causal_octave_log_spectra(1024, 16000))
        >>> bool(np.allclose(flat, 0.5))
        True
    """
    gains = octave_gains(np.fft.rfftfreq(FINE_SIZE, 1 / sample_rate))
    return np.fft.rfft(causal_responses(gains, FINE_SIZE, round(CEPSTRUM_SECONDS * sample_rate)), size)


def causal_responses(real: Float[np.ndarray, "n f"], size: int, kept: int) -> Float[np.ndarray, "n kept"]:
    """Compute causal responses of `kept` samples from real parts of `rfft` spectra of `size`.

    Negative times fold onto positive ones: samples after time 0 are doubled. They fade out as cos² within `kept`
    samples.
    """
    fade = np.cos(np.pi / 2 * np.arange(kept) / kept) ** 2
    return np.fft.irfft(real, size)[:, :kept] * np.where(np.arange(kept) > 0, 2 * fade, 1)
