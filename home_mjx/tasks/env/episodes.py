"""Episodes sampled in advance, to be saved, replayed and compared."""

from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_flag, check_number, check_type
from home_mjx.core.files import as_path, read_json_lines, write_json_lines
from home_mjx.errors import ConfigError, DatasetError, UnknownIdError
from home_mjx.tasks.base.state import Episodes, check_rows
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.rules.row_task import RowTask
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.suite.point_goals import OTHER_BANK_HINT, ROW_FORMAT_HINT, read_numbers
from home_mjx.tasks.suite.point_nav import PointNav
from home_mjx.tasks.suite.task_io import load_tasks
from home_mjx.tasks.validation.row_violations import is_same_length, wrong_length

MAX_EPISODE_FILE_BYTES = 1 << 28  # [bytes], maximum size of an episode file; about a million episodes
MAX_FILE_BYTES = 1 << 30  # [bytes], maximum size of a file of episodes or tasks
EMPTY_FILE_HINT = "Write one JSON object a line, see `save_episodes`."
POINT_NAV = PointNav()


def sample_episodes(
    bank: HouseBank,
    num: int,
    seed: int = 0,
    *,
    task: Task = POINT_NAV,
    min_length: float = 1.0,
    max_length: float = np.inf,
    same_storey: bool = False,
) -> Episodes:
    """Sample random episodes: number i in house i modulo their number, starts uniform by area, the rest by the task.

    Args:
        bank: The houses.
        num: Number of episodes.
        seed: Random seed.
        task: Task that samples the episodes.
        min_length: Minimum length of the shortest path [m]; tasks without a column `length` ignore both lengths.
        max_length: Maximum length of the shortest path [m].
        same_storey: Sample start and goal on the same storey. False: as the option of PointNav has it.

    Raises:
        ConfigError: No path of such a length was found for one of them, or `same_storey` is True for another task. Or
            `num` is not a whole number of at least 1.

    Example:
        >>> episodes = sample_episodes(env.bank, 1000, min_length=2.0)  # doctest: +SKIP
        >>> states = jax.vmap(env.with_tasks(episodes).reset)(keys)  # doctest: +SKIP
    """
    check_number("num", num, 1, integer=True)
    check_flag("same_storey", same_storey)
    if same_storey and not isinstance(task, PointNav):
        message = f"`same_storey` is for PointNav, whose goals are points, got {type(task).__name__}"
        raise ConfigError(message, hint="Leave it out, or choose rows by their start and goal: tasks.where(mask).")
    keys = jax.random.split(jax.random.key(seed), num)
    house = jnp.arange(num, dtype=jnp.int32) % bank.num_houses
    limits: dict[str, Any] = {"min_length": jnp.float32(min_length), "max_length": jnp.float32(max_length)}
    if same_storey:
        limits["same_storey"] = True

    def one(house: Array, key: Array) -> Episodes:
        """Sample one episode."""
        start, yaw, columns = task.sample(bank, house, key, **limits)
        return Episodes(house=house, start=start, yaw=yaw, columns=columns)

    episodes = jax.jit(jax.vmap(one))(house, keys)
    lost = np.flatnonzero(~np.isfinite(np.asarray(episodes.columns.get("length", np.zeros(num)))))
    if len(lost):
        name = bank.house_ids[int(house[lost[0]])]
        where = " on one storey" if same_storey or getattr(task, "same_storey", False) else ""
        raise ConfigError(
            f"house {name} has hardly any path of {min_length} m to {max_length} m{where}",
            hint="Choose other lengths, or other houses.",
        )
    return episodes


def save_episodes(path: str | Path, bank: HouseBank, episodes: Episodes, task: Task = POINT_NAV) -> None:
    """Write episodes as JSON lines, with ids and positions instead of indices: any bank of the houses can load them.

    Raises:
        ConfigError: The file cannot be written, or an index of a house is beyond the bank; other houses of the same
            indices are not noticed.
    """
    as_path(path, "episodes")
    check_type("bank", bank, HouseBank)
    check_type("episodes", episodes, Episodes)
    ids, host = bank.house_ids, jax.tree.map(np.asarray, episodes)
    check_rows(host.house, len(ids), "houses")
    lines = []
    for i in range(len(host)):
        house = int(host.house[i])
        columns = {name: values[i] for name, values in host.columns.items()}
        own = {"house": ids[house], "task": type(task).__name__}
        own |= {"start": host.start[i].tolist(), "yaw": float(host.yaw[i])}
        lines.append(own | task.to_json(bank, house, columns))
    write_json_lines(as_path(path, "episodes"), lines, "episodes")


