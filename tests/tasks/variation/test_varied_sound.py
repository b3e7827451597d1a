"""Equalizer and playback rate of an episode's clips, as heard."""

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


def play(bank, sensor: str, **ranges):
    """States of three environments after their reset."""
    env = HouseholdEnv(make_config(sensors=(sensor,), **OPTIONS), PointNav()).bind(bank).with_variation(ranges)
    return jax.jit(jax.vmap(env.core.reset, (None, 0)))(env.params, jax.random.split(jax.random.key(3), 3))


def test_the_equalizer_adds_its_decibels_to_each_octave(bank):
    plain, varied = play(bank, "ear_levels"), play(bank, "ear_levels", equalizer=(-12, 12))
    drawn = np.asarray(varied.world.variation.equalizer)
    assert drawn.shape == (3, 7)
    assert np.ptp(drawn, axis=1).min() > 3
    change = (varied.obs["ear_levels"] - plain.obs["ear_levels"]).reshape(3, 2, 7)
    np.testing.assert_allclose(change, np.broadcast_to(drawn[:, None], change.shape), atol=0.01)


def test_waveforms_are_equalized_as_levels_are(bank):
    """6 dB in all octaves double the pressure, reverberation included."""
    plain, loud = play(bank, "audio"), play(bank, "audio", equalizer=(6, 6))
    np.testing.assert_allclose(loud.obs["audio"], 10 ** (6 / 20) * plain.obs["audio"], atol=2e-4)
    assert np.abs(plain.obs["audio"]).max() > 0.02


def test_the_playback_rate_shifts_the_spectrum(bank):
    same, high = play(bank, "stft", playback_rate=1), play(bank, "stft", playback_rate=(1.5, 1.5))
    np.testing.assert_allclose(same.obs["stft"], play(bank, "stft").obs["stft"], atol=1e-6)
    assert not np.allclose(high.obs["stft"], same.obs["stft"], atol=1e-3)


def test_levels_of_octaves_have_no_playback_rate(bank):
    with pytest.raises(ConfigError, match="cannot vary here"):
        play(bank, "ear_levels", playback_rate=(0.8, 1.2))
