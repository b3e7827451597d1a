"""Rendering of paths and histograms into the responses of two ears, against closed forms."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy_measures import octave_energies

from home_mjx.audio_jax.auralization.response import early_response, late_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.base.options import Omni
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.receivers.spherical_head import diffuse_coherence, near_sphere_spectrum
from home_mjx.core.transforms import camera_quat
from home_mjx.schema.compiled import BANDS

OMNI, BINAURAL = AudioConfig(receiver=Omni()), AudioConfig()
RATE, SPEED = OMNI.sample_rate, OMNI.speed_of_sound
AHEAD = jnp.float32([1, 0, 0, 0])  # the head frame is the world's: +x right, +y up, looking along -z


def render(config: AudioConfig, distance: list, gain: np.ndarray, direction: list) -> np.ndarray:
    """Response to the given paths under strict promotion."""
    paths = Paths(jnp.float32(distance), jnp.asarray(gain, jnp.float32), jnp.float32(direction))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(_early[config](paths, AHEAD), np.float64)


_early = {c: jax.jit(lambda p, q, c=c: early_response(p, q, c)) for c in (OMNI, BINAURAL)}
_late = {c: jax.jit(lambda e, k, c=c: late_response(e, k, c)) for c in (OMNI, BINAURAL)}


def flat(amplitude: float) -> np.ndarray:
    return np.full((1, 7), amplitude)


def spectrum(response: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Fourier transform at any frequencies."""
    time = np.arange(response.shape[-1]) / RATE
    return response @ np.exp(-2j * np.pi * np.outer(time, frequency))


@pytest.mark.parametrize("distance", [0.25, 1.0, 3.3333, 7.77, 20.0, 100.0])
def test_direct_sound_in_the_open(distance):
    """Delay r / c within 0.05 samples and level 1 / r within 0.05 dB, 500 Hz to 5 kHz.

    Nearer than 1 m, what would ring before time 0 is cut off, which costs up to 0.2 dB.
    """
    response = render(OMNI, [distance], flat(1 / distance), [[0, 0, -1]])
    frequency = np.linspace(500, 5000, 181)
    undone = spectrum(response[0], frequency) * np.exp(2j * np.pi * frequency * distance / SPEED)
    late = -np.polyfit(2 * np.pi * frequency, np.unwrap(np.angle(undone)), 1)[0] * RATE
    assert abs(late) < 0.05
    level = 20 * np.log10(np.abs(spectrum(response[0], frequency)) * distance)
    assert np.max(np.abs(level)) < (0.05 if distance >= 1 else 0.2)
    np.testing.assert_array_equal(response[0], response[1])


def test_octave_gains_of_a_path():
    """The gain of each octave stands at its centre, and between centres nothing leaves the range of its neighbours."""
    gain = 10 ** (-np.array([17, 31, 33, 40, 38, 36, 36]) / 20)
    response = render(OMNI, [8.0], gain[None], [[0, 0, -1]])
    level = 20 * np.log10(np.abs(spectrum(response[0], np.array(BANDS[:6]))))
    np.testing.assert_allclose(level, 20 * np.log10(gain[:6]), atol=0.1)
    energies = 10 * np.log10(octave_energies(response[0], RATE))
    np.testing.assert_allclose(energies, 20 * np.log10(gain), atol=0.9)


def test_late_part_has_no_zero_frequency():
    late = np.asarray(_late[OMNI](jnp.ones((OMNI.num_bins, 2, 7)), jax.random.key(0)), float)
    assert np.all(np.abs(late.mean(axis=1)) < 0.01 * late.std(axis=1))


def test_paths_add_up_and_late_ones_are_left_out():
    gain = np.random.default_rng(0).uniform(0, 1, (3, 7))
    distance, direction = [3.0, 4.5, 500.0], [[0, 0, -1], [1, 0, 0], [0, 1, 0]]
    together = render(BINAURAL, distance, gain, direction)
    alone = np.zeros((3, 3, 7))
    alone[range(3), range(3)] = gain
    each = [render(BINAURAL, distance, alone[i], direction) for i in range(3)]
    np.testing.assert_allclose(together, sum(each), atol=1e-6)
    assert not each[2].any()


@pytest.mark.parametrize("config", [OMNI, BINAURAL])
@pytest.mark.parametrize(
    ("loss", "bar"), [([0] * 7, -50), ([17, 31, 33, 40, 38, 36, 36], -40), ([14, 19, 23, 18, 17, 21, 21], -40)]
)
def test_nothing_is_heard_long_before_it_comes(config, loss, bar):
    """Energy more than 1 ms before an arrival at each ear: -50 dB re all of it, -40 dB through a wall or a door."""
    for distance in (5.0, 5.013, 6.7, 7.77):
        for angle in (0.0, 0.9, np.pi / 2):
            direction = [np.sin(angle), 0, -np.cos(angle)]
            response = render(config, [distance], 10 ** (-np.array([loss]) / 20), [direction])
            for ear, side in enumerate((-1, 1)):
                turn = np.arccos(side * np.sin(angle))
                late = -np.cos(turn) if turn < np.pi / 2 else turn - np.pi / 2  # Woodworth's
                way = distance + (config.receiver_radius * late if config is BINAURAL else 0)
                early = response[ear, : int(way / SPEED * RATE - RATE / 1000) + 1]
                assert 10 * np.log10(np.sum(early**2) / np.sum(response[ear] ** 2) + 1e-30) < bar


