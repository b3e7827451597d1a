"""Interaural cues of sounds whose delay, level and correlation are known."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.auralization.interaural import NUM_BANDS, band_weights, interaural_cues, interaural_lags

RATE = 16000


def noise(rng: np.random.Generator, low: float = 0, high: float = RATE / 2, size: int = 9600) -> np.ndarray:
    spectrum, frequency = np.fft.rfft(rng.normal(size=size)), np.fft.rfftfreq(size, 1 / RATE)
    return np.fft.irfft(np.where((frequency >= low) & (frequency <= high), spectrum, 0), size)


def delayed(sound: np.ndarray, seconds: float) -> np.ndarray:
    frequency = np.fft.rfftfreq(sound.size, 1 / RATE)
    return np.fft.irfft(np.fft.rfft(sound) * np.exp(-2j * np.pi * frequency * seconds), sound.size)


def cues_of(left: np.ndarray, right: np.ndarray):
    return interaural_cues(jnp.asarray(np.stack([left, right]), jnp.float32), RATE)


@pytest.mark.parametrize("lead", [-0.0006, -0.0002, 0.0, 0.0005])
def test_delay_and_level_are_found_whatever_the_spectrum(rng, lead: float):
    """Of white and of red noise, at 60 dB less as well."""
    red = np.cumsum(noise(rng, 100))
    for sound in (noise(rng), red / red.std(), 0.001 * noise(rng)):
        cues = cues_of(0.1 * sound, 0.05 * delayed(sound, lead))
        np.testing.assert_allclose(cues.level_difference, 20 * np.log10(2), atol=0.7)
        np.testing.assert_allclose(cues.time_difference[:5], lead, atol=0.0001)
        assert np.all(np.asarray(cues.coherence)[:8] > 0.95)
        assert interaural_lags()[np.argmax(cues.correlation)] == pytest.approx(lead, abs=0.00005)


def test_independent_noise_at_the_ears_is_incoherent(rng):
    """A mixture of a common and of independent parts of equal power has the coherence 1/2."""
    left, right, common = (noise(rng, size=160000) for _ in range(3))
    assert np.max(cues_of(left, right).coherence) < 0.25
    half = cues_of(left + common, right + common)
    np.testing.assert_allclose(half.coherence, 0.5, atol=0.12)


def test_silent_bands_have_no_cues(rng):
    """A tone is loudest in its own band, and coherent there; silence has no cues at all."""
    tone = np.sin(2 * np.pi * 1000 * np.arange(4800) / RATE)
    cues = cues_of(0.1 * tone, 0.1 * tone)
    band = int(np.argmax(cues.level))
    assert band_weights(RATE, 257)[band][32] == 1  # 1000 Hz
    assert cues.coherence[band] == pytest.approx(1, abs=1e-3)
    silent = cues_of(np.zeros(4800), np.zeros(4800))
    for name in ("level_difference", "time_difference", "coherence", "correlation"):
        np.testing.assert_array_equal(getattr(silent, name), 0)
    np.testing.assert_array_equal(silent.level, -100)


def test_each_frequency_is_in_at_most_one_band():
    weights = band_weights(RATE, 257)
    assert weights.shape == (NUM_BANDS, 257)
    assert set(weights.sum(axis=0).tolist()) == {0.0, 1.0}
    assert np.all(weights.sum(axis=1) >= 3)
