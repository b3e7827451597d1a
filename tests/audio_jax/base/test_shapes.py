"""Filters that paths share, against the gains that they are to have."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.base.delays import HALF_WIDTH, delay_kernel, upsample_twice, windowed_sinc
from home_mjx.audio_jax.base.filter_basis import filter_basis, octave_filters_at_knots
from home_mjx.schema.compiled import BANDS

RATE = 16000


def spectrum(weight: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Of sums of the kernels."""
    kernel = weight @ filter_basis(RATE).kernel
    time = (np.arange(kernel.shape[-1]) - HALF_WIDTH) / RATE
    return kernel @ np.exp(-2j * np.pi * time[:, None] * frequency)


def octave_energy(response: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Mean square in each octave."""
    number = np.round(np.log2(frequency / BANDS[0])).astype(int)
    return np.stack([np.mean(np.abs(response[..., number == b]) ** 2, axis=-1) for b in range(len(BANDS))], axis=-1)


def test_together_they_change_nothing():
    frequency = np.linspace(30, 7000, 200)
    np.testing.assert_allclose(spectrum(np.ones(filter_basis(RATE).frequency.size), frequency), 1, atol=1e-4)


def test_reflections_off_materials_have_their_gains(rng):
    """One or two surfaces whose absorption rises or falls by about 0.1 per octave: centres and energies of octaves."""
    absorption = np.clip(rng.uniform(0.05, 0.6, (60, 2, 1)) + np.cumsum(rng.normal(0, 0.08, (60, 2, 7)), -1), 0.01, 0.9)
    gain = np.sqrt(np.prod(1 - absorption, axis=1))
    weight = np.real(np.asarray(octave_filters_at_knots(jnp.asarray(gain, jnp.float32), RATE)))
    level = 20 * np.log10(np.abs(spectrum(weight, np.array(BANDS[:6]))) / gain[:, :6])
    assert np.max(np.abs(level)) < 0.1
    frequency = np.geomspace(BANDS[0] / 2**0.5, 7000, 700)
    error = 10 * np.log10(octave_energy(spectrum(weight, frequency), frequency) / gain**2)
    assert np.sqrt(np.mean(error**2)) < 0.25
    assert np.max(np.abs(error)) < 1.5


def test_they_are_causal():
    """But for the band limit's look ahead, whatever the gains."""
    gain = jnp.asarray([[1.0, 0.5, 0.9, 0.3, 0.6, 0.2, 0.4]])
    kernel = np.real(np.asarray(octave_filters_at_knots(gain, RATE)))[0] @ filter_basis(RATE).kernel
    assert np.sum(kernel[:HALF_WIDTH] ** 2) < 0.02 * np.sum(kernel**2)
    assert kernel.size == HALF_WIDTH * 2 + round(0.032 * RATE)


@pytest.mark.parametrize("delay", [0.0, 0.2, 0.5, 0.77, 1.0])
def test_delays_are_those_of_a_band_limited_pulse(delay):
    """Up to 7 kHz within -55 dB."""
    kernel = np.asarray(delay_kernel(jnp.float32(delay)), float)
    frequency = np.linspace(0, 7000, 71)
    time = (np.arange(kernel.size) - HALF_WIDTH - 3) / RATE
    exact = np.exp(-2j * np.pi * frequency * delay / RATE)
    assert np.max(np.abs(kernel @ np.exp(-2j * np.pi * time[:, None] * frequency) - exact)) < 10 ** (-55 / 20)


def test_twice_the_rate(rng):
    signal = rng.normal(size=50)
    place = np.arange(100)[:, None] / 2 - np.arange(50)[None]
    exact = windowed_sinc(place) @ signal
    np.testing.assert_allclose(upsample_twice(jnp.asarray(signal, jnp.float32)), exact, atol=1e-5)
