"""Validation of tasks against an environment and its houses, when they are passed in (host side)."""

from itertools import pairwise, permutations
from typing import Any

import jax
import numpy as np
from jaxtyping import Float, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.rules.build_bank import is_feasible
from home_mjx.tasks.rules.declaration import row_columns
from home_mjx.tasks.rules.enums import Attribute, TargetKind
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.resolve import resolve_targets_on_host
from home_mjx.tasks.rules.row_task import RowTask
from home_mjx.tasks.rules.task_bank import RECORDS, RowStart, TaskBank
from home_mjx.tasks.validation.column_ranges import (
    MAX_INT16,
    Range,
    column_ranges,
    column_values,
    feature_ranges,
    index_range,
)
from home_mjx.tasks.validation.row_violations import (
    COMPARTMENT_HINT,
    Violation,
    blocked_start,
    find_violation,
    is_same_length,
    is_standable,
)
from home_mjx.tasks.validation.stored_targets import stored_target_fault

RESOLVED_KINDS = (TargetKind.OBJECT, TargetKind.ROOM)
OTHER_HOUSES_HINT = (
    "Create tasks for these houses: task.task_bank(bank), load_tasks(path, bank) or sample_episodes(bank)."
)


def check_tasks(config: EnvConfig, task: Task, bank: HouseBank, tasks: Any) -> None:
    """Check that an environment can begin these tasks, and that their conditions can hold in it.

    None passes, unless the task is a `RowTask`.

    Args:
        config: Options of the environment.
        task: Task of its agents.
        bank: Its houses.
        tasks: Value for `EnvParams.tasks`; traced arrays are not checked.

    Raises:
        ConfigError: They are of another type, empty, lack a column or belong to other houses, or a row has an invalid
            value. The message has the allowed values.
    """
    if tasks is None and isinstance(task, RowTask):
        hint = "Write EnvParams(bank, tasks=task.task_bank(bank)), or core.bind(bank)."
        raise ConfigError(f"{type(task).__name__} needs a task bank", hint=hint)
    if tasks is None:
        return
    if not isinstance(tasks, Episodes | TaskBank):
        hint = "Give `Episodes` from `sample_episodes` or `load_episodes`, or a `TaskBank` from `load_tasks`."
        raise ConfigError(f"expected tasks, got {type(tasks).__name__}", hint=hint)
    if any(isinstance(x, jax.core.Tracer) for x in jax.tree.leaves(tasks)):  # pyright: ignore
        return
    rows = tasks.rows if isinstance(tasks, TaskBank) else tasks
    _check_columns(task, tasks, rows)
    if not len(rows):
        raise ConfigError("there are no tasks", hint="Give at least one, or None to let resets draw new episodes.")
    special = {}
    if isinstance(tasks, TaskBank):
        special = _bank_ranges(bank, tasks)
        tasks.check_weights()
    _check_rows(config, bank, rows, special)


def _check_columns(task: Task, tasks: Episodes | TaskBank, rows: Episodes) -> None:
    """Raise `ConfigError` unless rows have the task's columns, each with one entry per row.

    Columns of `RowStart` must also have their declared shape, and for a `RowTask` all columns of a row shape and dtype.
    For a `RowTask`, `tasks`, which has these rows, must be a `TaskBank`.
    """
    name, own = type(task).__name__, row_columns(RECORDS) if isinstance(task, RowTask) else {}
    if own and not isinstance(tasks, TaskBank):
        hint = "Give a `TaskBank`, such as task.task_bank(bank) or load_tasks(path, bank)."
        raise ConfigError(f"the rows of {name} must be a TaskBank, got {type(tasks).__name__}", hint=hint)
    arrays = {"house": rows.house, "start": rows.start, "yaw": rows.yaw, **rows.columns}
    lost = [column for column in (*own, *task.columns) if column not in arrays]
    if lost:
        hint = f"Give rows that were made for {name}."
        raise ConfigError(f"the rows lack columns that {name} needs: {', '.join(lost)}", hint=hint)
    known = row_columns((RowStart,)) | own
    for column, array in arrays.items():
        declared = known.get(column)
        expected = (np.size(rows.house), *(array.shape[1:] if declared is None else declared.shape))
        if array.shape != expected:
            hint = "Give each column one entry per task."
            raise ConfigError(f"the column `{column}` must have the shape {expected}, got {array.shape}", hint=hint)
        if column in own and array.dtype != own[column].dtype:
            message = f"the column `{column}` must have the dtype {own[column].dtype}, got {array.dtype}"
            raise ConfigError(message, hint=f"Write columns[{column!r}].astype({str(own[column].dtype)!r}).")


def _bank_ranges(bank: HouseBank, tasks: TaskBank) -> dict[str, Range]:
    """Return the ranges of values that index arrays of the task bank; `ConfigError` if it is of other houses."""
    cells, fields = tasks.field.shape
    if cells != bank.navigation.field.shape[0] or not fields:
        message = f"the tasks have distances of {cells} cells, the houses have {bank.navigation.field.shape[0]}"
        raise ConfigError(message, hint=OTHER_HOUSES_HINT)
    return {"field": index_range(fields), "task": index_range(len(tasks.names) or MAX_INT16 + 1, allow_none=False)}


