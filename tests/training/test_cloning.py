"""Cloning: who leads, what is learned from, and that it learns."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

import home_mjx
from home_mjx.datasets import RoomOutline, outline_house, write_house, write_library
from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec, find_spec
from home_mjx.training import (
    CPU_CONFIG,
    AdvisedPPO,
    BehaviorCloning,
    NetworkConfig,
    PPOConfig,
    RunConfig,
    evaluate,
    random_policy,
    train,
)
from home_mjx.training import run as run_module
from home_mjx.training.checkpoint import AGENT_FILE, CHECKPOINT_FILE, read_updates
from home_mjx.training.metrics_log import read_lines
from home_mjx.training.ppo import TrainBatch, TrainState
from home_mjx.training.rollout import Transitions

ONE = jax.devices()[:1]
SMALL = PPOConfig(
    num_envs=8, num_timesteps=8 * 4 * 10, unroll_length=4, num_minibatches=2, num_epochs=2, optimizer="adam",
    network=NetworkConfig(features=16, memory=16),
)  # fmt: skip


@pytest.fixture(scope="module")
def cloning(generated_bank) -> BehaviorCloning:
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("goal",), impl="kinematic", actions="discrete")
    return BehaviorCloning(env.core, SMALL, ONE)


def test_the_network_does_not_read_the_advice(cloning: BehaviorCloning):
    assert "expert" in cloning.core.observation_spec
    assert [name for name, _ in cloning.agent.specs] == ["goal"]


def test_the_expert_leads_less_and_less(cloning: BehaviorCloning):
    """Of many rows, the part that does what the expert says; the network's own actions are none of an expert's."""
    rows = 4000
    obs = {"goal": jnp.zeros((rows, 4)), "expert": jnp.full(rows, 9, jnp.int32)}
    keys = jax.random.key_data(jax.random.split(jax.random.key(0), rows))
    net = cloning.agent.init_net(jax.random.key(0))

    def led(updates: int) -> float:
        state = TrainState.build_unchecked(net=net, opt=None, actor=None, key=None, updates=jnp.int32(updates))
        policy = cloning.behavior_policy(state)
        _, action, outputs = policy.act(policy.initial_memory(rows), obs, jnp.ones(rows, bool), keys)
        assert outputs["value"].shape == (rows,)
        return float(jnp.mean(action == 9))

    assert led(0) == 1.0
    assert led(2) == pytest.approx(0.6, abs=0.04)
    assert led(5) == led(7) == pytest.approx(0.3, abs=0.04)
    assert led(8) == led(9) == 0.0


def test_the_loss_is_how_unlikely_the_advice_is(cloning: BehaviorCloning, rng: np.random.Generator):
    """By hand, of two steps of three rows; actions that were taken and rewards do not matter."""
    net = cloning.agent.init_net(jax.random.key(1))
    obs = {"goal": jnp.asarray(rng.normal(size=(2, 3, 4)), jnp.float32), "expert": jnp.array([[0, 1, 2], [3, 4, 5]])}
    begins, memory, target = jnp.ones((2, 3), bool), cloning.agent.initial_memory(3), jnp.ones((2, 3))
    steps = Transitions.build_unchecked(
        obs=obs, is_first=begins, action=None, outputs=None, reward=None, done=None, truncation_value=None
    )
    loss, parts = cloning.loss(
        net, TrainBatch.build_unchecked(steps=steps, memory=memory, advantage=None, target=target)
    )
    _, logits, value = cloning.agent.unroll(net, memory, obs, begins)
    odds = np.exp(np.asarray(logits, float))
    odds /= odds.sum(-1, keepdims=True)
    chosen = np.take_along_axis(odds, np.asarray(obs["expert"])[..., None], axis=-1)
    parts = {name: float(part) for name, part in parts.items()}
    assert parts["clone"] == pytest.approx(-np.log(chosen).mean(), abs=1e-5)
    assert parts["agreement"] == pytest.approx(np.mean(odds.argmax(-1) == np.asarray(obs["expert"])))
    assert float(loss) == pytest.approx(parts["clone"] + 0.5 * 0.5 * np.mean((np.asarray(value) - 1) ** 2), abs=1e-5)


def test_advice_beside_rewards_falls_to_nothing(generated_bank, monkeypatch: pytest.MonkeyPatch):
    """The gradient is that of PPO's loss plus the advice's times a weight that falls from the start."""
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("goal",), impl="kinematic", actions="discrete")
    advised = AdvisedPPO(env.core, dataclasses.replace(SMALL, advice_cost=0.25), ONE)
    state = jax.eval_shape(advised.init, env.params, jax.random.key(0))
    assert "expert" in state.actor.env.obs
    _, metrics = jax.eval_shape(advised.update, env.params, state)
    assert {"loss/clone", "loss/agreement", "loss/policy", "loss/entropy"} <= set(metrics)
    monkeypatch.setattr(advised, "apply_net", lambda net, batch: (None, None, jnp.float32(0.0), {}))
    monkeypatch.setattr(advised, "clipped_loss", lambda *read: (jnp.float32(2.0), {}))
    monkeypatch.setattr(home_mjx.training.imitation, "advice_loss", lambda *read: (jnp.float32(3.0), {}))
    steps = SimpleNamespace(obs={"expert": None})
    told = TrainBatch.build_unchecked(steps=steps, memory=None, advantage=None, target=None)
    for updates, weight in ((0, 0.25), (3.5, 0.125), (7, 0.0), (10, 0.0)):
        state = state.replace(updates=jnp.float32(updates))
        assert float(advised.current_loss(state)(None, told)[0]) == pytest.approx(2 + 3 * weight, abs=1e-6)


def test_advice_can_come_first():
    spec = EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav")
    run = RunConfig(spec, SMALL, clone_timesteps=96)
    assert [(name, ppo.num_updates) for name, ppo in run.stages] == [("clone", 3), ("ppo", 10)]
    assert RunConfig(spec, SMALL, algorithm="clone").stages == (("clone", SMALL),)
    with pytest.raises(ConfigError, match="precede PPO"):
        RunConfig(spec, SMALL, algorithm="clone", clone_timesteps=96)


@pytest.mark.slow
@pytest.mark.parametrize("killed_after", [2, 3, 5])
def test_a_run_of_two_stages_goes_on_from_either(hall: Path, tmp_path: Path, killed_after: int, monkeypatch):
    """Bit by bit, also from the very end of the first one."""
    options = {"sensors": ("goal",), "impl": "kinematic", "episode_length": 8, "actions": "discrete"}
    spec = dataclasses.replace(find_spec("PointNav-v0"), options=options, houses=str(hall), num_houses=1)
    config = RunConfig(spec, dataclasses.replace(SMALL, num_timesteps=32 * 4), clone_timesteps=32 * 3)
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    log = killed / "metrics.jsonl"
    whole.mkdir(), killed.mkdir()
    train(config, whole)
    with monkeypatch.context() as patch:
        patch.setattr(run_module._Run, "is_over", lambda run: len(read_lines(log)) + 1 >= killed_after)
        train(config, killed)
    assert read_updates(killed / CHECKPOINT_FILE) == killed_after
    train(config, killed, resume=True)
    one, other = (dict(np.load(out / CHECKPOINT_FILE)) for out in (whole, killed))
    assert int(one[".updates"]) == 7
    assert [name for name in one if not np.array_equal(one[name], other[name])] == []
    assert (whole / AGENT_FILE).read_bytes() == (killed / AGENT_FILE).read_bytes()
    assert [line["steps"] for line in read_lines(log)] == [32 * i for i in range(1, 8)]


def test_runs_say_how_they_learn():
    spec = EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav")
    assert RunConfig(spec).algorithm == "ppo"
    with pytest.raises(ConfigError, match="unknown algorithm"):
        RunConfig(spec, algorithm="cloning")


@pytest.fixture(scope="module")
def hall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One empty room: experts go straight, which can be told from where the goal is."""
    root = tmp_path_factory.mktemp("hall")
    write_library(root, [], {})
    write_house(root, outline_house("hall", [RoomOutline("Living_Room", [(0, 0), (6, 0), (6, 5), (0, 5)])], []))
    return root


@pytest.mark.slow
@pytest.mark.parametrize("actions", ["discrete", "continuous"])
def test_a_clone_learns_from_few_steps(hall: Path, actions: str):
    options = {"sensors": ("goal",), "impl": "kinematic", "ctrl_dt": 0.3, "episode_length": 60, "actions": actions}
    env = home_mjx.make("PointNav-v0", str(hall), **options)
    config = dataclasses.replace(
        CPU_CONFIG, num_timesteps=64 * 32 * 12, learning_rate=3e-3, network=NetworkConfig(features=64, memory=64)
    )
    cloning = BehaviorCloning(env.core, config, ONE)
    state, losses = cloning.init(env.params, jax.random.key(0)), []
    for _ in range(config.num_updates):
        state, metrics = cloning.update(env.params, state)
        losses.append(float(metrics["loss/clone"]))
    assert min(losses) < losses[0] - 0.3
    learned = evaluate(env, cloning.policy, state.net, num_episodes=64)["success"].mean()
    chance = evaluate(env, random_policy(env.core), num_episodes=64)["success"].mean()
    assert learned > chance + 0.4, (learned, chance)
