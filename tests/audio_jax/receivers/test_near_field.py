"""Heads near a source, against the exact series of the sphere and published values."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.receivers.spherical_head import near_sphere_spectrum, sphere_spectrum

CONFIG = AudioConfig()
RADIUS, SPEED, RATE = CONFIG.receiver_radius, CONFIG.speed_of_sound, CONFIG.sample_rate
AHEAD = jnp.float32([1, 0, 0, 0])
_early = jax.jit(lambda paths: early_response(paths, AHEAD, CONFIG))


def ears(distance: float, azimuth: float, frequency: np.ndarray) -> np.ndarray:
    """Spectra of the left and the right ear for a source to the left."""
    angle = np.radians(azimuth)
    direction = jnp.float32([[-np.sin(angle), 0, -np.cos(angle)]])
    paths = Paths(jnp.float32([distance]), jnp.full((1, 7), 1 / distance), direction)
    time = np.arange(CONFIG.response_length) / RATE
    return np.asarray(_early(paths), float) @ np.exp(-2j * np.pi * time[:, None] * frequency)


@pytest.mark.parametrize(("distance", "level"), [(2.0, 2.8), (1.0, 3.8), (0.5, 5.8), (0.25, 10.2)])
def test_level_difference_at_500_hz(distance, level):
    """At 90°, as an independent implementation has it [dB]."""
    left, right = ears(distance, 90, np.array([500.0]))[:, 0]
    assert 20 * np.log10(abs(left / right)) == pytest.approx(level, abs=0.15)


@pytest.mark.parametrize("distance", [0.25, 0.4, 0.8, 1.5])
@pytest.mark.parametrize("azimuth", [20, 55, 90, 130])
def test_level_differences_are_those_of_the_exact_sphere(distance, azimuth):
    """Within 1 dB from 125 Hz to 6 kHz."""
    frequency = np.array([125.0, 250, 500, 1000, 1700, 2500, 4000, 6000])
    left, right = ears(distance, azimuth, frequency)
    angles = np.arccos(np.array([1, -1]) * np.sin(np.radians(azimuth)))
    exact = near_sphere_spectrum(frequency, angles, distance, RADIUS, SPEED)
    ours, wanted = (20 * np.log10(np.abs(x / y)) for x, y in ((left, right), exact))
    assert np.max(np.abs(ours - wanted)) < 1


def test_from_afar_the_series_is_that_of_plane_waves():
    frequency, angle = np.array([100.0, 500, 2000, 7000]), np.array([0.0, 1.0, 2.5])
    near = near_sphere_spectrum(frequency, angle, 500.0, RADIUS, SPEED)
    np.testing.assert_allclose(near, sphere_spectrum(frequency, angle, RADIUS, SPEED), atol=2e-3)
