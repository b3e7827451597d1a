"""Several seeds in one program: one is PPO itself, and none depends on another."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

import home_mjx
from home_mjx.training import PPO, NetworkConfig, PPOConfig
from home_mjx.training.population import Population

ONE = jax.devices()[:1]
SMALL = PPOConfig(
    num_envs=4, num_timesteps=640, unroll_length=6, num_minibatches=2, num_epochs=2, network=NetworkConfig(16, 16)
)


@pytest.fixture(scope="module")
def env(generated_bank):
    options = {"sensors": ("goal",), "impl": "kinematic", "actions": "discrete", "episode_length": 4}
    return home_mjx.make("PointNav-v0", generated_bank, **options)


def assert_same(one: object, other: object, tolerance: float) -> None:
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_allclose(a, b, atol=tolerance)


@pytest.mark.slow
def test_a_population_of_one_learns_as_ppo(env):
    ppo, population = PPO(env.core, SMALL, ONE), Population(env.core, SMALL, 1, ONE)
    state = ppo.init(env.params, jax.random.key(0))
    alone = state.replace(**{name: jax.tree.map(lambda x: x[None], getattr(state, name)) for name in ("net", "opt")})
    alone = alone.replace(key=state.key[None])
    for _ in range(2):
        state, wanted = ppo.update(env.params, state)
        alone, found = population.update(env.params, alone)
    assert_same(state.net, population.net_of(alone, 0), 1e-5)
    assert {name: x.shape for name, x in found.items()} == dict.fromkeys(found, (1,))
    assert float(wanted["episode/episodes"]) > 0
    for name, value in found.items():
        assert float(value[0]) == pytest.approx(float(wanted[name]), abs=1e-4)


@pytest.mark.slow
def test_no_seed_depends_on_another(env):
    population = Population(env.core, SMALL, 3, ONE)
    state = population.init(env.params, jax.random.key(1))
    one, metrics = population.update(env.params, state)
    nets = [np.concatenate([np.ravel(x) for x in jax.tree.leaves(population.net_of(one, i))]) for i in range(3)]
    assert min(np.abs(nets[i] - nets[j]).max() for i, j in ((0, 1), (0, 2), (1, 2))) > 1e-2
    changed = jax.tree.map(lambda x: x.at[1].add(jnp.asarray(0.1, x.dtype)), state.net)
    other, _ = population.update(env.params, state.replace(net=changed))
    for seed in (0, 2):
        assert_same(population.net_of(one, seed), population.net_of(other, seed), 1e-6)
    assert metrics["episode/episodes"].shape == (3,)
    assert float(metrics["episode/episodes"].sum()) > 0
