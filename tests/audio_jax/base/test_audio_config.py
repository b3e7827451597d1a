"""Options of sound: what cannot be used is refused with a reason."""

from dataclasses import replace

import pytest

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Air, Baked, Binaural, MicrophoneArray, Motion, NoLate, Omni, Traced
from home_mjx.audio_jax.base.presets import PRESETS, audio_preset
from home_mjx.core.jsonable import from_json, to_json
from home_mjx.core.variants import override_fields
from home_mjx.errors import ConfigError
from home_mjx.schema import Timing
from home_mjx.tasks import make_config


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
        ({"humidity": 150.0}, "`humidity` must be a finite number of at least 0 and at most 100"),
        ({"receiver": "binural"}, "unknown `receiver` 'binural'.*Did you mean `binaural`"),
        ({"detector": "rein"}, "Did you mean `rain`"),
        ({"late": "backed"}, "Did you mean `baked`"),
        ({"late": "baked", "bin_seconds": 0.002}, "late=Baked\\(\\) does not support bin_seconds=0.002"),
        ({"late": "baked", "reflection_order": 2}, "late=Baked\\(\\) does not support reflection_order=2"),
        ({"late": "baked", "num_reflections": 0}, "late=Baked\\(\\) needs reflections"),
        ({"motion": True, "tail_seconds": -0.1}, "`tail_seconds` must be a finite number of at least 0"),
        ({"late": "baked", "temperature": 10.0}, "does not support air=Air"),
        ({"motion": True, "response_seconds": 0.004}, "at least two bins"),
    ],
)
def test_unusable_values_are_refused(options, message):
    with pytest.raises(ConfigError, match=message):
        override_fields(AudioConfig(), options)


def test_configs_are_hashable_and_compare_by_value():
    assert hash(AudioConfig()) == hash(AudioConfig(timing=Timing(sample_rate=16000)))
    assert AudioConfig() != AudioConfig(late=Traced(num_rays=65))


def test_memory_of_what_moves():
    """A response of 125 bins of 64 samples; 62 of them ring on twice in 0.4 s, and filters of the tail for 16 ms."""
    assert AudioConfig().memory_length == AudioConfig().response_length == 8000
    assert AudioConfig(motion=Motion(tail_seconds=0.0)).memory_length == 8000
    assert AudioConfig(motion=Motion(tail_seconds=0.4)).memory_length == 8000 + 2 * 62 * 64 + 256


def test_presets():
    """Two are looked up, one is traced; traced, each flies more than the one before; options may differ."""
    assert [audio_preset(name).late for name in PRESETS] == [Baked(), Baked(), audio_preset("reference").traced]
    traced = [audio_preset(name, late="traced") for name in PRESETS]
    rays = [config.traced.num_rays * config.traced.num_bounces for config in traced]
    assert rays == sorted(rays)
    assert len(set(rays)) == 3
    assert [config.early.reflection_order for config in traced] == [1, 2, 3]
    for name in PRESETS:  # each is to be had with late sound that has been baked
        assert audio_preset(name, late="baked").early.reflection_order == 1
    balanced = PRESETS["balanced"]
    assert audio_preset("balanced", num_edges=0) == replace(balanced, early=replace(balanced.early, num_edges=0))
    assert audio_preset("fast", late=Traced(num_rays=9)).late == audio_preset("fast", late="traced", num_rays=9).late
    assert audio_preset("fast", receiver=Omni()) == audio_preset("fast", receiver="omni")
    assert audio_preset("fast", motion=None).motion is audio_preset("fast", motion=False).motion is None
    with pytest.raises(ConfigError, match="Did you mean `fast`"):
        audio_preset("fats")
    with pytest.raises(ConfigError, match="num_rays"):
        audio_preset("fast", late="traced", num_rays=0)
    with pytest.raises(ConfigError, match="multiple of 7, got 100"):
        audio_preset("reference", num_rays=100)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"late": "baked", "num_rays": 9}, "num_rays` has no effect with Baked. Set .* to 'traced' too"),
        ({"late": "none", "detector": "sphere"}, "detector` has no effect with NoLate"),
        ({"receiver": "omni", "pinna": True}, "pinna` has no effect with Omni"),
        ({"receiver": "ambisonics", "positions": ((0, 0, 0),)}, "positions` has no effect with Ambisonics"),
        ({"motion": None, "tail_seconds": 0.4}, "tail_seconds` has no effect with None. Set .* to True too"),
        ({"motion": 1}, "unknown `.*motion` 1"),
        ({"early": "home"}, "early` must be .*EarlyPaths"),
        ({"microphones": ((0, 0, 0),)}, "unknown option `microphones`"),
        ({"num_heard": 8}, "unknown option `num_heard`"),
    ],
)
def test_no_option_is_ignored(options, message):
    with pytest.raises(ConfigError, match=message):
        make_config(**options)
    with pytest.raises(ConfigError, match=message):
        audio_preset("balanced", **{"late": "traced", "motion": None, **options})


def test_words_and_flat_names_select_records():
    air, few = Air(temperature=10.0), Traced(num_rays=7)
    traced = {"audio": AudioConfig(), "late": "traced", "temperature": 10.0}
    named = make_config(receiver="array", positions=[[0, 0, 0.1]], motion=True, tail_seconds=0.5, **traced)
    array = MicrophoneArray(((0.0, 0.0, 0.1),))
    assert named.audio == AudioConfig(air=air, receiver=array, motion=Motion(tail_seconds=0.5))
    assert make_config().audio == audio_preset("balanced")
    assert make_config(**{"audio.late": "traced", "audio.late.num_rays": 7}).audio == replace(
        audio_preset("balanced"), late=few
    )
    assert make_config(audio=audio_preset("fast"), tail_seconds=0.5).audio.motion == Motion(8, 0.5)
    assert make_config(receiver=Omni()).audio == audio_preset("balanced", receiver="omni")
    assert make_config(pinna=True).audio.receiver == Binaural(pinna=True)


def test_configs_are_kept_as_json():
    configs = [*(audio_preset(name, late=late) for name in PRESETS for late in ("traced", "baked"))]
    configs += [AudioConfig(receiver=MicrophoneArray(((0, 0, 0.1),)), motion=None), AudioConfig(late=NoLate())]
    for config in configs:
        again = from_json(to_json(config))
        assert again == config
        assert hash(again) == hash(config)
