"""What agents hear as spectra, hold, did last and got for it."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx import AutoReset, HouseBank, HouseholdEnv
from home_mjx.audio_jax import log_mel, stft_magnitude
from home_mjx.errors import ConfigError
from home_mjx.schema.categories import COARSE, FINE
from home_mjx.tasks import make_config
from home_mjx.tasks.env.actions import decode_actions

SENSES = ("prev_action", "prev_reward", "held_object")
SOUNDS = ("log_mel", "stft")
FEW = {"late": "traced", "num_rays": 4, "num_bounces": 1, "num_edges": 0}
OPTIONS = {"impl": "kinematic", "actions": "discrete", "hands": True, **FEW}
LENGTH = 2
FORWARD, LEFT = 1, 2


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=[Furniture((1.0, 1.0), (0.2, 0.2, 0.2), mass=0.5)])])


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(make_config(sensors=(*SENSES, *SOUNDS), episode_length=LENGTH, **OPTIONS)).bind(bank)


@pytest.fixture(scope="module")
def steps(env):
    """States of two environments, reset and after 1, 2 and 3 steps; they begin anew after two."""
    batch = AutoReset(env.core, "none").bind(env.params)
    step, states = jax.jit(batch.step), [jax.jit(batch.reset)(jax.random.split(jax.random.key(0), 2))]
    for moves in ([FORWARD, LEFT], [LEFT, FORWARD], [LEFT, LEFT]):
        states.append(step(states[-1], jnp.array(moves, jnp.int32)))
    return states


def test_the_last_action_is_told_until_the_episode_ends(env, steps):
    told = [np.asarray(state.obs["prev_action"]) for state in steps]
    assert env.observation_spec["prev_action"].shape == told[0].shape[1:] == (env.action_size,)
    one = np.eye(env.action_size)
    np.testing.assert_array_equal(told[0], 0)
    np.testing.assert_array_equal(told[1], one[[FORWARD, LEFT]])
    np.testing.assert_array_equal(told[2], 0)  # the first observation of the next episode
    np.testing.assert_array_equal(told[3], one[[LEFT, LEFT]])


def test_the_last_reward_is_told_until_the_episode_ends(steps):
    told = [np.asarray(state.obs["prev_reward"])[:, 0] for state in steps]
    np.testing.assert_array_equal(told[1], steps[1].reward)
    assert (told[1] != 0).all()
    np.testing.assert_array_equal([told[0], told[2]], 0)
    assert (np.asarray(steps[2].reward) != 0).all()


def test_continuous_actions_are_told_as_they_were_understood():
    config = make_config(sensors=("prev_action",))
    moves = decode_actions(config, jnp.array([0.5, -3.0, jnp.nan, 1.0]), jnp.zeros(1, bool))
    np.testing.assert_array_equal(moves.action, [[0.5, -1, 0, 1]])


def test_no_action_and_a_second_stop_are_told_as_such():
    config = make_config(actions="discrete", num_agents=2)
    moves = decode_actions(config, jnp.array([99, FORWARD]), jnp.array([False, True]))
    np.testing.assert_array_equal(moves.action, [[0] * 6, [1, 0, 0, 0, 0, 0]])


def test_what_the_hand_holds_is_told_in_words(env, steps):
    state = jax.tree.map(lambda x: x[0], steps[1])
    np.testing.assert_array_equal(state.obs["held_object"], -1)
    holds = state.replace(physics=state.physics.replace(held=jnp.zeros_like(state.physics.held)))
    fine, coarse, *_ = np.asarray(jax.jit(env.observe)(holds).obs["held_object"]).tolist()
    assert (FINE[fine], COARSE[coarse]) == ("ottoman", "ottoman")


def test_spectra_are_those_of_the_sound_that_is_computed_once(env, steps):
    assert set(steps[1].obs) == {*SENSES, *SOUNDS}  # no `audio`: it is not asked for
    assert set(steps[1].world.sensor_states) == {*SENSES, "audio"}
    frame = steps[1].world.sensor_states["audio"].frame[:, 0]
    magnitude = stft_magnitude(frame, 16000)
    np.testing.assert_allclose(steps[1].obs["stft"], magnitude, atol=1e-6)
    np.testing.assert_allclose(steps[1].obs["log_mel"], log_mel(magnitude, 16000), atol=0.01)
    assert np.abs(magnitude).max() > 1e-4
    for name in SOUNDS:
        assert env.observation_spec[name].shape == steps[1].obs[name].shape[1:]


def test_asking_for_spectra_beside_the_sound_traces_no_more_rays(bank):
    def length(*sensors):
        core = HouseholdEnv(make_config(sensors=sensors, **OPTIONS))
        env = core.bind(bank)
        state = jax.eval_shape(core.reset, env.params, jax.random.key(0))
        text = str(jax.make_jaxpr(functools.partial(core.observe, update=True))(env.params, state))
        return text.count("while[") + text.count("scan[")

    assert length("audio", "log_mel", "stft") == length("audio") > length("state")


def test_a_frame_too_short_for_a_spectrum_is_refused():
    with pytest.raises(ConfigError, match="spectrogram"):
        HouseholdEnv(make_config(sensors=("log_mel",), ctrl_dt=0.02))
