"""PiedPiper: who plays is led by the task, and following it is success."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.audio_jax import CLIPS
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, HouseholdEnv, expert_action
from home_mjx.tasks.suite import PiedPiper
from home_mjx.tasks.suite.audio_nav import DISTRACTOR_CLIPS, SPLITS

PHYSICS = PhysicsConfig(impl="kinematic", num_agents=3)
CONFIG = EnvConfig(sensors=("state",), actions="discrete", physics=PHYSICS)
LEFT, HORIZON = 2, 500


@pytest.fixture(scope="module")
def env():
    return HouseholdEnv(CONFIG, PiedPiper(num_tasks=4)).bind(load_bank("procedural:2?preset=flat"))


@pytest.fixture(scope="module")
def begun(env):
    rows = len(env.params.tasks)
    keys, index = jax.random.split(jax.random.key(0), rows), jnp.arange(rows)
    return jax.jit(jax.vmap(lambda key, row: env.core.reset(env.params, key, None, row, observe=False)))(keys, index)


@pytest.fixture(scope="module")
def stands(env, begun):
    """States of 40 steps in which the follower is told to turn on the spot."""
    step = jax.jit(jax.vmap(lambda s: env.core.step(env.params, s, LEFT, observe=False)))
    states = [begun]
    for _ in range(40):
        states.append(step(states[-1]))
    return states


def places(env, states) -> np.ndarray:
    return np.asarray(positions(env.core, env.params, states))


@functools.partial(jax.jit, static_argnums=0)
def positions(core, params, states):
    return jax.vmap(lambda s: core.snapshot(params, s).pose.pos)(states)


def test_the_others_walk_and_the_first_does_what_it_is_told(env, stands):
    path = np.stack([places(env, states) for states in stands])
    gone = np.linalg.norm(np.diff(path[..., :2], axis=0), axis=-1).sum(axis=0)  # (environments, agents)
    assert np.median(gone[:, 1:]) > 1
    assert gone[:, 0].max() < 1  # but it may be pushed
    told = np.asarray(stands[-1].world.action)
    assert (told[:, 0].argmax(axis=-1) == LEFT).all()


def test_sounds_go_with_those_who_make_them(env, stands):
    for states in (stands[0], stands[-1]):
        sounds = jax.tree.map(np.asarray, states.world.sounds)
        np.testing.assert_allclose(sounds.pos, places(env, states)[:, 1:], atol=1e-5)
        assert (sounds.body == env.bank.spec.num_instances + np.array([1, 2])).all()
        names = np.array(CLIPS)[sounds.clip]
        assert set(names[:, 0]) <= set(SPLITS["heard"])
        assert set(names[:, 1]) <= set(DISTRACTOR_CLIPS)


def test_only_the_follower_is_paid(stands):
    rewards = np.stack([np.asarray(states.world.reward) for states in stands[1:]])
    np.testing.assert_array_equal(rewards[..., 0], [states.reward for states in stands[1:]])
    assert (rewards[..., 1:] == 0).all()
    assert (rewards[..., 0] != 0).any()


def test_near_is_counted_by_hand(env, stands):
    """In the same storey and as near in the plan as the option says."""
    path = np.stack([places(env, states) for states in stands[1:]])
    away = np.linalg.norm(path[:, :, 1, :2] - path[:, :, 0, :2], axis=-1)
    over = np.stack([np.asarray(states.done) for states in stands[1:]])
    kept = ~over.any(axis=0)
    expected = (away <= env.task.follow_distance).mean(axis=0)
    np.testing.assert_allclose(np.asarray(stands[-1].metrics["near"])[kept], expected[kept], atol=1e-6)


@pytest.mark.parametrize("number", [2, 4])
def test_other_numbers_of_agents_are_refused(number):
    config = EnvConfig(actions="discrete", physics=PhysicsConfig(num_agents=number))
    with pytest.raises(ConfigError, match="num_agents=3"):
        HouseholdEnv(config, PiedPiper(num_tasks=1))


def test_the_id_makes_the_task(env):
    made = home_mjx.make("PiedPiper-v0", env.bank, sensors=("state", "rgb"), num_tasks=1, follow_steps=10)
    assert (made.num_agents, made.config.num_agents) == (1, 3)
    assert {name: spec.shape for name, spec in made.observation_spec.items()} == {
        "state": (10,), "pixels/head_rgb": (64, 64, 3),
    }  # fmt: skip
    assert made.action_spec.shape == ()
    assert made.config.num_sources == 2
    alone = home_mjx.make("PiedPiper-v0", env.bank, sensors=("state",), num_tasks=1, num_others=0, num_agents=2)
    assert alone.config.num_sources == 1
    assert (alone.num_agents, alone.config.num_agents) == (1, 2)


@pytest.mark.slow
def test_the_expert_follows_and_chance_does_not(env, begun):
    def run(act):
        def step(states, key):
            actions = jax.vmap(act)(states, jax.random.split(key, states.done.shape[0]))
            after = jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0))(env.params, states, actions)
            return jax.vmap(lambda o, a: jax.tree.map(lambda x, y: jnp.where(o.done, x, y), o, a))(states, after), None

        keys = jax.random.split(jax.random.key(1), HORIZON)
        return jax.jit(lambda s: jax.lax.scan(step, s, keys)[0])(begun)

    expert = run(lambda s, _: expert_action(env.core.snapshot(env.params, s), s.task))
    success = np.asarray(expert.metrics["success"])
    # Who brushes the leaf of a door may shut it, and cannot open it without hands: piper and others do so at times.
    angle = jax.vmap(lambda s: env.core.snapshot(env.params, s).door_angle)
    is_open = np.all(np.abs(np.asarray(angle(expert) - angle(begun))) < 0.8, axis=-1)
    assert is_open.sum() >= 5
    assert success[is_open].mean() >= 0.99
    random = run(lambda _, key: jax.random.randint(key, (), 0, 6))
    assert np.asarray(random.metrics["success"]).mean() < 0.1
