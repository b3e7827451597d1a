"""Echoes of the outer ear: the published delays, read from rendered responses."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax import AudioConfig, Paths
from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.options import Binaural
from home_mjx.audio_jax.receivers.channels import channel_gains
from home_mjx.audio_jax.receivers.pinna import PINNA_MODEL_RATE, pinna_delays, pinna_energy
from home_mjx.core.transforms import camera_quat
from home_mjx.schema.timing import Timing

FINE = {"timing": Timing(sample_rate=48000), "response_seconds": 0.1}
BARE, EARED = AudioConfig(**FINE), AudioConfig(**FINE, receiver=Binaural(pinna=True))
COARSE = AudioConfig(response_seconds=0.1, receiver=Binaural(pinna=True))
AHEAD = jnp.float32([1, 0, 0, 0])
LEVEL = camera_quat(jnp.float32(0.0), jnp.float32(0.0))
_early = {c: jax.jit(lambda p, q, c=c: early_response(p, q, c)) for c in (BARE, EARED, COARSE)}


def unit(side: float, around: float) -> np.ndarray:
    """Head frame, angles in degrees: to the right, and from ahead over above to behind."""
    s, a = np.radians([side, around])
    return np.array([np.sin(s), np.cos(s) * np.sin(a), -np.cos(s) * np.cos(a)])


def spectrum(config, vector, frequency, quat=AHEAD) -> np.ndarray:
    """(ears, f), of a path from 5 m."""
    paths = Paths(jnp.float32([5.0]), jnp.full((1, 7), 0.2), jnp.asarray(vector, jnp.float32)[None])
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        response = np.asarray(_early[config](paths, quat), float)
    return response @ np.exp(-2j * np.pi * np.outer(np.arange(response.shape[1]) / config.sample_rate, frequency))


def published(side: float, around: float) -> np.ndarray:
    """Delays [s] by the formula of Brown and Duda, written anew."""
    echoes = ((1, 2, 1.0), (5, 4, 0.5), (5, 7, 0.5), (5, 11, 0.5), (5, 13, 0.5))
    s, a = np.radians([side, around])
    return np.array([(x * np.cos(s / 2) * np.sin(d * (np.pi / 2 - a)) + b) / PINNA_MODEL_RATE for x, b, d in echoes])


FRONT = [(0, 0), (0, 45), (0, -45), (30, 20), (-60, 0), (0, 90), (20, -80)]


@pytest.mark.parametrize(("side", "around"), FRONT)
def test_delays_are_the_published_ones(side, around):
    found = np.asarray(pinna_delays(jnp.asarray(unit(side, around), jnp.float32)))
    np.testing.assert_allclose(found * PINNA_MODEL_RATE, published(side, around) * PINNA_MODEL_RATE, atol=1e-3)


@pytest.mark.parametrize(("side", "around"), FRONT)
def test_notches_of_a_response_are_where_the_delays_put_them(side, around):
    """Level re the bare sphere at the nearer ear, 1 to 14 kHz, where the model has above -12 dB: rms error below 1 dB.

    To the sides from above or below 1.6 dB. Notches of at least 6 dB within 5 %. In the head's shadow, up to 6.5 kHz,
    1.5 and 3 dB.
    """
    frequency = np.arange(1000.0, 14000.0, 50)
    ours = spectrum(EARED, unit(side, around), frequency) / spectrum(BARE, unit(side, around), frequency)
    strength = np.array([0.5, -1, 0.5, -0.25, 0.25])
    model = 1 + strength @ np.exp(-2j * np.pi * np.outer(published(side, around), frequency))
    levels = [20 * np.log10(np.abs(x)) for x in (*ours, model)]
    loud = levels[2] > -12
    near, far = levels[side > 0], levels[side <= 0]
    assert np.sqrt(np.mean((near - levels[2])[loud] ** 2)) < (1.0 if side * around == 0 else 1.6)
    assert np.sqrt(np.mean((far - levels[2])[loud & (frequency < 6500)] ** 2)) < (1.5 if side * around == 0 else 3.0)
    inner = (levels[2][1:-1] < levels[2][:-2]) & (levels[2][1:-1] < levels[2][2:]) & (levels[2][1:-1] < -6)
    for notch in frequency[1:-1][inner]:
        around_it = np.abs(frequency - notch) < 0.15 * notch
        found = frequency[around_it][np.argmin(near[around_it])]
        assert found == pytest.approx(notch, rel=0.05)


def test_no_echo_comes_before_its_sound_and_nothing_jumps_around_the_head():
    around = np.linspace(-90, 270, 1441)
    vectors = np.stack([unit(10, a) for a in around])
    delays = np.asarray(pinna_delays(jnp.asarray(vectors, jnp.float32))) * PINNA_MODEL_RATE
    assert delays.min() >= 0
    assert np.max(np.abs(np.diff(delays, axis=0))) < 0.05
    np.testing.assert_allclose(delays[0], delays[-1], atol=0.02)


@pytest.mark.parametrize("pair", [((0, 40), (0, -40)), ((0, 0), (0, 180)), ((30, 10), (30, 170))])
def test_up_and_down_front_and_back_differ_at_16_khz(pair):
    """Of the sphere alone they are one; with outer ears, by 3 dB somewhere below 7 kHz."""
    frequency = np.arange(1000.0, 7000.0, 100)
    level = [20 * np.log10(np.abs(spectrum(COARSE, unit(*where), frequency)[0])) for where in pair]
    assert np.max(np.abs(level[0] - level[1])) > 3
    bare = [np.abs(spectrum(BARE, unit(*where), frequency)[0]) for where in pair]
    np.testing.assert_allclose(*bare, rtol=0.01)


def test_a_head_that_looks_up_hears_what_is_ahead_from_below():
    frequency = np.arange(500.0, 12000.0, 100)
    up = camera_quat(jnp.float32(0.0), jnp.float32(np.radians(30)))
    ours = spectrum(EARED, [1.0, 0.0, 0.0], frequency, up)
    np.testing.assert_allclose(np.abs(ours), np.abs(spectrum(EARED, unit(0, -30), frequency)), rtol=1e-2, atol=1e-3)
    assert np.max(np.abs(np.abs(ours) / np.abs(spectrum(EARED, [1.0, 0, 0], frequency, LEVEL)) - 1)) > 0.3


def test_late_energy_has_the_echoes():
    """Per octave that of the formula, on a fine grid; nothing below 250 Hz."""
    vectors = np.stack([unit(*where) for where in FRONT])
    found = np.asarray(pinna_energy(jnp.asarray(vectors, jnp.float32), 48000))
    for row, where in zip(found, FRONT, strict=True):
        for octave, energy in zip((1000, 2000, 4000, 8000), row[3:], strict=True):
            frequency = np.linspace(octave / 2**0.5, octave * 2**0.5, 400)
            waves = np.exp(-2j * np.pi * np.outer(published(*where), frequency))
            exact = np.mean(np.abs(1 + np.array([0.5, -1, 0.5, -0.25, 0.25]) @ waves) ** 2)
            assert 10 * np.log10(energy / exact) == pytest.approx(0, abs=0.3)
        np.testing.assert_allclose(row[:2], 1, rtol=0.05)
    ratio = channel_gains(jnp.asarray(vectors, jnp.float32), AHEAD, EARED) / channel_gains(
        jnp.asarray(vectors, jnp.float32), AHEAD, BARE
    )
    np.testing.assert_allclose(np.asarray(ratio)[:, 0], found, rtol=1e-4)
