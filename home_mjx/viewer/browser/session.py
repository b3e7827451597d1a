"""Session of one environment in the viewer: a loop of steps in real time, and commands from other threads."""

import time
from collections import deque
from collections.abc import Callable
from pathlib import Path

import jax
import numpy as np

from home_mjx.errors import HomeMjxError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart
from home_mjx.tasks.experts.expert_observation import add_expert
from home_mjx.viewer.episodes.command_loop import CommandLoop
from home_mjx.viewer.episodes.episode import EpisodeRunner, RunningEpisode
from home_mjx.viewer.episodes.held_keys import HeldKeys, HeldKeysPlayer
from home_mjx.viewer.episodes.policies import Player, PolicyPlayer, make_policy
from home_mjx.viewer.episodes.run import HUMAN

PAUSE_AFTER_EPISODE = 1.5  # [s]
MAX_LAG = 0.25  # [s], delay of steps that is caught up; longer delays are forgotten
PACE_STEPS = 20  # steps over which the real-time factor is measured


class Session(CommandLoop):
    """One environment, its agent and the current episode.

    Args:
        env: The environment.
        agent: `expert`, `random`, `trained` or `human`.
        observer: Observer of all episodes.
        keys: Keys of a human agent.
        checkpoint: Checkpoint of `trained`.
        seed: Seed of the first episode and of actions; each further episode adds 1.
        on_error: Callback with the message of a command that failed.

    Attributes:
        agent: Name of the agent.
        episode: The current episode.
        house: Index of the house of the next episodes; None: any.

    Raises:
        ConfigError: The agent cannot play this environment.
    """

    episode: RunningEpisode

    def __init__(
        self,
        env: Env[HouseholdEnv],
        agent: str,
        observer: Observer,
        keys: HeldKeys,
        checkpoint: Path | None = None,
        seed: int = 0,
        on_error: Callable[[str], None] = lambda text: None,
    ) -> None:
        super().__init__(on_error)
        self.observer, self.keys, self.checkpoint, self.seed = observer, keys, checkpoint, seed
        self.house: int | None = None
        self._number, self._times = 0, deque(maxlen=PACE_STEPS)
        self.load(env, agent)

    @property
    def env(self) -> Env[HouseholdEnv]:
        """The environment of the current agent."""
        return self._runner.env

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second over the last steps; 0 before the second step."""
        seconds = self._times[-1] - self._times[0] if len(self._times) > 1 else np.inf
        return (len(self._times) - 1) * self.env.dt / seconds if len(self._times) > 1 else 0.0

    def load(self, env: Env[HouseholdEnv], agent: str) -> None:
        """Replace environment and agent, and start an episode; on an error nothing is replaced."""
        runner = EpisodeRunner(add_expert(env) if agent == "expert" else env)
        player = self._make_player(runner.env, agent)
        house = None if self.house is None or self.house >= env.bank.num_houses else self.house
        episode = self._begin(runner, house)
        self._plain, self.agent, self._runner, self._player, self.house = env, agent, runner, player, house
        self.observer.on_run_start(RunStart(agent, runner.env, "episodes", 1))
        self._show(episode)

    def set_agent(self, agent: str) -> None:
        """Replace the agent, and start an episode."""
        self.load(self._plain, agent)

    def reset(self, seed: int | None = None) -> None:
        """Start an episode with a seed; None: the next one."""
        self.seed = self.seed + 1 if seed is None else seed
        self._show(self._begin(self._runner, self.house))

    def advance(self) -> None:
        """Take one step, unless the episode is over or a person has not chosen an action."""
        episode = self.episode
        if episode.step.state.done:
            return
        action = self._player.act(episode.step.state)
        if action is None:
            return
        self._times.append(time.perf_counter())
        self.observer.on_episode_step(episode.advance(action))
        if episode.step.state.done:
            self.observer.on_episode_end(episode.result())
            self.due = time.perf_counter() + PAUSE_AFTER_EPISODE

    def replace_state(self, state: State) -> None:
        """Go on from another state of this episode, such as one with a door opened."""
        step = self.episode.step
        self.episode.step = EpisodeStep(step.index, state, step.action, step.episode_return)
        self.observer.on_episode_step(self.episode.step)

    def turn(self) -> None:
        """Take the step that is due, or start the next episode."""
        if self.episode.step.state.done:
            self.reset()
            return
        self.due = max(self.due, time.perf_counter() - MAX_LAG) + self.env.dt / self.speed
        self.advance()

    def _make_player(self, env: Env[HouseholdEnv], agent: str) -> Player:
        """Return the player of an agent."""
        if agent == HUMAN:
            return HeldKeysPlayer(env.core.acting_config, self.keys)
        checkpoint = self.checkpoint if agent == "trained" else None
        return PolicyPlayer(env.core, make_policy(env, agent, checkpoint), self.seed)

    def _begin(self, runner: EpisodeRunner, house: int | None) -> RunningEpisode:
        """Begin an episode in a house; environments with rows take one of the house's rows."""
        rng, tasks, env = np.random.default_rng(self.seed), runner.env.params.tasks, runner.env
        self._number += 1
        key = jax.random.key(self.seed)
        if tasks is None:
            chosen = rng.integers(env.bank.num_houses) if house is None else house
            return runner.begin(self._number, key, None, int(chosen))
        rows = np.arange(len(tasks)) if house is None else np.flatnonzero(np.asarray(tasks.house) == house)
        if not len(rows):
            raise HomeMjxError(f"there is no task in house {env.bank.house_ids[house or 0]}")
        return runner.begin(self._number, key, int(rng.choice(rows)))

    def _show(self, episode: RunningEpisode) -> None:
        """Make an episode the current one."""
        self.episode = episode
        self._times.clear()
        self._player.reset()
        self.observer.on_episode_start(episode.start)
        self.observer.on_episode_step(episode.step)
        self.due = time.perf_counter() + self.env.dt / self.speed
