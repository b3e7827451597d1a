"""What is read from sound frames: how much of each frequency is heard when, and which ear leads."""

import functools
import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.errors import ConfigError

WINDOW_SECONDS, HOP_SECONDS = 0.025, 0.010
NUM_MELS = 40
MOST_LEAD, FINER = 0.001, 8  # [s], and steps per sample, of correlations of both ears
LEAST, MOST = -100.0, 100.0  # [dB]


def spectrum_shape(samples: int, sample_rate: int) -> tuple[int, int]:
    """Windows and frequencies of `stft_magnitude` for a sound of so many samples.

    Raises:
        ConfigError: The sound is shorter than one window.

    Example:
        >>> spectrum_shape(1600, 16000)
        (8, 257)
    """
    window, hop, size = _lengths(sample_rate)
    if samples < window:
        raise ConfigError(
            f"a spectrogram needs {WINDOW_SECONDS} s of sound, a frame has {samples / sample_rate:g} s",
            hint="Make `ctrl_dt` longer.",
        )
    return 1 + (samples - window) // hop, size // 2 + 1


def stft_magnitude(sound: Float[Array, "*c m"], sample_rate: int) -> Float[Array, "*c windows bins"]:
    """Magnitudes of the short-time Fourier transform; a sine of amplitude 1 has 0.5 at its frequency.

    Hann windows of 25 ms every 10 ms, filled up with zeros to a power of two. None reaches beyond the sound. Scaled
    and laid out as `scipy.signal.stft(..., boundary=None, padded=False)`.

    Args:
        sound: Pressure.
        sample_rate: [Hz].

    Returns:
        Frequency k is k sample_rate / (2 bins - 2) [Hz].

    Raises:
        ConfigError: The sound is shorter than one window.

    Example:
        >>> stft_magnitude(jnp.zeros((2, 1600)), 16000).shape
        (2, 8, 257)
    """
    window, hop, size = _lengths(sample_rate)
    count, _ = spectrum_shape(sound.shape[-1], sample_rate)
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(window) / window)
    parts = sound[..., hop * np.arange(count)[:, None] + np.arange(window)]
    return jnp.abs(jnp.fft.rfft(parts * jnp.asarray(hann / hann.sum(), jnp.float32), size))


def log_mel(magnitude: Float[Array, "*c windows bins"], sample_rate: int) -> Float[Array, "*c windows mels"]:
    """Power in `NUM_MELS` bands that are equally wide to the ear [dB re the squared pressure of 1].

    Triangles of height 1 whose corners are equally spaced on the mel scale from 0 to half the sample rate, see
    `mel_of`. Clipped to `LEAST` and `MOST`.

    Args:
        magnitude: From `stft_magnitude`.
        sample_rate: [Hz].

    Example:
        >>> log_mel(stft_magnitude(jnp.zeros((2, 1600)), 16000), 16000).shape
        (2, 8, 40)
    """
    filters = jnp.asarray(mel_filters(sample_rate, magnitude.shape[-1]), jnp.float32)
    power = jnp.einsum("...k,mk->...m", magnitude**2, filters, precision="highest")
    return jnp.clip(10 * jnp.log10(jnp.maximum(power, 10 ** (LEAST / 10))), LEAST, MOST)


def gcc_phat(sound: Float[Array, "*c 2 m"], sample_rate: int) -> Float[Array, "*c lags"]:
    """Generalised cross-correlation of both ears with phase transform: largest where one ear hears the other's sound.

    Knapp and Carter, The generalized correlation method for estimation of time delay, IEEE Trans. ASSP 24 (1976). Every
    frequency counts the same, however loud.

    Args:
        sound: Left and right.
        sample_rate: [Hz].

    Returns:
        For leads of the left ear of `gcc_leads`: from -1 to 1.

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
    fine = jnp.fft.irfft(cross / jnp.maximum(level, least), FINER * size) * FINER
    most = len(gcc_leads(sample_rate)) // 2
    return jnp.concatenate([fine[..., -most:], fine[..., : most + 1]], axis=-1)


@functools.cache
def gcc_leads(sample_rate: int) -> Float[np.ndarray, " lags"]:
    """Leads [s] at which `gcc_phat` is given: up to `MOST_LEAD`, in steps of a fraction of a sample."""
    most = round(MOST_LEAD * FINER * sample_rate)
    return np.arange(-most, most + 1) / (FINER * sample_rate)


def mel_of(frequency: float) -> float:
    """Pitch of a frequency [Hz] in mel: 2595 log10(1 + f / 700).

    O'Shaughnessy, "Speech Communication: Human and Machine", 1987.

    Example:
        >>> round(mel_of(1000))
        1000
    """
    return 2595 * math.log10(1 + frequency / 700)


@functools.cache
def mel_filters(sample_rate: int, num_bins: int) -> Float[np.ndarray, "mels bins"]:
    """Weight of each frequency of a spectrum in each band."""
    corners = 700 * (10 ** (np.linspace(0, mel_of(sample_rate / 2), NUM_MELS + 2) / 2595) - 1)
    frequency = np.linspace(0, sample_rate / 2, num_bins)
    rise = (frequency - corners[:-2, None]) / np.diff(corners)[:-1, None]
    fall = (corners[2:, None] - frequency) / np.diff(corners)[1:, None]
    return np.maximum(np.minimum(rise, fall), 0.0)


def _lengths(sample_rate: int) -> tuple[int, int, int]:
    """Samples of a window, between two, and of the transform."""
    window = round(WINDOW_SECONDS * sample_rate)
    return window, round(HOP_SECONDS * sample_rate), 2 ** math.ceil(math.log2(window))
