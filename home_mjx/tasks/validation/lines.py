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
from home_mjx.tasks.language.phrases import COLUMN
from home_mjx.tasks.rules.words import (
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_STAGES,
    NUM_TRANSITIONS,
    Feature,
    Kind,
    Word,
)
from home_mjx.tasks.sounds.row import NUM_SOUNDS, VOICE
from home_mjx.tasks.validation.table import MEANT, MOST_AGENTS, Range, index_of, limits

ENDS = ("success", "failure")
MOST_SHOWN = 60  # maximum number of characters of an invalid value in a message
Check = Callable[[Any, str], None]  # checks a value at a place of the line; raises `DatasetError` if it is invalid


@dataclass(frozen=True)
class Many:
    """Schema of a list with `least` to `most` items of one form."""

    form: "Form"
    most: int
    least: int = 0


Form = Check | Many | Mapping[str, "Form"]  # fields of a mapping whose names end in "?" are optional


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
    _check(line, line_form(), "")


@contextmanager
def part(name: str) -> Iterator[None]:
    """Convert a `ConfigError` raised in this context to a `DatasetError` at the named field."""
    try:
        yield
    except ConfigError as error:
        raise DatasetError(error.message, element=name, hint=error.hint) from None


@functools.cache
def line_form() -> Form:
    """Return the schema of a line."""
    place = Many(_within(limits()["place"]._replace(besides=())), 3, 3)
    words = {f"{word.name.lower()}?": _word(word) for word in list(Word)[1:]}
    meant = {"kind": _one_of([kind.name.lower() for kind in Kind]), "place?": place, **words}
    numbers = {f"{name}?": _number(name) for name in ("first", "second", "agent", "least", "most")}
    whens = Many({"feature": _one_of([feature.name.lower() for feature in Feature]), **numbers}, NUM_CONDITIONS)
    way = {"next": _next, "needs?": whens, "bars?": whens, "reward?": _number("reward")}
    stage = {"ways": Many(way, NUM_TRANSITIONS, 1), "guide?": _number("guide")}
    sound = {"emitter": _number("sound_emitter"), "clip": _one_of((*CLIPS, VOICE))}
    sound |= {f"{name}?": _number(f"sound_{name}") for name in ("every", "lasts", "gain", "towards", "speed")}
    talk = {
        "answer?": _text,
        "told?": Many(_within(index_of(MOST_AGENTS, none=False)), MOST_AGENTS),
        "ask?": _number("ask"),
    }
    talk |= {"oracle?": Many(Many(_text, 2, 2), NUM_REPLIES)}
    own = {"house": _text, "task": _text, "start": Many(_number("start"), 3, 3), "yaw": _number("yaw")}
    own |= {"length": _number("length"), "instruction": _text, "meant": Many(meant, NUM_DESCRIPTORS)}
    return own | {"stages": Many(stage, NUM_STAGES, 1), "sounds?": Many(sound, NUM_SOUNDS)} | talk


def _check(value: Any, form: Form, place: str) -> None:
    if isinstance(form, Mapping):
        _check_fields(value, form, place)
    elif isinstance(form, Many):
        _check_type(value, list, "a list", place)
        if not form.least <= len(value) <= form.most:
            many = str(form.most) if form.least == form.most else f"{form.least} to {form.most}"
            raise DatasetError(f"expected {many} items, got {len(value)}", element=place)
        for number, item in enumerate(value):
            _check(item, form.form, f"{place}[{number}]")
    else:
        form(value, place)


def _check_fields(value: Any, form: Mapping[str, Form], place: str) -> None:
    _check_type(value, dict, "an object with fields", place)
    known = {name.rstrip("?"): own for name, own in form.items()}
    dot = f"{place}." if place else ""
    for name in value:
        if name not in known:
            raise DatasetError(f"unknown field {_shown(name)}", element=place or None, hint=did_you_mean(name, known))
    for name in form:
        if name not in value and not name.endswith("?"):
            hint = f"Fields are {', '.join(known)}."
            raise DatasetError(f"`{name}` is missing", element=place or None, hint=hint)
    for name, item in value.items():
        _check(item, known[name], dot + name)


def _check_type(value: Any, kind: type, text: str, place: str) -> None:
    if not isinstance(value, kind):
        raise DatasetError(f"expected {text}, got {_shown(value)}", element=place or None)


def _text(value: Any, place: str) -> None:
    _check_type(value, str, "a string", place)


def _number(column: str) -> Check:
    return _within(limits()[column])


def _within(allowed: Range) -> Check:
    def check(value: Any, place: str) -> None:
        known = int if allowed.whole else int | float
        if isinstance(value, bool) or not isinstance(value, known) or not allowed.holds(value):
            raise DatasetError(f"expected {allowed}, got {_shown(value)}", element=place)

    return check


def _one_of(names: Any) -> Check:
    def check(value: Any, place: str) -> None:
        if not isinstance(value, str) or value not in names:
            raise DatasetError(f"unknown name {_shown(value)}", element=place, hint=did_you_mean(str(value), names))

    return check


def _word(word: Word) -> Check:
    if word in COLUMN:
        return _one_of(("", "unknown", *vocabularies()[COLUMN[word]]))
    return _number(MEANT.format(word.name.lower()))


def _next(value: Any, place: str) -> None:
    if isinstance(value, str):
        _one_of(ENDS)(value, place)
    elif isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < NUM_STAGES:
        message = f"expected the number of a stage, {ENDS[0]} or {ENDS[1]}, got {_shown(value)}"
        raise DatasetError(message, element=place)


def _shown(value: Any) -> str:
    """Format a value for a message, shortened to `MOST_SHOWN` characters."""
    if isinstance(value, dict | list):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    if isinstance(value, int) and abs(value) > 10**MOST_SHOWN:
        return "a number of more than 60 digits"
    text = repr(value)
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}…"
