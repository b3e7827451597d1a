"""Typed, located errors: what was expected, what came, where, and what to do."""

import difflib
import math
import numbers
from collections.abc import Iterable
from pathlib import Path

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
        return f"{text}. {self.hint}" if self.hint else text

    def __reduce__(self) -> tuple:
        # Keyword-only arguments do not survive the default pickling, which worker processes need.
        return (_rebuild, (type(self), self.message, self.file, self.element, self.hint))


def _rebuild(
    cls: type[HomeMjxError], message: str, file: str | None, element: str | None, hint: str | None
) -> HomeMjxError:
    return cls(message, file=file, element=element, hint=hint)


class DatasetError(HomeMjxError):
    """A dataset folder or a file in it is missing, broken or out of its format."""


class ConfigError(HomeMjxError):
    """An option is unknown or has a value that cannot be used."""


class CapacityError(HomeMjxError):
    """Something does not fit the fixed capacity that was asked for."""


class ExecutorError(HomeMjxError):
    """A ray-cast executor cannot run here."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A hint that names the closest known name, and all of them or the first twenty.

    Example:
        >>> did_you_mean("deptth", ["rgb", "depth"])
        'Did you mean `depth`? Known: depth, rgb'
    """
    known = sorted(set(known))
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


def check_known(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raises `ConfigError` for the first of `names` that is not in `known`."""
    known = list(known)
    for name in names:
        if name not in known:
            raise ConfigError(f"unknown {kind} `{name}`", hint=did_you_mean(name, known))


def check_names(kind: str, names: object, known: Iterable[str]) -> None:
    """Raises `ConfigError` unless `names` is a sequence of known names; one bare string is not."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise ConfigError(f"expected several names of a {kind}, got `{names}`", hint=f'Write ("{names}",)')
    check_known(kind, [str(name) for name in names], known)


def check_flag(name: str, value: object) -> None:
    """Raises `ConfigError` unless an option is True or False."""
    if not isinstance(value, bool):
        raise ConfigError(f"`{name}` must be True or False, got {value!r}")


def check_type(name: str, value: object, kind: type) -> None:
    """Raises `ConfigError` unless an option is of a class."""
    if not isinstance(value, kind):
        raise ConfigError(f"`{name}` must be of type {kind.__name__}, got {value!r}")


def check_number(
    name: str, value: object, least: float = -math.inf, most: float = math.inf, *, whole: bool = False
) -> None:
    """Raises `ConfigError` unless an option is a finite number within limits.

    Args:
        name: Of the option, for the message.
        value: Of the option.
        least: The least value that is allowed.
        most: The greatest value that is allowed.
        whole: It must be an integer.

    Example:
        >>> check_number("width", 64, 1, whole=True)
        >>> check_number("width", 3.5, 1, whole=True)
        Traceback (most recent call last):
        ...
        home_mjx.errors.ConfigError: `width` must be a whole number of at least 1, got 3.5
    """
    kind = numbers.Integral if whole else numbers.Real
    if (
        isinstance(value, kind)
        and not isinstance(value, bool)
        and math.isfinite(value)
        and least <= float(value) <= most
    ):
        return
    above = f" of at least {least:g}" if math.isfinite(least) else ""
    below = f"{' and' if above else ' of'} at most {most:g}" if math.isfinite(most) else ""
    raise ConfigError(f"`{name}` must be a {'whole ' if whole else 'finite '}number{above}{below}, got {value!r}")
