"""PettingZoo's own checkers judge the adapter."""

import pickle

import gymnasium
import numpy as np
import pytest

pytest.importorskip("pettingzoo", reason="needs the extra `multiagent`")

from adapted import CHEAP, cases
from checkers import check_pettingzoo

from home_mjx.adapters.gymnasium import GymEnv
from home_mjx.adapters.pettingzoo import PettingZooEnv
from home_mjx.errors import ConfigError

TEAMS = [(2, "discrete"), (1, "continuous"), (3, "discrete"), (1, "discrete"), (2, "continuous"), (3, "continuous")]


@pytest.mark.parametrize(("env_id", "num_agents", "actions"), cases(*TEAMS))
def test_pettingzoo_accepts(env_id, num_agents, actions, generated_bank):
    check_pettingzoo(env_id, generated_bank, num_agents=num_agents, actions=actions, impl="fused")


@pytest.fixture(scope="module")
def pair(generated_bank):
    return PettingZooEnv(houses=generated_bank, num_agents=2, render_mode="rgb_array", render_size=(8, 6), **CHEAP)


def test_each_agent_has_its_part_of_what_gymnasium_gives(pair, generated_bank):
    gym = GymEnv(houses=generated_bank, num_agents=2, **CHEAP)
    whole, _ = gym.reset(seed=3)
    obs, infos = pair.reset(seed=3)
    assert pair.agents == list(obs) == list(infos) == ["agent_0", "agent_1"]
    for number in range(1, 6):
        actions = {agent: pair.action_space(agent).sample() for agent in reversed(pair.agents)}
        whole, _, terminated, truncated, info = gym.step(np.stack([actions["agent_0"], actions["agent_1"]]))
        obs, rewards, terminations, truncations, infos = pair.step(actions)
        for i, agent in enumerate(pair.possible_agents):
            np.testing.assert_array_equal(obs[agent]["state"], whole["state"][i])
            assert pair.observation_space(agent).contains(obs[agent])
            assert rewards[agent] == info["agent_reward"][i]
            assert (terminations[agent], truncations[agent]) == (terminated, truncated)
            assert infos[agent]["house"] == info["house"]
        assert truncated == (number == 5)
    assert pair.agents == []
    assert pair.step({}) == ({}, {}, {}, {}, {})


def test_every_agent_must_act(pair):
    pair.reset(seed=0)
    action = np.zeros(4, np.float32)
    with pytest.raises(ConfigError, match="agent_0, agent_1; got agent_1"):
        pair.step({"agent_1": action})
    with pytest.raises(ConfigError, match="agent_2"):
        pair.step(dict.fromkeys(["agent_0", "agent_1", "agent_2"], action))
    with pytest.raises(ConfigError, match="one shape"):
        pair.step({"agent_0": action, "agent_1": np.zeros(3, np.float32)})
    with pytest.raises(ConfigError, match="hous"):
        pair.reset(options={"hous": 1})


def test_after_the_end_and_before_the_first_reset_no_action_is_taken(generated_bank):
    env = PettingZooEnv(houses=generated_bank, **CHEAP)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step({"agent_0": np.zeros(4, np.float32)})


def test_spaces_of_agents_are_seeded_apart(pair):
    one, other = (pair.action_space(agent) for agent in pair.possible_agents)
    one.seed(1)
    other.seed(2)
    assert (one.sample() != other.sample()).any()


def test_houses_pictures_and_pickles(pair):
    _, infos = pair.reset(seed=1, options={"house": 1})
    assert infos["agent_0"]["house"] == infos["agent_1"]["house"] == 1
    assert pair.render().shape == (6, 8, 3)
    twin = pickle.loads(pickle.dumps(pair))
    np.testing.assert_array_equal(twin.reset(seed=1)[0]["agent_1"]["state"], pair.reset(seed=1)[0]["agent_1"]["state"])
