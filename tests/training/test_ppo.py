"""PPO's update: one program for all houses, the same bits again, the same on two devices, and it learns."""

import dataclasses
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

import home_mjx
from home_mjx.registry import EnvSpec
from home_mjx.training.checkpoint import load_checkpoint, save_checkpoint
from home_mjx.training.config import PPOConfig, RunConfig
from home_mjx.training.evaluation import evaluate, random_policy
from home_mjx.training.networks import NetworkConfig
from home_mjx.training.ppo import PPO, TrainState
from home_mjx.training.rollout import rollout

SMALL = PPOConfig(
    num_envs=8,
    num_timesteps=8 * 4 * 10,
    unroll_length=4,
    num_minibatches=2,
    num_epochs=2,
    optimizer="adam",
    network=NetworkConfig(features=16, memory=16, channels=(4, 8)),
)
ONE = jax.devices()[:1]


def leaves_equal(a: object, b: object) -> bool:
    return jax.tree.all(jax.tree.map(lambda x, y: bool(jnp.array_equal(x, y, equal_nan=True)), a, b))


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make("PointNav-v0", generated_bank, sensors=("state", "goal"), episode_length=6)


@pytest.fixture(scope="module")
def ppo(env) -> PPO:
    return PPO(env.core, SMALL, ONE)


@pytest.fixture(scope="module")
def state(ppo: PPO, env) -> TrainState:
    return ppo.init(env.params, jax.random.key(0))


def test_an_update_changes_what_it_should_and_nothing_of_its_form(ppo: PPO, env, state: TrainState):
    new, metrics = ppo.update(env.params, state)
    shapes = [jax.tree.map(lambda x: (x.shape, x.dtype), tree) for tree in (state, new)]
    assert shapes[0] == shapes[1]
    assert jax.tree.all(jax.tree.map(lambda a, b: not jnp.array_equal(a, b), state.net, new.net))
    assert int(new.updates) == 1
    assert all(np.isfinite(x) for x in metrics.values())
    # In 4 steps of 6 staggered ones some have ended; those that have not are counted on.
    assert 0 < metrics["episode/episodes"] <= 8
    assert np.array_equal(new.actor.is_first, new.actor.totals["length"] == 0)
    assert np.all(new.actor.totals["length"] <= 4)


def test_another_houses_bank_runs_the_same_program(ppo: PPO, env, state: TrainState, other_bank):
    ppo.update(env.params, state)
    programs = ppo.update._cache_size()
    here, there = (ppo.update(env.params.replace(bank=bank), state)[0] for bank in (env.bank, other_bank))
    assert ppo.update._cache_size() == programs
    assert not leaves_equal(here.actor.env.obs, there.actor.env.obs)


