"""Tasks as JSON lines, with names and positions instead of indices: any bank of the houses can load them."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jaxtyping import UInt16

from home_mjx.audio_jax.auralization.sources import CLIPS
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_type
from home_mjx.core.files import as_path, read_json_lines, write_json_lines
from home_mjx.errors import ConfigError, DatasetError, UnknownIdError
from home_mjx.scene_compile.semantics.vocabulary import encode_name, vocabularies
from home_mjx.tasks.base.state import check_rows
from home_mjx.tasks.communication.talk import ALL_AGENTS, NO_WORD, pack_speech
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import detokenize, tokenize
from home_mjx.tasks.rules.build import add_fields, pack_task_bank, pad_tokens
from home_mjx.tasks.rules.house_view import HouseView, house_views
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition, pack_program
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.rules.words import ANY, FAILURE, NUM_CONDITIONS, SUCCESS, Attribute, Feature, TargetKind
from home_mjx.tasks.sounds.row import SoundEvent, pack_sounds, unpack_sounds
from home_mjx.tasks.validation.faults import find_violation
from home_mjx.tasks.validation.lines import check_line, locate_errors
from home_mjx.tasks.validation.places import find_infeasible
from home_mjx.tasks.validation.table import column_ranges, feature_ranges

MAX_BYTES = 1 << 30  # [bytes], maximum size of a file; about a million tasks
OUTCOMES = {SUCCESS: "success", FAILURE: "failure"}


def save_tasks(path: str | Path, bank: HouseBank, tasks: TaskBank) -> None:
    """Write tasks, one JSON object a line.

    Args:
        path: The file.
        bank: The tasks' houses.
        tasks: Tasks from `Task.task_bank` or `build_task_bank`.

    Raises:
        ConfigError: The file cannot be written, or the tasks are of other houses, or have no names.

    Example:
        >>> save_tasks("tasks.jsonl", env.params.bank, env.params.tasks)  # doctest: +SKIP
    """
    as_path(path, "tasks")
    check_type("bank", bank, HouseBank)
    check_type("tasks", tasks, TaskBank)
    ids, host = bank.house_ids, jax.tree.map(np.asarray, tasks.rows)
    check_rows(host.house, len(ids), "houses")
    check_rows(host.columns["task"], len(tasks.names), "names of tasks")
    lines = []
    for at in range(len(host)):
        row = {name: values[at] for name, values in host.columns.items()}
        line = {"house": ids[int(host.house[at])], "task": tasks.names[int(row["task"])]}
        line |= {"start": host.start[at].tolist(), "yaw": float(host.yaw[at]), "length": float(row["length"])}
        line |= {
            "instruction": detokenize(row["tokens"]),
            "selectors": _format_selectors(row),
            "stages": _format_stages(row),
        }
        line |= {"sounds": sounds} if (sounds := _format_sounds(row)) else {}
        line |= _format_speech(row)
        lines.append(line)
    write_json_lines(as_path(path, "tasks"), lines, "tasks")


def load_tasks(path: str | Path, bank: HouseBank) -> TaskBank:
    """Load tasks that `save_tasks`, or a person, has written.

    Args:
        path: The file.
        bank: Holds the houses, and may hold others.

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
    if not rows:
        raise DatasetError("file holds no task", file=path, hint="Write one JSON object a line, see `save_tasks`.")
    fields = {}
    for view in house_views(bank):
        own = [(number, row) for number, row in enumerate(rows) if row["house"] == view.house]
        if own:
            fields[view.house] = _distance_fields(path, bank, view, own)
    tasks = pack_task_bank(bank, rows, fields, tuple(names))
    fault = find_violation(tasks.rows, bank, column_ranges(), feature_ranges(), {})
    if fault is not None:
        raise DatasetError(fault.message, file=path, element=f"line {fault.row + 1}, {fault.field}", hint=fault.hint)
    return tasks


def _distance_fields(
    path: str | Path, bank: HouseBank, view: HouseView, rows: list[tuple[int, dict[str, Any]]]
) -> UInt16[np.ndarray, "c g"]:
    """Return distances of a house's cells to the targets of its tasks; raise if a task cannot be solved."""
    columns = [row for _, row in rows]
    field_ = add_fields(bank, view, columns)
    fault = find_infeasible(bank, view, columns, field_)
    if fault is not None:
        element = f"line {rows[fault.row][0] + 1}, {fault.field}"
        raise DatasetError(fault.message, file=path, element=element, hint=fault.hint)
    return field_


def _parse_row(line: dict[str, Any], index: dict[str, int], names: dict[str, int]) -> dict[str, Any]:
    check_line(line)
    if line["house"] not in index:
        hint = "Give the houses that the tasks are of."
        raise UnknownIdError(f"the bank has no house {line['house'][:100]}", element="house", hint=hint)
    meant = [_parse_selector(item) for item in line["selectors"]]
    with locate_errors("stages"):
        arrays = pack_program(meant, [_parse_stage(item) for item in line["stages"]])
    with locate_errors("sounds"):
        arrays |= pack_sounds([SoundEvent(**item) for item in line.get("sounds", ())], len(meant))
    with locate_errors("instruction"):
        arrays |= {"tokens": pad_tokens(tokenize(line["instruction"]))}
    own = {"house": index[line["house"]], "task": names.setdefault(line["task"], len(names))}
    own |= {"start": np.array(line["start"], np.float32)}
    return arrays | own | {name: np.float32(line[name]) for name in ("yaw", "length")} | _parse_speech(line)


