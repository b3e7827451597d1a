"""Equalizer and playback rate of an episode's clips, as heard."""

import functools

import jax
import numpy as np
import pytest
from handmade import shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config
from home_mjx.tasks.suite import PointNav

OPTIONS = {"late": "traced", "num_rays": 8, "num_bounces": 1, "impl": "kinematic", "clip": "noise"}


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox()])


@pytest.fixture(scope="module")
def play(bank):
    """States of three environments after their reset; one program of each choice of senses takes any ranges."""

    @functools.cache
    def made(sensors):
        env = HouseholdEnv(make_config(sensors=sensors, **OPTIONS), PointNav()).bind(bank)
        return env, jax.jit(jax.vmap(env.core.reset, (None, 0)))

    def run(*sensors, **ranges):
        env, reset = made(sensors)
        return reset(env.with_variation(ranges).params, jax.random.split(jax.random.key(3), 3))

    return run


def test_the_equalizer_adds_its_decibels_to_each_octave(play):
    plain, varied = play("audio", "ear_levels"), play("audio", "ear_levels", equalizer=(-12, 12))
    drawn = np.asarray(varied.world.variation.equalizer)
    assert drawn.shape == (3, 7)
    assert np.ptp(drawn, axis=1).min() > 3
    change = (varied.obs["ear_levels"] - plain.obs["ear_levels"]).reshape(3, 2, 7)
    np.testing.assert_allclose(change, np.broadcast_to(drawn[:, None], change.shape), atol=0.01)


def test_waveforms_are_equalized_as_levels_are(play):
    """6 dB in all octaves double the pressure, reverberation included."""
    plain, loud = play("audio", "ear_levels"), play("audio", "ear_levels", equalizer=(6, 6))
    np.testing.assert_allclose(loud.obs["audio"], 10 ** (6 / 20) * plain.obs["audio"], atol=2e-4)
    assert np.abs(plain.obs["audio"]).max() > 0.02


def test_the_playback_rate_shifts_the_spectrum(play):
    same, high = play("stft", playback_rate=1), play("stft", playback_rate=(1.5, 1.5))
    np.testing.assert_allclose(same.obs["stft"], play("stft").obs["stft"], atol=1e-6)
    assert not np.allclose(high.obs["stft"], same.obs["stft"], atol=1e-3)


def test_levels_of_octaves_have_no_playback_rate(play):
    with pytest.raises(ConfigError, match="cannot vary here"):
        play("ear_levels", playback_rate=(0.8, 1.2))
