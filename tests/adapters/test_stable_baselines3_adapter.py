"""The `VecEnv` keeps the contract of Stable-Baselines3, also where that is not installed."""

import importlib
import sys

import numpy as np
import pytest
from adapted import CHEAP
from vec_env_contract import check_vec_env, stub

from home_mjx.errors import ConfigError

NUM_ENVS = 3
OPTIONS = {**CHEAP, "sensors": ("state", "goal"), "impl": "kinematic", "actions": "discrete"}


@pytest.fixture(scope="module")
def adapter():
    """The adapter, on the package's base class or what stands for it."""
    with pytest.MonkeyPatch.context() as patch:
        for name, module in stub().items():
            patch.setitem(sys.modules, name, module)
        patch.delitem(sys.modules, "home_mjx.adapters.stable_baselines3", raising=False)
        yield importlib.import_module("home_mjx.adapters.stable_baselines3")
        sys.modules.pop("home_mjx.adapters.stable_baselines3", None)


@pytest.fixture(scope="module")
def envs(adapter, generated_bank):
    return adapter.BatchVecEnv(NUM_ENVS, "PointNav-v0", houses=generated_bank, stop=True, **OPTIONS)


def test_the_contract_holds(envs):
    assert check_vec_env(envs, num_steps=12) >= 2 * NUM_ENVS


def test_steps_are_those_of_the_gymnasium_batch(envs):
    """Bit for bit, with the last observations of ended episodes."""
    from home_mjx.adapters.gymnasium import GymVectorEnv

    other = GymVectorEnv.__new__(GymVectorEnv)
    other.__dict__ = dict(envs.batch.__dict__)  # the same programs, with a state of its own
    envs.seed(5)
    obs, (expected, _) = envs.reset(), other.reset(seed=5)
    for number in range(7):
        np.testing.assert_equal(obs, expected)
        actions = np.full(NUM_ENVS, number % envs.action_space.n)
        obs, rewards, dones, infos = envs.step(actions)
        expected, wanted, terminated, truncated, told = other.step(actions)
        np.testing.assert_array_equal(rewards, wanted.astype(np.float32))
        np.testing.assert_array_equal(dones, terminated | truncated)
        for i in range(NUM_ENVS):
            assert infos[i]["distance"] == told["distance"][i]
            assert infos[i]["is_success"] == (told["success"][i] > 0)
            assert infos[i]["TimeLimit.truncated"] == (truncated[i] and not terminated[i])
            if dones[i]:
                np.testing.assert_equal(
                    infos[i]["terminal_observation"], {name: x[i] for name, x in told["final_obs"].items()}
                )


def test_options_of_a_reset_select_houses(envs):
    envs.set_options({"house": 1})
    envs.reset()
    assert [info["house"] for info in envs.reset_infos] == [1] * NUM_ENVS
    envs.set_options([{"house": i % 2} for i in range(NUM_ENVS)])
    envs.reset()
    assert [info["house"] for info in envs.reset_infos] == [i % 2 for i in range(NUM_ENVS)]
    envs.set_options([{"house": 0}, {}, {}])
    with pytest.raises(ConfigError, match="the same options in all environments"):
        envs.reset()
    envs.set_options()


def test_what_a_batch_cannot_do_is_refused(adapter, envs):
    envs.reset()
    with pytest.raises(ConfigError, match="there are no actions"):
        envs.step_wait()
    with pytest.raises(ConfigError, match="`width` of single environments cannot be set"):
        envs.set_attr("width", 3)
    with pytest.raises(ConfigError, match="`compute_reward` cannot be called"):
        envs.env_method("compute_reward")
    with pytest.raises(ConfigError, match="autoreset_mode"):
        adapter.BatchVecEnv(2, autoreset_mode="NextStep")


def test_ppo_learns_on_the_batch(envs):
    sb3 = pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")
    if not hasattr(sb3, "PPO"):
        pytest.skip("Stable-Baselines3 is not installed")
    from stable_baselines3.common.vec_env import VecMonitor

    monitored = VecMonitor(envs, info_keywords=("success", "spl"))
    model = sb3.PPO("MultiInputPolicy", monitored, n_steps=8, batch_size=12, n_epochs=1, seed=0)
    model.learn(48)
    assert model.num_timesteps == 48
    assert {"r", "l", "success", "spl"} <= model.ep_info_buffer[0].keys()
    assert len(model.ep_success_buffer) >= 6