def _format_speech(row: dict[str, np.ndarray]) -> dict[str, Any]:
    """Return the fields of a row about speech, without those that have their defaults."""
    item: dict[str, Any] = {}
    if row["answer"] != NO_WORD:
        item["answer"] = detokenize([int(row["answer"])])
    if row["instructed_agents"] != ALL_AGENTS:
        item["instructed_agents"] = [agent for agent in range(16) if int(row["instructed_agents"]) >> agent & 1]
    oracle = [[detokenize([word]) for word in pair] for pair in row["oracle"].tolist() if pair[0] != NO_WORD]
    return item | (
        {"oracle": oracle, "num_identifying_questions": int(row["num_identifying_questions"])} if oracle else {}
    )


def _parse_speech(line: dict[str, Any]) -> dict[str, np.ndarray]:
    with locate_errors("answer"):
        answer = _parse_word(line["answer"]) if "answer" in line else NO_WORD
    with locate_errors("oracle"):
        oracle = [(_parse_word(question), _parse_word(reply)) for question, reply in line.get("oracle", ())]
    with locate_errors("num_identifying_questions"):
        return pack_speech(answer, line.get("instructed_agents"), oracle, line.get("num_identifying_questions", 0))


def _parse_word(word: str) -> int:
    tokens = tokenize(word)
    if len(tokens) != 1:
        raise ConfigError(f"expected one word, got {len(tokens)}: {word[:100]!r}", hint="Write one, such as `yes`.")
    return tokens[0]


def _format_selectors(row: dict[str, np.ndarray]) -> list[dict[str, Any]]:
    found = []
    for words, place in zip(row["descriptor"].tolist(), row["place"], strict=True):
        item: dict[str, Any] = {"kind": TargetKind(words[Attribute.KIND]).name.lower()}
        for word in list(Attribute)[1:]:
            if words[word] != ANY:
                item[word.name.lower()] = (
                    vocabularies()[SEMANTIC_COLUMN[word]][words[word]] if word in SEMANTIC_COLUMN else words[word]
                )
        found.append(item | ({"place": place.tolist()} if np.isfinite(place).all() else {}))
    while found and found[-1] == {"kind": "nothing"}:
        found.pop()
    return found


def _format_sounds(row: dict[str, np.ndarray]) -> list[dict[str, Any]]:
    plain = SoundEvent(0, CLIPS[0])
    return [
        {"emitter": sound.emitter, "clip": sound.clip}
        | {name: value for name, value in asdict(sound).items() if value != getattr(plain, name)}
        for sound in unpack_sounds(row)
    ]


def _parse_selector(item: dict[str, Any]) -> Selector:
    words = {"kind": int(TargetKind[item["kind"].upper()])}
    for name, value in item.items():
        if name not in ("kind", "place"):
            word = Attribute[name.upper()]
            words[name] = encode_name(SEMANTIC_COLUMN[word], value) if word in SEMANTIC_COLUMN else int(value)
    return Selector(words, tuple(item["place"])) if "place" in item else Selector(words)


def _format_stages(row: dict[str, np.ndarray]) -> list[dict[str, Any]]:
    whens = [_format_condition(row, c) for c in range(NUM_CONDITIONS)]
    found = []
    for needs, bars, after, reward, guide in zip(
        *(row[name].tolist() for name in ("require", "forbid", "next", "reward", "guide")), strict=True
    ):
        ways = [
            {"next": OUTCOMES.get(after[g], after[g]), "require": _select_bits(needs[g], whens), "reward": reward[g]}
            | ({"forbid": _select_bits(bars[g], whens)} if bars[g] else {})
            for g in range(len(needs))
            if needs[g] >= 0
        ]
        if ways:
            found.append({"transitions": ways, "guide": guide})
    return found


def _select_bits(bits: int, whens: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [when for c, when in enumerate(whens) if bits >> c & 1]


def _format_condition(row: dict[str, np.ndarray], c: int) -> dict[str, Any]:
    item = {"feature": Feature(int(row["feature"][c])).name.lower()}
    plain = Condition(Feature.TRUE)
    for name in ("first", "second", "agent", "minimum", "maximum"):
        value = row[name][c].item()
        item |= {} if value == getattr(plain, name) else {name: value}
    return item


def _parse_stage(item: dict[str, Any]) -> TaskStage:
    return TaskStage(tuple(_parse_transition(way) for way in item["transitions"]), int(item.get("guide", ANY)))


def _parse_transition(way: dict[str, Any]) -> Transition:
    ends = {name: number for number, name in OUTCOMES.items()}
    needs, bars = (tuple(_parse_condition(when) for when in way.get(name, ())) for name in ("require", "forbid"))
    after = way["next"]
    return Transition(ends[after] if isinstance(after, str) else int(after), needs, bars, float(way.get("reward", 0.0)))


def _parse_condition(item: dict[str, Any]) -> Condition:
    options = {name: value for name, value in item.items() if name != "feature"}
    return Condition(Feature[item["feature"].upper()], **options)
