"""Frozen dataclasses of options to and from JSON."""

import dataclasses
import importlib
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from home_mjx.errors import ConfigError

PACKAGE = __name__.split(".")[0]
TYPE, TUPLE = "__type__", "__tuple__"
MOST_SHOWN = 600  # characters of a message
MOST_TEXT = 1 << 22  # characters; the ids of all of SUNCG's 45,622 houses take 2 million
HINT = "Another version of home_mjx wrote it, or it was changed by hand."


@runtime_checkable
class Trusting(Protocol):
    """Options that name what is run: `from_json` asks them before it hands them on, as a file must not choose that."""

    def check_trusted(self) -> None:
        """Raises `ConfigError` if what they name is not known here."""
        ...


def to_json(value: Any) -> str:
    """A value as JSON text; dataclasses and tuples come back as such.

    Raises:
        ConfigError: Something in it is no number, text, container or dataclass, or the text is too long to be read.

    Example:
        >>> to_json((1, "a"))
        '{"__tuple__": [1, "a"]}'
    """
    text = json.dumps(_plain(value, "value"))
    _check_length(text)
    return text


def from_json(text: str, file: Path | None = None) -> Any:
    """What `to_json` was given.

    Args:
        text: What it gave.
        file: Where the text is from, for errors.

    Raises:
        ConfigError: The text is broken or too long, or names something that is no dataclass, or one of a module that
            neither is of this package nor has been imported; or `check_trusted` of a part refuses.
    """
    try:
        _check_length(text)  # before it is parsed: lists within lists take many times the memory of their text
        return _rebuilt(json.loads(text))
    except ConfigError as error:  # it is a ValueError as well
        message, hint = _shown(error.message), _shown(error.hint or HINT)
        raise type(error)(message, file=file or error.file, element=error.element, hint=hint) from error
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError) as error:
        raise ConfigError(f"cannot be read as options: {_shown(str(error))}", file=file, hint=HINT) from error


def _check_length(text: str) -> None:
    if len(text) > MOST_TEXT:
        message = f"text of options has {len(text)} characters, at most {MOST_TEXT} are read"
        raise ConfigError(message, hint="Name a dataset or a split instead of each house.")


def _shown(text: str) -> str:
    """As a message has it: what a file holds may be long, or no text that can be printed."""
    return text.encode(errors="backslashreplace").decode()[:MOST_SHOWN]


def _plain(value: Any, where: str) -> Any:
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, tuple):
        return {TUPLE: [_plain(x, where) for x in value]}
    if isinstance(value, list):
        return [_plain(x, where) for x in value]
    if isinstance(value, Mapping):
        return {str(name): _plain(x, f"{where}.{name}") for name, x in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {f.name: _plain(getattr(value, f.name), f"{where}.{f.name}") for f in dataclasses.fields(value)}
        return {TYPE: f"{type(value).__module__}:{type(value).__qualname__}", **fields}
    raise ConfigError(f"`{where}` cannot be written as JSON: {value!r}")


def _rebuilt(value: Any) -> Any:
    if isinstance(value, list):
        return [_rebuilt(x) for x in value]
    if not isinstance(value, dict):
        return value
    if TUPLE in value:
        return tuple(_rebuilt(x) for x in value[TUPLE])
    fields = {name: _rebuilt(x) for name, x in value.items() if name != TYPE}
    if TYPE not in value:
        return fields
    made = _dataclass(value[TYPE])(**fields)
    if isinstance(made, Trusting):
        made.check_trusted()
    return made


def _dataclass(name: str) -> type:
    module, _, qualname = name.partition(":")
    if module.split(".")[0] != PACKAGE and module not in sys.modules:  # a file must not choose what is run
        hint = f"If you trust it, import {module} first."
        raise ConfigError(f"`{name}` is of a module that has not been imported", hint=hint)
    try:
        found: Any = importlib.import_module(module)
        for part in qualname.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"`{name}` cannot be imported: {error}") from error
    if not (isinstance(found, type) and dataclasses.is_dataclass(found)):
        raise ConfigError(f"`{name}` is no dataclass")
    return found
