"""Playing from options to episodes, lines of text and a film."""

import dataclasses
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np
from tqdm import tqdm

from home_mjx.core.files import write_all_or_none, write_json_lines
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.bound import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.teacher import add_expert
from home_mjx.tasks.sensors.choose import state_owners
from home_mjx.training.evaluation import check_episodes, with_episodes
from home_mjx.viewer.episodes.camera import CameraShot, FilmCamera, scene_without_agents
from home_mjx.viewer.episodes.episode import EpisodeResult, EpisodeRunner, EpisodeStep, format_status
from home_mjx.viewer.episodes.film import VideoWriter, compose_frame
from home_mjx.viewer.episodes.goal_markers import get_goal_markers, get_instruction, get_utterances
from home_mjx.viewer.episodes.keyboard import KeyboardPlayer, image_to_text, key_help
from home_mjx.viewer.episodes.overlay import TopDownOverlay
from home_mjx.viewer.episodes.policies import POLICIES, Player, PolicyPlayer, check_agent, make_policy

AGENT_NAMES = (*POLICIES, "human")
SOUND_STATE = "audio"  # sensor state with the sound frame, for observations as waveforms or spectra
DEFAULT_WIDTH, DEFAULT_HEIGHT = 480, 360  # [px] size of the agent's view


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

    @property
    def name(self) -> str:
        """Name of the files."""
        return f"{self.env.id}_{self.agent}"


def run_play(
    options: PlayOptions, print_line: Callable[[str], Any] = tqdm.write, key_source: Any = None
) -> list[EpisodeResult]:
    """Play episodes.

    Args:
        options: Options of episodes and film.
        print_line: Callback for the line of each episode.
        key_source: Input stream of a keyboard player; None: standard input.

    Returns:
        Result of each episode. With `out`, its folder gets a film, an image with the last frame of each episode, and
        the results as JSON lines, named after task and agent. On a full disk none of them is written.

    Raises:
        ConfigError: A checkpoint is missing, or for another agent or task; or the task has no expert.
    """
    check_agent(options.agent, options.checkpoint, AGENT_NAMES)
    check_episodes(options.episodes)
    env = with_episodes(options.env.make(), options.episodes, options.seed)
    env = add_expert(env) if options.agent == "expert" else env
    reporter = _Reporter(env, options)
    player = _make_player(env, options, reporter, key_source)
    game, outcomes = EpisodeRunner(env), []
    rows = _task_rows(env, options)
    hidden = True if options.agent == "human" else None
    with tqdm(total=options.episodes, unit=" episodes", disable=hidden) as bar:
        for number, row in enumerate(rows, 1):
            for step in game.run(player, number, jax.random.key(options.seed + number), row):
                reporter.add(step)
                bar.set_postfix_str(f"step {int(step.state.world.step)}")
            assert game.result is not None
            outcomes.append(game.result)
            reporter.end(game.result)
            print_line(game.result.format_line())
            bar.update()
    reporter.write(outcomes)
    return outcomes


def film_checkpoint(
    checkpoint: Path, out: Path, episodes: int, split: str = "val", num_houses: int = 4, seed: int = 0,
    greedy: bool = False, *, episode_file: str | Path | None = None, dataset: str | Path | None = None,
) -> list[EpisodeResult]:  # fmt: skip
    """Film episodes of a trained agent.

    Args:
        checkpoint: Checkpoint of the agent.
        out: Folder for the film; it exists.
        episodes: Number of episodes.
        split: Split of the dataset that houses are from.
        num_houses: Number of houses.
        seed: Seed of episodes and actions.
        greedy: Take the most likely action instead of sampling.
        episode_file: Use the first episodes of this file, in the houses that it names, instead.
        dataset: Root of a dataset other than that of training.

    Returns:
        Result of each episode; nothing is printed.
    """
    from home_mjx.training import evaluation_spec, read_config  # needs the extra `train`

    env = evaluation_spec(read_config(checkpoint).env, split, num_houses, episode_file=episode_file, dataset=dataset)
    return run_play(PlayOptions(env, "trained", checkpoint, episodes, seed, greedy, out), lambda line: None)


