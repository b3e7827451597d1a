"""One episode from reset to end, step by step, and its result."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import jax
import numpy as np

from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.bound import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.moves import action_names
from home_mjx.viewer.episodes.goal_markers import Instruction, get_instruction
from home_mjx.viewer.episodes.policies import Player


@dataclass(frozen=True)
class EpisodeResult:
    """Result of an episode.

    Attributes:
        number: Number of the episode, from 1.
        task: Name of the task.
        instruction: Instruction of the episode.
        house: Id of the house.
        success: The task's success metric.
        spl: Success weighted by path length (arXiv:1807.06757); NaN if the shortest path is unknown.
        steps: Number of steps.
        episode_return: Return of the first agent.
        metrics: All metrics of the task at the end.
    """

    number: int
    task: str
    instruction: str
    house: str
    success: float
    spl: float
    steps: int
    episode_return: float
    metrics: dict[str, float] = field(default_factory=dict)

    def format_line(self) -> str:
        """Format the result as one line of text.

        Example:
            >>> Outcome(1, "RoomNav", "RoomNav: the kitchen", "a0", 1.0, 0.9312, 24, 3.1).line()
            '  1  RoomNav               success  SPL 0.93    24 steps  RoomNav: the kitchen'
        """
        how = "success" if self.success > 0 else "failure"
        spl = "   -" if np.isnan(self.spl) else f"{self.spl:.2f}"
        return f"{self.number:3d}  {self.task:<20}  {how}  SPL {spl}  {self.steps:4d} steps  {self.instruction}"


class EpisodeStep(NamedTuple):
    """Step of an episode: the state after it, the action (None after the reset), and the return so far."""

    state: State
    action: Any
    return_so_far: float


class EpisodeRunner:
    """Runner of episodes of one environment.

    Args:
        env: The environment.
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        self.env = env
        self._reset = jax.jit(env.core.reset)
        self._step = jax.jit(env.core.step)
        self._pos = jax.jit(lambda params, state: env.core.snapshot(params, state).pose.pos[0])
        self.result: EpisodeResult | None = None

    def run(self, player: Player, number: int, key: Any, row: int | None) -> Iterator[EpisodeStep]:
        """Yield the steps of an episode; `result` is set after the last one.

        Args:
            player: Player that chooses the actions.
            number: Number of the episode, from 1.
            key: Random key.
            row: Row of the environment's episodes or tasks; None: sampled with the key.
        """
        params = self.env.params
        state = self._reset(params, key, None, row)
        asked, walked, gained, steps = get_instruction(self.env, state), 0.0, 0.0, 0
        pos = np.asarray(self._pos(params, state))
        player.reset()
        yield EpisodeStep(state, None, gained)
        while not state.done:
            action = player.act(state)
            if action is None:
                break
            state = self._step(params, state, action)
            before, pos = pos, np.asarray(self._pos(params, state))
            walked += float(np.linalg.norm(pos - before))
            gained, steps = gained + float(np.reshape(state.reward, -1)[0]), steps + 1
            yield EpisodeStep(state, action, gained)
        self.result = self._ended(number, asked, state, walked, gained, steps)

    def _ended(
        self, number: int, asked: Instruction, state: State, walked: float, gained: float, steps: int
    ) -> EpisodeResult:
        metrics = {name: float(value) for name, value in state.metrics.items()}
        success = metrics.get("success", 0.0)
        spl = success * asked.path_length / max(asked.path_length, walked, 1e-6)
        house = self.env.bank.house_ids[int(state.world.house)]
        return EpisodeResult(
            number, asked.task, asked.text, house, success, metrics.get("spl", spl), steps, gained, metrics
        )


def format_status(env: Env[HouseholdEnv], step: EpisodeStep, name: str) -> str:
    """Format the progress of an episode as one line of text."""
    parts = [name, f"step {int(step.state.world.step)} of {env.config.episode_length}"]
    if step.action is not None:
        parts.append(describe_action(env, step.action))
    if "distance" in step.state.metrics:
        parts.append(f"{float(step.state.metrics['distance']):.1f} m to go")
    parts.append(f"return {step.return_so_far:+.2f}")
    return "   ".join(parts)


def describe_action(env: Env[HouseholdEnv], action: Any) -> str:
    """Describe the first agent's action."""
    names, own = action_names(env.config), np.asarray(action)
    own = own if env.num_agents == 1 else own[0]
    if env.config.discrete is not None:
        return names[int(own)]
    return ", ".join(f"{name} {x:+.1f}" for name, x in zip(names, own, strict=True) if abs(x) > 0.05) or "nothing"
