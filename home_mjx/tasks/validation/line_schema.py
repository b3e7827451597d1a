"""Schema of a line of a task file, derived from the dataclasses that it describes and the declarations of columns."""

import dataclasses
import functools
import typing
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntEnum
from types import UnionType
from typing import Any

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.errors import ConfigError, DatasetError, did_you_mean
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.rules.declaration import AXES, Column, row_columns
from home_mjx.tasks.rules.enums import FAILURE, MAX_AGENTS, NUM_REPLIES, NUM_STAGES, SUCCESS, Attribute, TargetKind
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.task_bank import RECORDS
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP, SoundEvent
from home_mjx.tasks.validation.column_ranges import DESCRIPTOR_COLUMN, Range, column_ranges, index_range, values_range

OUTCOMES = {SUCCESS: "success", FAILURE: "failure"}  # names of final stages
MAX_SHOWN_CHARS = 60  # maximum number of characters of an invalid value in a message
ITEMS = {Selector: "d", Condition: "c", Transition: "g", TaskStage: "s", SoundEvent: "e"}  # their axes, keys of `AXES`
NEVER_EMPTY = (Transition, TaskStage)  # items of which a list has at least one
Checker = Callable[[Any, str], None]  # checks a value at a place of the line; raises `DatasetError` if it is invalid


@dataclass(frozen=True)
class TaskLine:
    """A task as a line of a file: names and positions instead of indices.

    Attributes:
        house: Id of the house.
        task: Name of the task's generator.
        start: Start on the floor [m].
        yaw: Yaw at the start [rad].
        length: Length of the shortest path from start to goal [m].
        instruction: Words of the instruction.
        selectors: Descriptors.
        stages: Stages; an episode begins in the first one.
        sounds: Sounds; none: the house's own source.
        answer: Correct answer to the row's question, one word; None: it asks none.
        instructed_agents: Indices of the agents that receive the instruction; None: all.
        oracle: Questions that agents may ask, one word each, with the one-word replies.
        num_identifying_questions: Number of oracle questions, from the first, that suffice to identify the target.
    """

    house: str
    task: str
    start: tuple[float, float, float]
    yaw: float
    length: float
    instruction: str
    selectors: tuple[Selector, ...]
    stages: tuple[TaskStage, ...]
    sounds: tuple[SoundEvent, ...] = ()
    answer: str | None = None
    instructed_agents: tuple[int, ...] | None = None
    oracle: tuple[tuple[str, str], ...] = ()
    num_identifying_questions: int = 0


@dataclass(frozen=True)
class ListSchema:
    """Schema of a list with `min_items` to `max_items` items of one form."""

    item: "Schema"
    max_items: int
    min_items: int = 0


Schema = Checker | ListSchema | Mapping[str, "Schema"]  # fields of a mapping whose names end in "?" are optional


def check_line(line: Any) -> None:
    """Raise `DatasetError` unless a line's decoded JSON has the form of a task; names the field and its allowed values.

    Example:
        >>> check_line(["house"])
        Traceback (most recent call last):
        ...
        home_mjx.errors.DatasetError: expected an object with fields, got a list of 1
    """
    _check(line, schema_of(TaskLine), "")


@contextmanager
def locate_errors(name: str) -> Iterator[None]:
    """Convert a `ConfigError` raised in this context to a `DatasetError` at the named field."""
    try:
        yield
    except ConfigError as error:
        raise DatasetError(error.message, element=name, hint=error.hint) from None


def field_types(cls: type) -> dict[str, Any]:
    """Return the annotations of a dataclass's fields by name, without their `| None`.

    Example:
        >>> field_types(TaskLine)["answer"]
        <class 'str'>
    """
    hints = {field.name: typing.get_type_hints(cls)[field.name] for field in dataclasses.fields(cls)}
    return {name: typing.get_args(kind)[0] if isinstance(kind, UnionType) else kind for name, kind in hints.items()}


@functools.cache
def schema_of(cls: type) -> Schema:
    """Return the schema of a dataclass as a JSON object; fields with a default are optional.

    A field's annotation determines the form of its value; the column with its name determines the range of numbers.
    """
    if cls is Selector:
        return _selector_schema()
    columns, prefix = row_columns(RECORDS), getattr(cls, "PREFIX", "")
    types = field_types(cls)
    required = {field.name: field.default is dataclasses.MISSING for field in dataclasses.fields(cls)}
    return {
        name if required[name] else f"{name}?": SPECIAL.get((cls, name))
        or _schema(types[name], columns.get(prefix + name))
        for name in types
    }


def _schema(kind: Any, column: Column | None) -> Schema:
    """Return the schema of a value with an annotation; `column` has the range of a number."""
    if typing.get_origin(kind) is tuple:
        item, *others = typing.get_args(kind)
        if others == [...]:
            axis = AXES[ITEMS[item]]
            return ListSchema(schema_of(item), axis.capacity, int(item in NEVER_EMPTY))
        return ListSchema(_schema(item, column), 1 + len(others), 1 + len(others))
    if kind is str:
        return _check_text
    if issubclass(kind, IntEnum):
        return _name_checker(names_of(kind))
    assert column is not None
    return _range_checker(values_range(column.values))


