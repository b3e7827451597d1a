"""Playground's registry, wrappers and trainer take the adapter."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("mujoco_playground", reason="needs the extra `playground`")

from adapted import CHEAP, assert_equal
from checkers import check_playground
from mujoco_playground import registry
from mujoco_playground import wrapper as playground_wrapper

import home_mjx
from home_mjx.adapters.brax import BraxEnv
from home_mjx.adapters.playground import PlaygroundEnv, default_config, register, wrap_for_training
from home_mjx.errors import ConfigError
from home_mjx.training import brax_compat


def test_every_id_is_in_the_registry():
    register()
    assert set(home_mjx.list_envs()) <= set(registry.ALL_ENVS)
    assert len(registry.ALL_ENVS) == len(set(registry.ALL_ENVS))
    assert registry.get_domain_randomizer("PointNav-v0") is None
    assert registry.get_default_config("PointNav-v0").ctrl_dt == 0.1


def test_playgrounds_wrapper_steps_it(generated_bank):
    check_playground("PointNav-v0", generated_bank)


@pytest.fixture(scope="module")
def env(generated_bank):
    return PlaygroundEnv(config_overrides={**CHEAP, "houses": generated_bank})


def test_steps_are_those_of_brax(env):
    brax = BraxEnv(env.brax.env)
    key, action = jax.random.PRNGKey(1), jnp.full(4, 0.5)
    ours, theirs = jax.jit(env.reset)(key), jax.jit(brax.reset)(key)
    assert_equal((ours.data, ours.obs), (theirs.pipeline_state, theirs.obs))
    ours, theirs = jax.jit(env.step)(ours, action), jax.jit(brax.step)(theirs, action)
    assert_equal((ours.data, ours.obs, ours.reward), (theirs.pipeline_state, theirs.obs, theirs.reward))


@pytest.mark.slow
def test_full_resets_begin_elsewhere(env):
    wrapped = playground_wrapper.wrap_for_brax_training(env, episode_length=1, full_reset=True)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.PRNGKey(0), 2))
    new = jax.jit(wrapped.step)(state, jnp.zeros((2, 4)))
    assert (new.done == 1).all()
    assert (new.obs["state"] != state.obs["state"]).any(axis=-1).all()


def test_our_wrapper_begins_elsewhere(env):
    wrapped = wrap_for_training(env, episode_length=1)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.PRNGKey(0), 2))
    new = jax.jit(wrapped.step)(state, jnp.zeros((2, 4)))
    assert (new.done == 1).all()
    assert (new.info["truncation"] == 1).all()
    assert (new.obs["state"] != state.obs["state"]).any(axis=-1).all()


def test_options(generated_bank):
    config = default_config()
    config.friction = 0.5
    config.width = 32
    overrides = {"houses": generated_bank, "task.success_distance": 0.3, "sensors": ("state",), "ctrl_dt": 0.2}
    env = PlaygroundEnv(config, overrides)
    made = env.brax.env
    assert (made.config.physics.friction, made.config.width, made.task.success_distance) == (0.5, 32, 0.3)
    assert (env.dt, env.sim_dt, env.n_substeps) == (0.2, made.config.timing.sim_dt, made.config.timing.substeps)
    assert "friction" not in default_config()
    with pytest.raises(ConfigError, match="episode_length"):
        PlaygroundEnv(config_overrides={"episode_lenght": 3})
    with pytest.raises(ConfigError, match="ctrl_dt"):
        PlaygroundEnv(config_overrides={"action_repeat": 2})


@pytest.mark.parametrize("name", ["xml_path", "mj_model", "mjx_model"])
def test_there_is_no_model_of_a_household(env, name):
    with pytest.raises(ConfigError, match=name):
        getattr(env, name)


def test_randomisation_of_a_model_is_refused(env):
    with pytest.raises(ConfigError, match="num_houses"):
        playground_wrapper.wrap_for_brax_training(env, randomization_fn=lambda model: (model, None))


def test_pictures(env):
    state = jax.jit(env.reset)(jax.random.PRNGKey(0))
    pictures = env.render([state, state], height=6, width=8)
    assert [picture.shape for picture in pictures] == [(6, 8, 3)] * 2
    np.testing.assert_array_equal(env.render(state, height=6, width=8), pictures[0])
    assert np.ptp(pictures[0]) > 0
    with pytest.raises(ConfigError, match="camera"):
        env.render([state], camera="track")


@pytest.mark.slow
@pytest.mark.parametrize("wrap", [playground_wrapper.wrap_for_brax_training, wrap_for_training])
def test_ppo_trains(env, wrap):
    brax_compat.install()
    from brax.training.agents.ppo import networks, train

    small = {"policy_hidden_layer_sizes": (8,), "value_hidden_layer_sizes": (8,)}
    records = []
    train.train(
        env,
        num_timesteps=64,
        episode_length=4,
        num_envs=4,
        batch_size=4,
        num_minibatches=2,
        unroll_length=4,
        num_updates_per_batch=1,
        num_eval_envs=2,
        max_devices_per_host=1,
        wrap_env_fn=wrap,
        network_factory=functools.partial(networks.make_ppo_networks, **small),
        progress_fn=lambda step, metrics: records.append((step, metrics["eval/episode_reward"])),
    )
    assert records[-1][0] >= 64
    assert np.isfinite([float(reward) for _, reward in records]).all()
