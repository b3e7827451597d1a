"""Evaluation against episodes that are stepped one at a time, and against closed forms."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.training.evaluation import evaluate, random_policy, summarize, with_episodes
from home_mjx.training.rollout import Policy

NUM = 6


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make(
        "PointNav-v0", generated_bank, sensors=("goal",), episode_length=30, ctrl_dt=0.3, success_distance=1.0
    )


def walk(goal: jax.Array) -> jax.Array:
    """Turns to the goal and goes there."""
    turn = jnp.clip(jnp.arctan2(goal[..., 2], goal[..., 1]) / 0.4, -1, 1)
    nothing = jnp.zeros_like(turn)
    return jnp.stack([jnp.maximum(goal[..., 1], 0.0), nothing, turn, nothing], axis=-1)


def walker(net: object) -> Policy:
    """Remembers how many steps it has taken, and forgets at an episode's begin."""

    def act(memory: jax.Array, obs: dict, begins: jax.Array, keys: jax.Array) -> tuple:
        return jnp.where(begins, 1, memory + 1), walk(obs["goal"]), {}

    return Policy(act, initial_memory=lambda num: jnp.zeros(num, jnp.int32))


@pytest.mark.slow
def test_who_stands_still_gets_nowhere(env):
    def still(net: object) -> Policy:
        return Policy(lambda memory, obs, begins, keys: (memory, jnp.zeros((keys.shape[0], 4)), {}))

    found = evaluate(env, still, num_episodes=NUM)
    assert {x.shape for x in found.values()} == {(NUM,)}
    assert not np.any([found["success"], found["spl"]])
    assert np.all(found["episode_steps"] == 30)
    assert np.all(found["walked"] < 0.02)
    length = np.asarray(with_episodes(env, NUM).params.tasks.columns["length"])
    np.testing.assert_allclose(found["distance"], length, atol=0.05)
    costs = 30 * env.task.step_cost
    touching = 30 * env.task.contact_cost
    assert np.all(found["return"] < -costs + 0.05)
    assert np.all(found["return"] > -costs - touching - 0.05)


@pytest.mark.slow
def test_figures_are_those_of_episodes_stepped_one_by_one(env):
    found = evaluate(env, walker, num_episodes=NUM, seed=6)
    single = with_episodes(env, NUM, 6)
    lengths = np.asarray(single.params.tasks.columns["length"])
    reset, step = jax.jit(single.core.reset), jax.jit(single.core.step)
    for i in range(NUM):
        state = reset(single.params, jax.random.key(0), None, i)
        walked = gained = steps = 0.0
        while not state.done:
            before = np.asarray(single.core.snapshot(single.params, state).pose.pos[0])
            state = step(single.params, state, walk(state.obs["goal"]))
            walked += np.linalg.norm(np.asarray(single.core.snapshot(single.params, state).pose.pos[0]) - before)
            gained, steps = gained + float(state.reward), steps + 1
        success, distance = float(state.metrics["success"]), float(state.metrics["distance"])
        short = lengths[i] / max(lengths[i], walked)
        wanted = {
            "success": success, "return": gained, "episode_steps": steps, "walked": walked, "distance": distance,
            "spl": success * short, "soft_spl": np.clip(1 - distance / lengths[i], 0, 1) * short,
        }  # fmt: skip
        for name, value in wanted.items():
            assert found[name][i] == pytest.approx(value, abs=2e-3), (name, i)
    assert 0 < found["success"].mean() < 1


@pytest.mark.slow
@pytest.mark.parametrize("actions", ["continuous", "discrete"])
def test_chance_is_the_same_for_the_same_seed(generated_bank, actions: str):
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("goal",), episode_length=8, actions=actions)
    act = random_policy(env.core)
    one, again, other = (evaluate(env, act, num_episodes=NUM, seed=seed) for seed in (0, 0, 1))
    assert all(np.array_equal(one[name], again[name]) for name in one)
    assert not np.array_equal(one["walked"], other["walked"])
    drawn = act(None).act((), {}, jnp.ones(4000, bool), jax.random.key_data(jax.random.split(jax.random.key(0), 4000)))[
        1
    ]
    if actions == "discrete":
        assert np.all(np.bincount(np.asarray(drawn), minlength=6) > 4000 / 6 * 0.85)
        assert drawn.max() == 5
    else:
        np.testing.assert_allclose(drawn.mean(0), 0, atol=0.05)
        np.testing.assert_allclose(drawn.var(0), 1 / 3, atol=0.02)


def test_summary_is_mean_and_standard_error(rng: np.random.Generator):
    x = rng.normal(3, 2, 10_000)
    found = summarize({"x": x})["x"]
    assert found == {"mean": pytest.approx(x.mean()), "stderr": pytest.approx(x.std() / 100)}


@pytest.mark.parametrize("option", ["num_episodes", "max_batch"])
@pytest.mark.parametrize("value", [0, -1])
def test_numbers_that_allow_no_episode_are_refused(env, option, value):
    with pytest.raises(ConfigError, match=option):
        evaluate(env, walker, **{option: value})