def load_episodes(path: str | Path, bank: HouseBank, task: Task = POINT_NAV) -> Episodes:
    """Load episodes that `save_episodes` has written.

    Args:
        path: The file.
        bank: Holds the houses, compiled with the same options.
        task: Task of the episodes.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: A line is malformed or of another task. Or the bank lacks its house, the house lacks its goal, no
            path leads there, or `length` is not that of the shortest path. Or the file has no lines.
    """
    file = as_path(path, "episodes")
    check_type("bank", bank, HouseBank)
    index = {name: i for i, name in enumerate(bank.house_ids)}
    rows = list(
        read_json_lines(file, "episode", lambda line: _parse_episode(line, bank, index, task), MAX_EPISODE_FILE_BYTES)
    )
    if not rows:
        raise DatasetError("file holds no episode", file=path, hint=EMPTY_FILE_HINT)
    episodes = Episodes(**jax.tree.map(lambda *values: jnp.asarray(np.stack(values)), *rows))
    solvable, lengths = (np.asarray(values) for values in _solvable_and_length(task, bank, episodes))
    lost = np.flatnonzero(~solvable)
    if len(lost):
        message = "from its start no agent can walk to its goal"
        raise DatasetError(message, file=path, element=f"line {lost[0] + 1}", hint=OTHER_BANK_HINT)
    given = np.asarray(episodes.columns.get("length", lengths))
    wrong = np.flatnonzero(~np.isnan(lengths) & ~is_same_length(given, lengths))
    if len(wrong):
        message, hint = wrong_length(float(given[wrong[0]]), float(lengths[wrong[0]]))
        raise DatasetError(message, file=path, element=f"line {wrong[0] + 1}, length", hint=hint)
    return episodes


def load_episodes_or_tasks(path: str | Path, bank: HouseBank, task: Task) -> Episodes | TaskBank:
    """Load the kind of file that fits a task: that of `save_tasks` for a `RowTask`, else that of `save_episodes`.

    Its first line decides which kind it is.

    Raises:
        DatasetError: As for `load_tasks` and `load_episodes`, or the file is of the other kind.
    """
    is_bank = isinstance(task, RowTask)
    lines = read_json_lines(as_path(path, "episodes"), "episode", lambda line: "stages" in line, MAX_FILE_BYTES)
    if next(iter(lines), is_bank) != is_bank:
        raise _wrong_kind(as_path(path, "episodes"), task, is_bank)
    return load_tasks(path, bank) if is_bank else load_episodes(path, bank, task)


def _wrong_kind(path: Path, task: Task, is_bank: bool) -> DatasetError:
    """Return the error about a file of the wrong kind for a task; `is_bank`: it takes rows, the file has episodes."""
    name = type(task).__name__
    if is_bank:
        message = "file holds what `save_episodes` writes: episodes of a `goal`, without `stages`"
        hint = f"{name} takes rows, as `save_tasks` writes them; make PointNav-v0 for this file. {ROW_FORMAT_HINT}"
    else:
        message = "file holds what `save_tasks` writes: rows with `stages`"
        hint = (
            f"{name} takes episodes with a `goal`, as `save_episodes` writes them (docs/dataset.md, Saved episodes). "
            "Make the environment of the task that the rows name; those of PointGoals, PointNav as rows, and of your "
            "own tasks load in RoomNav-v0."
        )
    return DatasetError(message, file=path, hint=hint)


def read_house_ids(path: str | Path) -> tuple[str, ...]:
    """Return the ids of the houses in a file of episodes or tasks, each once, in order of their first line.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: A line is malformed, or the file has no lines.
    """
    found = read_json_lines(as_path(path, "episodes"), "episode", lambda line: str(line["house"]), MAX_FILE_BYTES)
    ids = tuple(dict.fromkeys(found))
    if not ids:
        raise DatasetError("file holds no episode", file=path, hint=EMPTY_FILE_HINT)
    return ids


def _solvable_and_length(
    task: Task, bank: HouseBank, episodes: Episodes
) -> tuple[Bool[Array, " e"], Float[Array, " e"]]:
    """Return for each episode whether it can be solved, and its shortest-path length [m]; NaN if the task has none."""

    def one(bank: HouseBank, row: Episodes) -> tuple[Array, Array]:
        """Return both values of one episode."""
        return task.is_solvable(bank, row), task.shortest_length(bank, row)

    return jax.jit(jax.vmap(one, (None, 0)))(bank, episodes)


def _parse_episode(line: dict[str, Any], bank: HouseBank, index: dict[str, int], task: Task) -> dict[str, Any]:
    """Return house index, start, yaw and columns from a line of a file; `index` maps ids of houses to indices.

    A line without `task` passes for any task, and one of a base class of the task as well.

    Raises:
        DatasetError: The line is of another task, or as in `Task.from_json`.
        UnknownIdError: `index` lacks the house.
        KeyError, TypeError, ValueError: The line is malformed.
    """
    name = type(task).__name__
    if line.get("task", name) not in [kind.__name__ for kind in type(task).__mro__]:
        message = f"the episode is one of {line['task']!s:.100}, not of {name}"
        raise DatasetError(message, element="task", hint="Give the task that it was drawn for.")
    if not isinstance(line["house"], str) or line["house"] not in index:
        raise UnknownIdError(f"the bank has no house {line['house']}", hint=OTHER_BANK_HINT)
    house, start, yaw = index[line["house"]], read_numbers(line, "start", (3,)), float(read_numbers(line, "yaw", ()))
    columns = {name: _as_scalar(value) for name, value in task.from_json(bank, house, line).items()}
    return {"house": np.int32(house), "start": start.astype(np.float32), "yaw": np.float32(yaw), "columns": columns}


def _as_scalar(value: Any) -> Any:
    """Return a Python integer or boolean as int32, any other number as float32, NumPy's integers included."""
    return np.int32(value) if isinstance(value, int) else np.float32(value)
