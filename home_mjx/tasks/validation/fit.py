"""Validation of tasks against an environment, when they are passed in and not only when a reset draws them."""

from typing import Any

import jax
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.communication.talk import pack_speech
from home_mjx.tasks.rules.build import pad_tokens
from home_mjx.tasks.rules.program import TaskStage, Transition, pack_program
from home_mjx.tasks.rules.row_task import RowTask
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.rules.words import NUM_DESCRIPTORS, SUCCESS
from home_mjx.tasks.sounds.row import pack_sounds
from home_mjx.tasks.validation.faults import find_violation
from home_mjx.tasks.validation.table import MAX_INT16, Range, column_ranges, feature_ranges, index_range

OTHER_HOUSES_HINT = (
    "Create tasks for these houses: task.task_bank(bank), load_tasks(path, bank) or sample_episodes(bank)."
)


def check_tasks(config: EnvConfig, task: Task, bank: HouseBank, tasks: Any) -> None:
    """Check that an environment can begin these tasks, and that they can be solved.

    Args:
        config: Options of the environment.
        task: Task of its agents.
        bank: Its houses.
        tasks: Value for `EnvParams.tasks`; traced arrays are not checked.

    Raises:
        ConfigError: They are of another type, empty, lack a column or belong to other houses, or a row has an invalid
            value. The message has the allowed values.
    """
    if tasks is None:
        return _check_no_bank_needed(task)
    if not isinstance(tasks, Episodes | TaskBank):
        hint = "Give `Episodes` from `sample_episodes` or `load_episodes`, or a `TaskBank` from `load_tasks`."
        raise ConfigError(f"expected tasks, got {type(tasks).__name__}", hint=hint)
    if any(isinstance(x, jax.core.Tracer) for x in jax.tree.leaves(tasks)):  # pyright: ignore
        return None
    rows = tasks.rows if isinstance(tasks, TaskBank) else tasks
    _check_columns(task, tasks, rows)
    if not len(rows):
        raise ConfigError("there are no tasks", hint="Give at least one, or None to let resets draw new episodes.")
    ranges = column_ranges() | {"goal": index_range(bank.navigation.goal.shape[1], allow_none=False)}
    if isinstance(tasks, TaskBank):
        ranges |= _bank_ranges(bank, tasks)
        tasks.check_weights()
    _check_rows(config, bank, rows, ranges)


def empty_row() -> dict[str, np.ndarray]:
    """Return the columns of an empty row, with their names, shapes and dtypes.

    Example:
        >>> blank_row()["place"].shape
        (4, 3)
    """
    columns = (
        pack_program([], [TaskStage((Transition(SUCCESS),))])
        | pack_sounds((), 0)
        | pack_speech()
        | {"tokens": pad_tokens(())}
    )
    columns["field"] = np.full(NUM_DESCRIPTORS, -1, np.int16)
    return columns | {"task": np.zeros((), np.int32), "length": np.zeros((), np.float32)}


def _check_no_bank_needed(task: Task) -> None:
    if isinstance(task, RowTask):
        hint = "Write EnvParams(bank, tasks=task.task_bank(bank)), or core.bind(bank)."
        raise ConfigError(f"{type(task).__name__} needs a task bank", hint=hint)


def _check_columns(task: Task, tasks: Episodes | TaskBank, rows: Episodes) -> None:
    """Check that rows have the columns of the task, each with the right shape and one entry per row."""
    name, own = type(task).__name__, empty_row() if isinstance(task, RowTask) else {}
    if own and not isinstance(tasks, TaskBank):
        hint = "Give a `TaskBank`, such as task.task_bank(bank) or load_tasks(path, bank)."
        raise ConfigError(f"the rows of {name} must be a TaskBank, got {type(tasks).__name__}", hint=hint)
    lost = [column for column in (*own, *task.columns) if column not in rows.columns]
    if lost:
        hint = f"Give rows that were made for {name}."
        raise ConfigError(f"the rows lack columns that {name} needs: {', '.join(lost)}", hint=hint)
    shapes = {"house": (), "start": (3,), "yaw": ()} | {column: value.shape for column, value in own.items()}
    arrays = {"house": rows.house, "start": rows.start, "yaw": rows.yaw, **rows.columns}
    for column, array in arrays.items():
        expected = (np.size(rows.house), *shapes.get(column, array.shape[1:]))
        if array.shape != expected:
            hint = "Give each column one entry per task."
            raise ConfigError(f"the column `{column}` must have the shape {expected}, got {array.shape}", hint=hint)


def _bank_ranges(bank: HouseBank, tasks: TaskBank) -> dict[str, Range]:
    """Return the ranges of columns that index arrays of the task bank."""
    cells, fields = tasks.field.shape
    if cells != bank.navigation.field.shape[0] or not fields:
        message = f"the tasks have distances of {cells} cells, the houses have {bank.navigation.field.shape[0]}"
        raise ConfigError(message, hint=OTHER_HOUSES_HINT)
    return {"field": index_range(fields), "task": index_range(len(tasks.names) or MAX_INT16 + 1, allow_none=False)}


def _check_rows(config: EnvConfig, bank: HouseBank, rows: Episodes, ranges: dict[str, Range]) -> None:
    agents = index_range(config.num_agents)
    ranges = ranges | {
        "agent": agents,
        "selectors.agent": agents,
        "instructed_agents": index_range(2**config.num_agents),
    }
    hints = dict.fromkeys(("house", "field", "goal"), OTHER_HOUSES_HINT)
    hints |= dict.fromkeys(
        ("agent", "selectors.agent", "instructed_agents"), f"There are {config.num_agents} agents: see num_agents=..."
    )
    hints |= {"held": "Give hands=True.", "stopped": 'Give actions="discrete".', "said": "Give speech=(...)."}
    fault = find_violation(rows, bank, ranges, feature_ranges(config), hints, config.episode_length)
    if fault is not None:
        raise ConfigError(fault.message, element=f"task {fault.row}, {fault.field}", hint=fault.hint)
