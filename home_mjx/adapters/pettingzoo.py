"""PettingZoo: one household as a `ParallelEnv`, whose agents act simultaneously.

Example:
    >>> env = PettingZooEnv("PointNav-v0", num_agents=2)  # doctest: +SKIP
    >>> obs, infos = env.reset(seed=0)  # doctest: +SKIP
    >>> actions = {agent: env.action_space(agent).sample() for agent in env.agents}  # doctest: +SKIP
    >>> obs, rewards, terminations, truncations, infos = env.step(actions)  # doctest: +SKIP
"""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle

from home_mjx.adapters import gymnasium_tools as tools
from home_mjx.adapters.base.agents import agent_names, ordered_values, split_by_agent
from home_mjx.adapters.gymnasium import GymEnv
from home_mjx.errors import ConfigError, install_hint
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.env.spaces import agent_action_space, make_gym_box
from home_mjx.tasks.rules.task_bank import TaskBank

try:
    from pettingzoo import ParallelEnv
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `pettingzoo`", hint=install_hint("multiagent")) from error

API_TEST_OPTION = "options"  # PettingZoo's API test resets with options={"options": 1}


class PettingZooEnv(ParallelEnv, EzPickle):
    """One household with `agent_0`, `agent_1`, ... as a `ParallelEnv` of NumPy arrays.

    An episode ends for all agents at once. `infos` contains house, episode, metrics and status flags, the same for
    each.

    Args:
        env_id: An id of `home_mjx.list_envs()`.
        render_mode: None, or "rgb_array": `render()` returns an image of the first agent's view.
        render_size: Width and height of that image [px].
        episodes: Saved episodes or a task bank, or the file of either; resets use their rows in order.
        **options: As for `home_mjx.make`, including `num_agents`.
    """

    metadata = {"name": "home_mjx", "render_modes": ["rgb_array"], "render_fps": 10, "is_parallelizable": True}  # noqa: RUF012

    def __init__(
        self,
        env_id: str = "PointNav-v0",
        render_mode: str | None = None,
        render_size: tuple[int, int] = (tools.DEFAULT_RENDER_SIZE, tools.DEFAULT_RENDER_SIZE),
        episodes: Episodes | TaskBank | str | Path | None = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(self, env_id, render_mode, render_size, episodes, **options)
        self.gym = GymEnv(env_id, render_mode, render_size, episodes, **options)
        self.render_mode = render_mode
        self.metadata = {**type(self).metadata, "name": env_id, "render_fps": self.gym.metadata["render_fps"]}
        env = self.gym.env
        self.possible_agents, self.agents = agent_names(env.num_agents), []
        specs = {name: spec.for_one_agent(env.num_agents) for name, spec in env.observation_spec.items()}
        # Separate objects, so that each space can be seeded.
        self.observation_spaces = {
            agent: gymnasium.spaces.Dict({name: make_gym_box(spec) for name, spec in specs.items()})
            for agent in self.possible_agents
        }
        self.action_spaces = {agent: agent_action_space(env) for agent in self.possible_agents}

    def observation_space(self, agent: str) -> gymnasium.Space:
        """Return the agent's space of observations, boxes by name; the same object at every call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space:
        """Return the agent's box of numbers in [-1, 1], or discrete actions; the same object at every call."""
        return self.action_spaces[agent]

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict, dict]:
        """Start an episode; return observations and infos by agent.

        `seed`, `options` such as `{"house": i}`, and errors are those of `GymEnv.reset`. The option "options" of
        PettingZoo's API test is ignored.
        """
        options = {name: value for name, value in (options or {}).items() if name != API_TEST_OPTION}
        obs, info = self.gym.reset(seed=seed, options=options)
        self.agents = list(self.possible_agents)
        return split_by_agent(obs, self.agents), self._each(info)

    def step(self, actions: dict[str, Any]) -> tuple[dict, dict, dict, dict, dict]:
        """Apply one control step.

        Args:
            actions: One element of its action space for every agent. After the end of the episode there are no agents,
                and `{}` returns five empty dictionaries.

        Returns:
            Observations, rewards, terminations, truncations and infos by agent.

        Raises:
            gymnasium.error.ResetNeeded: There are actions, but no agents: before `reset` or after the end.
            ConfigError: An agent's action is missing or not in the action space, or an agent is unknown.
        """
        if not self.agents and not actions:
            return {}, {}, {}, {}, {}
        if not self.agents:
            raise tools.reset_needed_error()
        names = self.agents
        taken = ordered_values(actions, names)
        obs, reward, terminated, truncated, info = self.gym.step(taken[0] if len(names) == 1 else _stack_actions(taken))
        rewards = info.pop("agent_reward", np.asarray([reward]))
        if terminated or truncated:
            self.agents = []
        return (
            split_by_agent(obs, names),
            {agent: float(rewards[i]) for i, agent in enumerate(names)},
            dict.fromkeys(names, terminated),
            dict.fromkeys(names, truncated),
            {agent: dict(info) for agent in names},
        )

    def render(self) -> np.ndarray | None:
        """Render the view of the first agent (H, W, 3) uint8; None if off or before reset."""
        return self.gym.render()

    def _each(self, info: dict[str, Any]) -> dict[str, dict[str, Any]]:
        """Return a copy of `info` for every agent."""
        return {agent: dict(info) for agent in self.possible_agents}


def _stack_actions(actions: list[Any]) -> np.ndarray:
    """Stack the actions of several agents (A, ...); raise `ConfigError` if shapes differ."""
    shapes = [np.shape(action) for action in actions]
    if len(set(shapes)) > 1:
        raise ConfigError(f"expected actions of one shape, got {', '.join(map(str, shapes))}")
    return np.stack(actions)
