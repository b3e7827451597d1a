"""Trajectories of `record` are simulated again from keys and actions."""

import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="needs the extra `data`")

import home_mjx
from home_mjx.training.evaluation import random_policy
from home_mjx.training.trajectories import Trajectories, record
from home_mjx.viewer.replay.trajectories import is_trajectories, replay_trajectories


@pytest.mark.slow
def test_episodes_simulated_again_have_the_recorded_observations(tmp_path):
    options = {"sensors": ("state",), "impl": "kinematic", "episode_length": 6}
    env = home_mjx.make("PointNav-v0", "procedural:2?preset=flat&seed=7", **options)
    record(env, tmp_path, random_policy(env.core)(None), num_steps=24, num_envs=2, agent="random", progress=False)
    data = Trajectories(tmp_path)
    assert is_trajectories(tmp_path)
    assert len(data) >= 4  # also episodes of automatic resets
    other, replay = replay_trajectories(tmp_path)
    assert other.bank.house_ids == env.bank.house_ids
    for episode, track in zip(data, replay.tracks, strict=True):
        assert track.num_steps == len(episode.actions)
        assert track.notes["house"] == episode.notes["house"]
        assert track.series["reward"][1:] == pytest.approx(episode.rewards, abs=1e-5)
        assert np.array_equal(track.actions, episode.actions)
    assert len({tuple(episode.notes["reset_key"]) for episode in data}) == len(data)
