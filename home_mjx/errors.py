"""Typed, located errors: each states the expected value, the actual value, the location and a remedy.

Each class also derives from the matching built-in class, so that generic `except` clauses catch it:

| Class | Also a |
| --- | --- |
| `DatasetError`, `ConfigError`, `CapacityError` | `ValueError` |
| `MissingFileError` | `DatasetError`, `FileNotFoundError` |
| `UnknownIdError` | `DatasetError`, `KeyError` |
| `UnknownNameError` | `ConfigError`, `KeyError` |
| `UnknownMemberError` | `UnknownNameError`, `AttributeError` |
| `OutOfRangeError` | `ConfigError`, `IndexError` |
| `BackendError` | `RuntimeError` |
"""

import difflib
import errno
from collections.abc import Iterable
from pathlib import Path
from typing import Any

MAX_LISTED = 20  # maximum names listed in a hint; a dataset may have 45,000 houses
MAX_COMPARED = 100  # maximum length of a compared name [characters]
MAX_CANDIDATES = 100_000  # maximum names compared for a suggestion


class HomeMjxError(Exception):
    """Base class of all errors that home_mjx raises deliberately.

    Args:
        message: Expected and actual value.
        file: File at fault; None if no file is involved.
        element: Path of the element inside the file, such as `levels[0].nodes[17].transform`.
        hint: Remedy for the user.

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
        # Text from files may contain lone surrogates, which no output can encode.
        return text.encode(errors="backslashreplace").decode()

    def __reduce__(self) -> tuple:
        # Keyword-only arguments do not survive the default pickling, which worker processes need.
        return (_rebuild, (type(self), self.message, self.file, self.element, self.hint))


def _rebuild(
    cls: type[HomeMjxError], message: str, file: str | None, element: str | None, hint: str | None
) -> HomeMjxError:
    """Unpickle an error."""
    return cls(message, file=file, element=element, hint=hint)


class DatasetError(HomeMjxError, ValueError):
    """Missing, broken or invalid dataset folder or file."""


class MissingFileError(DatasetError, FileNotFoundError):
    """Missing file or folder; `filename` is its path or the path of the file that refers to it.

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
    """Unknown house id in a dataset or a bank."""


class ConfigError(HomeMjxError, ValueError):
    """Unknown option, or an option value that cannot be used."""


class UnknownNameError(ConfigError, KeyError):
    """Unknown name of an environment, an option, a sensor or a command."""


class UnknownMemberError(UnknownNameError, AttributeError):
    """Unknown member of an enumeration, such as a column of `Semantic`."""


class OutOfRangeError(ConfigError, IndexError):
    """Index outside the valid range of rows."""


class CapacityError(HomeMjxError, ValueError):
    """Data that exceeds a requested fixed capacity."""


class BackendError(HomeMjxError, RuntimeError):
    """Backend or compiled program, such as of ray casts, that cannot run in this process."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a hint with the closest known name, if one is similar, and at most `MAX_LISTED` known names, sorted.

    Example:
        >>> did_you_mean("deptth", ["rgb", "depth"])
        'Did you mean `depth`? Known: depth, rgb'
    """
    known = sorted(set(known) - {""})
    if not known:
        return "No choices are available."
    # Names from a broken file may have megabytes, and the cost of comparing is the product of both lengths.
    short = [candidate for candidate in known if len(candidate) <= MAX_COMPARED]
    given, by_case = str(name)[:MAX_COMPARED], {candidate.casefold(): candidate for candidate in short}
    same = by_case.get(given.casefold())
    close = [same] if same else difflib.get_close_matches(given, short[:MAX_CANDIDATES], n=1)
    more = f", … ({len(known)} in all)" if len(known) > MAX_LISTED else ""
    listing = "Known: " + ", ".join(known[:MAX_LISTED]) + more
    return f"Did you mean `{close[0]}`? {listing}" if close else listing


def install_hint(extra: str) -> str:
    """Return the command that installs one of this project's extras from a clone.

    Example:
        >>> install_hint("exact")
        "In the clone of home_mjx: pip install '.[exact]'"
    """
    return f"In the clone of home_mjx: pip install '.[{extra}]'"
