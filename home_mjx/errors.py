"""Typed, located errors: what was expected, what came, where, and what to do.

Each class also derives from the built-in class that other code catches in such a case:

| Class | Also a |
| --- | --- |
| `DatasetError`, `ConfigError`, `CapacityError` | `ValueError` |
| `MissingFileError` | `DatasetError`, `FileNotFoundError` |
| `UnknownIdError` | `DatasetError`, `KeyError` |
| `UnknownNameError` | `ConfigError`, `KeyError` |
| `OutOfRangeError` | `ConfigError`, `IndexError` |
| `ExecutorError` | `RuntimeError` |
"""

import difflib
import errno
from collections.abc import Iterable
from pathlib import Path
from typing import Any

MAX_LISTED = 20  # names in a hint: a dataset may have 45,000 houses
MAX_COMPARED = 100  # characters of a name
MAX_CANDIDATES = 100_000


class HomeMjxError(Exception):
    """Base of every error that home_mjx raises on purpose.

    Args:
        message: What was expected and what came.
        file: The file at fault, if one is.
        element: Path of the element inside it, such as `levels[0].nodes[17].transform`.
        hint: What the user can do about it.

    Example:
        >>> print(DatasetError("expected 16 numbers, got 3", element="levels[0].nodes[1].transform"))
        expected 16 numbers, got 3 (at levels[0].nodes[1].transform)
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        element: str | None = None,
        hint: str | None = None,
    ) -> None:
        self.message = message
        self.file = str(file) if file is not None else None
        self.element = element
        self.hint = hint
        super().__init__(str(self))

    def __str__(self) -> str:
        where = ", ".join(w for w in (self.file and f"in {self.file}", self.element and f"at {self.element}") if w)
        text = f"{self.message} ({where})" if where else self.message
        text = f"{text}. {self.hint}" if self.hint else text
        # What a file holds may have halves of characters, which can be printed nowhere.
        return text.encode(errors="backslashreplace").decode()

    def __reduce__(self) -> tuple:
        # Keyword-only arguments do not survive the default pickling, which worker processes need.
        return (_rebuild, (type(self), self.message, self.file, self.element, self.hint))


def _rebuild(
    cls: type[HomeMjxError], message: str, file: str | None, element: str | None, hint: str | None
) -> HomeMjxError:
    return cls(message, file=file, element=element, hint=hint)


class DatasetError(HomeMjxError, ValueError):
    """A dataset folder or a file in it is missing, broken or out of its format."""


class MissingFileError(DatasetError, FileNotFoundError):
    """A file or folder is missing. `filename` is that file, or the one that refers to it.

    Example:
        >>> try:
        ...     raise MissingFileError("file is missing", file="room.obj")
        ... except FileNotFoundError as error:
        ...     print(error.filename, "|", error)
        room.obj | file is missing (in room.obj)
    """

    def __init__(self, message: str, **details: Any) -> None:
        super().__init__(message, **details)
        self.errno, self.filename = errno.ENOENT, self.file


class UnknownIdError(DatasetError, KeyError):
    """A dataset or a bank has no house of this id."""


class ConfigError(HomeMjxError, ValueError):
    """An option is unknown or has a value that cannot be used."""


class UnknownNameError(ConfigError, KeyError):
    """A name is none of the known ones: an environment, an option, a sensor, a command."""


class OutOfRangeError(ConfigError, IndexError):
    """A number is that of no row: there are fewer, or it is less than 0."""


class CapacityError(HomeMjxError, ValueError):
    """Something does not fit the fixed capacity that was asked for."""


class ExecutorError(HomeMjxError, RuntimeError):
    """A ray-cast executor cannot run here."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A hint that names the closest known name, and all of them or the first twenty.

    Example:
        >>> did_you_mean("deptth", ["rgb", "depth"])
        'Did you mean `depth`? Known: depth, rgb'
    """
    known = sorted(set(known) - {""})
    if not known:
        return "There is none to choose from."
    # names from a broken file may be megabytes long, and comparing takes the product of their lengths
    short = [candidate for candidate in known if len(candidate) <= MAX_COMPARED]
    close = difflib.get_close_matches(str(name)[:MAX_COMPARED], short[:MAX_CANDIDATES], n=1)
    more = f", … ({len(known)} in all)" if len(known) > MAX_LISTED else ""
    listing = "Known: " + ", ".join(known[:MAX_LISTED]) + more
    return f"Did you mean `{close[0]}`? {listing}" if close else listing


def install_hint(extra: str) -> str:
    """How to get the packages of one of our extras; the project is installed from a clone.

    Example:
        >>> install_hint("exact")
        "In the clone of home_mjx: pip install '.[exact]'"
    """
    return f"In the clone of home_mjx: pip install '.[{extra}]'"
