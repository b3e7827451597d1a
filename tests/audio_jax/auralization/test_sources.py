"""Clips: loud as promised, no seam, the same every time."""

import numpy as np
import pytest

from home_mjx.audio_jax.auralization.clips import CLIPS, clip_samples
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Traced
from home_mjx.errors import ConfigError
from home_mjx.schema import Timing

NOISES = ("water", "static")


@pytest.mark.parametrize("name", CLIPS)
def test_clips_have_the_promised_loudness_and_no_offset(name):
    clip = clip_samples(name, AudioConfig())
    assert clip.dtype == np.float32
    assert clip.shape == (128000,)
    assert np.sqrt(np.mean(clip.astype(float) ** 2)) == pytest.approx(0.1, rel=1e-5)
    assert abs(clip.mean()) < 1e-6


@pytest.mark.parametrize("name", CLIPS)
def test_the_seam_is_no_rougher_than_the_rest(name):
    """First and second differences across the loop's end stay within those inside."""
    clip = clip_samples(name, AudioConfig()).astype(float)
    for order in (1, 2):
        steps = np.abs(np.diff(np.concatenate([clip[-4:], clip[:4]]), order))
        assert steps.max() <= np.abs(np.diff(clip, order)).max() + 1e-9


def test_clips_depend_on_name_and_rate_only():
    a, b = (clip_samples("speech", config) for config in (AudioConfig(), AudioConfig(late=Traced(num_rays=3))))
    np.testing.assert_array_equal(a, b)
    assert clip_samples("speech", AudioConfig(timing=Timing(sample_rate=8000))).shape == (64000,)


def test_unknown_clip_is_refused():
    with pytest.raises(ConfigError, match="Did you mean `radio`"):
        clip_samples("raido", AudioConfig())


def test_static_is_white_and_water_is_made_of_bubbles():
    """Octaves of white noise rise by 3 dB; bubbles of 5 to 0.5 mm ring at 600 to 6000 Hz, and come one by one."""
    power = {name: np.abs(np.fft.rfft(clip_samples(name, AudioConfig()).astype(float))) ** 2 for name in NOISES}
    frequency = np.fft.rfftfreq(128000, 1 / 16000)

    def share(name, low, high):
        return power[name][(frequency >= low) & (frequency < high)].sum() / power[name].sum()

    octaves = [10 * np.log10(share("static", low, 2 * low)) for low in (1000, 2000, 4000)]
    np.testing.assert_allclose(np.diff(octaves), 3.0, atol=0.5)
    assert share("static", 0, 100) < 1e-3
    assert share("water", 500, 7000) > 0.9
    envelope = {name: clip_samples(name, AudioConfig())[:120000].reshape(-1, 80).std(axis=1) for name in NOISES}
    assert envelope["water"].std() / envelope["water"].mean() > 3 * envelope["static"].std() / envelope["static"].mean()
