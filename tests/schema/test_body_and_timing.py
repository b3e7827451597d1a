"""The body and the clock: one record each, refused when they make no sense."""

import pytest

from home_mjx.audio_jax import AudioConfig
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsSetup
from home_mjx.schema import AgentBody, Timing

NAN = float("nan")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"mass": NAN}, r"`body\.mass`"),
        ({"mass": 0.0}, r"`body\.mass`"),
        ({"radius": -0.1}, r"`body\.radius`"),
        ({"height": 0.2}, r"`body\.height` 0\.2 m is not above twice"),
        ({"eye_height": 3.0, "height": 1.0}, r"`body\.eye_height` 3\.0 m is above `body\.height` 1\.0 m"),
        ({"eye_height": NAN}, r"`body\.eye_height`"),
    ],
)
def test_impossible_bodies_are_refused(options, words):
    with pytest.raises(ConfigError, match=words):
        AgentBody(**options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"ctrl_dt": 0.095}, "not a whole number of `sim_dt`"),
        ({"ctrl_dt": 0.005}, "not a whole number of `sim_dt`"),
        ({"sim_dt": 0.0}, "`sim_dt`"),
        ({"sample_rate": 22050, "ctrl_dt": 0.033, "sim_dt": 0.033}, "whole number of samples, got 727.65"),
        ({"sample_rate": 0}, "`sample_rate`"),
        ({"sample_rate": 10**30}, "`sample_rate`"),
        ({"ctrl_dt": 1e308}, "`ctrl_dt`"),
        ({"ctrl_dt": 1e308, "sim_dt": 1e308}, "`ctrl_dt`"),
    ],
)
def test_impossible_clocks_are_refused(options, words):
    with pytest.raises(ConfigError, match=words):
        Timing(**options)


def test_a_step_is_a_whole_number_of_physics_steps_and_samples():
    assert (Timing().substeps, Timing().frame) == (10, 1600)
    assert Timing(sim_dt=0.1 / 3, ctrl_dt=0.1).substeps == 3  # not exact in binary
    assert Timing(sample_rate=48000, ctrl_dt=0.05, sim_dt=0.025).frame == 2400


@pytest.mark.parametrize("config", [PhysicsSetup, AudioConfig])
def test_engines_take_the_same_clock(config):
    clock = Timing(ctrl_dt=0.2)
    assert config(timing=clock).timing is clock
