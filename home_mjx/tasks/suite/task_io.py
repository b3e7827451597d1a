"""Tasks as JSON lines, with names and positions instead of indices: any bank of the houses can load them."""

import logging
import typing
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jaxtyping import UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_type
from home_mjx.core.files import as_path, read_json_lines, write_json_lines
from home_mjx.errors import ConfigError, DatasetError, UnknownIdError
from home_mjx.schema.vocabulary import encode_name, vocabularies
from home_mjx.tasks.base.state import check_rows
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import detokenize, tokenize
from home_mjx.tasks.rules.build_bank import add_fields, pack_task_bank
from home_mjx.tasks.rules.declaration import pack
from home_mjx.tasks.rules.enums import NO_WORD, Attribute, TargetKind
from home_mjx.tasks.rules.house_view import HouseView, house_views
from home_mjx.tasks.rules.packing import (
    Columns,
    pack_program,
    pack_sounds,
    pack_speech,
    unpack_program,
    unpack_sounds,
    unpack_speech,
)
from home_mjx.tasks.rules.program import NO_PLACE, Selector, Transition
from home_mjx.tasks.rules.task_bank import RowStart, TaskBank
from home_mjx.tasks.validation.column_ranges import column_ranges, feature_ranges
from home_mjx.tasks.validation.line_schema import OUTCOMES, TaskLine, check_line, field_types, locate_errors
from home_mjx.tasks.validation.row_violations import find_violation
from home_mjx.tasks.validation.task_fit import correct_lengths, find_infeasible

log = logging.getLogger(__name__)

MAX_BYTES = 1 << 30  # [bytes], maximum size of a file; about a million tasks


def save_tasks(path: str | Path, bank: HouseBank, tasks: TaskBank) -> None:
    """Write tasks, one JSON object a line.

    Args:
        path: The file.
        bank: The tasks' houses.
        tasks: Tasks from `Task.task_bank` or `build_task_bank`.

    Raises:
        ConfigError: The file cannot be written, or an index of a house is beyond the bank, or the tasks have no names.
            Other houses of the same indices are not noticed.

    Example:
        >>> save_tasks("tasks.jsonl", env.params.bank, env.params.tasks)  # doctest: +SKIP
    """
    as_path(path, "tasks")
    check_type("bank", bank, HouseBank)
    check_type("tasks", tasks, TaskBank)
    ids, host = bank.house_ids, jax.tree.map(np.asarray, tasks.rows)
    check_rows(host.house, len(ids), "houses")
    check_rows(host.columns["task"], len(tasks.names), "names of tasks")
    columns = {"house": host.house, "start": host.start, "yaw": host.yaw, **host.columns}
    rows = ({name: values[at] for name, values in columns.items()} for at in range(len(host)))
    lines = [encode(_task_line(row, ids, tasks.names)) for row in rows]
    write_json_lines(as_path(path, "tasks"), lines, "tasks")


def load_tasks(path: str | Path, bank: HouseBank) -> TaskBank:
    """Load tasks that `save_tasks`, or a person, has written.

    Args:
        path: The file.
        bank: Holds the houses, and may hold others.

    Returns:
        The tasks. A `length` that is not that of the shortest path is computed anew, with a warning in the log.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: A line is malformed, or names a house that the bank lacks; names the line.

    Example:
        >>> env = env.with_tasks(load_tasks("tasks.jsonl", env.params.bank))  # doctest: +SKIP
    """
    file = as_path(path, "tasks")
    check_type("bank", bank, HouseBank)
    index = {name: number for number, name in enumerate(bank.house_ids)}
    names: dict[str, int] = {}
    rows = list(read_json_lines(file, "task", lambda line: _parse_row(line, index, names), MAX_BYTES))
    return _pack_rows(path, bank, rows, tuple(names))


