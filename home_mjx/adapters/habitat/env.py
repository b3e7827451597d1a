"""One environment with the interface of `habitat.Env`, and of `habitat.RLEnv`."""

from collections.abc import Callable
from typing import Any

import gymnasium
import jax
import numpy as np

from home_mjx.adapters.habitat.config import HabitatConfig, build
from home_mjx.adapters.habitat.episodes import NavigationDataset, NavigationEpisode
from home_mjx.adapters.habitat.image_goals import GoalImages
from home_mjx.adapters.habitat.observations import action_index, convert, make_space, measures, to_host
from home_mjx.adapters.habitat.top_down import MapMeasure
from home_mjx.core.checks import check_number
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.native.fork_guard import forbid_after_fork
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.spaces import action_space

Observations = dict[str, np.ndarray]


class HabitatEnv:
    """One household with the interface of `habitat.Env`; episodes come in order, the first again after the last.

    Args:
        config: Options; None: PointNav in generated homes.
        dataset: Episodes that replace those of `config`.

    Raises:
        ConfigError: An option is invalid.
        DatasetError: Houses or episodes cannot be read, or do not fit.

    Example:
        >>> env = HabitatEnv(get_config("pointnav"))  # doctest: +SKIP
        >>> observations = env.reset()  # doctest: +SKIP
        >>> while not env.episode_over:  # doctest: +SKIP
        ...     observations = env.step(env.action_space.sample())
        >>> env.get_metrics()["spl"]  # doctest: +SKIP
        0.0
    """

    def __init__(self, config: HabitatConfig | None = None, dataset: NavigationDataset | None = None) -> None:
        self.config = HabitatConfig() if config is None else config
        self.env, self._episodes = build(self.config, dataset)
        names, depths = self.config.sensor_names, (self.config.min_depth, self.config.max_depth)
        self.observation_space = make_space(names, self.env.observation_spec)
        self.action_space: gymnasium.Space = action_space(self.env)
        core = self.env.core

        def reset(params: EnvParams, key: Any, episode: Any) -> tuple[State, dict]:
            """Return the first state of an episode, and its observations by Habitat's names."""
            state = core.reset(params, key, None, episode)
            return state, convert(names, state.obs, *depths)

        def step(params: EnvParams, state: State, action: Any) -> tuple[State, dict]:
            """Return the next state, and its observations by Habitat's names."""
            state = core.step(params, state, action)
            return state, convert(names, state.obs, *depths)

        xla = compiler_options()
        self._reset: Callable[..., Any] = forbid_after_fork(jax.jit(reset, compiler_options=xla), "reset")
        self._step: Callable[..., Any] = forbid_after_fork(jax.jit(step, compiler_options=xla), "step")
        self._state: State | None = None
        self._map = MapMeasure(self.env, self.config.max_episode_steps) if self.config.top_down_map else None
        self._images = GoalImages(self.env) if "imagegoal" in names else None
        self._fixed: Observations = {}
        self._index, self._metrics = -1, {}
        self.seed(self.config.seed)

    @property
    def episodes(self) -> tuple[NavigationEpisode, ...]:
        """All episodes, in the order in which they come."""
        return self._episodes

    @property
    def number_of_episodes(self) -> int:
        """Number of episodes."""
        return len(self._episodes)

    @property
    def current_episode(self) -> NavigationEpisode:
        """The episode of the last `reset`; `ConfigError` before the first."""
        self._started()
        return self._episodes[self._index]

    @property
    def episode_over(self) -> bool:
        """True after the end of an episode, and before the first one."""
        return self._state is None or bool(self._state.done)

    def seed(self, seed: int) -> None:
        """Set the seed of the random numbers of later resets, and begin with the first episode again."""
        check_number("seed", seed, 0, integer=True)
        self._random, self._index = np.random.default_rng(seed), -1

    def reset(self) -> Observations:
        """Start the next episode and return its first observations."""
        self._index = (self._index + 1) % len(self._episodes)
        key = self._random.integers(0, 2**32, 2, np.uint32)
        state, obs = self._reset(self.env.params, key, np.int32(self._index))
        self._state, self._metrics = state, measures(state.metrics, 0, 0.0) | self._map_measure(state)
        if self._images is not None:
            self._fixed = {"imagegoal": self._images.image(self.env.params, state, self._index, self.current_episode)}
        return to_host({**obs, **self._fixed}, self.observation_space)

    def step(self, action: Any) -> Observations:
        """Take an action, a number, a name or `{"action": ...}`, and return the observations after it.

        Raises:
            ConfigError: There is no such action, or the episode is over.
        """
        state = self._started()
        if self.episode_over:
            raise ConfigError("the episode is over", hint="Call reset() before step().")
        before = float(state.metrics["collisions"])
        number = np.int32(action_index(action, self.env.core.action_names))
        state, obs = self._step(self.env.params, state, number)
        self._state = state
        self._metrics = measures(state.metrics, int(state.world.step), before) | self._map_measure(state)
        return to_host({**obs, **self._fixed}, self.observation_space)

    def get_metrics(self) -> dict[str, Any]:
        """Return Habitat's measures after the last step, see `measures`."""
        self._started()
        return dict(self._metrics)

    def get_reward(self) -> float:
        """Return the task's own reward of the last step; 0 after a reset."""
        return float(self._started().reward)

    def close(self) -> None:
        """Drop the episode; `reset` starts another one."""
        self._state = None

    def __enter__(self) -> "HabitatEnv":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _map_measure(self, state: State) -> dict[str, Any]:
        """Return the measure `top_down_map` by its name; empty unless the options ask for it."""
        return {} if self._map is None else {"top_down_map": self._map.update(self.env.params, state)}

    def _started(self) -> State:
        """Return the present state; `ConfigError` if no episode was started."""
        if self._state is None:
            raise ConfigError("no episode was started", hint="Call reset() first.")
        return self._state


