"""The curriculum: which rows are easy, that only these are drawn, and how their share grows."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import EnvParams
from home_mjx.training import PPO, NetworkConfig, PPOConfig
from home_mjx.training.curriculum import MIN_SHARE, draw_easy_rows, easy_share, row_difficulty

SMALL = PPOConfig(num_envs=8, num_timesteps=640, unroll_length=8, curriculum=0.5, network=NetworkConfig(8, 8, (4,)))


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make("RoomNav-v0", generated_bank, sensors=("state",), impl="kinematic", num_tasks=8)


def test_easy_rows_have_short_paths_in_homes_with_few_objects(env):
    """Against ranks by SciPy-like sorting in a loop: the sum of both ranks orders the rows."""
    rows = env.params.tasks.rows
    length = np.asarray(rows.columns["length"])
    objects = np.asarray(env.bank.geometry.instance_object) >= 0
    clutter = objects.sum(axis=1)[np.asarray(rows.house)]
    both = [sum(np.sum(x < x[i]) + np.sum(x[:i] == x[i]) for x in (length, clutter)) for i in range(len(length))]
    order = sorted(range(len(both)), key=lambda i: (both[i], i))
    difficulty = np.asarray(row_difficulty(env.params))
    assert np.argsort(difficulty, kind="stable").tolist() == order
    assert sorted(difficulty * len(both)) == pytest.approx(range(len(both)))


def test_only_the_easiest_rows_are_drawn_and_at_the_end_all(env):
    difficulty = np.asarray(row_difficulty(env.params))
    keys = jax.random.split(jax.random.key(0), 2000)
    for share in (0.2, 0.5, 1.0):
        tasks = draw_easy_rows(env.params, jnp.float32(share)).tasks
        drawn = np.unique(jax.vmap(tasks.draw)(keys))
        assert drawn.tolist() == np.flatnonzero(difficulty <= np.float32(share)).tolist()


def test_the_share_grows_with_the_updates_of_the_run(env):
    ppo = PPO(env.core, SMALL, jax.devices()[:1])
    counts = [int(jnp.sum(ppo._drawn_params(env.params, jnp.int32(n)).tasks.weights)) for n in (0, 2, 5, 10)]
    num = len(env.params.tasks)
    assert counts == [int(jnp.sum(row_difficulty(env.params) <= x)) for x in (0.2, 0.52, 1.0, 1.0)]
    assert counts[0] < counts[1] < counts[2] == num
    assert float(easy_share(jnp.float32(0), 0.5, 10)) == pytest.approx(MIN_SHARE)
    plain = PPO(env.core, dataclasses.replace(SMALL, curriculum=0.0), jax.devices()[:1])
    assert plain._drawn_params(env.params, jnp.int32(0)) is env.params


def test_rows_of_weight_zero_are_never_drawn(env):
    own = jnp.arange(len(env.params.tasks), dtype=jnp.float32) % 3
    params = env.params.replace(tasks=env.params.tasks.with_weights(own))
    for share in (0.3, 1.0):
        weights = np.asarray(draw_easy_rows(params, jnp.float32(share)).tasks.weights)
        assert (weights[own == 0] == 0).all()
        kept = weights > 0
        assert 0 < kept.sum() <= (own > 0).sum()
        difficulty = np.asarray(row_difficulty(env.params))
        assert difficulty[kept].max() <= difficulty[(own > 0) & ~kept].min(initial=2)
    np.testing.assert_array_equal(weights > 0, own > 0)


def test_a_stage_after_cloning_begins_with_the_easiest_rows(env):
    ppo = PPO(env.core, SMALL, jax.devices()[:1])
    first = ppo._drawn_params(env.params, jnp.int32(0)).tasks.weights
    ppo.first_update = 40
    np.testing.assert_array_equal(ppo._drawn_params(env.params, jnp.int32(40)).tasks.weights, first)


def test_tasks_without_rows_have_no_curriculum(env):
    with pytest.raises(ConfigError, match="episodes are rows"):
        row_difficulty(EnvParams(env.bank))
    with pytest.raises(ConfigError, match="`curriculum` must be"):
        dataclasses.replace(SMALL, curriculum=1.5)