def _task_rows(env: Env[HouseholdEnv], options: PlayOptions) -> list[int | None]:
    """Return rows of the tasks, shuffled without early repetition; those of a file in order."""
    if env.params.tasks is None:
        return [None] * options.episodes
    order = np.arange(len(env.params.tasks))
    if "episodes" not in options.env.options:
        order = np.random.default_rng(options.seed).permutation(order)
    return [int(order[i % len(order)]) for i in range(options.episodes)]


def _make_player(env: Env[HouseholdEnv], options: PlayOptions, reporter: "_Reporter", keys: Any) -> Player:
    if options.agent == "human":
        return KeyboardPlayer(env.core.acting_config, reporter.show, keys)
    return PolicyPlayer(env.core, make_policy(env, options.agent, options.checkpoint, options.greedy), options.seed)


class _Reporter:
    """Film of the episodes, and display for a keyboard player."""

    def __init__(self, env: Env[HouseholdEnv], options: PlayOptions) -> None:
        self.env, self.options = env, options
        self.in_terminal = options.agent == "human" and sys.stdout.isatty()
        self.is_seen = options.out is not None or self.in_terminal
        self.camera = FilmCamera(env, options.width, options.height, options.samples)
        self.heard = SOUND_STATE in {sensor.name for sensor in state_owners(env.core.sensors)}
        self.film = VideoWriter(env.dt, env.config.audio.sample_rate if self.heard else None)
        self.sights: list[CameraShot] = []
        self.words: dict[str, None] = {}  # that were said, each once, in their order

    def add(self, step: EpisodeStep) -> None:
        """Record a step."""
        self.step = step
        is_first = step.action is None
        if is_first:
            self.asked, self.sights, self.words = get_instruction(self.env, step.state), [], {}
            self.plan = TopDownOverlay(self.env.bank, int(step.state.world.house))
        self.words |= dict.fromkeys(get_utterances(step.state))
        if not self.is_seen:
            return
        self.sights.append(self.camera.capture(step.state))
        if self.options.out is not None:
            moves = is_first or self.env.config.hands
            if is_first or not step.state.terminated:  # no goal is left in a terminal state
                self.goals = get_goal_markers(self.env.bank, step.state, self.sights[-1].boxes)
            scene = scene_without_agents(self.env, step.state) if moves else None
            self.top = self.plan.draw(scene, self.sights, self.goals)
            self.film.add(self._frame(format_status(self.env, step, self.options.agent)), self._sound(step))

    def end(self, outcome: EpisodeResult) -> None:
        """Add the result of the episode to the film."""
        if self.options.out is not None:
            spl = "" if np.isnan(outcome.spl) else f"   SPL {outcome.spl:.2f}"
            how = "success" if outcome.success else "failure"
            words = f"   said {', '.join(self.words)}" if self.words else ""
            text = f"{self.options.agent}   {how}{spl}   {outcome.steps} steps   return {outcome.episode_return:+.2f}{words}"
            self.film.add_final(self._frame(text, outcome.success > 0))

    def show(self, state: Any) -> None:
        """Print view, instruction and status for a keyboard player before each action."""
        lines = [image_to_text(self.sights[-1].view)] if self.in_terminal else []
        if self.step.action is None:
            lines += [key_help(self.env.config)]
        lines += [self.asked.text, format_status(self.env, self.step, "you")]
        sys.stdout.write(("\x1b[H\x1b[J" if self.in_terminal else "") + "\n".join(lines) + "\n")
        sys.stdout.flush()

    def write(self, outcomes: list[EpisodeResult]) -> None:
        """Write the film and the results."""
        out, name = self.options.out, self.options.name
        if out is not None:
            with write_all_or_none(out, "film") as beside:
                self.film.write(beside, name)
                write_json_lines(beside / f"{name}.jsonl", map(dataclasses.asdict, outcomes), "outcomes")

    def _frame(self, status: str, success: bool | None = None) -> np.ndarray:
        return compose_frame(self.sights[-1].view, self.top, self.asked.text, status, success)

    def _sound(self, step: EpisodeStep) -> np.ndarray | None:
        return np.asarray(step.state.world.sensor_states[SOUND_STATE].frame)[0] if self.heard else None
