"""Schema of a line of a task file; the ranges of numbers come from `table`."""

import functools
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from home_mjx.audio_jax.auralization.sources import CLIPS
from home_mjx.errors import ConfigError, DatasetError, did_you_mean
from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.tasks.communication.talk import NUM_REPLIES
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.rules.words import (
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_STAGES,
    NUM_TRANSITIONS,
    Attribute,
    Feature,
    TargetKind,
)
from home_mjx.tasks.sounds.row import NUM_SOUNDS, VOICE_CLIP
from home_mjx.tasks.validation.table import DESCRIPTOR_COLUMN, MAX_AGENTS, Range, column_ranges, index_range

END_NAMES = ("success", "failure")
MAX_SHOWN_CHARS = 60  # maximum number of characters of an invalid value in a message
Checker = Callable[[Any, str], None]  # checks a value at a place of the line; raises `DatasetError` if it is invalid


@dataclass(frozen=True)
class ListSchema:
    """Schema of a list with `min_items` to `max_items` items of one form."""

    item: "Schema"
    max_items: int
    min_items: int = 0


Schema = Checker | ListSchema | Mapping[str, "Schema"]  # fields of a mapping whose names end in "?" are optional


def check_line(line: Any) -> None:
    """Check that a line has the form of a task.

    Args:
        line: Decoded JSON of the line.

    Raises:
        DatasetError: Names the field, such as `stages[0].ways[1].reward`, and its allowed values.

    Example:
        >>> check_line(["house"])
        Traceback (most recent call last):
        ...
        home_mjx.errors.DatasetError: expected an object with fields, got a list of 1
    """
    _check(line, build_line_schema(), "")


@contextmanager
def locate_errors(name: str) -> Iterator[None]:
    """Convert a `ConfigError` raised in this context to a `DatasetError` at the named field."""
    try:
        yield
    except ConfigError as error:
        raise DatasetError(error.message, element=name, hint=error.hint) from None


@functools.cache
def build_line_schema() -> Schema:
    """Return the schema of a line."""
    place = ListSchema(_range_checker(column_ranges()["place"]._replace(also_allowed=())), 3, 3)
    words = {f"{word.name.lower()}?": _attribute_checker(word) for word in list(Attribute)[1:]}
    meant = {"kind": _name_checker([kind.name.lower() for kind in TargetKind]), "place?": place, **words}
    numbers = {f"{name}?": _column_checker(name) for name in ("first", "second", "agent", "minimum", "maximum")}
    whens = ListSchema(
        {"feature": _name_checker([feature.name.lower() for feature in Feature]), **numbers}, NUM_CONDITIONS
    )
    way = {"next": _check_next, "require?": whens, "forbid?": whens, "reward?": _column_checker("reward")}
    stage = {"transitions": ListSchema(way, NUM_TRANSITIONS, 1), "guide?": _column_checker("guide")}
    sound = {"emitter": _column_checker("sound_emitter"), "clip": _name_checker((*CLIPS, VOICE_CLIP))}
    sound |= {
        f"{name}?": _column_checker(f"sound_{name}") for name in ("period", "duration", "gain", "destination", "speed")
    }
    talk = {
        "answer?": _check_text,
        "instructed_agents?": ListSchema(_range_checker(index_range(MAX_AGENTS, allow_none=False)), MAX_AGENTS),
        "num_identifying_questions?": _column_checker("num_identifying_questions"),
    }
    talk |= {"oracle?": ListSchema(ListSchema(_check_text, 2, 2), NUM_REPLIES)}
    own = {
        "house": _check_text,
        "task": _check_text,
        "start": ListSchema(_column_checker("start"), 3, 3),
        "yaw": _column_checker("yaw"),
    }
    own |= {
        "length": _column_checker("length"),
        "instruction": _check_text,
        "selectors": ListSchema(meant, NUM_DESCRIPTORS),
    }
    return own | {"stages": ListSchema(stage, NUM_STAGES, 1), "sounds?": ListSchema(sound, NUM_SOUNDS)} | talk


def _check(value: Any, form: Schema, place: str) -> None:
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
    if not isinstance(value, kind):
        raise DatasetError(f"expected {text}, got {_format_value(value)}", element=place or None)


def _check_text(value: Any, place: str) -> None:
    _check_type(value, str, "a string", place)


def _column_checker(column: str) -> Checker:
    return _range_checker(column_ranges()[column])


def _range_checker(allowed: Range) -> Checker:
    def check(value: Any, place: str) -> None:
        known = int if allowed.is_integer else int | float
        if isinstance(value, bool) or not isinstance(value, known) or not allowed.contains(value):
            raise DatasetError(f"expected {allowed}, got {_format_value(value)}", element=place)

    return check


def _name_checker(names: Any) -> Checker:
    def check(value: Any, place: str) -> None:
        if not isinstance(value, str) or value not in names:
            raise DatasetError(
                f"unknown name {_format_value(value)}", element=place, hint=did_you_mean(str(value), names)
            )

    return check


def _attribute_checker(word: Attribute) -> Checker:
    if word in SEMANTIC_COLUMN:
        return _name_checker(("", "unknown", *vocabularies()[SEMANTIC_COLUMN[word]]))
    return _column_checker(DESCRIPTOR_COLUMN.format(word.name.lower()))


def _check_next(value: Any, place: str) -> None:
    if isinstance(value, str):
        _name_checker(END_NAMES)(value, place)
    elif isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < NUM_STAGES:
        message = f"expected the number of a stage, {END_NAMES[0]} or {END_NAMES[1]}, got {_format_value(value)}"
        raise DatasetError(message, element=place)


def _format_value(value: Any) -> str:
    """Format a value for a message, shortened to `MAX_SHOWN_CHARS` characters."""
    if isinstance(value, dict | list):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    if isinstance(value, int) and abs(value) > 10**MAX_SHOWN_CHARS:
        return "a number of more than 60 digits"
    text = repr(value)
    return text if len(text) <= MAX_SHOWN_CHARS else f"{text[:MAX_SHOWN_CHARS]}…"
