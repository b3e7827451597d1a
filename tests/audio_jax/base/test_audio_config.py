"""Options of sound: what cannot be used is refused with a reason."""

import pytest

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.presets import PRESETS, audio_preset
from home_mjx.errors import ConfigError
from home_mjx.schema import Timing


def test_lengths_follow_from_rates():
    config = AudioConfig(timing=Timing(sample_rate=48000, ctrl_dt=0.05, sim_dt=0.025), response_seconds=1.0)
    assert (config.frame, config.bin_samples, config.num_bins, config.response_length) == (2400, 192, 250, 48000)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bin_seconds": 0.00303}, "`bin_seconds` must hold a whole number of samples"),
        ({"bin_seconds": 0.0040625, "response_seconds": 0.40625}, "even number of samples, got 65"),
        ({"response_seconds": 0.5001}, "`response_seconds` must hold a whole number of bins"),
        ({"num_rays": 0}, "`num_rays` must be a whole number of at least 1, got 0"),
        ({"num_reflections": -1}, "`num_reflections` must be a whole number of at least 0, got -1"),
        ({"head_radius": 0.0}, "`head_radius` must be positive"),
        ({"humidity": 150.0}, "humidity of 0..100 %"),
        ({"receiver": "binural"}, "Did you mean `binaural`"),
        ({"detector": "rein"}, "Did you mean `rain`"),
        ({"late": "backed"}, "Did you mean `baked`"),
        ({"late": "baked", "bin_seconds": 0.002}, "late='baked' does not support bin_seconds=0.002"),
        ({"late": "baked", "reflection_order": 2}, "late='baked' does not support reflection_order=2"),
        ({"late": "baked", "num_reflections": 0}, "late='baked' needs reflections"),
        ({"tail_seconds": -0.1}, "`tail_seconds` must be a finite number of at least 0"),
        ({"motion": True, "response_seconds": 0.004}, "at least two bins"),
    ],
)
def test_unusable_values_are_refused(options, message):
    with pytest.raises(ConfigError, match=message):
        AudioConfig(**options)


def test_configs_are_hashable_and_compare_by_value():
    assert hash(AudioConfig()) == hash(AudioConfig(timing=Timing(sample_rate=16000)))
    assert AudioConfig() != AudioConfig(num_rays=65)


def test_memory_of_what_moves():
    """A response of 125 bins of 64 samples; 62 of them ring on twice in 0.4 s, and filters of the tail for 16 ms."""
    assert AudioConfig(tail_seconds=0.4).memory_length == AudioConfig().response_length == 8000
    assert AudioConfig(motion=True, tail_seconds=0.0).memory_length == 8000
    assert AudioConfig(motion=True, tail_seconds=0.4).memory_length == 8000 + 2 * 62 * 64 + 256


def test_presets():
    """Two are looked up, one is traced; traced, each flies more than the one before; options may differ."""
    assert [audio_preset(name).late for name in PRESETS] == ["baked", "baked", "traced"]
    traced = [audio_preset(name, late="traced") for name in PRESETS]
    rays = [config.num_rays * config.num_bounces for config in traced]
    assert rays == sorted(rays)
    assert len(set(rays)) == 3
    assert [config.reflection_order for config in traced] == [1, 2, 3]
    for name in PRESETS:  # each is to be had with late sound that has been baked
        assert audio_preset(name, late="baked").reflection_order == 1
    assert audio_preset("balanced", num_edges=0) == AudioConfig(**{**PRESETS["balanced"], "num_edges": 0})
    with pytest.raises(ConfigError, match="Did you mean `kernels`"):
        audio_preset("fats")
    with pytest.raises(ConfigError, match="num_rays"):
        audio_preset("fast", num_rays=0)
    with pytest.raises(ConfigError, match="multiple of 7, got 100"):
        audio_preset("reference", num_rays=100)
