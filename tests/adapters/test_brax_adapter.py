"""Brax's PPO trains on the adapter."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("brax", reason="needs the extra `train`")

from brax import envs
from brax.envs.wrappers.training import EvalWrapper
from brax.training.acme import running_statistics, specs
from brax.training.agents.ppo import checkpoint, networks, networks_vision, train

import home_mjx
from home_mjx import registry
from home_mjx.adapters.brax import BraxEnv, register, wrap_for_training
from home_mjx.errors import ConfigError
from home_mjx.tasks import check_status
from home_mjx.training import brax_compat


@pytest.fixture(scope="module")
def brax_env(generated_bank) -> BraxEnv:
    return BraxEnv(
        home_mjx.make("PointNav-v0", generated_bank, width=16, height=16, sensors=("rgb", "depth", "state", "goal"))
    )


def test_observation_sizes(brax_env):
    assert brax_env.observation_size == {
        "pixels/head_rgb": (16, 16, 3),
        "pixels/head_depth": (16, 16, 1),
        "state": (14,),
    }


@pytest.mark.slow
def test_ppo_trains_from_pixels(brax_env):
    brax_compat.install()
    records, policies = [], []
    make_networks = functools.partial(
        networks_vision.make_ppo_networks_vision,
        policy_hidden_layer_sizes=(32,),
        value_hidden_layer_sizes=(32,),
        cnn_output_channels=(8, 8),
        cnn_kernel_size=(4, 3),
        cnn_stride=(2, 2),
        policy_obs_key="state",
        value_obs_key="state",
    )
    _, params, _ = train.train(
        brax_env,
        num_timesteps=2**12,
        episode_length=64,
        num_envs=16,
        batch_size=16,
        num_minibatches=4,
        unroll_length=8,
        num_updates_per_batch=1,
        num_evals=3,
        num_eval_envs=8,
        max_devices_per_host=1,
        vision=True,
        wrap_env_fn=wrap_for_training,
        network_factory=make_networks,
        progress_fn=lambda step, metrics: records.append((step, metrics)),
        policy_params_fn=lambda step, make_policy, params: policies.append(jax.device_get(params)),
    )
    rewards = [float(m["eval/episode_reward"]) for _, m in records]
    losses = [float(m["training/total_loss"]) for _, m in records if "training/total_loss" in m]
    assert records[-1][0] >= 2**12
    assert np.isfinite(rewards).all()
    assert len(set(rewards)) > 1
    assert losses
    assert np.isfinite(losses).all()
    # Training changes the policy, and what it returns is the last.
    first, last = (jax.tree.leaves(policies[i][1]) for i in (0, -1))
    assert any(not np.array_equal(a, b) for a, b in zip(first, last, strict=True))
    assert all(np.array_equal(a, b) for a, b in zip(last, jax.tree.leaves(params[1]), strict=True))


def test_action_repeat_is_refused(brax_env):
    with pytest.raises(ConfigError, match="ctrl_dt"):
        wrap_for_training(brax_env, action_repeat=2)


def test_sums_of_metrics_are_those_of_the_end(generated_bank):
    """Brax adds metrics up over an episode: distances of 500 steps would make a sum that means nothing."""
    options = {"sensors": ("state", "goal"), "impl": "kinematic"}
    wrapped = wrap_for_training(BraxEnv(home_mjx.make("PointNav-v0", generated_bank, **options)), episode_length=3)
    judged = EvalWrapper(wrapped)
    states = jax.jit(judged.reset)(jax.random.split(jax.random.PRNGKey(0), 2))
    forward, step, seen = jnp.zeros((2, 4)).at[:, 0].set(1.0), jax.jit(judged.step), []
    for _ in range(3):
        states = step(states, forward)
        seen.append({name: np.asarray(value) for name, value in states.metrics.items() if name != "reward"})
    assert not np.any([list(metrics.values()) for metrics in seen[:2]])
    own = states.pipeline_state.metrics
    assert np.all(own["distance"] > 0)
    assert set(own) == set(seen[2])
    for name, value in own.items():
        for found in (states.info["episode_metrics"][name], states.info["eval_metrics"].episode_metrics[name]):
            np.testing.assert_array_equal(found, value)


def test_braxs_checkpoints_load_by_default_arguments(tmp_path):
    """As its trainer saves them; without the shim: KeyError None."""
    brax_compat.install()
    size = {"state": specs.Array((13,), jnp.dtype("float32"))}
    network = networks.make_ppo_networks({"state": (13,)}, 4, preprocess_observations_fn=running_statistics.normalize)
    one, other = jax.random.split(jax.random.PRNGKey(0))
    nets = network.policy_network.init(one), network.value_network.init(other)
    params = (running_statistics.init_state(size), *nets)
    config = checkpoint.network_config(size, 4, True, networks.make_ppo_networks)
    checkpoint.save(tmp_path, 0, params, config)
    (path,) = tmp_path.iterdir()
    loaded, wanted = checkpoint.load_policy(path), networks.make_inference_fn(network)(params, deterministic=True)
    obs = {"state": jnp.linspace(-1, 1, 13)}
    np.testing.assert_array_equal(loaded(obs, one)[0], wanted(obs, one)[0])


def test_braxs_registry_has_every_id(generated_bank, brax_env, monkeypatch):
    """Those from before the adapter was imported; after another `register` also those of users and other tests."""
    monkeypatch.setattr(envs, "_envs", dict(envs._envs))
    monkeypatch.setitem(registry._REGISTRY, "Late-v0", registry.EnvSpec("Late-v0", "home_mjx.tasks.suite:PointNav"))
    assert "Late-v0" not in envs._envs
    env = envs.get_environment("PointNav-v0", houses=generated_bank, sensors=("state", "goal"), impl="kinematic")
    assert isinstance(env, BraxEnv)
    register()
    assert "Late-v0" in home_mjx.list_envs()
    assert set(home_mjx.list_envs()) <= set(envs._envs)
    with pytest.raises(ConfigError, match="variation"):
        _ = env.sys
    with pytest.raises(ConfigError, match="stop=False"):
        envs.get_environment("RoomNav-v0", houses=generated_bank, num_tasks=1, sensors=("state",))
    assert envs.get_environment(
        "RoomNav-v0", houses=generated_bank, num_tasks=1, sensors=("state",), actions="continuous", stop=False
    )
    state = jax.jit(env.reset)(jax.random.PRNGKey(0))
    picture = env.render(state, height=6, width=8)
    assert picture.shape == (6, 8, 3)
    np.testing.assert_array_equal(env.render([state.pipeline_state], height=6, width=8)[0], picture)


def test_both_kinds_of_key_and_two_devices(generated_bank):
    options = {"sensors": ("depth", "state"), "width": 8, "height": 8, "impl": "kinematic"}
    wrapped = wrap_for_training(BraxEnv(home_mjx.make("PointNav-v0", generated_bank, **options)), episode_length=4)
    keys = jax.random.split(jax.random.PRNGKey(0), 4).reshape(2, 2, 2)
    states = jax.pmap(wrapped.reset)(keys)
    step = jax.pmap(wrapped.step)
    for _ in range(4):
        states = step(states, jnp.zeros((2, 2, 4)))
        check_status(states.pipeline_state)
    np.testing.assert_array_equal(states.info["truncation"], 1)
    np.testing.assert_array_equal(states.info["episode_metrics"]["length"], 4)


def test_shim_is_what_jax_had():
    devices = jax.devices()[:2]
    out = brax_compat.device_put_replicated({"a": np.arange(3)}, devices)["a"]
    assert out.shape == (2, 3)
    assert {shard.device for shard in out.addressable_shards} == set(devices)
