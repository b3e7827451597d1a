"""The loop of purejaxrl runs on the adapter; every transition is that of the core."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from adapted import assert_equal, cases, cheap, row
from checkers import NUM_ENVS, check_gymnax
from checkers import gymnax_rollout as rollout
from counted_jit import CountedJit

from home_mjx.adapters.gymnax import GymnaxEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import sample_episodes


@pytest.mark.parametrize(("env_id", "actions"), cases(("discrete",), ("continuous",)))
def test_a_loop_like_that_of_purejaxrl(env_id, actions, generated_bank):
    check_gymnax(env_id, generated_bank, actions=actions, impl="fused")


def test_a_vector_without_images_says_so(generated_bank):
    seen = cheap("PointNav-v0", generated_bank, sensors=("depth", "goal"), width=4, height=4)
    with pytest.warns(UserWarning, match="omits pixels/head_depth"):
        GymnaxEnv(seen, vector=True)


@pytest.fixture(scope="module")
def env(generated_bank):
    return GymnaxEnv(cheap("PointNav-v0", generated_bank, sensors=("state", "goal")), vector=True)


def test_alone_and_in_a_batch_are_the_same(env):
    keys = jax.random.split(jax.random.key(1), NUM_ENVS)
    many = jax.vmap(env.reset)(keys)
    for i in range(NUM_ENVS):
        assert_equal(env.reset(keys[i]), row(many, i))
    stepped = jax.vmap(env.step)(keys, many[1], jnp.ones((NUM_ENVS, 4)))
    for i in range(NUM_ENVS):
        alone = env.step(keys[i], row(many[1], i), jnp.ones(4))
        jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-5), alone, row(stepped, i))


@pytest.mark.slow
def test_batches_in_batches_and_with_houses_of_their_own(env, other_bank):
    keys = jax.random.split(jax.random.key(2), 4).reshape(2, 2)
    obs, _ = jax.vmap(jax.vmap(env.reset))(keys)
    np.testing.assert_array_equal(obs[1, 0], env.reset(keys[1, 0])[0])
    params = env.default_params, env.default_params.replace(bank=other_bank)
    both = jax.tree.map(lambda *x: jnp.stack(x), *params)
    obs, _ = jax.vmap(env.reset)(keys[0], both)
    for i in range(2):
        np.testing.assert_allclose(obs[i], env.reset(keys[0, i], params[i])[0], atol=1e-5)


def test_other_houses_run_the_same_program(env, generated_bank, other_bank):
    run = CountedJit(rollout(env))
    first = run(env.default_params, jax.random.key(0))
    second = run(env.default_params.replace(bank=other_bank), jax.random.key(0))
    assert run.traces == 1
    assert (first[0] != second[0]).any()


def test_new_episodes_are_drawn_only_when_one_has_ended(env):
    """A branch on the whole batch: `vmap` would make a `select` of a branch on each environment."""
    keys = jax.random.split(jax.random.key(1), NUM_ENVS)
    _, state = jax.vmap(env.reset)(keys)
    program = str(jax.make_jaxpr(jax.vmap(env.step))(keys, state, jnp.zeros((NUM_ENVS, 4))))
    assert " cond[" in program


def test_a_batch_takes_saved_episodes_in_order(env, generated_bank):
    params = env.default_params.replace(tasks=sample_episodes(generated_bank, 4, min_length=1.0))
    keys = jax.random.split(jax.random.key(0), NUM_ENVS)
    _, state = jax.vmap(env.reset, in_axes=(0, None))(keys, params)
    np.testing.assert_array_equal(state.world.episode, range(NUM_ENVS))
    np.testing.assert_array_equal(state.world.house, params.tasks.house[:NUM_ENVS])


def test_vectors_and_names(env):
    obs, _ = env.reset(jax.random.key(0))
    space = env.observation_space(env.default_params)
    assert obs.shape == space.shape == (sum(spec.shape[0] for spec in env.env.observation_spec.values()),)
    assert space.contains(space.sample(jax.random.key(0)))
    assert (env.name, env.num_actions) == ("PointNav-v0", 4)


def test_both_kinds_of_key(env):
    typed, raw = jax.random.key(5), jax.random.PRNGKey(5)
    assert_equal(env.reset(typed), env.reset(raw))


def test_what_gymnax_cannot_drive_is_refused(generated_bank):
    with pytest.raises(ConfigError, match="one agent"):
        GymnaxEnv(cheap("PointNav-v0", generated_bank, num_agents=2))
    with pytest.raises(ConfigError, match="no vector"):
        GymnaxEnv(cheap("PointNav-v0", generated_bank, sensors=("depth",), width=4, height=4), vector=True)


def test_wrappers_of_gymnax(env):
    pytest.importorskip("gymnax.wrappers.compat", reason="gymnax 1 is not installed")
    from gymnax.wrappers.compat import LegacyStepAPIWrapper
    from gymnax.wrappers.purerl import LogWrapper

    logged, key = LogWrapper(env), jax.random.key(0)
    _, state = logged.reset(key, env.default_params)
    for _ in range(5):
        *_, info = (obs_state := logged.step(key, state, jnp.zeros(4), env.default_params))
        state = obs_state[1]
    assert bool(info["returned_episode"])
    assert int(info["returned_episode_lengths"]) == 5
    assert len(LegacyStepAPIWrapper(env).step(key, state.env_state, jnp.zeros(4), env.default_params)) == 5
