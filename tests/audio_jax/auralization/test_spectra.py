"""Spectrograms against SciPy's and against the formula of the mel scale."""

import math

import jax.numpy as jnp
import numpy as np
import pytest
import scipy.signal

from home_mjx.audio_jax import log_mel, stft_magnitude
from home_mjx.audio_jax.auralization.features import MIN_MEL_LEVEL, NUM_MELS, mel_filters, spectrum_shape
from home_mjx.errors import ConfigError


@pytest.mark.parametrize(("rate", "samples"), [(16000, 1600), (16000, 4800), (8000, 801)])
def test_magnitudes_are_scipys(rate: int, samples: int, rng: np.random.Generator):
    sound = rng.normal(size=(2, samples)).astype(np.float32)
    window = round(0.025 * rate)
    size = 512 if rate == 16000 else 256
    _, _, expected = scipy.signal.stft(
        sound, rate, "hann", window, window - round(0.01 * rate), size, boundary=None, padded=False
    )
    found = stft_magnitude(jnp.asarray(sound), rate)
    assert found.shape == (2, *spectrum_shape(samples, rate))
    np.testing.assert_allclose(found, np.abs(expected).swapaxes(1, 2), atol=1e-6)


def test_a_sine_has_half_its_amplitude_at_its_frequency():
    sine = 3 * np.sin(2 * np.pi * 1000 * np.arange(1600) / 16000)
    found = np.asarray(stft_magnitude(jnp.asarray(sine, jnp.float32), 16000))
    assert (found.argmax(axis=-1) == 1000 / 16000 * 512).all()
    np.testing.assert_allclose(found.max(axis=-1), 1.5, rtol=1e-3)


def mels(frequency: float) -> float:
    return 1127 * math.log(1 + frequency / 700)  # the same scale by natural logarithms


@pytest.mark.parametrize("frequency", [200, 440, 1000, 2500, 5000, 7500])
def test_a_sine_is_in_the_band_of_its_pitch(frequency: int):
    sine = np.sin(2 * np.pi * frequency * np.arange(1600) / 16000)
    found = np.asarray(log_mel(stft_magnitude(jnp.asarray(sine, jnp.float32), 16000), 16000))
    band = round(mels(frequency) / mels(8000) * (NUM_MELS + 1)) - 1  # whose middle is nearest
    assert (np.abs(found.argmax(axis=-1) - band) <= (0 if frequency > 300 else 1)).all()
    far = np.abs(np.arange(NUM_MELS) - band) > 4
    assert found[:, far].max() < found[:, band].min() - 15


@pytest.mark.parametrize("rate", [8000, 16000, 48000])
def test_bands_cover_the_spectrum_and_none_is_empty(rate: int):
    filters = mel_filters(rate, 2 ** math.ceil(math.log2(0.025 * rate)) // 2 + 1)
    assert (filters.max(axis=1) > 0.3).all()
    assert filters.max() <= 1
    frequency = np.linspace(0, rate / 2, filters.shape[1])
    first, last = (700 * (math.exp(mels(rate / 2) * k / (NUM_MELS + 1) / 1127) - 1) for k in (1, NUM_MELS))
    between = (frequency >= first) & (frequency <= last)
    np.testing.assert_allclose(filters.sum(axis=0)[between], 1, atol=1e-9)  # neighbours share each frequency


def test_loudness_is_in_decibels_and_silence_at_the_floor():
    sound = np.sin(2 * np.pi * 440 * np.arange(1600) / 16000)
    loud, quiet = (log_mel(stft_magnitude(jnp.asarray(g * sound, jnp.float32), 16000), 16000) for g in (1, 0.1))
    assert float(loud.max() - quiet.max()) == pytest.approx(20, abs=0.01)
    assert float(log_mel(stft_magnitude(jnp.zeros(1600), 16000), 16000).max()) == MIN_MEL_LEVEL


def test_a_sound_shorter_than_a_window_is_refused():
    with pytest.raises(ConfigError, match=r"0.025 s.*0.02 s"):
        spectrum_shape(320, 16000)
