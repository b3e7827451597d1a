"""Automatic resets: who ends begins anew, everybody is observed once."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

from home_mjx import AutoReset, HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config

OPTIONS = {"sensors": ("depth", "audio", "state", "goal"), "width": 8, "height": 8, "num_rays": 8, "num_bounces": 2}


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    return HouseBank.from_compiled([shoebox()])


def core_of(**options) -> HouseholdEnv:
    return HouseholdEnv(make_config(**OPTIONS | options))


def keys(num: int):
    return jax.random.split(jax.random.key(0), num)


def casts(function, *args) -> int:
    """Ray casts in a lowered program."""
    return jax.jit(function).lower(*args).as_text().count("home_mjx_cast")


def test_everybody_is_observed_once(bank):
    """Programs of a step with and without automatic resets cast the same rays."""
    core = core_of()
    params = core.bind(bank).params
    states = jax.eval_shape(jax.vmap(core.reset, (None, 0)), params, keys(4))
    plain = casts(jax.vmap(core.step, (None, 0, 0)), params, states, jnp.zeros((4, 4)))
    counts = {}
    for choice in ("none", "cheap", "all"):
        auto = AutoReset(core, choice)
        batch = jax.eval_shape(auto.reset, params, keys(4))
        counts[choice] = casts(auto.step, params, batch, jnp.zeros((4, 4)))
    assert plain > 0
    assert counts == {"none": plain, "cheap": plain, "all": 2 * plain}


@pytest.mark.parametrize("choice", ["cheap", "all"])
def test_final_observations_are_those_before_the_reset(bank, choice):
    """Environments that end at different steps; a twin without resets says what each saw last."""
    core = core_of(episode_length=3)
    params = core.bind(bank).params
    auto = AutoReset(core, choice)
    states = jax.jit(auto.reset)(params, keys(5))
    ages = jnp.array([0, 2, 1, 2, 0], jnp.int32)
    states = states.replace(world=states.world.replace(step=ages))
    action = jnp.tile(jnp.array([1.0, 0.0, 0.5, 0.0]), (5, 1))
    plain = jax.jit(jax.vmap(core.step, (None, 0, 0)))(params, states, action)
    new = jax.jit(auto.step)(params, states, action)
    ended = np.array([False, True, False, True, False])
    np.testing.assert_array_equal(new.truncated | new.terminated, ended)
    assert set(new.info["final_obs"]) == (set(plain.obs) if choice == "all" else {"state", "goal"})
    for name, value in new.info["final_obs"].items():
        np.testing.assert_allclose(value, plain.obs[name], atol=2e-4, err_msg=name)
        np.testing.assert_array_equal(value[~ended], new.obs[name][~ended])
        assert (np.abs(np.asarray(value - new.obs[name], np.float64)[ended]).reshape(2, -1).max(1) > 1e-3).all(), name
    np.testing.assert_array_equal(new.world.step, np.where(ended, 0, ages + 1))
    np.testing.assert_array_equal(new.reward, plain.reward)


def test_more_ends_than_a_chunk_holds(bank, monkeypatch):
    monkeypatch.setattr("home_mjx.tasks.environment.autoreset.CHUNK", 2)
    core = core_of(episode_length=1, sensors=("depth",))
    params = core.bind(bank).params
    auto = AutoReset(core, "all")
    states = jax.jit(auto.reset)(params, keys(5))
    plain = jax.jit(jax.vmap(core.step, (None, 0, 0)))(params, states, jnp.zeros((5, 4)))
    new = jax.jit(auto.step)(params, states, jnp.zeros((5, 4)))
    assert new.done.all()
    final = new.info["final_obs"]["pixels/head_depth"]
    np.testing.assert_allclose(final, plain.obs["pixels/head_depth"], atol=1e-4)


def test_the_sound_begins_anew(bank):
    """The first frame of an episode does not fade from the last one's response."""
    core = core_of(episode_length=1, sensors=("audio",))
    params = core.bind(bank).params
    auto = AutoReset(core)
    states = jax.jit(auto.step)(params, jax.jit(auto.reset)(params, keys(3)), jnp.zeros((3, 4)))
    again = jax.jit(jax.vmap(core.perceive, (None, 0)))(params, states.replace(info={}))
    np.testing.assert_array_equal(states.world.sensors["audio"].phase, 0)
    np.testing.assert_allclose(again.obs["audio"], states.obs["audio"], atol=1e-6)


def test_observing_again_changes_nothing(bank):
    core = core_of()
    params = core.bind(bank).params
    step, observe = jax.jit(core.step), jax.jit(core.observe)
    state = jax.jit(core.reset)(params, jax.random.key(0))
    for _ in range(3):
        state = step(params, state, jnp.array([1.0, 0.0, 1.0, 0.0]))
        again = observe(params, observe(params, state))
        jax.tree.map(np.testing.assert_array_equal, again, state)


def test_scratch_space_is_handed_on(bank):
    core = core_of(sensors=("state",))
    params = core.bind(bank).params
    state = core.reset(params, jax.random.key(0)).replace(info={"mine": jnp.float32(7)})
    assert float(core.step(params, state, jnp.zeros(4)).info["mine"]) == 7


def test_wrong_use_is_refused(bank):
    env = core_of().bind(bank)
    with pytest.raises(ConfigError, match="Did you mean `cheap`"):
        AutoReset(env.core, "cheep")
    with pytest.raises(ConfigError, match="batch of random keys"):
        AutoReset(env.core).bind(bank).reset(jax.random.key(0))
    with pytest.raises(ConfigError, match=r"jax\.random\.key\(0\)"):
        env.reset(0)
    with pytest.raises(ConfigError, match="one random key"):
        env.reset(keys(3))
    with pytest.raises(ConfigError, match="real numbers"):
        env.step(env.reset(jax.random.key(0)), jnp.zeros(4, bool))
    with pytest.raises(ConfigError, match="dictionary of agent_0"):
        env.step(env.reset(jax.random.key(0)), {"agent_0": jnp.zeros(4)})
