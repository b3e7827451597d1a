"""Stable-Baselines3: a batch of environments as a `VecEnv`, one jitted step for all of them.

Example:
    >>> model = PPO("MultiInputPolicy", VecMonitor(BatchVecEnv(64, "PointNav-v0")))  # doctest: +SKIP
"""

# pyright: reportMissingImports=false

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from home_mjx.adapters.gymnasium import GymVectorEnv
from home_mjx.errors import ConfigError, install_hint

try:
    from stable_baselines3.common.vec_env import VecEnv
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `stable-baselines3`", hint=install_hint("sb3")) from error

SUCCESS = "success"  # metric that Stable-Baselines3 reads as `is_success`


class BatchVecEnv(VecEnv):
    """Many households in one jitted step, as a `VecEnv`; environments whose episode ended start the next one.

    Observations are dictionaries, so that policies are `MultiInputPolicy`. `infos[i]` has the metrics of environment i,
    its house and status flags, `is_success`, and `TimeLimit.truncated`. In the last step of an episode it also has
    `terminal_observation`. Wrap the batch in `VecMonitor` for returns and lengths of episodes.

    The reward of several agents is their mean. Environments have no objects of their own: attributes are those of the
    whole batch, and neither `set_attr` nor `env_method` exists for one of them.

    Args:
        num_envs: Number of environments.
        env_id: An id of `home_mjx.list_envs()`.
        render_mode: None, or "rgb_array": `get_images()` returns the first agent's view in each environment.
        **options: As for `home_mjx.make`; also `render_size` and `episodes`, as for `GymVectorEnv`.

    Raises:
        ConfigError: An option is unknown or invalid.

    Example:
        >>> envs = BatchVecEnv(64, "PointNav-v0", sensors=("depth", "goal"), actions="discrete")  # doctest: +SKIP
        >>> obs = envs.reset()  # doctest: +SKIP
        >>> obs, rewards, dones, infos = envs.step(np.zeros(64, int))  # doctest: +SKIP
    """

    def __init__(
        self, num_envs: int = 1, env_id: str = "PointNav-v0", render_mode: str | None = None, **options: Any
    ) -> None:
        if "autoreset_mode" in options:
            raise ConfigError("`autoreset_mode` cannot be chosen: a VecEnv resets in the step that ends an episode")
        self.batch = GymVectorEnv(num_envs, env_id, render_mode, **options)
        self._actions: np.ndarray | None = None
        super().__init__(num_envs, self.batch.single_observation_space, self.batch.single_action_space)

    def reset(self) -> dict[str, np.ndarray]:
        """Start an episode in every environment, with the seeds and options of `seed` and `set_options`, used once.

        Actions of `step_async` are dropped. `reset_infos` has an info per environment.

        Raises:
            ConfigError: Environments have options of different names, or an option is invalid.
        """
        seeded = any(seed is not None for seed in self._seeds)
        obs, infos = self.batch.reset(seed=list(self._seeds) if seeded else None, options=_merge_options(self._options))
        self.reset_infos = _infos_of_each(infos, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        self._actions = None
        return obs

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions of the next `step_wait`, one per environment."""
        self._actions = np.asarray(actions)

    def step_wait(self) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Step all environments with the actions of `step_async`, which are used up.

        Returns:
            Observations, rewards (N,) float32, whether episodes ended (N,), and an info per environment. Where an
            episode ended, the observations are the first ones of the next, and the info has `terminal_observation`.

        Raises:
            gymnasium.error.ResetNeeded: `reset` was never called.
            ConfigError: There are no actions, or they are not in the action space.
        """
        if self._actions is None:
            raise ConfigError("there are no actions", hint="Call step_async(actions) first, or step(actions).")
        actions, self._actions = self._actions, None
        obs, rewards, terminated, truncated, info = self.batch.step(actions)
        last = info.pop("final_obs", None)
        infos, dones = _infos_of_each(info, self.num_envs), terminated | truncated
        for i, own in enumerate(infos):
            own["TimeLimit.truncated"] = bool(truncated[i] and not terminated[i])
            if dones[i]:
                own["terminal_observation"] = {name: value[i] for name, value in last.items()}
        return obs, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Release nothing: arrays are freed with the object."""
        self.batch.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Return the first agent's view in each environment, (H, W, 3) uint8; None if off or before the reset."""
        return self.batch.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: int | Iterable[int] | None = None) -> list[Any]:
        """Return an attribute of the whole batch, repeated for each of the `indices`; None: all.

        Raises:
            AttributeError: The batch has no such attribute.
        """
        found = getattr(self.batch, attr_name)
        return [found] * len(self._indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: int | Iterable[int] | None = None) -> None:
        """Raise `ConfigError`: environments have no attributes of their own."""
        raise ConfigError(
            f"`{attr_name}` of single environments cannot be set", hint="Make the batch with this option."
        )

    def env_method(
        self, method_name: str, *method_args: Any, indices: int | Iterable[int] | None = None, **method_kwargs: Any
    ) -> list[Any]:
        """Raise `ConfigError`: environments have no methods of their own."""
        raise ConfigError(
            f"`{method_name}` cannot be called on single environments",
            hint="`envs.batch.env.core` has functions of one environment, for `jax.vmap`.",
        )

    def env_is_wrapped(self, wrapper_class: type, indices: int | Iterable[int] | None = None) -> list[bool]:
        """Return a list with False for each of the `indices` (None: all): none is wrapped."""
        return [False] * len(self._indices(indices))

    def _indices(self, indices: int | Iterable[int] | None) -> list[int]:
        """Return indices of environments as a list, from one, several or None, which means all."""
        if indices is None:
            return list(range(self.num_envs))
        return [indices] if isinstance(indices, int) else list(indices)


def _infos_of_each(infos: dict[str, Any], num_envs: int) -> list[dict[str, Any]]:
    """Return one dictionary per environment, of Python numbers or lists.

    Names without a mask `_name`, the masks themselves and nested dictionaries such as `final_info` are omitted. Masks
    are not read, so that entries which they mark as invalid are returned too. `is_success`, whether the metric
    `success` is above 0, is added if there is this metric.
    """
    named = {name: value for name, value in infos.items() if f"_{name}" in infos and not isinstance(value, dict)}
    if SUCCESS in named:
        named["is_success"] = named[SUCCESS] > 0
    rows = zip(*(np.asarray(value).tolist() for value in named.values()), strict=True)
    return [dict(zip(named, row, strict=True)) for row in rows] or [{} for _ in range(num_envs)]


def _merge_options(options: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return options of the batch: for each name an array of the values of all environments.

    Raises:
        ConfigError: Environments have options of different names.
    """
    if any(own.keys() != options[0].keys() for own in options):
        raise ConfigError(f"expected the same options in all environments, got {list(options)}")
    return {name: np.array([own[name] for own in options]) for name in options[0]}
