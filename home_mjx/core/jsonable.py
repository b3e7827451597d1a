"""Conversion of option dataclasses to and from JSON."""

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
MAX_MESSAGE_LENGTH = 600  # maximum length of a message [characters]
MAX_TEXT_LENGTH = 1 << 22  # maximum length [characters]; the ids of SUNCG's 45,622 houses take 2 million
HINT = "It was written by another version of home_mjx, or edited by hand."


@runtime_checkable
class TrustChecked(Protocol):
    """Options that name code to run; `from_json` calls `check_trusted` because a file must not choose that code."""

    def check_trusted(self) -> None:
        """Raise `ConfigError` if the named code is not registered in this process."""
        ...


def to_json(value: Any) -> str:
    """Serialize a value as JSON text that preserves dataclasses and tuples; keys of mappings become text.

    Raises:
        ConfigError: A part is not None, a Python number, text, list, tuple, mapping or dataclass, or the text is too
            long for `from_json`.

    Example:
        >>> to_json((1, "a"))
        '{"__tuple__": [1, "a"]}'
    """
    text = json.dumps(_plain(value, "value"))
    _check_length(text)
    return text


def from_json(text: str, file: Path | None = None) -> Any:
    """Rebuild a value from the text of `to_json`.

    Args:
        text: Output of `to_json`.
        file: Source of the text, for error messages.

    Raises:
        ConfigError: The text is broken or too long. Or it names a type that is not a dataclass, or a module that is
            neither part of this package nor imported. Or `check_trusted` of a part raises.
    """
    try:
        _check_length(text)  # before parsing: nested lists take many times the memory of their text
        return _rebuilt(json.loads(text))
    except ConfigError as error:  # a `ConfigError` is also a `ValueError`
        message, hint = _shown(error.message), _shown(error.hint or HINT)
        raise type(error)(message, file=file or error.file, element=error.element, hint=hint) from error
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError) as error:
        raise ConfigError(f"cannot be read as options: {_shown(str(error))}", file=file, hint=HINT) from error


def _check_length(text: str) -> None:
    """Raise `ConfigError` if a text has more than `MAX_TEXT_LENGTH` characters."""
    if len(text) > MAX_TEXT_LENGTH:
        message = f"options text has {len(text)} characters, at most {MAX_TEXT_LENGTH} are read"
        raise ConfigError(message, hint="Name a dataset or a split instead of each house.")


def _shown(text: str) -> str:
    """Return text for a message: lone surrogates escaped, cut off after `MAX_MESSAGE_LENGTH` characters."""
    return text.encode(errors="backslashreplace").decode()[:MAX_MESSAGE_LENGTH]


def _plain(value: Any, where: str) -> Any:
    """Convert to JSON types, with markers for tuples and dataclasses; `ConfigError` at path `where` for other types."""
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
    """Convert parsed JSON back: markers become tuples and dataclass instances, whose `check_trusted` is called.

    Errors of `_dataclass`, of constructors and of `check_trusted` come through.
    """
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
    if isinstance(made, TrustChecked):
        made.check_trusted()
    return made


def _dataclass(name: str) -> type:
    """Import the dataclass `module:qualname`; `ConfigError` if it is none, or the module foreign and not imported."""
    module, _, qualname = name.partition(":")
    if module.split(".")[0] != PACKAGE and module not in sys.modules:  # a file must not choose the code to run
        hint = f"If you trust it, import {module} first."
        raise ConfigError(f"`{name}` belongs to a module that has not been imported", hint=hint)
    try:
        found: Any = importlib.import_module(module)
        for part in qualname.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"`{name}` cannot be imported: {error}") from error
    if not (isinstance(found, type) and dataclasses.is_dataclass(found)):
        raise ConfigError(f"`{name}` is not a dataclass")
    return found


def parse_assignments(texts: list[str]) -> dict[str, Any]:
    """Parse `NAME=VALUE` arguments; values are JSON, else text. The last value of a repeated name counts.

    Raises:
        ConfigError: An argument has no name or no `=`, or too deeply nested brackets.

    Example:
        >>> parse_assignments(["width=32", "actions=discrete"])
        {'width': 32, 'actions': 'discrete'}
    """
    return dict(_parse_assignment(text) for text in texts)


def _parse_assignment(text: str) -> tuple[str, Any]:
    """Return name and value of one `NAME=VALUE` argument; the value is JSON, or else text. See `parse_assignments`."""
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise ConfigError(f"expected NAME=VALUE, got `{text:.80}`", hint="For example width=32.")
    try:
        return name, json.loads(value)
    except RecursionError:
        message = f"`{name}` has too deeply nested brackets: `{value:.40}…`"
        raise ConfigError(message, hint="Values are JSON or text.") from None
    except ValueError:
        return name, value
