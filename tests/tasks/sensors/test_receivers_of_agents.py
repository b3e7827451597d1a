"""What agents hear has as many channels as their receiver."""

import jax
import pytest
from handmade import shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import AudioConfig
from home_mjx.audio_jax.base.options import Ambisonics, MicrophoneArray, Motion
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config

OPTIONS = {"impl": "kinematic", "actions": "discrete"}
THREE = ((0.1, 0, 0), (-0.1, 0, 0), (0, 0, 0.1))


@pytest.mark.parametrize("motion", [None, Motion()])
@pytest.mark.parametrize(("receiver", "count"), [(MicrophoneArray(THREE), 3), (Ambisonics(), 4)])
def test_observations_follow_the_receiver(receiver, count, motion):
    """As declared, in resets and steps; nothing is compiled."""
    audio = AudioConfig(receiver=receiver, motion=motion, response_seconds=0.1)
    config = make_config(audio=audio, sensors=("audio", "stft", "log_mel"), **OPTIONS)
    env = HouseholdEnv(config).bind(HouseBank.from_compiled([shoebox()]))
    state = jax.eval_shape(env.reset, jax.random.key(0))
    later = jax.eval_shape(env.step, state, 0)
    for name in ("audio", "stft", "log_mel"):
        shape = env.observation_spec[name].shape
        assert shape[0] == count
        assert state.obs[name].shape == later.obs[name].shape == shape


def test_levels_of_ears_want_ears():
    config = make_config(audio=AudioConfig(receiver=Ambisonics()), sensors=("ear_levels",), **OPTIONS)
    with pytest.raises(ConfigError, match="two ears"):
        _ = HouseholdEnv(config).bind(HouseBank.from_compiled([shoebox()])).observation_spec