def convert_tasks(lines: Sequence[TaskLine], bank: HouseBank, path: str | Path) -> TaskBank:
    """Return tasks read from a file of another format; checks, lengths and errors as for `load_tasks`.

    Args:
        lines: The tasks.
        bank: Holds the houses.
        path: The file, for messages, which name its tasks as lines from 1.
    """
    index = {name: number for number, name in enumerate(bank.house_ids)}
    names: dict[str, int] = {}
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            rows.append(_parse_row(encode(line), index, names))
        except DatasetError as error:
            place = f"line {number}, {error.element}"
            raise type(error)(error.message, file=path, element=place, hint=error.hint) from None
    return _pack_rows(path, bank, rows, tuple(names))


def _pack_rows(path: str | Path, bank: HouseBank, rows: list[dict[str, Any]], names: tuple[str, ...]) -> TaskBank:
    """Return the tasks of parsed rows of a file, with distances; `DatasetError` if one cannot be used."""
    if not rows:
        raise DatasetError("file holds no task", file=path, hint="Write one JSON object a line, see `save_tasks`.")
    fields = {}
    for view in house_views(bank):
        own = [(number, row) for number, row in enumerate(rows) if row["house"] == view.house]
        if own:
            fields[view.house] = _distance_fields(path, bank, view, own)
    tasks = pack_task_bank(bank, rows, fields, names)
    fault = find_violation(tasks.rows, bank, column_ranges(), feature_ranges(), {})
    if fault is not None:
        raise DatasetError(fault.message, file=path, element=f"line {fault.row + 1}, {fault.field}", hint=fault.hint)
    return tasks


def _distance_fields(
    path: str | Path, bank: HouseBank, view: HouseView, rows: list[tuple[int, dict[str, Any]]]
) -> UInt16[np.ndarray, "c g"]:
    """Return the distance fields of a house's rows; add the column `field` and correct `length` in `rows`, in place.

    `rows` are pairs of a line's index, from 0, and its columns.

    Raises:
        DatasetError: A task cannot be solved.
    """
    columns = [row for _, row in rows]
    field_ = add_fields(bank, view, columns)
    fault = find_infeasible(bank, view, columns, field_)
    if fault is not None:
        element = f"line {rows[fault.row][0] + 1}, {fault.field}"
        raise DatasetError(fault.message, file=path, element=element, hint=fault.hint)
    for number, (wrong, right) in correct_lengths(view, columns, field_).items():
        place = f"{path}, line {rows[number][0] + 1}"
        log.warning("%s: `length` is %.2f m, the shortest path is %.2f m, which is used", place, wrong, right)
    return field_


def _task_line(row: Columns, ids: tuple[str, ...], names: tuple[str, ...]) -> TaskLine:
    """Return the line of a row of a task bank, with names and words instead of indices and tokens."""
    selectors, stages = unpack_program(row)
    x, y, z = row["start"].tolist()
    speech = unpack_speech(row)
    speech["answer"] = None if speech["answer"] == NO_WORD else detokenize([speech["answer"]])
    speech["oracle"] = tuple((detokenize([question]), detokenize([reply])) for question, reply in speech["oracle"])
    return TaskLine(
        house=ids[int(row["house"])],
        task=names[int(row["task"])],
        start=(x, y, z),
        yaw=float(row["yaw"]),
        length=float(row["length"]),
        instruction=detokenize(row["tokens"].tolist()),
        selectors=tuple(selectors),
        stages=tuple(stages),
        sounds=tuple(unpack_sounds(row)),
        **speech,
    )


def _parse_row(line: Any, index: dict[str, int], names: dict[str, int]) -> dict[str, np.ndarray]:
    """Return the columns of a row, without distances, from a line's decoded JSON; add its task to `names`, in place.

    `DatasetError` if the line is malformed, `UnknownIdError` if `index` lacks its house.
    """
    check_line(line)
    task = decode(TaskLine, line)
    if task.house not in index:
        hint = "Give the houses that the tasks are of."
        raise UnknownIdError(f"the bank has no house {task.house[:100]}", element="house", hint=hint)
    with locate_errors("stages"):
        columns = pack_program(task.selectors, task.stages)
    with locate_errors("sounds"):
        columns |= pack_sounds(task.sounds, len(task.selectors))
    number = names.setdefault(task.task, len(names))
    with locate_errors("instruction"):
        own = {"house": index[task.house], "task": number, "tokens": tokenize(task.instruction)}
        columns |= pack(RowStart, own | {name: getattr(task, name) for name in ("start", "yaw", "length")})
    return columns | _pack_speech(task)


