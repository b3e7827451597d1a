"""JaxMARL's base class, wrappers and loops take the adapter; every transition is that of the core."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("jaxmarl", reason="needs the extra `multiagent`")

from adapted import CHEAP, assert_equal, cases, cheap
from checkers import NUM_ENVS, check_jaxmarl
from jaxmarl.environments import spaces
from jaxmarl.wrappers.baselines import CTRolloutManager, LogWrapper

from home_mjx.adapters.jaxmarl import JaxMarlEnv
from home_mjx.errors import ConfigError

TEAMS = [(2, "discrete"), (1, "continuous"), (3, "continuous")]


@pytest.mark.parametrize(("env_id", "num_agents", "actions"), cases(*TEAMS))
def test_a_loop_like_those_of_jaxmarl(env_id, num_agents, actions, generated_bank):
    check_jaxmarl(env_id, generated_bank, num_agents=num_agents, actions=actions, impl="fused")


@pytest.fixture(scope="module")
def pair(generated_bank):
    options = {"num_agents": 2, "actions": "discrete", "sensors": ("state", "goal"), "episode_length": 2}
    return JaxMarlEnv(cheap("PointNav-v0", generated_bank, **options))


def test_step_is_reset_after_step_env(pair):
    """Where an episode ends: after `reset_state`, from that state; otherwise the two agree."""
    key, actions = jax.random.key(0), {"agent_0": jnp.int32(1), "agent_1": jnp.int32(2)}
    obs, first = pair.reset(key)
    again = pair.get_obs(first)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-6), obs, again)
    plain, auto, given = (
        pair.step_env(key, first, actions),
        pair.step(key, first, actions),
        pair.step(key, first, actions, first),
    )
    for other in (auto, given):
        jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-5), plain, other)
    second = plain[1]
    ended = pair.step(key, second, actions, first)
    assert bool(ended[3]["__all__"])
    assert_equal(ended[1], first)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-6), ended[0], obs)
    _, renewed, *_ = pair.step(key, second, actions)
    assert int(renewed.world.step) == 0
    assert (renewed.world.key != first.world.key).any()


@pytest.mark.slow
def test_last_observations_are_kept_on_request(pair):
    key = jax.random.key(0)
    env = JaxMarlEnv(pair.env, final_obs=True)
    actions = dict.fromkeys(env.agents, jnp.int32(1))
    _, state = env.reset(key)
    for _ in range(2):
        last, (obs, state, _, dones, infos) = env.step_env(key, state, actions)[0], env.step(key, state, actions)
        jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-5), infos["final_obs"], last)
    assert bool(dones["__all__"])
    assert (obs["agent_0"] != infos["final_obs"]["agent_0"]).any()


def test_the_wrapper_of_policy_gradient_trainers(pair):
    key, logged = jax.random.key(0), LogWrapper(pair)
    _, state = logged.reset(key)
    for _ in range(2):
        _, state, _, _, info = logged.step(key, state, dict.fromkeys(pair.agents, jnp.int32(1)))
    np.testing.assert_array_equal(info["returned_episode"], [True, True])
    np.testing.assert_array_equal(info["returned_episode_lengths"], [2, 2])


@pytest.mark.slow
def test_the_wrapper_of_q_learning_trainers(pair):
    key, manager = jax.random.key(0), CTRolloutManager(pair, batch_size=NUM_ENVS)
    size = pair.observation_space("agent_0").shape[0]
    obs, state = manager.batch_reset(key)
    assert obs["agent_1"].shape == (NUM_ENVS, size + 2)
    actions = {agent: manager.batch_sample(key, agent) for agent in pair.agents}
    obs, _, rewards, _, _ = manager.batch_step(key, state, actions)
    assert obs["__all__"].shape == (NUM_ENVS, 2 * size)
    np.testing.assert_allclose(rewards["__all__"], rewards["agent_0"] + rewards["agent_1"], rtol=1e-6)


def test_spaces_actions_and_classes(pair):
    assert isinstance(pair.observation_space("agent_0"), spaces.Box)
    assert isinstance(pair.action_space("agent_1"), spaces.Discrete)
    _, state = pair.reset(jax.random.key(0))
    assert {agent: mask.tolist() for agent, mask in pair.get_avail_actions(state).items()} == {
        "agent_0": [True] * 6,
        "agent_1": [True] * 6,
    }
    assert pair.agent_classes == {"agent": ["agent_0", "agent_1"]}


def test_what_cannot_be_driven_is_refused(pair, generated_bank):
    _, state = pair.reset(jax.random.key(0))
    with pytest.raises(ConfigError, match="agent_0, agent_1; got agent_1"):
        pair.step(jax.random.key(0), state, {"agent_1": jnp.int32(0)})
    blind = cheap("PointNav-v0", generated_bank, **{**CHEAP, "sensors": ("depth",), "width": 4, "height": 4})
    with pytest.raises(ConfigError, match="no vector"):
        JaxMarlEnv(blind)


def test_a_vector_without_words_says_so(generated_bank):
    sensors = ("state", "goal_words", "heard_words")
    env = cheap("Communication-v0", generated_bank, **{**CHEAP, "sensors": sensors, "actions": "discrete"})
    with pytest.warns(UserWarning, match="omits goal_words, heard_words"):
        JaxMarlEnv(env)
    space = JaxMarlEnv(env, vector=False).observation_space("agent_1")
    assert set(space.spaces) == set(sensors)
