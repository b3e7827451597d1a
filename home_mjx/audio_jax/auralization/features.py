"""Features of sound frames: spectrograms, log-mel energies, and cross-correlations of both ears."""

import functools
import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.errors import ConfigError

WINDOW_SECONDS, HOP_SECONDS = 0.025, 0.010
NUM_MELS = 40
MAX_LEAD, LAGS_PER_SAMPLE = 0.001, 8  # [s] maximum lag, and lags per sample, of interaural correlations
MIN_MEL_LEVEL, MAX_MEL_LEVEL = -100.0, 100.0  # [dB], range of log-mel powers


def spectrum_shape(samples: int, sample_rate: int) -> tuple[int, int]:
    """Return the numbers of windows and of frequency bins of `stft_magnitude` for `samples` samples.

    Raises:
        ConfigError: The sound is shorter than one window.

    Example:
        >>> spectrum_shape(1600, 16000)
        (8, 257)
    """
    window, hop, size = _window_sizes(sample_rate)
    if samples < window:
        raise ConfigError(
            f"a spectrogram needs {WINDOW_SECONDS} s of sound, a frame has {samples / sample_rate:g} s",
            hint="Increase `ctrl_dt`.",
        )
    return 1 + (samples - window) // hop, size // 2 + 1


def stft(sound: Float[Array, "*c m"], sample_rate: int) -> Complex[Array, "*c windows bins"]:
    """Compute the short-time Fourier transform of which `stft_magnitude` is the magnitude.

    Phases are relative to each window's first sample.

    Raises:
        ConfigError: The sound is shorter than one window.
    """
    window, hop, size = _window_sizes(sample_rate)
    count, _ = spectrum_shape(sound.shape[-1], sample_rate)
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(window) / window)
    parts = sound[..., hop * np.arange(count)[:, None] + np.arange(window)]
    return jnp.fft.rfft(parts * jnp.asarray(hann / hann.sum(), jnp.float32), size)


def stft_magnitude(sound: Float[Array, "*c m"], sample_rate: int) -> Float[Array, "*c windows bins"]:
    """Compute short-time Fourier magnitudes of pressure; a sine of amplitude 1 has 0.5 at its frequency.

    Hann windows of 25 ms every 10 ms are zero-padded to a power of two; no window extends beyond the sound. Scale and
    layout are those of `scipy.signal.stft(..., boundary=None, padded=False)`. Bin k is the frequency
    k sample_rate / (2 bins - 2) [Hz].

    Raises:
        ConfigError: The sound is shorter than one window.

    Example:
        >>> stft_magnitude(jnp.zeros((2, 1600)), 16000).shape
        (2, 8, 257)
    """
    return jnp.abs(stft(sound, sample_rate))


def log_mel(magnitude: Float[Array, "*c windows bins"], sample_rate: int) -> Float[Array, "*c windows mels"]:
    """Compute the power in `NUM_MELS` mel bands [dB re 1] from `stft_magnitude`, clipped to -100 .. 100 dB.

    Bands are triangles of height 1 whose corners are equally spaced on the mel scale from 0 to half the sample rate,
    see `hz_to_mel`.

    Example:
        >>> log_mel(stft_magnitude(jnp.zeros((2, 1600)), 16000), 16000).shape
        (2, 8, 40)
    """
    filters = jnp.asarray(mel_filters(sample_rate, magnitude.shape[-1]), jnp.float32)
    power = jnp.einsum("...k,mk->...m", magnitude**2, filters, precision="highest")
    return jnp.clip(10 * jnp.log10(jnp.maximum(power, 10 ** (MIN_MEL_LEVEL / 10))), MIN_MEL_LEVEL, MAX_MEL_LEVEL)


def gcc_phat(sound: Float[Array, "*c 2 m"], sample_rate: int) -> Float[Array, "*c lags"]:
    """Compute the generalized cross-correlation with phase transform of the left and right channel.

    The phase transform weights all frequencies equally, so that the result, -1 .. 1 at the leads of the left ear in
    `gcc_leads`, peaks at time differences; it is 0 in silence. Frequencies below 1e-6 of the largest cross-power weigh
    less. Knapp and Carter, The generalized correlation method for estimation of time delay, IEEE Trans. ASSP 24 (1976).

    Example:
        >>> left = jnp.zeros(400).at[100].set(1.0)
        >>> found = gcc_phat(jnp.stack([left, jnp.roll(left, 4)]), 16000)
        >>> round(float(gcc_leads(16000)[found.argmax()]) * 1e6)  # [µs]
        250
    """
    size = 2 ** math.ceil(math.log2(2 * sound.shape[-1]))
    spectra = jnp.fft.rfft(sound, size)
    cross = jnp.conj(spectra[..., 0, :]) * spectra[..., 1, :]
    level = jnp.abs(cross)
    least = 1e-6 * jnp.max(level, axis=-1, keepdims=True) + 1e-30
    fine = jnp.fft.irfft(cross / jnp.maximum(level, least), LAGS_PER_SAMPLE * size) * LAGS_PER_SAMPLE
    most = len(gcc_leads(sample_rate)) // 2
    return jnp.concatenate([fine[..., -most:], fine[..., : most + 1]], axis=-1)


@functools.cache
def gcc_leads(sample_rate: int) -> Float[np.ndarray, " lags"]:
    """Return the leads of `gcc_phat` [s]: -`MAX_LEAD` .. `MAX_LEAD` in steps of 1 / `LAGS_PER_SAMPLE` of a sample."""
    most = round(MAX_LEAD * LAGS_PER_SAMPLE * sample_rate)
    return np.arange(-most, most + 1) / (LAGS_PER_SAMPLE * sample_rate)


def hz_to_mel(frequency: float) -> float:
    """Convert a frequency [Hz] to mel: 2595 log10(1 + f / 700).

    O'Shaughnessy, "Speech Communication: Human and Machine", 1987.

    Example:
        >>> round(hz_to_mel(1000))
        1000
    """
    return 2595 * math.log10(1 + frequency / 700)


@functools.cache
def mel_filters(sample_rate: int, num_bins: int) -> Float[np.ndarray, "mels bins"]:
    """Compute triangular weights, 0 .. 1, per mel band of `num_bins` equally spaced frequencies, 0 to half the rate."""
    corners = 700 * (10 ** (np.linspace(0, hz_to_mel(sample_rate / 2), NUM_MELS + 2) / 2595) - 1)
    frequency = np.linspace(0, sample_rate / 2, num_bins)
    rise = (frequency - corners[:-2, None]) / np.diff(corners)[:-1, None]
    fall = (corners[2:, None] - frequency) / np.diff(corners)[1:, None]
    return np.maximum(np.minimum(rise, fall), 0.0)


def _window_sizes(sample_rate: int) -> tuple[int, int, int]:
    """Return the window, hop and transform sizes [samples]: 25 ms, 10 ms, and the next power of two."""
    window = round(WINDOW_SECONDS * sample_rate)
    return window, round(HOP_SECONDS * sample_rate), 2 ** math.ceil(math.log2(window))
