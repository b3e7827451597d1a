"""Trajectories of `home-mjx record`, whose episodes are simulated again from their keys and actions."""

import dataclasses
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.core.progress import say
from home_mjx.env_factory import make
from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import RunStart
from home_mjx.training.trajectories import Trajectories, Trajectory
from home_mjx.training.trajectories.minari_format import RESET_KEY, ROW
from home_mjx.viewer.episodes.episode import EpisodeRunner
from home_mjx.viewer.replay.recorder import ReplayRecorder
from home_mjx.viewer.replay.track import Replay

MAX_EPISODES = 20  # episodes that are simulated again
MAX_DIFFERENCE = 1e-3  # of rewards, above which an episode counts as another one
SPEC = "home_mjx_env"  # name of the environment in the metadata


def is_trajectories(path: Path) -> bool:
    """Return whether a path is a folder with a data set of trajectories."""
    return (path / "data" / "metadata.json").exists()


def replay_trajectories(
    folder: Path, sensors: tuple[str, ...] | None = None, max_episodes: int = MAX_EPISODES
) -> tuple[Env[HouseholdEnv], Replay]:
    """Simulate the first episodes of a data set again, and record them; return them with their environment.

    Where the rewards differ from the recorded ones, such as on another device, a line says from which step on.

    Args:
        folder: Folder of `home-mjx record`.
        sensors: Sensors of the environment; None: as recorded.
        max_episodes: Maximum number of episodes.

    Raises:
        ConfigError: The data set does not name its environment, or episodes have no key (older versions).
        DatasetError: It is broken.
    """
    data = Trajectories(folder)
    if SPEC not in data.metadata:
        raise ConfigError("the data set does not name its environment", file=folder, hint="Record it by a task's id.")
    spec = EnvSpec.from_json(data.metadata[SPEC])
    spec.check_trusted()
    if sensors is not None:
        spec = dataclasses.replace(spec, options={**spec.options, "sensors": sensors})
    env, recorder = make(spec), ReplayRecorder()
    runner = EpisodeRunner(env)
    recorder.on_run_start(RunStart(str(data.metadata["algorithm_name"]), env, "episodes", len(data)))
    for number in range(min(len(data), max_episodes)):
        _simulate(runner, number + 1, data[number], recorder)
    return env, recorder.replay


def _simulate(runner: EpisodeRunner, number: int, episode: Trajectory, recorder: ReplayRecorder) -> None:
    """Simulate one episode again with a recorder."""
    if RESET_KEY not in episode.notes:
        hint = "Record the data set again: episodes of older versions have no key."
        raise ConfigError(f"episode {number - 1} cannot be simulated again", hint=hint)
    key = jax.random.wrap_key_data(jnp.array(episode.notes[RESET_KEY], jnp.uint32), impl="threefry2x32")
    row, houses = int(episode.notes[ROW]), list(runner.env.bank.house_ids)
    house = houses.index(episode.notes["house"]) if row < 0 else None  # a person may have chosen it
    running = runner.begin(number, key, row if row >= 0 else None, house)
    recorder.on_episode_start(running.start)
    recorder.on_episode_step(running.step)
    first = None
    for index, (action, reward) in enumerate(zip(episode.actions, episode.rewards, strict=True), 1):
        step = running.advance(jnp.asarray(action))
        recorder.on_episode_step(step)
        differs = abs(float(np.mean(step.state.reward)) - reward) > MAX_DIFFERENCE
        first = index if first is None and differs else first
        if step.state.done:
            break
    recorder.on_episode_end(running.result())
    if first is not None:
        say(f"episode {number - 1} differs from the recorded one from step {first} on: another device or version")
