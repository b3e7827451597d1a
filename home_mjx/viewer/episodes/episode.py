"""Episodes from reset to end, step by step; observers are called at each step."""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.progress import show_compile
from home_mjx.tasks.base.state import State, to_raw_key
from home_mjx.tasks.base.task import path_scores
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer
from home_mjx.viewer.episodes.goal_markers import get_instruction
from home_mjx.viewer.episodes.policies import Player


class EpisodeRunner:
    """Runner of episodes of one environment.

    Args:
        env: The environment.
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        self.env = env
        # Two programs for a step: the one of the sensors, which takes longest to compile, serves resets as well.
        options = compiler_options()
        self._reset = jax.jit(functools.partial(env.core.reset, observe=False), compiler_options=options)
        self._step = jax.jit(functools.partial(env.core.step, observe=False), compiler_options=options)
        self._sense = jax.jit(functools.partial(env.core.observe, update=True), compiler_options=options)
        self._called: set[str] = set()
        self._pos = jax.jit(lambda params, state: env.core.snapshot(params, state).pose.pos[0])

    def run(self, player: Player, number: int, key: Any, row: int | None, observer: Observer) -> EpisodeResult:
        """Run an episode to its end, or until the player's action is None; return its result, even after no step.

        Return and walked distance are those of the first agent.

        Args:
            player: Player that chooses the actions.
            number: Number of the episode, from 1.
            key: Random key of the reset.
            row: Row of the environment's episodes or tasks; None: sampled with the key.
            observer: Observer of the episode.
        """
        episode = self.begin(number, key, row)
        player.reset()
        observer.on_episode_start(episode.start)
        observer.on_episode_step(episode.step)
        while not episode.step.state.done:
            action = player.act(episode.step.state)
            if action is None:
                break
            observer.on_episode_step(episode.advance(action))
        result = episode.result()
        observer.on_episode_end(result)
        return result

    def begin(self, number: int, key: Any, row: int | None, house: int | None = None) -> "RunningEpisode":
        """Reset the environment, and return the episode at its step 0.

        Args:
            number: Number of the episode, from 1.
            key: Random key of the reset.
            row: Row of the environment's episodes or tasks; None: sampled with the key.
            house: Index of the house, for environments without rows; None: sampled with the key.
        """
        state = self._observe(self._call("reset", self._reset, self.env.params, key, house, row))
        start = self._start(number, row, state, np.asarray(to_raw_key(key)))
        return RunningEpisode(self, start, EpisodeStep(0, state, None, 0.0))

    def position(self, state: State) -> Float[np.ndarray, "3"]:
        """Return the centre of the first agent's capsule [m]."""
        return np.asarray(self._pos(self.env.params, state))

    def next_state(self, state: State, action: Any) -> State:
        """Return the state after one step, with observations."""
        return self._observe(self._call("step", self._step, self.env.params, state, action))

    def _observe(self, state: State) -> State:
        """Return the state with its sensors' observations, after a reset or a step without."""
        return self._call("sensors", self._sense, self.env.params, state)

    def _call(self, name: str, program: Callable[..., State], *arguments: Any) -> State:
        """Call a program and return its state; show that it compiles if this is its first call."""
        if name in self._called:
            return program(*arguments)
        self._called.add(name)
        with show_compile(name, self.env.core.progress):
            return jax.block_until_ready(program(*arguments))

    def _start(self, number: int, row: int | None, state: State, key: np.ndarray) -> EpisodeStart:
        """Describe the episode that begins in `state`, for observers."""
        instruction = get_instruction(self.env, state)
        house = self.env.bank.house_ids[int(state.world.house)]
        return EpisodeStart(number, row, house, instruction.task, instruction.text, instruction.path_length, key)


class RunningEpisode:
    """Episode between two steps.

    Args:
        runner: Runner of the environment.
        start: Description of the episode.
        step: Its step 0.

    Attributes:
        start: Description of the episode.
        step: The last step.
    """

    def __init__(self, runner: EpisodeRunner, start: EpisodeStart, step: EpisodeStep) -> None:
        self.start, self.step, self._runner = start, step, runner
        self._pos, self._walked = runner.position(step.state), 0.0

    def advance(self, action: Any) -> EpisodeStep:
        """Take one step with the action of all agents, and return it."""
        state = self._runner.next_state(self.step.state, action)
        before, self._pos = self._pos, self._runner.position(state)
        self._walked += float(np.linalg.norm(self._pos - before))
        reward = float(np.reshape(state.reward, -1)[0])
        self.step = EpisodeStep(self.step.index + 1, state, action, self.step.episode_return + reward)
        return self.step

    def result(self) -> EpisodeResult:
        """Return the result after the last step, whether the episode is over or not."""
        return _result(self.start, self.step, self._walked)


def run_episodes(
    env: Env[HouseholdEnv], player: Player, rows: Sequence[int | None], seed: int, observer: Observer
) -> list[EpisodeResult]:
    """Run one episode per row and return their results; `observer.on_update(1)` follows each.

    Args:
        env: The environment.
        player: Player that chooses the actions.
        rows: Rows of the environment's episodes or tasks; None: sampled.
        seed: Seed of the episodes; the key of number n, from 1, is of `seed + n`.
        observer: Observer of the episodes.
    """
    runner, results = EpisodeRunner(env), []
    for number, row in enumerate(rows, 1):
        results.append(runner.run(player, number, jax.random.key(seed + number), row, observer))
        observer.on_update(1)
    return results


def _result(start: EpisodeStart, last: EpisodeStep, walked: float) -> EpisodeResult:
    """Return the result of an episode after step `last`.

    `spl` is from its metrics, else computed from the walked distance `walked` [m]; NaN if neither is known.
    """
    metrics = {name: float(value) for name, value in last.state.metrics.items()}
    success = metrics.get("success", 0.0)
    spl = float(path_scores(*(jnp.float32(x) for x in (success, start.path_length, walked, 0.0)))["spl"])
    return EpisodeResult(
        number=start.number,
        task=start.task,
        instruction=start.instruction,
        house=start.house,
        success=success,
        spl=metrics.get("spl", spl if np.isfinite(start.path_length) else np.nan),
        steps=last.index,
        episode_return=last.episode_return,
        metrics=metrics,
    )


def format_status(env: Env[HouseholdEnv], step: EpisodeStep, name: str) -> str:
    """Format agent name, step, action (none after a reset), distance to the goal (if a metric) and return as a line."""
    parts = [name, f"step {int(step.state.world.step)} of {env.config.episode_length}"]
    if step.action is not None:
        parts.append(describe_action(env, step.action))
    if "distance" in step.state.metrics:
        parts.append(f"{float(step.state.metrics['distance']):.1f} m to go")
    parts.append(f"return {step.episode_return:+.2f}")
    return "   ".join(parts)


def describe_action(env: Env[HouseholdEnv], action: Any) -> str:
    """Return the name of the first agent's discrete action, or names and values of components beyond ±0.05.

    Without such components it is `nothing`.
    """
    names, own = action_names(env.config), np.asarray(action)
    own = own if env.num_agents == 1 else own[0]
    if env.config.discrete is not None:
        return names[int(own)]
    return ", ".join(f"{name} {x:+.1f}" for name, x in zip(names, own, strict=True) if abs(x) > 0.05) or "nothing"
