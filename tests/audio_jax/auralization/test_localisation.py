"""Where a sound in the open comes from, by the lead of one ear."""

import jax
import jax.numpy as jnp
import numpy as np
from scipy.signal import fftconvolve

from home_mjx.audio_jax import AudioConfig, Paths, gcc_leads, gcc_phat
from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.receivers.spherical_head import near_sphere_spectrum

CONFIG = AudioConfig(response_seconds=0.1)
RATE, DISTANCE = CONFIG.sample_rate, 3.0
AZIMUTHS = np.arange(-75, 76, 15)


def exact_leads(azimuth: np.ndarray) -> np.ndarray:
    """[s], of the exact sphere: where its own phases correlate best."""
    frequency = np.linspace(50, 7000, 700)
    axes = np.arccos(np.stack([-np.sin(np.radians(azimuth)), np.sin(np.radians(azimuth))]))
    left, right = (
        near_sphere_spectrum(frequency, a, DISTANCE, CONFIG.receiver_radius, CONFIG.speed_of_sound) for a in axes
    )
    cross = np.conj(left) * right
    lag = np.arange(-1e-3, 1e-3, 2e-6)
    waves = np.exp(2j * np.pi * frequency[:, None] * lag)
    return lag[np.argmax(np.real(cross / np.abs(cross) @ waves), axis=1)]


def test_noise_in_the_open_is_found_within_two_degrees(rng):
    """At every 15 degrees from -75 to 75, from one frame of 0.1 s, right of the nose counting as positive."""
    noise = rng.normal(size=CONFIG.frame + CONFIG.response_length)
    early, grid = jax.jit(lambda p: early_response(p, jnp.float32([1, 0, 0, 0]), CONFIG)), np.arange(-90, 90.1, 0.25)
    wanted = exact_leads(grid)
    for azimuth in AZIMUTHS:
        angle = np.radians(azimuth)
        direction = jnp.float32([[np.sin(angle), 0, -np.cos(angle)]])
        response = np.asarray(early(Paths(jnp.float32([DISTANCE]), jnp.full((1, 7), 1 / DISTANCE), direction)))
        ears = [fftconvolve(noise, x)[CONFIG.response_length : noise.size] for x in response]
        lead = gcc_leads(RATE)[int(jnp.argmax(gcc_phat(jnp.asarray(np.stack(ears), jnp.float32), RATE)))]
        found = grid[np.abs(wanted - lead) <= np.min(np.abs(wanted - lead)) + 1e-9]
        assert np.abs(found.mean() - azimuth) <= 2
