"""Actions that are words: what they are called, what they say, who is refused."""

import functools
from dataclasses import dataclass

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.adapters.base.spaces import DiscreteSpace
from home_mjx.adapters.gymnax import GymnaxEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import EnvConfig, HouseholdEnv, Task, make_config
from home_mjx.tasks.base.specs import MOVE_NAMES
from home_mjx.tasks.env.actions import action_names, decode_actions
from home_mjx.tasks.env.spaces import action_space
from home_mjx.tasks.language import tokenize

WORDS = ("say:yes", "answer:red", "say:kitchen")
TOKENS = [-1] * 6 + list(tokenize("yes red kitchen"))
DISCRETE = {"actions": "discrete", "sensors": ("state",), "impl": "kinematic"}


@dataclass(frozen=True)
class Talks(Task):
    """Agents may say three words."""

    @property
    def speech(self):
        return WORDS


@dataclass(frozen=True)
class Pair(Task):
    """For two."""

    @property
    def min_agents(self):
        return 2


def test_words_follow_moves_and_move_nothing():
    config = make_config(speech=WORDS, num_agents=2, **DISCRETE)
    assert action_names(config) == (*MOVE_NAMES, *WORDS)
    for number, token in enumerate(TOKENS):
        moves = decode_actions(config, jnp.array([number, 0]), jnp.zeros(2, bool))
        assert moves.spoken_token.tolist() == [token, -1]
        assert moves.stopped.tolist() == [number == 0, True]
        assert not bool(moves.is_invalid)
        if number >= len(MOVE_NAMES):
            assert not np.asarray(moves.drive).any()
            assert not np.asarray(moves.look).any()


def test_who_has_stopped_is_silent_and_numbers_beyond_say_nothing():
    config = make_config(speech=WORDS, num_agents=2, **DISCRETE)
    moves = decode_actions(config, jnp.array([6, 9]), jnp.array([True, False]))
    assert moves.spoken_token.tolist() == [-1, -1]
    assert bool(moves.is_invalid)


def test_hands_come_before_words():
    names = action_names(make_config(speech=WORDS, hands=True, **DISCRETE))
    assert names[-4:] == ("close", *WORDS)


def test_the_tasks_words_are_added_once():
    core = HouseholdEnv(make_config(speech=("say:no", "say:yes"), **DISCRETE), Talks())
    assert core.action_names[6:] == ("say:no", "say:yes", "answer:red", "say:kitchen")
    again = HouseholdEnv(core.config, core.task)
    assert again.config == core.config
    assert again.action_spec.high == 9
    assert HouseholdEnv(make_config(**DISCRETE)).action_names == MOVE_NAMES


def test_what_is_said_is_in_the_next_state_and_every_space_has_it(generated_bank):
    env = HouseholdEnv(make_config(**DISCRETE), Talks()).bind(generated_bank)
    assert action_space(env) == gymnasium.spaces.Discrete(9)
    space = GymnaxEnv(env).action_space()
    assert isinstance(space, DiscreteSpace)
    assert space.n == 9
    state = jax.jit(functools.partial(env.core.reset, observe=False))(env.params, jax.random.key(0))
    assert state.world.spoken_token.tolist() == [-1]
    step = jax.jit(functools.partial(env.core.step, observe=False))
    spoken = step(env.params, state, jnp.int32(7))
    assert env.core.snapshot(env.params, spoken).spoken_token.tolist() == [TOKENS[7]]
    np.testing.assert_array_equal(spoken.world.stopped, [False])
    assert step(env.params, spoken, jnp.int32(1)).world.spoken_token.tolist() == [-1]


@pytest.mark.parametrize("word", ["yes", "shout:yes", "say:", "say:blorb", "say:yes no"])
def test_what_is_no_word_is_refused(word):
    with pytest.raises(ConfigError):
        HouseholdEnv(EnvConfig(actions="discrete", speech=(word,)))


def test_speaking_needs_discrete_actions_and_some_tasks_several_agents():
    with pytest.raises(ConfigError, match="speak"):
        HouseholdEnv(EnvConfig(), Talks())
    with pytest.raises(ConfigError, match="speak"):
        HouseholdEnv(EnvConfig(speech=WORDS))
    with pytest.raises(ConfigError, match="2 agents"):
        HouseholdEnv(EnvConfig(), Pair())
    assert HouseholdEnv(make_config(num_agents=2), Pair()).num_agents == 2