def test_a_resumed_run_gives_the_same_next_update_bit_by_bit(ppo: PPO, env, state: TrainState, tmp_path: Path):
    config = RunConfig(EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav"), SMALL)
    one, _ = ppo.update(env.params, state)
    save_checkpoint(tmp_path / "checkpoint.npz", one, config)
    wanted = ppo.update(env.params, one)
    again = ppo.to_devices(load_checkpoint(tmp_path / "checkpoint.npz", state, config))
    assert leaves_equal(ppo.update(env.params, again), wanted)
    assert not leaves_equal(wanted[0].net, one.net)


def test_time_running_out_is_continued_by_the_value_of_the_last_observation(ppo: PPO, env, state: TrainState):
    """Of each step that time ended: the value of what the core's own step observes, and only of those."""
    policy = ppo.policy(state.net)
    run = jax.jit(lambda actor: rollout(ppo.batch, env.params, actor, policy, 1))
    step, actor, late = jax.jit(jax.vmap(env.core.step, (None, 0, 0))), state.actor, 0
    for _ in range(6):
        before, (actor, steps, _) = actor, run(actor)
        after = step(env.params, before.env, policy.clip(steps.action[0]))
        memory = ppo.agent.unroll_step(state.net, before.memory, before.env.obs, before.is_first)[0]
        value = ppo.agent.unroll_step(state.net, memory, after.obs, jnp.zeros(8, bool))[2]
        np.testing.assert_allclose(steps.truncation_value[0], jnp.where(after.truncated, value, 0.0), atol=1e-5)
        assert np.array_equal(steps.done[0], after.done)
        late += int(after.truncated.sum())
    assert late == 8


def test_programs_compiled_in_advance_are_those_of_init_and_update(ppo: PPO, state: TrainState, env):
    reset, update = ppo.lower(env.params)
    again = ppo.init(env.params, jax.random.key(0), reset.compile())
    jax.tree.map(np.testing.assert_array_equal, again, state)
    metrics = update.compile()(env.params, again)[1]
    jax.tree.map(np.testing.assert_array_equal, metrics, ppo.update(env.params, state)[1])


def test_staggered_environments_end_at_different_times(ppo: PPO, state: TrainState, env):
    assert len(set(np.asarray(state.actor.env.world.step).tolist())) > 2
    together = PPO(env.core, dataclasses.replace(SMALL, stagger=False), ONE)
    assert not np.any(together.init(env.params, jax.random.key(0)).actor.env.world.step)


@pytest.mark.slow
def test_two_devices_learn_what_one_does(env):
    """Actions depend on each environment's own key, gradients are averaged: only rounding tells them apart."""
    assert len(jax.devices()) >= 2
    config = dataclasses.replace(SMALL, num_minibatches=1, num_epochs=1)
    results = []
    for devices in (ONE, jax.devices()[:2]):
        ppo = PPO(env.core, config, devices)
        params = ppo.sharding.put_params(env.params)
        state = ppo.init(params, jax.random.key(0))
        for _ in range(2):
            state, metrics = ppo.update(params, state)
        results.append((state, metrics))
    (one, metrics_of_one), (two, metrics_of_two) = results
    assert len(two.actor.memory.sharding.device_set) == 2
    assert two.actor.memory.addressable_shards[0].data.shape == (4, 16)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=2e-5), one.net, two.net)
    np.testing.assert_allclose(one.actor.env.obs["goal"], two.actor.env.obs["goal"], atol=1e-3)
    for name, value in metrics_of_one.items():
        np.testing.assert_allclose(metrics_of_two[name], value, rtol=1e-2, atol=1e-4, err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        {"sensors": ("state", "goal"), "actions": "discrete"},
        {"sensors": ("state", "goal"), "num_agents": 2},
        {"sensors": ("state", "goal"), "actions": "discrete", "num_agents": 2},
        {"sensors": ("depth", "rgb", "fine", "audio", "goal"), "width": 16, "height": 16},
    ],
    ids=["discrete", "two agents", "two agents, discrete", "images and sound"],
)
@pytest.mark.parametrize("final_obs", ["cheap", "all"])
def test_any_environment_can_be_learned_in(generated_bank, options: dict, final_obs: str):
    env = home_mjx.make("PointNav-v0", generated_bank, episode_length=4, **options)
    ppo = PPO(env.core, dataclasses.replace(SMALL, final_obs=final_obs), ONE)
    state = ppo.init(env.params, jax.random.key(0))
    new, metrics = ppo.update(env.params, state)
    assert all(np.isfinite(x) for x in metrics.values())
    assert new.actor.memory.shape == (8 * options.get("num_agents", 1), 16)
    assert metrics["episode/episodes"] == 8
    assert not leaves_equal(state.net, new.net)


@pytest.mark.slow
@pytest.mark.parametrize("final_obs", ["cheap", "all"])
def test_agents_that_the_task_leads_are_no_rows_to_learn_from(generated_bank, final_obs: str):
    options = {"sensors": ("state", "depth"), "width": 16, "height": 16, "impl": "kinematic", "num_tasks": 2}
    env = home_mjx.make("PiedPiper-v0", generated_bank, episode_length=4, follow_steps=2, **options)
    ppo = PPO(env.core, dataclasses.replace(SMALL, final_obs=final_obs), ONE)
    state = ppo.init(env.params, jax.random.key(0))
    new, metrics = ppo.update(env.params, state)
    assert all(np.isfinite(x) for x in metrics.values())
    assert new.actor.memory.shape == (8, 16)
    assert new.actor.env.world.reward.shape == (8, 3)
    assert metrics["episode/episodes"] == 8
    assert not leaves_equal(state.net, new.net)


@pytest.mark.slow
def test_it_learns_in_one_small_house():
    """60,000 steps of short episodes: success of the last ones is far above chance."""
    env = home_mjx.make("PointNav-v0", "procedural:1?preset=flat", sensors=("goal",), ctrl_dt=0.3, episode_length=40)
    config = PPOConfig(
        num_envs=64, num_timesteps=64 * 16 * 60, unroll_length=16, num_minibatches=4, num_epochs=4, optimizer="adam",
        learning_rate=2e-3, weight_decay=0.0, entropy_cost=0.0, network=NetworkConfig(features=64, memory=64),
    )  # fmt: skip
    ppo = PPO(env.core, config, ONE)
    state = ppo.init(env.params, jax.random.key(0))
    success, episodes = [], []
    for _ in range(config.num_updates):
        state, metrics = ppo.update(env.params, state)
        success.append(float(metrics["episode/success"]))
        episodes.append(float(metrics["episode/episodes"]))
    learned = sum(success[-10:]) / sum(episodes[-10:])
    chance = evaluate(env, random_policy(env.core), num_episodes=128)["success"].mean()
    assert learned > chance + 0.2, (learned, chance)
