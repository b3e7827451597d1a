"""Many environments with the interface of `habitat.VectorEnv`: one jitted step, no worker processes."""

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import jax
import numpy as np

from home_mjx.adapters.habitat.config import HabitatConfig, build
from home_mjx.adapters.habitat.env import Observations
from home_mjx.adapters.habitat.episodes import NavigationDataset, NavigationEpisode
from home_mjx.adapters.habitat.observations import action_index, convert, make_space, measures, to_host
from home_mjx.core.checks import check_number
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.native.fork_guard import forbid_after_fork
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.spaces import action_space

StepResult = tuple[Observations, float, bool, dict[str, Any]]


class HabitatVectorEnv:
    """Many households with the interface of `habitat.VectorEnv`, whose environments are `RLEnv`.

    An environment whose episode ends starts its next one in the same step: observations are those of the new episode,
    reward, done and info those of the old one. Environment i of n takes the episodes i, i + n, ...

    Args:
        config: Options; None: PointNav in generated homes.
        num_envs: Number of environments.
        dataset: Episodes that replace those of `config`.

    Raises:
        ConfigError: An option is invalid.
        DatasetError: Houses or episodes cannot be read, or do not fit.

    Example:
        >>> envs = HabitatVectorEnv(get_config("pointnav"), num_envs=64)  # doctest: +SKIP
        >>> observations = envs.reset()  # doctest: +SKIP
        >>> outputs = envs.step([1] * envs.num_envs)  # doctest: +SKIP
        >>> observations, rewards, dones, infos = map(list, zip(*outputs))  # doctest: +SKIP
    """

    def __init__(
        self, config: HabitatConfig | None = None, num_envs: int = 1, dataset: NavigationDataset | None = None
    ) -> None:
        check_number("num_envs", num_envs, 1, integer=True)
        self.config, self.num_envs = HabitatConfig() if config is None else config, num_envs
        if self.config.top_down_map or "imagegoal" in self.config.sensor_names:
            raise ConfigError("a `VectorEnv` has neither `top_down_map` nor `imagegoal`", hint="Use `Env`.")
        self.env, self._episodes = build(self.config, dataset)
        names, depths = self.config.sensor_names, (self.config.min_depth, self.config.max_depth)
        space = make_space(names, self.env.observation_spec)
        self.observation_spaces: list[gymnasium.spaces.Dict] = [space] * num_envs
        self.action_spaces: list[gymnasium.Space] = [action_space(self.env)] * num_envs
        auto = AutoReset(self.env.core, final_obs="none")

        def reset(params: EnvParams, keys: Any) -> tuple[State, dict]:
            """Return the first states of a batch, and the observations by Habitat's names."""
            state = auto.reset(params, keys)
            return state, convert(names, state.obs, *depths)

        def step(params: EnvParams, state: State, actions: Any) -> tuple[State, dict]:
            """Return the next states of a batch, and the observations by Habitat's names."""
            state = auto.step(params, state, actions)
            return state, convert(names, state.obs, *depths)

        xla = compiler_options()
        self._reset: Callable[..., Any] = forbid_after_fork(jax.jit(reset, compiler_options=xla), "reset")
        self._step: Callable[..., Any] = forbid_after_fork(jax.jit(step, compiler_options=xla), "step")
        self._state: State | None = None
        self._num_steps, self._collisions = np.zeros(num_envs, int), np.zeros(num_envs)
        self._random = np.random.default_rng(self.config.seed)

    @property
    def number_of_episodes(self) -> list[int]:
        """Number of episodes of each environment; all share them."""
        return [len(self._episodes)] * self.num_envs

    def current_episodes(self) -> list[NavigationEpisode]:
        """Return the present episode of each environment."""
        rows = np.asarray(self._started().world.episode) % len(self._episodes)
        return [self._episodes[row] for row in rows]

    def reset(self) -> list[Observations]:
        """Start episodes 0 to n - 1, and return the first observations of each environment."""
        keys = self._random.integers(0, 2**32, (self.num_envs, 2), np.uint32)
        self._state, obs = self._reset(self.env.params, keys)
        self._num_steps[:], self._collisions[:] = 0, 0
        return self._split(obs)

    def step(self, data: Sequence[Any]) -> list[StepResult]:
        """Take an action in each environment, and return observations, reward, done and info of each.

        Raises:
            ConfigError: There is no such action, or their number differs from that of the environments.
        """
        state = self._started()
        if len(data) != self.num_envs:
            raise ConfigError(f"expected {self.num_envs} actions, got {len(data)}")
        numbers = [action_index(action, self.env.core.action_names) for action in data]
        state, obs = self._step(self.env.params, state, np.array(numbers, np.int32))
        self._state, done = state, np.asarray(state.terminated | state.truncated)
        self._num_steps += 1
        infos = self._infos(state)
        self._collisions = np.where(done, 0, np.asarray(state.metrics["collisions"]))
        self._num_steps[done] = 0
        rewards = np.asarray(state.reward).tolist()
        return list(zip(self._split(obs), rewards, done.tolist(), infos, strict=True))

    def close(self) -> None:
        """Drop the episodes; `reset` starts others."""
        self._state = None

    def _infos(self, state: State) -> list[dict[str, Any]]:
        """Return the measures of each environment after a step, before its reset."""
        metrics = {name: np.asarray(value) for name, value in state.metrics.items()}
        return [
            measures({name: x[i] for name, x in metrics.items()}, int(self._num_steps[i]), float(self._collisions[i]))
            for i in range(self.num_envs)
        ]

    def _split(self, obs: dict[str, Any]) -> list[Observations]:
        """Return the observations of each environment."""
        host = to_host(obs, self.observation_spaces[0])
        return [{name: value[i] for name, value in host.items()} for i in range(self.num_envs)]

    def _started(self) -> State:
        """Return the present states; `ConfigError` if no episode was started."""
        if self._state is None:
            raise ConfigError("no episode was started", hint="Call reset() first.")
        return self._state
