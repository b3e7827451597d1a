"""Shared parts of both Gymnasium environments: options of reset, actions, infos, images."""

import inspect
import multiprocessing
import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from types import FrameType
from typing import Any

import gymnasium
import jax
import numpy as np
from gymnasium.vector import AutoresetMode

from home_mjx.core.checks import check_known, check_number
from home_mjx.env_factory import make
from home_mjx.errors import BackendError, ConfigError
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.tasks.base.config import AgentCamera
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.base.state import Episodes, State, World
from home_mjx.tasks.base.status import status_report
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.episodes import load_episodes_or_tasks
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.sensors.cameras import agent_ids, place_cameras

RENDER_MODES = (None, "rgb_array")
AUTORESET_MODES = (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP)
HOUSE_OPTIONS = {
    "num_houses",
    "split",
    "filter",
}  # options that select houses; without them the episode file selects them
MAX_LISTED_ROWS = 8  # maximum number of rows that a message lists
DEFAULT_RENDER_SIZE = 256  # [px] default width and height of `render` images
# Number of environments that each batch in this process has made so far.
_num_built: weakref.WeakKeyDictionary[Any, int] = weakref.WeakKeyDictionary()


def make_env(
    env_id: str, episodes: Episodes | TaskBank | str | Path | None, options: Mapping[str, Any]
) -> Env[HouseholdEnv]:
    """Make an environment whose resets use `episodes`, if any; a file also selects its houses unless `options` do."""
    if isinstance(episodes, str | Path):
        if not HOUSE_OPTIONS.intersection(name for name, value in options.items() if value is not None):
            return make(env_id, episodes=episodes, **options)
        env = make(env_id, **options)
        return env.with_tasks(load_episodes_or_tasks(episodes, env.bank, env.task))
    env = make(env_id, **options)
    return env.with_tasks(episodes) if episodes is not None else env


def refuse_forking_workers() -> None:
    """Raise if Gymnasium's `AsyncVectorEnv` makes this environment to learn its spaces, before it forks workers.

    Forked workers lack JAX's threads and would wait forever. Their own errors reach the caller as `EOFError` only.

    Raises:
        BackendError: Names the batch that needs no workers.
    """
    owner = _building(gymnasium.vector.AsyncVectorEnv)
    if owner is not None and multiprocessing.get_context(owner.context).get_start_method() == "fork":
        hint = "Omit `vectorization_mode` for one jitted batch, or give vector_kwargs={'context': 'spawn'}."
        raise BackendError("asynchronous environments would fork this process, which runs JAX", hint=hint)


def position_in_batch() -> tuple[int, int]:
    """Return the index of the environment that a batch in this process makes, and their number; else (0, 1).

    Such batches are Gymnasium's `SyncVectorEnv` and Stable-Baselines3's `DummyVecEnv`. They do not pass the index, so
    the frames of the callers are searched, and the calls counted. Call it once per environment.
    """
    found = _caller(lambda frame: frame.f_code.co_name == "__init__" and {"self", "env_fns"} <= frame.f_locals.keys())
    if found is None:
        return 0, 1
    index = _num_built.get(found["self"], 0)
    _num_built[found["self"]] = index + 1
    return index, len(found["env_fns"])


def refuse_shared_rows() -> None:
    """Raise if environments of saved episodes are made for worker processes, which would all begin at the first row.

    Gymnasium's `AsyncVectorEnv` makes one more environment before its workers. Those of Stable-Baselines3's
    `SubprocVecEnv` raise themselves. Neither tells a worker how many there are.

    Raises:
        ConfigError: Names the batches that share rows.
    """
    is_worker = multiprocessing.parent_process() is not None and _caller(lambda f: "env_fn_wrapper" in f.f_locals)
    if is_worker or _building(gymnasium.vector.AsyncVectorEnv) is not None:
        hint = (
            "Omit `vectorization_mode` for one jitted batch, or use 'sync', whose environments share the rows; with "
            "Stable-Baselines3 use `home_mjx.adapters.stable_baselines3`."
        )
        raise ConfigError("environments of worker processes would all begin at the same episode", hint=hint)


