"""Gymnasium: `gymnasium.make("home_mjx/PointNav-v0")` and its vector environment."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import gymnasium
import jax
import numpy as np
from gymnasium.utils import EzPickle
from gymnasium.vector import AutoresetMode

from home_mjx.adapters import gymnasium_tools as tools
from home_mjx.core.checks import check_number
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.native.fork_guard import forbid_after_fork
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import Episodes, State
from home_mjx.tasks.env.autoreset import AutoReset, select_envs
from home_mjx.tasks.env.reset import is_sequential
from home_mjx.tasks.env.spaces import action_space, observation_space
from home_mjx.tasks.rules.task_bank import TaskBank


class GymEnv(gymnasium.Env, EzPickle):
    """One household as a `gymnasium.Env` of NumPy arrays.

    Args:
        env_id: An id of `home_mjx.list_envs()`.
        render_mode: None, or "rgb_array": `render()` returns an image of the first agent's view, independent of the
            observations.
        render_size: Width and height of that image [px].
        episodes: Saved episodes or a task bank, or the file of either; resets use their rows in order.
        **options: As for `home_mjx.make`.

    Raises:
        BackendError: Gymnasium's `AsyncVectorEnv` asks for it and would fork worker processes.
        ConfigError: It has saved episodes, and worker processes ask for it, which would all begin at the first one.

    Example:
        >>> import gymnasium, home_mjx  # doctest: +SKIP
        >>> env = gymnasium.make("home_mjx/PointNav-v0", render_mode="rgb_array")  # doctest: +SKIP
        >>> obs, info = env.reset(seed=0, options={"house": 1})  # doctest: +SKIP
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012, as in the base class

    def __init__(
        self,
        env_id: str = "PointNav-v0",
        render_mode: str | None = None,
        render_size: tuple[int, int] = (tools.DEFAULT_RENDER_SIZE, tools.DEFAULT_RENDER_SIZE),
        episodes: Episodes | TaskBank | str | Path | None = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(self, env_id, render_mode, render_size, episodes, **options)
        tools.check_render_mode(render_mode)
        tools.refuse_forking_workers()
        self.env = tools.make_env(env_id, episodes, options)
        if is_sequential(self.env.params.tasks):
            tools.refuse_shared_rows()
        self.render_mode = render_mode
        self.metadata = {**type(self).metadata, "render_fps": round(1 / self.env.dt)}
        self.observation_space = observation_space(self.env)
        self.action_space = action_space(self.env)
        self._picture = tools.DisplayCamera(self.env, render_size) if render_mode else None
        core, xla = self.env.core, compiler_options()
        self._reset: Callable[..., State] = forbid_after_fork(jax.jit(core.reset, compiler_options=xla), "reset")
        self._step: Callable[..., State] = forbid_after_fork(jax.jit(core.step, compiler_options=xla), "step")
        self._state: State | None = None
        # Rows of saved episodes: the first, and from one to the next. Those of a batch share the rows.
        self._first_row, self._row_step = tools.position_in_batch()
        self._next_episode = self._first_row

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict, dict]:
        """Start an episode; `options={"house": i}` selects a house, `{"episode": i}` a row of saved episodes or tasks.

        Without rows, the default house is random. With rows, `house` is refused, because a row has its own house. The
        default row is the one after the last, the first after a seed, or sampled if rows have weights. Environment i of
        n in a `SyncVectorEnv` uses the rows i, i + n, ... After the last row come the first ones again;
        `info["episode_index"]` goes on counting.

        Raises:
            ConfigError: An option is unknown, out of range, or `house` beside rows.
        """
        super().reset(seed=seed)
        options, count = options or {}, tools.count_episodes(self.env)
        tools.check_options(self.env, options)
        house = tools.index_option(options, "house", self.env.bank.num_houses)
        episode = tools.index_option(options, "episode", count) if count else None
        if is_sequential(self.env.params.tasks) and episode is None:
            episode = np.int32(self._first_row if seed is not None else self._next_episode)
        self._next_episode = self._first_row if episode is None else int(episode) + self._row_step
        self._state = self._reset(self.env.params, tools.draw_key(self.np_random), house, episode)
        return tools.to_numpy(self._state.obs), _scalars(self._state)

    def step(self, action: Any) -> tuple[dict, float, bool, bool, dict]:
        """Apply one control step; the reward of several agents is their mean, `info["agent_reward"]` has each.

        Raises:
            gymnasium.error.ResetNeeded: The episode is over, or none was started.
            ConfigError: The action is not in the action space; a continuous one beyond the bounds is clipped.
        """
        if self._state is None or bool(self._state.done):
            raise tools.reset_needed_error(is_over=self._state is not None)
        action = tools.check_action(action, self.env.action_spec)
        self._state = state = self._step(self.env.params, self._state, action)
        info = _scalars(state)
        if self.env.num_agents > 1:
            info["agent_reward"] = np.array(state.reward)
        reward = float(np.mean(state.reward))
        return tools.to_numpy(state.obs), reward, bool(state.terminated), bool(state.truncated), info

    def render(self) -> np.ndarray | None:
        """Render the view of the first agent (H, W, 3) uint8; None if off or before reset."""
        return None if self._picture is None or self._state is None else self._picture.render(self._state)


