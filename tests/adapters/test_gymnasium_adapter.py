"""Gymnasium's own checkers judge the adapter."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import home_mjx  # noqa: F401, registers the ids
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.errors import ConfigError

SMALL = {"width": 16, "height": 16, "num_rays": 16, "num_bounces": 3, "episode_length": 5}


def test_check_env(generated_bank):
    env = gymnasium.make("home_mjx/PointNav-v0", houses=generated_bank, render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    obs, _ = env.reset(seed=1)
    again, _ = env.reset(seed=1)
    for name in obs:
        np.testing.assert_array_equal(obs[name], again[name])
    assert env.render().shape == (16, 16, 3)


def test_the_house_can_be_chosen(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    assert [env.reset(options={"house": i})[1]["house"] for i in (1, 0)] == [1, 0]


@pytest.mark.parametrize("options", [{"house": 2}, {"house": -1}, {"house": 1.0}, {"house": "a"}, {"hous": 1}])
def test_other_options_of_reset_are_refused(generated_bank, options):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    with pytest.raises(ConfigError, match="hous"):
        env.reset(options=options)


def test_actions_outside_of_the_space_are_refused(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    env.reset(seed=0)
    with pytest.raises(ConfigError, match="NaN"):
        env.step(np.full(4, np.nan))
    with pytest.raises(ConfigError, match="shape"):
        env.step(np.zeros((2, 2)))


def test_what_cannot_be_made_is_refused(generated_bank):
    with pytest.raises(ConfigError, match="rgb"):
        GymEnv(houses=generated_bank, sensors=("depth",), render_mode="rgb_array")
    with pytest.raises(ConfigError, match="num_envs"):
        GymVectorEnv(0, houses=generated_bank)


def test_stepping_before_reset_is_refused(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(4))


def test_vector_env_resets_in_the_same_step(generated_bank):
    env = gymnasium.make_vec(
        "home_mjx/PointNav-v0", num_envs=3, houses=generated_bank, sensors=("state", "goal"), episode_length=2
    )
    assert isinstance(env.unwrapped, GymVectorEnv)
    obs, _ = env.reset(seed=0)
    assert env.observation_space.contains(obs)
    env.step(env.action_space.sample())
    obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
    assert reward.shape == (3,)
    assert (terminated | truncated).all()
    assert info["_final_obs"].all()
    assert not np.allclose(info["final_obs"]["state"], obs["state"])