def _building(kind: type) -> Any:
    """Return the innermost object of a class whose `__init__` is among the callers; None if there is none."""
    found = _caller(lambda frame: frame.f_code.co_name == "__init__" and isinstance(frame.f_locals.get("self"), kind))
    return None if found is None else found["self"]


def _caller(is_wanted: Callable[[FrameType], Any]) -> dict[str, Any] | None:
    """Return the local variables of the innermost caller that fits a condition; None if there is none."""
    frame = inspect.currentframe()
    while frame is not None:
        if is_wanted(frame):
            return dict(frame.f_locals)
        frame = frame.f_back
    return None


def check_render_mode(render_mode: str | None) -> None:
    """Raise `ConfigError` for render modes that are not in `RENDER_MODES`."""
    if render_mode not in RENDER_MODES:
        hint = "gymnasium.make(..., render_mode='human') shows the pictures of 'rgb_array' in a window (needs pygame)."
        raise ConfigError(f"render_mode must be None or 'rgb_array', got {render_mode!r}", hint=hint)


def parse_autoreset_mode(mode: Any) -> AutoresetMode:
    """Return an autoreset mode from the mode or its value, such as "NextStep".

    Raises:
        ConfigError: It is not in `AUTORESET_MODES`.
    """
    names = {known.value: known for known in AUTORESET_MODES}
    name = getattr(mode, "value", mode)
    check_known("mode of resets", [name], names)
    return names[name]


