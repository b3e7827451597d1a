"""The field of the late part: how alike two ears hear it, and how little it follows a head."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.signal import butter as butterworth
from scipy.signal import csd, sosfilt
from scipy.special import spherical_jn, spherical_yn

from home_mjx.audio_jax import AudioConfig
from home_mjx.audio_jax.auralization.response import late_response
from home_mjx.audio_jax.receivers.diffuse_noise import noise_levels, noise_mix
from home_mjx.audio_jax.receivers.spherical_head import diffuse_coherence, sphere_spectrum
from home_mjx.core.transforms import camera_quat

CONFIG = AudioConfig()
HEAD = CONFIG.receiver_radius, CONFIG.speed_of_sound
_late = jax.jit(lambda key, quat: late_response(jnp.ones((CONFIG.num_bins, 2, 7)), key, CONFIG, quat))


def heard(yaw, pitch=0.0, keys=12):
    """Ears of a head in fields of equal energy everywhere."""
    quat = camera_quat(jnp.float32(yaw), jnp.float32(pitch))
    return np.stack([np.asarray(_late(jax.random.key(k), quat), float) for k in range(keys)])


def from_all_sides(frequency, count=4000):
    """Coherence of two opposite points of a sphere: plane waves from everywhere, added up."""
    cosine = (np.arange(count) + 0.5) * 2 / count - 1  # of the angle to one point: evenly spread over the sphere
    waves = sphere_spectrum(np.array([frequency]), np.arccos(cosine), *HEAD)[:, 0]
    opposite = waves[::-1]
    return np.real(np.mean(waves * np.conj(opposite)) / np.mean(np.abs(waves) ** 2))


@pytest.mark.parametrize("frequency", [125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0])
def test_coherence_on_a_sphere_against_plane_waves(frequency):
    ours = diffuse_coherence(np.array([frequency]), np.pi, *HEAD)[0]
    assert ours == pytest.approx(from_all_sides(frequency), abs=0.005)


def test_coherence_at_500_hz():
    """The rigid sphere's, which is far from the 0.62 of two free points."""
    assert diffuse_coherence(np.array([500.0]), np.pi, *HEAD)[0] == pytest.approx(0.17, abs=0.02)


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.5])
def test_ears_are_as_coherent_as_on_a_sphere(yaw):
    left, right = np.moveaxis(heard(yaw), 1, 0)
    frequency, cross = csd(left, right, 16000, nperseg=512)
    powers = [csd(x, x, 16000, nperseg=512)[1].real.mean(axis=0) for x in (left, right)]
    coherence = cross.real.mean(axis=0) / np.sqrt(powers[0] * powers[1])
    for octave in (250, 500, 1000, 2000, 4000):
        inside = (frequency > octave / 2**0.5) & (frequency < octave * 2**0.5)
        exact = [diffuse_coherence(np.array([f]), np.pi, *HEAD)[0] for f in frequency[inside]]
        assert np.mean(coherence[inside]) == pytest.approx(np.mean(exact), abs=0.1)


@pytest.mark.parametrize("turn", [np.pi / 2, -np.pi / 2, np.pi])
def test_a_turned_head_hears_other_noise(turn):
    """Above 1 kHz; below 125 Hz, where a head is a point, it hears the same."""
    before, after = heard(0.3), heard(0.3 + turn)
    high = butterworth(4, 1000, "high", fs=16000, output="sos")
    low = butterworth(4, 90, "low", fs=16000, output="sos")
    for ear in range(2):
        both = [sosfilt(high, x[:, ear]).ravel() for x in (before, after)]
        assert abs(np.corrcoef(*both)[0, 1]) < 0.3
        both = [sosfilt(low, x[:, ear]).ravel() for x in (before, after)]
        assert np.corrcoef(*both)[0, 1] > 0.85


def test_small_turns_change_little():
    before, after = heard(0.3, keys=3), heard(0.35, keys=3)
    assert np.corrcoef(before[:, 0].ravel(), after[:, 0].ravel())[0, 1] > 0.98


@pytest.mark.parametrize("quat", [[1.0, 0, 0, 0], [0.5, 0.5, -0.5, -0.5], [0.6, -0.48, 0.64, 0.0]])
def test_every_head_hears_the_same_energy(quat):
    levels = noise_levels(np.array([125.0, 500.0, 2000.0, 8000.0]), CONFIG)
    mix = np.asarray(noise_mix(jnp.float32(quat), CONFIG), float)
    np.testing.assert_allclose(mix**2 @ levels**2, 1, atol=1e-5)


def test_weights_of_modes_are_those_of_the_series():
    """At μ = 1 the first two modes by hand: |h'_0|² and |h'_1|²."""
    speed, radius = 343.2, 0.0875
    frequency = np.array([speed / (2 * np.pi * radius)])
    parts = [(2 * m + 1) / (spherical_jn(m, 1.0, True) ** 2 + spherical_yn(m, 1.0, True) ** 2) for m in range(8)]
    signs = (-1.0) ** np.arange(8)
    exact = np.sum(signs * parts) / np.sum(parts)
    assert diffuse_coherence(frequency, np.pi, radius, speed)[0] == pytest.approx(exact, abs=1e-6)