def _check_rows(config: EnvConfig, bank: HouseBank, rows: Episodes, special: dict[str, Range]) -> None:
    """Raise `ConfigError` if a row has an invalid value; `special` has ranges by name of values."""
    special = special | {"agent": index_range(config.num_agents), "agents": index_range(2**config.num_agents)}
    goals = index_range(bank.navigation.goal.shape[1], allow_none=False)
    hints = {name: hint for name, values in column_values().items() if (hint := _hint(config, values))}
    hints |= {"goal": OTHER_HOUSES_HINT}
    hints |= {"held": "Give hands=True.", "stopped": 'Give actions="discrete".', "said": "Give speech=(...)."}
    hints |= {"switched_on": 'Give switches="random".'}
    ranges = column_ranges(special) | {"goal": goals}
    fault = find_violation(rows, bank, ranges, feature_ranges(config), hints, config.episode_length)
    if fault is not None:
        raise ConfigError(fault.message, element=f"task {fault.row}, {fault.field}", hint=fault.hint)


def _hint(config: EnvConfig, values: str) -> str | None:
    """Return the hint for columns whose range has this name; None if there is no special one."""
    if values in ("agent", "agents"):
        return f"There are {config.num_agents} agents: see num_agents=..."
    return OTHER_HOUSES_HINT if values in ("house", "field") else None


def find_infeasible(
    bank: HouseBank, view: HouseView, rows: list[dict[str, np.ndarray]], fields: UInt16[np.ndarray, "c g"]
) -> Violation | None:
    """Return the violation of the first infeasible row of a house; None if all are feasible.

    Feasible: the house has its targets, an agent can stand at its start, and paths lead close enough to its targets.
    `rows`, at least one, have their columns with `field`; `fields` is from `add_fields`.
    """
    descriptor = np.stack([row["descriptor"] for row in rows])
    targets = resolve_targets_on_host(bank, view.house, descriptor)
    there = np.any(targets.instance, axis=-1) | np.any(targets.room, axis=-1)
    lost = np.isin(descriptor[..., Attribute.KIND], RESOLVED_KINDS) & ~there
    home = view.graph.place
    nearest = fields[: len(home)].min(axis=0, initial=FIELD_UNREACHABLE) * FIELD_UNIT
    stands = is_standable(bank, np.full(len(rows), view.house), np.stack([row["start"] for row in rows]))
    for number, row in enumerate(rows):
        if not stands[number]:
            return blocked_start(number, row["start"])
        if lost[number].any():
            name = f"selectors[{np.argmax(lost[number])}]"
            return Violation(
                number, name, "the house has no such object or room", "`HouseView.objects` lists its objects."
            )
        fault = stored_target_fault(bank, view.house, row, np.asarray(targets.instance[number]))
        if fault is not None:
            return Violation(number, "stages", fault, COMPARTMENT_HINT)
        if not is_feasible(row, nearest):
            message = "no path leads to a target of the task, or none close enough to it"
            return Violation(number, "selectors", message, "Choose another goal, or a greater `maximum` of `distance`.")
    return None


def correct_lengths(
    view: HouseView, rows: list[dict[str, np.ndarray]], fields: UInt16[np.ndarray, "c g"]
) -> dict[int, tuple[float, float]]:
    """Replace each `length` that is none of `_path_lengths` by that of the path through all guides, in place.

    `rows` are feasible and have `field`; `fields` is from `add_fields`.

    Returns:
        Wrong and right length [m], by index of the row.
    """
    corrected = {}
    for number, row in enumerate(rows):
        lengths = _path_lengths(view, row, fields[: len(view.graph.place)])
        if len(lengths) and not is_same_length(row["length"], lengths).any():
            corrected[number] = float(row["length"]), float(lengths[0])
            row["length"] = np.asarray(lengths[0], np.float32)
    return corrected


def _path_lengths(
    view: HouseView, row: dict[str, np.ndarray], fields: UInt16[np.ndarray, "c g"]
) -> Float[np.ndarray, " n"]:
    """Return the lengths that a row may have [m]: a row does not say which of its descriptors its length leads to.

    They are those of the paths through some descriptors in any order. The first one leads through all guides in order.
    """
    way = fields[np.argmin(np.linalg.norm(view.graph.place - row["start"], axis=1))] * FIELD_UNIT
    columns = row["field"].tolist()
    guides = [i for i in dict.fromkeys(row["guide"].tolist()) if i >= 0 and columns[i] >= 0]
    known = [i for i, column in enumerate(columns) if column >= 0]
    orders = [guides] * bool(guides) + [order for n in range(len(known)) for order in permutations(known, n + 1)]
    ends = {i: int(np.argmin(fields[:, columns[i]])) for i in known}
    legs = {(i, j): fields[ends[i], columns[j]] * FIELD_UNIT for i in known for j in known}
    return np.array([way[columns[order[0]]] + sum(legs[pair] for pair in pairwise(order)) for order in orders])