def _pack_speech(task: TaskLine) -> dict[str, np.ndarray]:
    """Return the columns of a line's speech; `DatasetError` names the invalid field."""
    with locate_errors("answer"):
        answer = NO_WORD if task.answer is None else _parse_word(task.answer)
    with locate_errors("oracle"):
        oracle = [(_parse_word(question), _parse_word(reply)) for question, reply in task.oracle]
    with locate_errors("num_identifying_questions"):
        return pack_speech(answer, task.instructed_agents, oracle, task.num_identifying_questions)


def _parse_word(word: str) -> int:
    """Return the token of a single word; `ConfigError` for unknown words or other numbers of words."""
    tokens = tokenize(word)
    if len(tokens) != 1:
        raise ConfigError(f"expected one word, got {len(tokens)}: {word[:100]!r}", hint="Write one, such as `yes`.")
    return tokens[0]


def encode(value: Any) -> Any:
    """Return a dataclass of a task line as JSON values; fields that equal their default are left out.

    Tuples become lists and members of enumerations their lower-case names; other values are returned as they are.

    Example:
        >>> encode(Transition(-1, reward=2.5))
        {'next': 'success', 'reward': 2.5}
    """
    if isinstance(value, Selector):
        return _encode_selector(value)
    if is_dataclass(value):
        own = {field.name: getattr(value, field.name) for field in fields(value)}
        changed = [field.name for field in fields(value) if own[field.name] != field.default]
        named = {"next": OUTCOMES.get(value.next, value.next)} if isinstance(value, Transition) else {}
        return {name: encode(own[name]) for name in changed} | named
    if isinstance(value, IntEnum):
        return value.name.lower()
    return [encode(item) for item in value] if isinstance(value, tuple) else value


def decode(kind: Any, value: Any) -> Any:
    """Return the value of a type whose JSON form `encode` returns; the JSON must have passed `check_line`.

    Args:
        kind: `TaskLine`, or the annotation of one of its parts.
        value: Decoded JSON.

    Raises:
        DatasetError: A value contradicts another one; names the field.
    """
    if kind is Selector:
        return _decode_selector(value)
    if isinstance(kind, type) and is_dataclass(kind):
        own, types = {}, field_types(kind)
        for name, item in value.items():
            with locate_errors(name):
                own[name] = decode(types[name], item)
        return kind(**own)
    if isinstance(value, list):
        return tuple(decode(typing.get_args(kind)[0], item) for item in value)
    if kind is int and isinstance(value, str):
        return next(number for number, name in OUTCOMES.items() if name == value)
    return kind[value.upper()] if issubclass(kind, IntEnum) else value


def _encode_selector(selector: Selector) -> dict[str, Any]:
    """Return a selector as JSON values, with names of vocabularies instead of indices; `place` only if it has one."""
    item: dict[str, Any] = {"kind": TargetKind(selector.attributes.get("kind", TargetKind.NOTHING)).name.lower()}
    for name, value in selector.attributes.items():
        word = Attribute[name.upper()]
        if word != Attribute.KIND:
            item[name] = vocabularies()[SEMANTIC_COLUMN[word]][value] if word in SEMANTIC_COLUMN else value
    return item if selector.place == NO_PLACE else item | {"place": list(selector.place)}


def _decode_selector(item: dict[str, Any]) -> Selector:
    """Return the selector that `_encode_selector` has encoded."""
    words = {"kind": int(TargetKind[item["kind"].upper()])}
    for name, value in item.items():
        if name not in ("kind", "place"):
            word = Attribute[name.upper()]
            words[name] = encode_name(SEMANTIC_COLUMN[word], value) if word in SEMANTIC_COLUMN else int(value)
    return Selector(words, tuple(item["place"])) if "place" in item else Selector(words)
