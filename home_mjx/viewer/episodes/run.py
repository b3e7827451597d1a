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

from home_mjx.core.files import write_json_lines, write_together
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.bound import BoundEnv
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.teacher import with_expert
from home_mjx.tasks.sensors.choose import keepers
from home_mjx.training.evaluation import check_episodes, with_episodes
from home_mjx.viewer.episodes.camera import FilmCamera, Sight, without_agents
from home_mjx.viewer.episodes.episode import Game, Outcome, Step, said
from home_mjx.viewer.episodes.film import Film, frame
from home_mjx.viewer.episodes.goal_markers import asked_of, goals_of, words_of
from home_mjx.viewer.episodes.keyboard import KeyboardPlayer, as_text, key_help
from home_mjx.viewer.episodes.overlay import Plan
from home_mjx.viewer.episodes.policies import POLICIES, Player, PolicyPlayer, check_agent, policy_of

AGENTS = (*POLICIES, "human")
HEARD = "audio"  # sensor state with the sound frame, for observations as waveforms or spectra
WIDTH, HEIGHT = 480, 360  # [px] size of the agent's view


@dataclass(frozen=True)
class PlayOptions:
    """Options of episodes and their film.

    Attributes:
        env: The environment.
        agent: One of `AGENTS`.
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
    width: int = WIDTH
    height: int = HEIGHT
    samples: int = 1

    @property
    def name(self) -> str:
        """Name of the files."""
        return f"{self.env.id}_{self.agent}"


def run_play(options: PlayOptions, tell: Callable[[str], Any] = tqdm.write, keys: Any = None) -> list[Outcome]:
    """Play episodes.

    Args:
        options: Options of episodes and film.
        tell: Callback for the line of each episode.
        keys: Input stream of a keyboard player; None: standard input.

    Returns:
        Result of each episode. With `out`, its folder gets a film, an image with the last frame of each episode, and
        the results as JSON lines, named after task and agent. On a full disk none of them is written.

    Raises:
        ConfigError: A checkpoint is missing, or for another agent or task; or the task has no expert.
    """
    check_agent(options.agent, options.checkpoint, AGENTS)
    check_episodes(options.episodes)
    env = with_episodes(options.env.make(), options.episodes, options.seed)
    env = with_expert(env) if options.agent == "expert" else env
    reporter = _Reporter(env, options)
    player = _player(env, options, reporter, keys)
    game, outcomes = Game(env), []
    rows = _rows(env, options)
    hidden = True if options.agent == "human" else None
    with tqdm(total=options.episodes, unit=" episodes", disable=hidden) as bar:
        for number, row in enumerate(rows, 1):
            for step in game.play(player, number, jax.random.key(options.seed + number), row):
                reporter.add(step)
                bar.set_postfix_str(f"step {int(step.state.world.step)}")
            assert game.outcome is not None
            outcomes.append(game.outcome)
            reporter.end(game.outcome)
            tell(game.outcome.line())
            bar.update()
    reporter.write(outcomes)
    return outcomes


def film_checkpoint(
    checkpoint: Path, out: Path, episodes: int, split: str = "val", num_houses: int = 4, seed: int = 0,
    greedy: bool = False, *, episode_file: str | Path | None = None, dataset: str | Path | None = None,
) -> list[Outcome]:  # fmt: skip
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
    from home_mjx.training import judged, read_config  # needs the extra `train`

    env = judged(read_config(checkpoint).env, split, num_houses, episode_file=episode_file, dataset=dataset)
    return run_play(PlayOptions(env, "trained", checkpoint, episodes, seed, greedy, out), lambda line: None)


def _rows(env: BoundEnv[HouseholdEnv], options: PlayOptions) -> list[int | None]:
    """Return rows of the tasks, shuffled without early repetition; those of a file in order."""
    if env.params.tasks is None:
        return [None] * options.episodes
    order = np.arange(len(env.params.tasks))
    if "episodes" not in options.env.options:
        order = np.random.default_rng(options.seed).permutation(order)
    return [int(order[i % len(order)]) for i in range(options.episodes)]


def _player(env: BoundEnv[HouseholdEnv], options: PlayOptions, reporter: "_Reporter", keys: Any) -> Player:
    if options.agent == "human":
        return KeyboardPlayer(env.core.own_config, reporter.show, keys)
    return PolicyPlayer(env.core, policy_of(env, options.agent, options.checkpoint, options.greedy), options.seed)


class _Reporter:
    """Film of the episodes, and display for a keyboard player."""

    def __init__(self, env: BoundEnv[HouseholdEnv], options: PlayOptions) -> None:
        self.env, self.options = env, options
        self.in_terminal = options.agent == "human" and sys.stdout.isatty()
        self.is_seen = options.out is not None or self.in_terminal
        self.camera = FilmCamera(env, options.width, options.height, options.samples)
        self.heard = HEARD in {sensor.name for sensor in keepers(env.core.sensors)}
        self.film = Film(env.dt, env.config.audio.sample_rate if self.heard else None)
        self.sights: list[Sight] = []
        self.words: dict[str, None] = {}  # that were said, each once, in their order

    def add(self, step: Step) -> None:
        """Record a step."""
        self.step = step
        is_first = step.action is None
        if is_first:
            self.asked, self.sights, self.words = asked_of(self.env, step.state), [], {}
            self.plan = Plan(self.env.bank, int(step.state.world.house))
        self.words |= dict.fromkeys(words_of(step.state))
        if not self.is_seen:
            return
        self.sights.append(self.camera.shot(step.state))
        if self.options.out is not None:
            moves = is_first or self.env.config.hands
            if is_first or not step.state.terminated:  # no goal is left in a terminal state
                self.goals = goals_of(self.env.bank, step.state, self.sights[-1].boxes)
            scene = without_agents(self.env, step.state) if moves else None
            self.top = self.plan.drawn(scene, self.sights, self.goals)
            self.film.add(self._frame(said(self.env, step, self.options.agent)), self._sound(step))

    def end(self, outcome: Outcome) -> None:
        """Add the result of the episode to the film."""
        if self.options.out is not None:
            spl = "" if np.isnan(outcome.spl) else f"   SPL {outcome.spl:.2f}"
            how = "success" if outcome.success else "failure"
            words = f"   said {', '.join(self.words)}" if self.words else ""
            text = f"{self.options.agent}   {how}{spl}   {outcome.steps} steps   return {outcome.gained:+.2f}{words}"
            self.film.end(self._frame(text, outcome.success > 0))

    def show(self, state: Any) -> None:
        """Print view, instruction and status for a keyboard player before each action."""
        lines = [as_text(self.sights[-1].view)] if self.in_terminal else []
        if self.step.action is None:
            lines += [key_help(self.env.config)]
        lines += [self.asked.text, said(self.env, self.step, "you")]
        sys.stdout.write(("\x1b[H\x1b[J" if self.in_terminal else "") + "\n".join(lines) + "\n")
        sys.stdout.flush()

    def write(self, outcomes: list[Outcome]) -> None:
        """Write the film and the results."""
        out, name = self.options.out, self.options.name
        if out is not None:
            with write_together(out, "film") as beside:
                self.film.write(beside, name)
                write_json_lines(beside / f"{name}.jsonl", map(dataclasses.asdict, outcomes), "outcomes")

    def _frame(self, status: str, success: bool | None = None) -> np.ndarray:
        return frame(self.sights[-1].view, self.top, self.asked.text, status, success)

    def _sound(self, step: Step) -> np.ndarray | None:
        return np.asarray(step.state.world.sensors[HEARD].frame)[0] if self.heard else None