@pytest.mark.parametrize("azimuth", [90, 60, 30])
@pytest.mark.parametrize("side", [-1, 1])
def test_ears_hear_what_a_rigid_sphere_would(azimuth, side):
    """Complex ratio of both ears against the exact series; left and right in their place."""
    angle = np.radians(azimuth)
    response = render(BINAURAL, [4.0], flat(0.25), [[side * np.sin(angle), 0, -np.cos(angle)]])
    frequency = np.array([250.0, 500, 1000, 2000, 4000, 7000])
    left, right = spectrum(response, frequency)
    near, far = (right, left) if side > 0 else (left, right)
    ears = np.array([np.pi / 2 - angle, np.pi / 2 + angle])
    expected = near_sphere_spectrum(frequency, ears, 4.0, BINAURAL.binaural.head_radius, SPEED)
    np.testing.assert_allclose(near / far, expected[0] / expected[1], rtol=0.02)
    np.testing.assert_allclose(np.abs(near), 0.25 * np.abs(expected[0]), rtol=0.02)
    onset = np.argmax(np.abs(response), axis=1)
    assert onset[int(side > 0)] < onset[int(side < 0)], "the nearer ear hears first"


def test_above_ahead_and_behind_are_the_same_in_both_ears():
    for direction in ([0, 1, 0], [0, 0, -1], [0, 0, 1], [0, -0.6, 0.8]):
        response = render(BINAURAL, [4.0], flat(0.25), [direction])
        np.testing.assert_allclose(response[0], response[1], atol=1e-6)


def test_noise_follows_the_histogram():
    """Energy over 100 ms windows and in octave bands; bins, bands and ears get what the histogram says."""
    decay = np.exp(-13.8 * OMNI.bin_seconds / np.array([0.8, 0.6, 0.5, 0.5, 0.4, 0.3, 0.2]))
    energy = 0.01 * decay ** np.arange(OMNI.num_bins)[:, None]
    both = jnp.asarray(np.stack([energy, energy], axis=1), jnp.float32)
    late = np.stack([np.asarray(_late[OMNI](both, jax.random.key(k)), float) for k in range(100)])
    total = np.mean(octave_energies(late[:, 0], RATE), axis=0)
    level = 10 * np.log10(total / energy.sum(axis=0))
    np.testing.assert_allclose(level[1:], 0, atol=0.3)
    assert -1 < level[0] < 0, "the high-pass takes its part of the first band"
    share = octave_gains(np.linspace(0, RATE / 2, 4001)).mean(axis=1)
    windows = np.mean(late[:, 0].reshape(100, -1, 1600) ** 2, axis=0).sum(axis=1)
    expected = (energy @ share).reshape(-1, 25).sum(axis=1)
    np.testing.assert_allclose(10 * np.log10(windows / expected), 0, atol=0.8)


def test_noise_is_gaussian_flat_and_as_coherent_as_a_diffuse_field():
    """Of heads that look in several directions, as one noise serves all keys."""
    energy = jnp.ones((BINAURAL.num_bins, 2, 7))
    heads = [camera_quat(jnp.float32(yaw), jnp.float32(0)) for yaw in np.arange(12) * np.pi / 6]
    run = jax.jit(lambda key, quat: late_response(energy, key, BINAURAL, quat))
    late = np.stack([np.asarray(run(jax.random.key(k), quat), float) for k, quat in enumerate(heads)])
    pooled = late[:, 0].ravel()
    assert np.mean(pooled**4) / np.mean(pooled**2) ** 2 == pytest.approx(3, abs=0.15)
    cut = late.reshape(12, 2, -1, 400)
    left, right = np.moveaxis(np.fft.rfft(cut * np.hanning(400)), 1, 0)
    coherence = np.real(np.mean(left * np.conj(right), axis=(0, 1)))
    coherence /= np.sqrt(np.mean(np.abs(left) ** 2, axis=(0, 1)) * np.mean(np.abs(right) ** 2, axis=(0, 1)))
    frequency = np.fft.rfftfreq(400, 1 / RATE)
    expected = diffuse_coherence(np.maximum(frequency, 1), np.pi, BINAURAL.binaural.head_radius, SPEED)
    assert np.max(np.abs(coherence - expected)[2:]) < 0.2
    assert np.sqrt(np.mean((coherence - expected)[2:] ** 2)) < 0.07


def test_keys_choose_the_noise_typed_or_raw():
    energy = jnp.ones((OMNI.num_bins, 2, 7))
    typed, raw = jax.random.key(3), jax.random.key_data(jax.random.key(3))
    np.testing.assert_array_equal(_late[OMNI](energy, typed), _late[OMNI](energy, raw))
    other = _late[OMNI](energy, jax.random.key(4))[0]
    assert abs(np.corrcoef(_late[OMNI](energy, typed)[0], other)[0, 1]) < 0.05
