"""Playing from options to episodes, lines of text and a film."""

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from home_mjx.core.files import write_all_or_none
from home_mjx.env_factory import make, make_core
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, Observer, ObserverGroup, RunStart, resolve_observers
from home_mjx.tasks.experts.expert_observation import add_expert
from home_mjx.training.evaluation import check_episodes, with_episodes
from home_mjx.training.progress import ProgressBar
from home_mjx.viewer.episodes.episode import run_episodes
from home_mjx.viewer.episodes.keyboard import KeyboardPlayer
from home_mjx.viewer.episodes.observers import (
    DEFAULT_HEIGHT,
    DEFAULT_WIDTH,
    FilmObserver,
    ResultsObserver,
    ShotCache,
    TerminalObserver,
)
from home_mjx.viewer.episodes.policies import POLICIES, Player, PolicyPlayer, check_agent, make_policy

HUMAN = "human"
BLIND_SENSORS = ("state",)  # sensors of agents that do not use observations
AGENT_NAMES = (*POLICIES, HUMAN)


@dataclass(frozen=True)
class PlayOptions:
    """Options of episodes and their film.

    Attributes:
        env: The environment.
        agent: One of `AGENT_NAMES`.
        checkpoint: Checkpoint of agent `trained`.
        episodes: Number of episodes.
        seed: Seed of episodes and actions.
        greedy: Take a trained agent's most likely action.
        out: Folder for the film; None: no film.
        width: Width of the agent's view [px].
        height: Height of the agent's view [px].
        samples: Rays per pixel.
        name: Name of the files; "" for task and agent.
    """

    env: EnvSpec
    agent: str = "expert"
    checkpoint: Path | None = None
    episodes: int = 3
    seed: int = 0
    greedy: bool = False
    out: Path | None = None
    width: int = DEFAULT_WIDTH
    height: int = DEFAULT_HEIGHT
    samples: int = 1
    name: str = ""

    @property
    def file_name(self) -> str:
        """Name of the files without suffix: `name`, or `<environment id>_<agent>` if it is empty."""
        return self.name or f"{self.env.id}_{self.agent}"


def run_play(
    options: PlayOptions,
    print_line: Callable[[str], Any] = tqdm.write,
    key_source: Any = None,
    observers: Iterable[Observer | str] = (),
    shots: ShotCache | None = None,
) -> list[EpisodeResult]:
    """Play episodes of one environment; print a line for each, and film them if `options.out` is given.

    Args:
        options: Options of episodes and film.
        print_line: Callback for the line of each episode.
        key_source: Input stream of a keyboard player; None: standard input.
        observers: Further observers of the episodes, or their names. With `out`, each writes its files there.
        shots: Views of the first agent, which observers may share; None: new ones of the options' size.

    Returns:
        Result of each episode. With `out`, its folder, created if missing, gets a film, an image with the last frame of
        each episode, and the results as JSON lines, named `options.file_name`. On a full disk none of them is written.

    Raises:
        ConfigError: A checkpoint is missing, or for another agent or task; the task has no expert; the number of
            episodes is invalid; or the files cannot be written.
        UnknownNameError: A name in `observers` is unknown.
    """
    check_agent(options.agent, options.checkpoint, AGENT_NAMES)
    check_episodes(options.episodes)
    more = resolve_observers(observers)
    env = with_episodes(make(options.env), options.episodes, options.seed)
    env = add_expert(env) if options.agent == "expert" else env
    player = _make_player(env, options, key_source)
    with ObserverGroup((*_own_observers(options, print_line, shots), *more)) as group:
        group.on_run_start(RunStart(options.agent, env, "episodes", options.episodes))
        results = run_episodes(env, player, _task_rows(env, options), options.seed, group)
        if options.out is not None:
            with write_all_or_none(options.out, "film") as folder:
                group.write(folder)
    return results


def default_sensors(spec: EnvSpec) -> tuple[str, ...]:
    """Return the sensors of a task whose agent uses none: `state`, and `audio` in tasks with sounds.

    These play sounds or require hearing, or bodies sound when they touch. Entry points that are functions, not a
    `Task`, count as silent.
    """
    hearing = dataclasses.replace(spec, options={**spec.options, "sensors": (*BLIND_SENSORS, "audio")})
    core = make_core(hearing)
    has_sounds = core is not None and bool(
        core.task.clips or core.task.requires_hearing or core.config.contact_sounds is not None
    )
    return (*BLIND_SENSORS, "audio") if has_sounds else BLIND_SENSORS


def _own_observers(
    options: PlayOptions, print_line: Callable[[str], Any], shots: ShotCache | None
) -> Iterator[Observer]:
    """Yield the observers that the options imply.

    These are the film (with `out`), the terminal of a human, results and progress. Film and terminal share images.
    """
    shots = shots or ShotCache(options.width, options.height, options.samples)
    if options.out is not None:
        yield FilmObserver(shots, options.file_name)
    if options.agent == HUMAN:
        yield TerminalObserver(shots, has_keys=True)
    yield ResultsObserver(options.file_name, print_line)
    yield ProgressBar(False if options.agent == HUMAN else None)


def film_checkpoint(
    checkpoint: Path, out: Path, episodes: int, split: str = "val", num_houses: int = 4, seed: int = 0,
    greedy: bool = False, *, episode_file: str | Path | None = None, dataset: str | Path | None = None,
) -> list[EpisodeResult]:  # fmt: skip
    """Film episodes of a trained agent; files are those of `run_play`.

    Args:
        checkpoint: Checkpoint of the agent.
        out: Folder for the film; created if missing.
        episodes: Number of episodes.
        split: Split of the dataset that houses are from.
        num_houses: Number of houses.
        seed: Seed of episodes and actions.
        greedy: Take the most likely action instead of sampling.
        episode_file: Use the first episodes of this file, in the houses that it names, instead; again from the first
            if it has too few.
        dataset: Root of a dataset other than that of training.

    Returns:
        Result of each episode; nothing is printed.
    """
    from home_mjx.training import evaluation_spec, read_config  # needs the extra `train`

    env = evaluation_spec(read_config(checkpoint).env, split, num_houses, episode_file=episode_file, dataset=dataset)
    return run_play(PlayOptions(env, "trained", checkpoint, episodes, seed, greedy, out), lambda line: None)


def _task_rows(env: Env[HouseholdEnv], options: PlayOptions) -> list[int | None]:
    """Return a task row per episode: in order if from a file, else shuffled; repeated in turn. None without tasks."""
    if env.params.tasks is None:
        return [None] * options.episodes
    order = np.arange(len(env.params.tasks))
    if "episodes" not in options.env.options:
        order = np.random.default_rng(options.seed).permutation(order)
    return [int(order[i % len(order)]) for i in range(options.episodes)]


def _make_player(env: Env[HouseholdEnv], options: PlayOptions, keys: Any) -> Player:
    """Return the player of the agent that the options name; `keys` is the input stream of a human."""
    if options.agent == HUMAN:
        return KeyboardPlayer(env.core.acting_config, keys)
    return PolicyPlayer(env.core, make_policy(env, options.agent, options.checkpoint, options.greedy), options.seed)
