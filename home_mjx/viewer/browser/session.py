"""Session of environments in the viewer, one of them watched: a loop of steps in real time, and commands."""

import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

import jax
import numpy as np

from home_mjx.errors import HomeMjxError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart
from home_mjx.tasks.experts.expert_observation import add_expert
from home_mjx.viewer.browser.checkpoints import Checkpoints
from home_mjx.viewer.episodes.command_loop import CommandLoop
from home_mjx.viewer.episodes.episode import EpisodeRunner, RunningEpisode
from home_mjx.viewer.episodes.held_keys import HeldKeys, HeldKeysPlayer
from home_mjx.viewer.episodes.policies import PolicyPlayer, check_agent, load_trained, make_policy
from home_mjx.viewer.episodes.run import HUMAN

PAUSE_AFTER_EPISODE = 1.5  # [s]
MAX_LAG = 0.25  # [s], delay of steps that is caught up; longer delays are forgotten
SEED_STRIDE = 10_000  # between the seeds of two environments
PACE_STEPS = 20  # steps over which the real-time factor is measured


class Session(CommandLoop):
    """Environments of one kind with their agents and episodes, of which one is watched.

    A human drives the watched environment; agents of the others are then `random`.

    Args:
        env: The environment.
        agent: `expert`, `random`, `trained` or `human`.
        observer: Observer of all episodes.
        keys: Keys of human agents, one person each.
        checkpoint: Checkpoint of `trained`, or a folder, whose newest one is loaded again at each reset.
        seed: Seed of the first episode and of actions; each further episode adds 1.
        on_error: Callback with the message of a command that failed.
        num_envs: Number of environments.

    Attributes:
        agent: Name of the agent.
        episodes: The current episode of each environment.
        watched: Number of the watched environment.
        checkpoints: Checkpoints of `trained`.
        house: Index of the house of the next episodes; None: any.

    Raises:
        ConfigError: The agent cannot play this environment.
    """

    def __init__(
        self,
        env: Env[HouseholdEnv],
        agent: str,
        observer: Observer,
        keys: Sequence[HeldKeys],
        checkpoint: Path | None = None,
        seed: int = 0,
        on_error: Callable[[str], None] = lambda text: None,
        num_envs: int = 1,
    ) -> None:
        super().__init__(on_error)
        self.observer, self.keys, self.seed = observer, keys, seed
        self.checkpoints = Checkpoints(checkpoint)
        self.house: int | None = None
        self.num_envs, self.watched, self.episodes = num_envs, 0, list[RunningEpisode]()
        self._seeds = [seed + SEED_STRIDE * n for n in range(num_envs)]
        self._number, self._times = 0, deque(maxlen=PACE_STEPS)
        self.load(env, agent)

    @property
    def episode(self) -> RunningEpisode:
        """Episode of the watched environment."""
        return self.episodes[self.watched]

    @property
    def env(self) -> Env[HouseholdEnv]:
        """The environment of the current agent."""
        return self._runner.env

    @property
    def value(self) -> float | None:
        """Value that the watched agent's network gave the state before its last step; None if it gives none."""
        outputs = getattr(self._human or self._players[self.watched], "outputs", {})
        return float(outputs["value"][0]) if "value" in outputs else None

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second over the last steps; 0 before the second step."""
        seconds = self._times[-1] - self._times[0] if len(self._times) > 1 else np.inf
        return (len(self._times) - 1) * self.env.dt / seconds if len(self._times) > 1 else 0.0

    def load(self, env: Env[HouseholdEnv], agent: str) -> None:
        """Replace environment and agent, and start an episode; on an error nothing is replaced."""
        runner = EpisodeRunner(add_expert(env) if agent == "expert" else env)
        players = self._make_players(runner.env, agent)
        house = None if self.house is None or self.house >= env.bank.num_houses else self.house
        self._seeds[self.watched] = self.seed  # of the episode that begins
        episodes = [self._begin(runner, house, seed) for seed in self._seeds]
        self._plain, self.agent, self._runner, self._players, self.house = env, agent, runner, players, house
        self.episodes = episodes
        self.observer.on_run_start(RunStart(agent, runner.env, "episodes", 1))
        self._show()

    def set_agent(self, agent: str) -> None:
        """Replace the agent, and start an episode."""
        self.load(self._plain, agent)

    def reset(self, seed: int | None = None) -> None:
        """Start an episode with a seed; None: the next one. A newer checkpoint is loaded before it."""
        if self.agent == "trained" and self.checkpoints.has_changed():
            try:
                self._load_net()
            except HomeMjxError as error:  # the episodes go on with the parameters before
                self._on_error(str(error))
        self.seed = self.seed + 1 if seed is None else seed
        self._seeds[self.watched] = self.seed
        self.episodes[self.watched] = self._begin(self._runner, self.house, self.seed)
        self._players[self.watched].reset()
        self._show()

    def choose_checkpoint(self, name: str) -> None:
        """Load another checkpoint, see `Checkpoints.choose`, and start episodes of all environments with it."""
        before = self.checkpoints
        self.checkpoints = before.choose(name)
        try:
            self._load_net()
        except HomeMjxError:
            self.checkpoints = before
            raise
        self.episodes = [self._begin(self._runner, self.house, seed) for seed in self._seeds]
        self._show()

    def _load_net(self) -> None:
        """Load the parameters of all players; the memory of each begins anew.

        Networks of other shapes are loaded with their own policy, which compiles.
        """
        make, net = load_trained(self.checkpoints.load_path(), self.env.core)
        shapes = [jax.tree.map(lambda x: (x.shape, x.dtype), tree) for tree in (net, self._players[0].net)]
        if shapes[0] != shapes[1]:
            first = PolicyPlayer(self.env.core, make(net), self.seed, make, net)
            self._players = [first, *(first.copy(seed) for seed in self._seeds[1:])]
        for player in self._players:
            player.net = net
            player.reset()

    def watch(self, number: int) -> None:
        """Watch another environment from its current step on; numbers beyond the last one are clipped."""
        self.watched = int(np.clip(number, 0, self.num_envs - 1))
        self.seed = self._seeds[self.watched]
        self._show()

    def advance(self) -> None:
        """Take one step of all environments, unless the episode is over or a person has not chosen an action."""
        episode = self.episode
        if episode.step.state.done:
            return
        action = (self._human or self._players[self.watched]).act(episode.step.state)
        if action is None:
            return
        self._advance_others()
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

    def _advance_others(self) -> None:
        """Take one step of the environments that are not watched; those at an end begin the next episode."""
        for number, (episode, player) in enumerate(zip(self.episodes, self._players, strict=True)):
            if number == self.watched:
                continue
            if episode.step.state.done:
                self._seeds[number] += 1
                self.episodes[number] = self._begin(self._runner, self.house, self._seeds[number])
                player.reset()
            else:
                episode.advance(player.act(episode.step.state))

    def _make_players(self, env: Env[HouseholdEnv], agent: str) -> list[PolicyPlayer]:
        """Return a player for each environment; a human's keys are those of the watched one."""
        is_human = agent == HUMAN
        human = HeldKeysPlayer(env.core.acting_config, self.keys) if is_human else None
        if agent == "trained":
            check_agent(agent, self.checkpoints.path)
            make, net = load_trained(self.checkpoints.load_path(), env.core)
            first = PolicyPlayer(env.core, make(net), self.seed, make, net)
        else:
            first = PolicyPlayer(env.core, make_policy(env, "random" if is_human else agent), self.seed)
        self._human = human
        return [first, *(first.copy(seed) for seed in self._seeds[1:])]

    def _begin(self, runner: EpisodeRunner, house: int | None, seed: int) -> RunningEpisode:
        """Begin an episode in a house; environments with rows take one of the house's rows."""
        rng, tasks, env = np.random.default_rng(seed), runner.env.params.tasks, runner.env
        self._number += 1
        key = jax.random.key(seed)
        if tasks is None:
            chosen = rng.integers(env.bank.num_houses) if house is None else house
            return runner.begin(self._number, key, None, int(chosen))
        rows = np.arange(len(tasks)) if house is None else np.flatnonzero(np.asarray(tasks.house) == house)
        if not len(rows):
            raise HomeMjxError(f"there is no task in house {env.bank.house_ids[house or 0]}")
        return runner.begin(self._number, key, int(rng.choice(rows)))

    def _show(self) -> None:
        """Show the watched environment's episode."""
        episode = self.episode
        self._times.clear()
        if self._human is not None:
            self._human.reset()
        self.observer.on_episode_start(episode.start)
        self.observer.on_episode_step(episode.step)
        self.due = time.perf_counter() + self.env.dt / self.speed
