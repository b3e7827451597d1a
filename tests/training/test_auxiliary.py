"""Auxiliary losses: exact targets, silence that does not count, and a head that only the loss reads."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config
from home_mjx.tasks.suite import PointNav
from home_mjx.training.auxiliary import add_sensors, source_loss
from home_mjx.training.config import PPOConfig
from home_mjx.training.imitation import BehaviorCloning
from home_mjx.training.networks import NetworkConfig
from home_mjx.training.ppo import PPO

SMALL = PPOConfig(
    num_envs=16,
    num_timesteps=16 * 8 * 16,
    unroll_length=8,
    num_minibatches=2,
    num_epochs=2,
    auxiliary="source",
    auxiliary_cost=1.0,
    learning_rate=3e-3,
    network=NetworkConfig(features=16, memory=16),
)
OPTIONS = {"late": "none", "impl": "kinematic", "actions": "discrete", "episode_length": 20}
ONE = jax.devices()[:1]


@pytest.fixture(scope="module")
def env():
    config = make_config(sensors=("interaural", "goal"), **OPTIONS)
    return HouseholdEnv(config, PointNav()).bind(HouseBank.from_compiled([shoebox()]))


def test_the_loss_is_that_of_the_steps_with_sound(rng):
    found = rng.normal(size=(5, 7, 3))
    angle, distance = rng.uniform(-np.pi, np.pi, (5, 7)), rng.uniform(0, 9, (5, 7))
    sounds = rng.uniform(size=(5, 7)) < 0.5
    target = np.stack([np.sin(angle), np.cos(angle), distance, sounds], axis=-1)
    loss, parts = source_loss(jnp.asarray(found, jnp.float32), jnp.asarray(target, jnp.float32))
    wanted = np.stack([np.sin(angle), np.cos(angle), np.log1p(distance)], axis=-1)
    assert float(loss) == pytest.approx(np.sum((found - wanted) ** 2, axis=-1)[sounds].mean(), rel=1e-4)
    off = np.abs(np.angle(np.exp(1j * (np.arctan2(found[..., 0], found[..., 1]) - angle))))[sounds]
    assert float(parts["direction"]) == pytest.approx(off.mean(), rel=1e-4)
    assert float(parts["distance"]) == pytest.approx(
        np.abs(np.expm1(found[..., 2]) - distance)[sounds].mean(), rel=1e-4
    )
    silent = jnp.asarray(target, jnp.float32).at[..., 3].set(0)
    assert float(source_loss(jnp.asarray(found, jnp.float32), silent)[0]) == 0


def test_the_target_is_where_the_source_is(env):
    """In world coordinates: from the eyes along yaw plus azimuth, at the radius that the height leaves."""
    core = add_sensors(env.core, ("source_target",))
    assert add_sensors(core, ("source_target",)) is core
    reset = jax.jit(jax.vmap(core.reset, (None, 0)))
    states = reset(env.params, jax.random.split(jax.random.key(1), 8))
    each = [jax.tree.map(lambda x, i=i: x[i], states) for i in range(8)]
    seen = [core.snapshot(env.params, state) for state in each]
    sine, cosine, distance, sounds = np.asarray(states.obs["source_target"], float).T
    yaw, source = np.array([one.pose.yaw[0] for one in seen]), np.array([one.source for one in seen])
    body = core.config.body
    eyes = np.array([one.feet[0] for one in seen]) + np.array([0, 0, body.eye_height])
    away = source - eyes
    np.testing.assert_allclose(distance, np.linalg.norm(away, axis=1), atol=0.15)
    plane = np.linalg.norm(away[:, :2], axis=1)
    heading = np.stack([np.cos(yaw) * cosine - np.sin(yaw) * sine, np.sin(yaw) * cosine + np.cos(yaw) * sine], axis=1)
    np.testing.assert_allclose(plane[:, None] * heading, away[:, :2], atol=0.15)
    np.testing.assert_array_equal(sounds, 1)


@pytest.mark.parametrize("kind", [PPO, pytest.param(BehaviorCloning, marks=pytest.mark.slow)])
def test_updates_lower_the_loss_and_policies_do_not_need_the_target(env, kind):
    ppo = kind(env.core, SMALL, ONE)
    assert "source_target" in ppo.core.observation_spec
    assert "source_target" not in dict(ppo.agent.specs)
    state, losses = ppo.init(env.params, jax.random.key(0)), []
    for _ in range(SMALL.num_updates):
        state, metrics = ppo.update(env.params, state)
        losses.append(float(metrics["loss/source"]))
    assert np.mean(losses[-3:]) < 0.8 * np.mean(losses[:2])
    act = ppo.policy(state.net).act
    obs = {name: jnp.zeros((2, *spec.shape)) for name, spec in env.core.observation_spec.items()}
    act(jnp.zeros((2, 16)), obs, jnp.ones(2, bool), jax.random.split(jax.random.key(0), 2))


def test_cloning_has_the_loss_too(env):
    """As far as its trace tells; the slow suite lowers it."""
    cloning = BehaviorCloning(env.core, SMALL, ONE)
    assert "source_target" in cloning.core.observation_spec
    assert "source_target" not in dict(cloning.agent.specs)
    state = jax.eval_shape(cloning.init, env.params, jax.random.key(0))
    after, metrics = jax.eval_shape(cloning.update, env.params, state)
    assert {"loss/source", "loss/clone"} <= set(metrics)
    assert jax.tree.structure(after) == jax.tree.structure(state)


def test_unknown_losses_are_refused():
    with pytest.raises(ConfigError, match="Did you mean `source`"):
        PPOConfig(auxiliary="sourse")
