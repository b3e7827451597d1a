"""Held-out evaluation during training: the episodes of `evaluate`, in parts, and no effect on the training."""

import dataclasses
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

import home_mjx
from home_mjx.registry import find_spec
from home_mjx.training import CPU_CONFIG, NetworkConfig, Policy, RunConfig, evaluate, train
from home_mjx.training import run as run_module
from home_mjx.training.evaluation import with_episodes
from home_mjx.training.held_out import HeldOutRollout
from home_mjx.training.metrics_log import read_lines

LENGTH = 6  # [steps] of an episode


@pytest.fixture(scope="module")
def env(generated_bank):
    options = {"sensors": ("goal",), "impl": "kinematic", "ctrl_dt": 0.3, "episode_length": LENGTH}
    return with_episodes(home_mjx.make("PointNav-v0", generated_bank, **options), 8)


def test_parts_of_episodes_are_those_of_evaluate(env):
    """Of agents that move as their parameters say: all episodes end after the same number of steps."""

    def walk(net):
        return Policy(lambda memory, obs, begins, keys: (memory, net * jnp.ones((len(keys), 4)), {}))

    speed = jnp.array([0.3, 0.0, 0.5, 0.0])
    whole = evaluate(env, walk, speed, num_episodes=8)
    parts = HeldOutRollout(env, walk, speed, num_envs=4, num_steps=LENGTH // 2)
    assert parts.means() == {}
    parts.advance(speed)
    assert parts.means() == {"held_out/episodes": 0.0}
    for half, num_parts in ((slice(0, 4), 1), (slice(4, 8), 2)):
        for _ in range(num_parts):
            parts.advance(speed)
        found = parts.means()
        assert found["held_out/episodes"] == 4
        for name in ("distance", "success"):
            assert found[f"held_out/{name}"] == pytest.approx(float(np.mean(whole[name][half])), abs=1e-4)


@pytest.mark.slow
def test_training_is_the_same_with_and_without(env, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Bit by bit; lines of metrics have both rates."""
    monkeypatch.setattr(run_module, "make_env", lambda spec, progress: env)
    ppo = dataclasses.replace(
        CPU_CONFIG, num_envs=8, unroll_length=4, num_timesteps=128, num_minibatches=2, network=NetworkConfig(8, 8, (4,))
    )
    plain, watched = RunConfig(find_spec("PointNav-v0"), ppo), tmp_path / "watched"
    (tmp_path / "plain").mkdir(), watched.mkdir()
    train(plain, tmp_path / "plain")
    train(dataclasses.replace(plain, validation_houses=2), watched)
    one, other = (dict(np.load(out / "agent.npz")) for out in (tmp_path / "plain", watched))
    assert [name for name in one if name != "config" and not np.array_equal(one[name], other[name])] == []
    lines = read_lines(watched / "metrics.jsonl")
    assert sum(line["held_out/episodes"] for line in lines) >= 16  # 16 steps of 8 environments
    assert all("held_out/distance" in line for line in lines if line["held_out/episodes"])
