"""Episodes that an observer records as trajectories: those that were played; they begin again from their keys."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="needs the extra `train`")

from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.tasks.env.observers import RunStart
from home_mjx.training.trajectories import Trajectories
from home_mjx.viewer.episodes.episode import EpisodeRunner
from home_mjx.viewer.episodes.trajectory_observer import EDITED, LEFT, TrajectoryObserver

NUM_STEPS = 6


@pytest.fixture(scope="module")
def env():
    houses = [shoebox(furniture=(Furniture((x, 0.0)),)) for x in (1.0, -1.0)]
    bank = HouseBank.from_compiled([dataclasses.replace(house, id=f"box {n}") for n, house in enumerate(houses)])
    return home_mjx.make("PointNav-v0", bank, sensors=("state", "goal"), impl="kinematic", episode_length=NUM_STEPS)


def drive(runner: EpisodeRunner, observer: TrajectoryObserver, seed: int, house: int, num_steps: int) -> list:
    """Drive an episode, which is left if it has more steps; return its steps."""
    episode = runner.begin(1, jax.random.key(seed), None, house)
    observer.on_episode_start(episode.start)
    steps = [episode.step]
    observer.on_episode_step(episode.step)
    for turn in np.random.default_rng(seed).uniform(-1, 1, num_steps):
        steps.append(episode.advance(np.array([1, 0, turn, 0], np.float32)))
        observer.on_episode_step(steps[-1])
    if steps[-1].state.done:
        observer.on_episode_end(episode.result())
    return steps


def test_driven_episodes_are_a_data_set_that_begins_again_from_its_keys(env, tmp_path):
    runner, lines = EpisodeRunner(env), []
    observer = TrajectoryObserver(tmp_path, lines.append)
    observer.on_run_start(RunStart("human", env, "episodes", 1))
    whole = drive(runner, observer, 3, 1, NUM_STEPS)
    left = drive(runner, observer, 4, 0, 2)
    observer.on_episode_step(left[-1])  # as after a click on a door
    drive(runner, observer, 5, 0, 0)  # an episode without a step
    observer.close()
    assert lines == [f"2 episodes, {NUM_STEPS + 2} steps in {tmp_path / 'PointNav-v0_human'}"]
    data = Trajectories(tmp_path / "PointNav-v0_human")
    for steps, episode in zip((whole, left), data, strict=True):
        assert np.array_equal(episode.actions, [step.action for step in steps[1:]])
        assert episode.rewards == pytest.approx([float(step.state.reward) for step in steps[1:]])
        for name, values in episode.observations.items():
            assert np.array_equal(values, [step.state.obs[name] for step in steps])
        assert episode.notes["distance"] == pytest.approx(float(steps[-1].state.metrics["distance"]))
        assert episode.terminations.tolist() == [False] * len(episode.rewards)  # the goal is far
        assert episode.truncations.tolist() == [False] * (len(episode.rewards) - 1) + [True]
        key = jax.random.wrap_key_data(jnp.array(episode.notes["reset_key"], jnp.uint32))
        house = env.bank.house_ids.index(episode.notes["house"])
        again = runner.begin(1, key, None, house).step.state.obs
        assert all(np.array_equal(again[name], values[0]) for name, values in episode.observations.items())
    assert [(LEFT in episode.notes, EDITED in episode.notes) for episode in data] == [(False, False), (True, True)]


def test_a_data_set_is_continued_only_with_the_same_observations(env, tmp_path):
    for seed in (1, 2):
        observer = TrajectoryObserver(tmp_path, lambda line: None)
        observer.on_run_start(RunStart("human", env, "episodes", 1))
        drive(EpisodeRunner(env), observer, seed, 0, 1)
        observer.close()
    assert len(Trajectories(tmp_path / "PointNav-v0_human")) == 2
    other = home_mjx.make("PointNav-v0", env.bank, sensors=("state",), impl="kinematic")
    with pytest.raises(ConfigError, match="observation_space"):
        TrajectoryObserver(tmp_path).on_run_start(RunStart("human", other, "episodes", 1))
    lines = []
    observer = TrajectoryObserver(tmp_path, lines.append)
    observer.on_run_start(RunStart("human", env, "episodes", 1))
    observer.on_run_start(RunStart("human", other, "episodes", 1))  # another task chosen in the page
    drive(EpisodeRunner(other), observer, 1, 0, 1)
    observer.close()
    assert len(Trajectories(tmp_path / "PointNav-v0_human")) == 2
    assert lines[-1].startswith("nothing is recorded: the dataset has another `observation_space`")
