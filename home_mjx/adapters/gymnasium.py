"""Gymnasium: `gymnasium.make("home_mjx/PointNav-v0")` and its vector twin."""

from collections.abc import Callable
from typing import Any

import gymnasium
import jax
import numpy as np
from gymnasium.vector import AutoresetMode

from home_mjx.adapters.spaces import action_space, observation_space
from home_mjx.core.checks import check_known, check_number
from home_mjx.errors import ConfigError
from home_mjx.registry import make
from home_mjx.tasks.base.state import State
from home_mjx.tasks.environment.autoreset import AutoReset
from home_mjx.tasks.environment.household import HouseholdEnv


class GymEnv(gymnasium.Env):
    """One household as a `gymnasium.Env` of NumPy arrays.

    Args:
        env_id: An id of `home_mjx.list_envs()`.
        render_mode: None or "rgb_array" (needs the `rgb` sensor).
        **options: As for `home_mjx.make`.

    Example:
        >>> import gymnasium, home_mjx  # doctest: +SKIP
        >>> env = gymnasium.make("home_mjx/PointNav-v0", render_mode="rgb_array")  # doctest: +SKIP
        >>> obs, info = env.reset(seed=0)  # doctest: +SKIP
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012, the base class declares it so

    def __init__(self, env_id: str = "PointNav-v0", render_mode: str | None = None, **options: Any) -> None:
        self.env: HouseholdEnv = make(env_id, **options)
        if render_mode is not None and "rgb" not in self.env.config.sensors:
            raise ConfigError(f"render_mode `{render_mode}` shows the `rgb` sensor, which is not among the sensors")
        self.render_mode = render_mode
        self.observation_space = observation_space(self.env)
        self.action_space = action_space(self.env)
        self._reset: Callable[..., State] = jax.jit(self.env.reset_in)
        self._step: Callable[..., State] = jax.jit(self.env.step_in)
        self._state: State | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict, dict]:
        """Begins an episode in a random house; `options={"house": i}` chooses one."""
        super().reset(seed=seed)
        key = np.asarray(self.np_random.integers(0, 2**32, 2, np.uint32))
        house = _chosen_house(options or {}, self.env.bank.num_houses)
        state: State = self._reset(self.env.bank, key, house)
        self._state = state
        return to_numpy(state.obs), _info(state)

    def step(self, action: np.ndarray) -> tuple[dict, float, bool, bool, dict]:
        """One control step."""
        if self._state is None:
            raise gymnasium.error.ResetNeeded("call reset() before step()")
        action = _checked(action, self.action_space.shape)
        state: State = self._step(self.env.bank, self._state, action)
        self._state = state
        truncated = bool(state.info["truncation"])
        terminated = bool(state.done) and not truncated
        return to_numpy(state.obs), float(np.mean(state.reward)), terminated, truncated, _info(state)

    def render(self) -> np.ndarray | None:
        """The first agent's RGB image (H, W, 3) uint8."""
        if self.render_mode is None or self._state is None or "pixels/head_rgb" not in self._state.obs:
            return None
        image = np.array(self._state.obs["pixels/head_rgb"])
        return image if image.ndim == 3 else image[0]


class GymVectorEnv(gymnasium.vector.VectorEnv):
    """Many households in one jitted step; ended ones begin anew in the same step (`SAME_STEP`).

    Args:
        num_envs: Number of environments.
        env_id: An id of `home_mjx.list_envs()`.
        **options: As for `home_mjx.make`.
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.SAME_STEP}  # noqa: RUF012, as above

    def __init__(self, num_envs: int = 1, env_id: str = "PointNav-v0", **options: Any) -> None:
        options.pop("render_mode", None)
        check_number("num_envs", num_envs, 1, whole=True)
        self.env: HouseholdEnv = make(env_id, **options)
        self.num_envs = num_envs
        self.single_observation_space = observation_space(self.env)
        self.single_action_space = action_space(self.env)
        batch = gymnasium.vector.utils.batch_space
        self.observation_space = batch(self.single_observation_space, num_envs)
        self.action_space = batch(self.single_action_space, num_envs)
        auto = AutoReset(self.env)
        self._reset: Callable[..., State] = jax.jit(auto.reset_in)
        self._step: Callable[..., State] = jax.jit(auto.step_in)
        self._state: State | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict, dict]:
        """Begins an episode in every environment."""
        super().reset(seed=seed)
        keys = np.asarray(self.np_random.integers(0, 2**32, (self.num_envs, 2), np.uint32))
        state: State = self._reset(self.env.bank, keys)
        self._state = state
        return to_numpy(state.obs), {}

    def step(self, actions: np.ndarray) -> tuple[dict, np.ndarray, np.ndarray, np.ndarray, dict]:
        """One control step of all; `info["final_obs"]` holds the last observation of those that ended."""
        if self._state is None:
            raise gymnasium.error.ResetNeeded("call reset() before step()")
        actions = _checked(actions, self.action_space.shape)
        state: State = self._step(self.env.bank, self._state, actions)
        self._state = state
        done = np.asarray(state.done) > 0
        truncated = np.asarray(state.info["truncation"]) > 0
        reward = np.asarray(state.reward, np.float64).reshape(self.num_envs, -1).mean(-1)
        info: dict[str, Any] = {}
        if done.any():
            info = {"final_obs": to_numpy(state.info["final_obs"]), "_final_obs": done}
        return to_numpy(state.obs), reward, done & ~truncated, truncated, info


def to_numpy(tree: Any) -> Any:
    """Arrays of their own, not views of device buffers that a later step may reuse."""
    return jax.tree.map(np.array, tree)


def _chosen_house(options: dict[str, Any], num_houses: int) -> np.int32 | None:
    """What `reset` is told by its options; None: any house."""
    check_known("option of reset", options, ["house"])
    if options.get("house") is None:
        return None
    check_number("house", options["house"], 0, num_houses - 1, whole=True)
    return np.int32(options["house"])


def _checked(action: Any, shape: tuple[int, ...] | None) -> np.ndarray:
    """The action as float32; refuses what the action space never holds, but not what is merely too large."""
    action = np.asarray(action, np.float32)
    if action.shape != shape:
        raise ConfigError(f"expected an action of shape {shape}, got {action.shape}")
    if np.isnan(action).any():
        raise ConfigError("the action holds NaN", hint="Look at what the policy gives.")
    return action


def _info(state: State) -> dict[str, Any]:
    metrics = {name: float(value) for name, value in state.metrics.items()}
    return {"house": int(state.info["world"].house), **metrics}