def names_of(kind: type[IntEnum]) -> list[str]:
    """Return the names of an enumeration's members as in files: in lower case.

    Example:
        >>> names_of(TargetKind)[:3]
        ['nothing', 'object', 'room']
    """
    return [member.name.lower() for member in kind]


def _selector_schema() -> Schema:
    """Return the schema of a selector: its kind, optional place and optional attributes, by name."""
    place = ListSchema(_range_checker(values_range("point")), 3, 3)
    words = {f"{word.name.lower()}?": _attribute_checker(word) for word in list(Attribute)[1:]}
    return {"kind": _name_checker(names_of(TargetKind)), "place?": place, **words}


def _attribute_checker(word: Attribute) -> Checker:
    """Return the checker of an attribute's value: a number in its range, or a name of its vocabulary.

    Where there is a vocabulary, the empty text and "unknown" pass too.
    """
    if word in SEMANTIC_COLUMN:
        return _name_checker(("", "unknown", *vocabularies()[SEMANTIC_COLUMN[word]]))
    return _range_checker(column_ranges()[DESCRIPTOR_COLUMN.format(word.name.lower())])


def _check(value: Any, form: Schema, place: str) -> None:
    """Raise `DatasetError` unless `value`, at `place` in the line, has the form of a schema, at any depth."""
    if isinstance(form, Mapping):
        _check_fields(value, form, place)
    elif isinstance(form, ListSchema):
        _check_type(value, list, "a list", place)
        if not form.min_items <= len(value) <= form.max_items:
            many = str(form.max_items) if form.min_items == form.max_items else f"{form.min_items} to {form.max_items}"
            raise DatasetError(f"expected {many} items, got {len(value)}", element=place)
        for number, item in enumerate(value):
            _check(item, form.item, f"{place}[{number}]")
    else:
        form(value, place)


def _check_fields(value: Any, form: Mapping[str, Schema], place: str) -> None:
    """Raise `DatasetError` unless an object has all required fields, no others, and valid values."""
    _check_type(value, dict, "an object with fields", place)
    known = {name.rstrip("?"): own for name, own in form.items()}
    dot = f"{place}." if place else ""
    for name in value:
        if name not in known:
            raise DatasetError(
                f"unknown field {_format_value(name)}", element=place or None, hint=did_you_mean(name, known)
            )
    for name in form:
        if name not in value and not name.endswith("?"):
            hint = f"Fields are {', '.join(known)}."
            raise DatasetError(f"`{name}` is missing", element=place or None, hint=hint)
    for name, item in value.items():
        _check(item, known[name], dot + name)


def _check_type(value: Any, kind: type, text: str, place: str) -> None:
    """Raise `DatasetError` unless a value is of a type, whose description is `text`."""
    if not isinstance(value, kind):
        raise DatasetError(f"expected {text}, got {_format_value(value)}", element=place or None)


def _check_text(value: Any, place: str) -> None:
    """Raise `DatasetError` unless a value is a string."""
    _check_type(value, str, "a string", place)


def _range_checker(allowed: Range) -> Checker:
    """Return the checker of numbers in a range; booleans are not numbers, and floats are not whole numbers."""

    def check(value: Any, place: str) -> None:
        """Raise `DatasetError` unless a value is a number in the range."""
        known = int if allowed.is_integer else int | float
        if isinstance(value, bool) or not isinstance(value, known) or not allowed.contains(value):
            raise DatasetError(f"expected {allowed}, got {_format_value(value)}", element=place)

    return check


def _name_checker(names: Any) -> Checker:
    """Return the checker of strings that are one of `names`; its error suggests the closest."""

    def check(value: Any, place: str) -> None:
        """Raise `DatasetError` unless a value is one of the names."""
        if not isinstance(value, str) or value not in names:
            raise DatasetError(
                f"unknown name {_format_value(value)}", element=place, hint=did_you_mean(str(value), names)
            )

    return check


def _check_next(value: Any, place: str) -> None:
    """Raise `DatasetError` unless a value is the number of a stage or the name of an outcome."""
    names = list(OUTCOMES.values())
    if isinstance(value, str):
        _name_checker(names)(value, place)
    elif isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < NUM_STAGES:
        message = f"expected the number of a stage, {' or '.join(names)}, got {_format_value(value)}"
        raise DatasetError(message, element=place)


def _format_value(value: Any) -> str:
    """Format a value for a message, shortened to `MAX_SHOWN_CHARS` characters."""
    if isinstance(value, dict | list):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    if isinstance(value, int) and abs(value) > 10**MAX_SHOWN_CHARS:
        return "a number of more than 60 digits"
    text = repr(value)
    return text if len(text) <= MAX_SHOWN_CHARS else f"{text[:MAX_SHOWN_CHARS]}…"


SPECIAL: Mapping[tuple[type, str], Schema] = {  # fields whose form in files differs from their annotation
    (Transition, "next"): _check_next,
    (SoundEvent, "clip"): _name_checker((*CLIPS, VOICE_CLIP)),
    (TaskLine, "instructed_agents"): ListSchema(_range_checker(index_range(MAX_AGENTS, allow_none=False)), MAX_AGENTS),
    (TaskLine, "oracle"): ListSchema(ListSchema(_check_text, 2, 2), NUM_REPLIES),
}