class GymVectorEnv(gymnasium.vector.VectorEnv):
    """Many households in one jitted step; environments whose episode ended are reset in the same step (`SAME_STEP`).

    `info` contains metrics, house and status of every environment. At the end of an episode they are those of its final
    step, also in `info["final_info"]`, and `info["final_obs"]` contains its last observations.

    With `NEXT_STEP` the final step itself returns its observations and info. The step after it ignores its action and
    returns the first observations of the next episode, without reward and info. Images of `render` show the next
    episode one step earlier.

    Args:
        num_envs: Number of environments.
        env_id: An id of `home_mjx.list_envs()`.
        render_mode: None, or "rgb_array": `render()` returns an image per environment.
        render_size: Width and height of these images [px].
        episodes: Saved episodes or a task bank, or the file of either: environment i uses the rows i, i + n, ...
        autoreset_mode: `AutoresetMode.SAME_STEP`, or `NEXT_STEP`, which Gymnasium's observation wrappers need; or
            "SameStep", "NextStep".
        **options: As for `home_mjx.make`.
    """

    metadata = {  # noqa: RUF012, as in the base class
        "render_modes": ["rgb_array"],
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        env_id: str = "PointNav-v0",
        render_mode: str | None = None,
        render_size: tuple[int, int] = (tools.DEFAULT_RENDER_SIZE, tools.DEFAULT_RENDER_SIZE),
        episodes: Episodes | TaskBank | str | Path | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        **options: Any,
    ) -> None:
        check_number("num_envs", num_envs, 1, integer=True)
        tools.check_render_mode(render_mode)
        self.env = tools.make_env(env_id, episodes, options)
        self.num_envs, self.render_mode, self._mode = num_envs, render_mode, tools.parse_autoreset_mode(autoreset_mode)
        self.metadata = {
            **type(self).metadata, "render_fps": round(1 / self.env.dt), "autoreset_mode": self._mode,
        }  # fmt: skip
        self.single_observation_space = observation_space(self.env)
        self.single_action_space = action_space(self.env)
        batch = gymnasium.vector.utils.batch_space
        self.observation_space = batch(self.single_observation_space, num_envs)
        self.action_space = batch(self.single_action_space, num_envs)
        self._picture = tools.DisplayCamera(self.env, render_size) if render_mode else None
        auto = AutoReset(self.env.core, final_obs="all")
        xla = compiler_options()
        self._reset: Callable[..., State] = forbid_after_fork(jax.jit(auto.reset, compiler_options=xla), "reset")
        self._step: Callable[..., State] = forbid_after_fork(jax.jit(auto.step, compiler_options=xla), "step")
        self._merge: Callable[..., State] = jax.jit(select_envs)
        self._state: State | None = None
        self._pending_reset = np.zeros(num_envs, bool)  # NEXT_STEP: environments whose next step only resets

    def reset(
        self, *, seed: int | np.integer | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict, dict]:
        """Start an episode in every environment.

        Args:
            seed: Environment i starts as `GymEnv` does with seed + i; or one seed per environment, None for those
                whose random numbers go on.
            options: `house` or `episode`: an index, or one per environment, see `GymEnv.reset`. `reset_mask`: True for
                environments to reset; others continue.

        The default row of environment i of n is i at the first reset and after a seed for it. Otherwise it is the row
        of its last episode plus n, as in automatic resets.

        Raises:
            ConfigError: An option is unknown, out of range, or `house` beside rows; or the number of seeds differs.
        """
        seed = int(seed) if isinstance(seed, np.integer) else seed
        super().reset(seed=seed if isinstance(seed, int) else None)
        options, count = options or {}, tools.count_episodes(self.env)
        tools.check_options(self.env, options, ("reset_mask",))
        house = tools.index_option(options, "house", self.env.bank.num_houses, self.num_envs)
        episode = tools.index_option(options, "episode", count, self.num_envs) if count else None
        mask = self._mask(options.get("reset_mask"))
        keys = self._keys(seed)
        if is_sequential(self.env.params.tasks) and episode is None:
            episode = self._next_rows(seed)
        new = self._reset(self.env.params, keys, house, episode)
        self._state = new if self._state is None or mask.all() else self._merge(mask, new, self._state)
        self._pending_reset &= ~mask
        return tools.to_numpy(self._state.obs), tools.with_masks(tools.collect_infos(self._state), mask)

    def step(self, actions: np.ndarray) -> tuple[dict, np.ndarray, np.ndarray, np.ndarray, dict]:
        """Apply one control step to all, and reset by `autoreset_mode`, `SAME_STEP` or `NEXT_STEP`.

        With `NEXT_STEP` the step after an episode's end ignores the action: it only resets, with reward 0. The reward
        of several agents is their mean, `info["agent_reward"]` has each (N, A).

        Raises:
            gymnasium.error.ResetNeeded: `reset` was never called.
            ConfigError: The actions are not in the action space; continuous ones beyond the bounds are clipped.
        """
        if self._state is None:
            raise tools.reset_needed_error()
        actions = tools.check_action(actions, self.env.action_spec, self.num_envs)
        before, self._state = self._state, self._step(self.env.params, self._state, actions)
        if self._pending_reset.any():
            self._state = self._merge(self._pending_reset, before, self._state)
        return self._step_result(self._state, tools.collect_infos(self._state, before.world))

    def _step_result(
        self, state: State, infos: dict[str, Any]
    ) -> tuple[dict, np.ndarray, np.ndarray, np.ndarray, dict]:
        """Return the 5-tuple of `step`; rewards (n,) are means over agents, 0 where it only reset.

        NEXT_STEP: `obs` has the last observations of ended episodes, and the mask marks them. SAME_STEP: they are
        in `final_obs`. `infos` is from `collect_infos`; with several agents, `agent_reward` is added to it.
        """
        moved, obs = ~self._pending_reset, tools.to_numpy(state.obs)
        rewards = np.asarray(state.reward, np.float64).reshape(self.num_envs, -1) * moved[:, None]
        terminated, truncated = np.array(state.terminated) & moved, np.array(state.truncated) & moved
        done = terminated | truncated
        if self.env.num_agents > 1:
            infos["agent_reward"] = rewards
        info = tools.with_masks(infos, moved)
        self._pending_reset = done & (self._mode is AutoresetMode.NEXT_STEP)
        if done.any():
            last = tools.to_numpy(state.info["final_obs"])
            if self._mode is AutoresetMode.NEXT_STEP:
                obs = {name: np.where(tools.broadcast_mask(done, x), last[name], x) for name, x in obs.items()}
            else:
                info |= {"final_obs": last, "_final_obs": done}
                info |= {"final_info": tools.with_masks(infos, done), "_final_info": done}
        return obs, rewards.mean(-1), terminated, truncated, info

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Render the first agent's view in each environment, (H, W, 3) uint8; None if off or before reset."""
        if self._picture is None or self._state is None:
            return None
        states = (jax.tree.map(lambda x, i=i: x[i], self._state) for i in range(self.num_envs))
        return tuple(self._picture.render(state) for state in states)

    def _keys(self, seed: int | Sequence[int | None] | None) -> np.ndarray:
        """Return raw keys (n, 2), from `seed` as in `reset`; raise `ConfigError` if the number differs.

        Keys without a seed are drawn from the batch's generator, which one seed per environment seeds as well.
        """
        if seed is None:
            return np.asarray(self.np_random.integers(0, 2**32, (self.num_envs, 2), np.uint32))
        seed = [seed + i for i in range(self.num_envs)] if isinstance(seed, int) else seed
        if len(seed) != self.num_envs:
            raise ConfigError(f"expected one seed, or {self.num_envs}, got {len(seed)}")
        for i, one in enumerate(seed):
            if one is not None:
                check_number(f"seed of environment {i}", one, 0, integer=True)
        given = [one for one in seed if one is not None]
        if len(given) == self.num_envs:
            # Spawned, so that a later reset without a seed repeats, but not the episodes of this one.
            self.np_random = np.random.default_rng(np.random.SeedSequence(given).spawn(1)[0])
        return np.stack([tools.draw_key(self.np_random if one is None else np.random.default_rng(one)) for one in seed])

    def _next_rows(self, seed: int | Sequence[int | None] | None) -> np.ndarray:
        """Return the row (n,) with which each environment begins.

        It is the environment's own index at the first reset, and after a seed for this environment. Otherwise it is the
        environment's last row plus n, beyond the number of rows too. An environment whose next step only resets is in
        its next row already, unobserved, and begins with that one.
        """
        first = np.arange(self.num_envs, dtype=np.int32)
        if self._state is None or isinstance(seed, int):
            return first
        last = np.asarray(self._state.world.episode)
        following = np.where(self._pending_reset, last, last + self.num_envs)
        is_seeded = np.zeros(self.num_envs, bool) if seed is None else np.array([one is not None for one in seed])
        return np.where(is_seeded, first, following).astype(np.int32)

    def _mask(self, mask: Any) -> np.ndarray:
        """Return a valid `reset_mask`, all True if it is None; else raise `ConfigError`."""
        if mask is None:
            return np.ones(self.num_envs, bool)
        if np.shape(mask) != (self.num_envs,) or np.asarray(mask).dtype != bool:
            raise ConfigError(f"`reset_mask` must be {self.num_envs} booleans, got {mask!r}")
        if self._state is None and not np.all(mask):
            raise ConfigError("`reset_mask` omits environments that were never reset")
        return np.asarray(mask)


def _scalars(state: State) -> dict[str, Any]:
    """Return `collect_infos` of one environment as Python numbers."""
    return {name: value.item() for name, value in tools.collect_infos(state).items()}