class HabitatRLEnv:
    """One household with the interface of `habitat.RLEnv`: `step` returns observations, reward, done and info.

    A subclass may override `get_reward`, `get_done` and `get_info`; here they are the task's reward, `episode_over`
    and the measures.

    Args:
        config: As for `HabitatEnv`.
        dataset: As for `HabitatEnv`.

    Example:
        >>> class Sparse(HabitatRLEnv):
        ...     def get_reward(self, observations):
        ...         return self.habitat_env.get_metrics()["success"]
    """

    def __init__(self, config: HabitatConfig | None = None, dataset: NavigationDataset | None = None) -> None:
        self._env = HabitatEnv(config, dataset)
        self.observation_space, self.action_space = self._env.observation_space, self._env.action_space

    @property
    def habitat_env(self) -> HabitatEnv:
        """The environment inside."""
        return self._env

    @property
    def episodes(self) -> tuple[NavigationEpisode, ...]:
        """All episodes, in the order in which they come."""
        return self._env.episodes

    @property
    def current_episode(self) -> NavigationEpisode:
        """The episode of the last `reset`."""
        return self._env.current_episode

    def reset(self) -> Observations:
        """Start the next episode and return its first observations."""
        return self._env.reset()

    def step(self, action: Any) -> tuple[Observations, float, bool, dict[str, Any]]:
        """Take an action and return observations, reward, whether the episode is over, and measures."""
        observations = self._env.step(action)
        reward = self.get_reward(observations)
        return observations, reward, self.get_done(observations), self.get_info(observations)

    def get_reward(self, observations: Observations) -> float:
        """Return the reward of the last step."""
        return self._env.get_reward()

    def get_done(self, observations: Observations) -> bool:
        """Return whether the episode is over."""
        return self._env.episode_over

    def get_info(self, observations: Observations) -> dict[str, Any]:
        """Return the measures after the last step."""
        return self._env.get_metrics()

    def seed(self, seed: int) -> None:
        """Set the seed of later resets, see `HabitatEnv.seed`."""
        self._env.seed(seed)

    def close(self) -> None:
        """Drop the episode."""
        self._env.close()