def broadcast_mask(mask: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Reshape a mask (N,) of environments to (N, 1, ...), with as many axes as `x`."""
    return mask.reshape(-1, *[1] * (x.ndim - 1))


def to_numpy(tree: Any) -> Any:
    """Copy arrays to NumPy, bool to int8, because views of device buffers may be overwritten by a later step."""
    return jax.tree.map(lambda x: np.array(x, np.int8) if x.dtype == bool else np.array(x), tree)


def draw_key(random: np.random.Generator) -> np.ndarray:
    """Draw a raw JAX key (2,) uint32 from Gymnasium's generator, which advances."""
    return np.asarray(random.integers(0, 2**32, 2, np.uint32))


def index_option(options: Mapping[str, Any], name: str, count: int, num_envs: int | None = None) -> Any:
    """Return option `name` of reset, from 0 to `count` - 1, as int32 or (num_envs,) int32; None if it is absent.

    With `num_envs`, a single index is repeated for all environments.

    Raises:
        ConfigError: It is out of range, or its number differs from the number of environments.
    """
    value = options.get(name)
    if value is None:
        return None
    if num_envs is None or np.ndim(value) == 0:
        check_number(name, value, 0, count - 1, integer=True)
        return np.int32(value) if num_envs is None else np.full(num_envs, value, np.int32)
    given = np.asarray(value)
    if given.shape != (num_envs,) or given.dtype.kind not in "iu" or given.min() < 0 or given.max() >= count:
        raise ConfigError(f"`{name}` must be one index, or {num_envs}, of 0 to {count - 1}; got {value}")
    return given.astype(np.int32)


def check_options(env: Env, options: Mapping[str, Any], others: tuple[str, ...] = ()) -> None:
    """Raise for options of reset without effect: unknown ones, `episode` without rows, and `house` with rows.

    Names in `others` are known as well.

    Raises:
        ConfigError: Names the option, and the rows of the house that was asked for.
    """
    count = count_episodes(env)
    check_known("option of reset", options, ("house", *(("episode",) if count else ()), *others))
    house = options.get("house")
    if not count or house is None:
        return
    tasks = env.params.tasks
    rows = np.flatnonzero(np.isin(np.asarray(getattr(tasks, "rows", tasks).house), np.asarray(house)))
    listing = ", ".join(map(str, rows[:MAX_LISTED_ROWS].tolist())) + (", ..." if len(rows) > MAX_LISTED_ROWS else "")
    raise ConfigError(
        f"`house` cannot be chosen, because each of the {count} episodes has its own house",
        element="options",
        hint=f"Give `episode`: rows in house {house} are {listing}." if len(rows) else "Give `episode`, a row.",
    )


def count_episodes(env: Env) -> int:
    """Return the number of saved episodes or tasks, which `options={"episode": ...}` selects; 0 without any."""
    return 0 if env.params.tasks is None else len(env.params.tasks)


def check_action(action: Any, spec: ArraySpec, num_envs: int | None = None) -> np.ndarray:
    """Return the action of one environment, or a batch of `num_envs`, in the type of its spec.

    Raises:
        ConfigError: The action has another shape or kind of number, contains NaN, or is no discrete action. Continuous
            actions may be integers, and beyond the bounds, because the step clips them.
    """
    action, shape = np.asarray(action), (*(() if num_envs is None else (num_envs,)), *spec.shape)
    whole = np.dtype(spec.dtype).kind == "i"
    if action.dtype.kind not in ("iu" if whole else "fiu"):
        raise ConfigError(f"expected an action of {'integers' if whole else 'real numbers'}, got {action.dtype}")
    if action.shape != shape:
        raise ConfigError(f"expected an action of shape {shape}, got {action.shape}")
    if np.isnan(action).any():
        raise ConfigError("the action contains NaN", hint="Check the output of the policy.")
    if whole and ((action < spec.low) | (action > spec.high)).any():
        raise ConfigError(f"expected actions of {spec.low} to {spec.high}, got {action}", hint=f"In order: {spec.text}")
    return action.astype(spec.dtype)


def collect_infos(state: State, before: World | None = None) -> dict[str, np.ndarray]:
    """Return `house`, `episode_index`, metrics and `status/<flag>` of one environment () or each of a batch (N,).

    Args:
        state: State after the step.
        before: World before the step, for the house and episode of the metrics; a reset may have drawn others. None:
            those of `state`.
    """
    lost = status_report(np.asarray(state.status))
    world = before or state.world
    metrics = {name: np.array(value) for name, value in state.metrics.items()}
    # Not `episode`, a key of Gymnasium's RecordEpisodeStatistics and Stable-Baselines3.
    own = {"house": np.array(world.house), "episode_index": np.array(world.episode)}
    return {**own, **metrics, **{f"status/{name}": value for name, value in lost.items()}}


def with_masks(infos: Mapping[str, Any], mask: np.ndarray) -> dict[str, Any]:
    """Return infos as of Gymnasium's vector environments: beside each `name`, `_name` is `mask`, True where valid."""
    return {**infos, **{f"_{name}": mask for name in infos}}


class DisplayCamera:
    """Renderer of images of `size` (width, height) [px] for display, independent of the observations."""

    def __init__(self, env: Env[HouseholdEnv], size: tuple[int, int]) -> None:
        view = AgentCamera("picture", ("rgb",), Lens(*size), env.config.fovy, shader=env.config.shader)

        def draw(params: Any, state: State) -> Any:
            """Render the first agent's view (H, W, 3) uint8."""
            snapshot = env.core.snapshot(params, state)
            camera = jax.tree.map(
                lambda x: x[0], place_cameras(env.config, view, snapshot.pose, snapshot.camera_offsets)
            )
            own = agent_ids(snapshot.bank, 1)[0]
            return render(snapshot.scene, camera, view.lens, kinds=("rgb",), shader=view.shader, exclude=own)["rgb"]

        self._params, self._draw = env.params, jax.jit(draw)

    def render(self, state: State) -> np.ndarray:
        """Render the first agent's view (H, W, 3) uint8 in a state of one environment."""
        return np.array(self._draw(self._params, state))


def reset_needed_error(is_over: bool = False) -> gymnasium.error.ResetNeeded:
    """Return, not raise, the error for a step before the first reset or, if `is_over`, after the end of the episode."""
    return gymnasium.error.ResetNeeded(f"call reset() before step(){': the episode is over' if is_over else ''}")
