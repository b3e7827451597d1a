"""Option checks; each raises a `ConfigError` with the expected and the actual value."""

import inspect
import json
import math
import numbers
from collections.abc import Iterable
from typing import TypeGuard

from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean

INT64_BOUND = 2**63  # exclusive bound of signed 64-bit integers
MAX_VALUE_LENGTH = 200  # maximum length of a value in a message [characters]


def check_known(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raise `UnknownNameError`, a `ConfigError`, for the first of `names` not in `known`; `kind` is for the message.

    A bare string counts as its letters; `check_names` rejects it.
    """
    known = list(known)
    for name in names:
        if name not in known:
            raise UnknownNameError(f"unknown {kind} `{name}`", hint=did_you_mean(name, known))


def check_names(kind: str, names: object, known: Iterable[str]) -> None:
    """Raise `ConfigError` unless `names` is an iterable of names in `known`, maybe empty; a bare string is rejected."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise ConfigError(f"expected several names of a {kind}, got {shorten(names)}", hint=names_hint(names))
    check_known(kind, [str(name) for name in names], known)


def names_hint(text: object) -> str:
    """Return a hint that shows names, given as one text with or without commas, as a tuple and as a JSON list.

    Brackets and quotes in the text are left out: shells remove quotes within `[depth]`.

    Example:
        >>> names_hint("depth, rgb")
        'Write ("depth", "rgb"); on the command line NAME=["depth", "rgb"], in quotes.'
    """
    names = [name.strip("[](){}'\" ") for name in str(text)[:MAX_VALUE_LENGTH].split(",")]
    names = [name for name in names if name] or ["..."]
    return f"Write ({json.dumps(names)[1:-1]}{',' * (len(names) == 1)}); " + (
        f"on the command line NAME={json.dumps(names)}, in quotes."
    )


def check_flag(name: str, value: object) -> None:
    """Raise `ConfigError` unless an option is True or False; 0, 1 and NumPy's booleans are rejected."""
    if not isinstance(value, bool):
        raise ConfigError(f"`{name}` must be True or False, got {value!r}")


def check_type(name: str, value: object, kind: type) -> None:
    """Raise `ConfigError` unless an option is an instance of `kind`."""
    if not isinstance(value, kind):
        raise ConfigError(f"`{name}` must be of type {kind.__name__}, got {shorten(value)}")


def check_frozen_dataclass(role: str, cls: type) -> None:
    """Raise `ConfigError` unless a class whose fields are options is a frozen dataclass.

    A subclass that adds fields needs the decorator as well. `role` names the class in the message.
    """
    params = getattr(cls, "__dataclass_params__", None)
    lost = inspect.get_annotations(cls) if "__dataclass_params__" not in vars(cls) else {}
    if params is None or not params.frozen or lost:
        hint = "Write @dataclasses.dataclass(frozen=True) above the class."
        raise ConfigError(f"the {role} {cls.__name__} is not a frozen dataclass", hint=hint)


def check_number(
    name: str, value: object, minimum: float = -math.inf, maximum: float = math.inf, *, integer: bool = False
) -> None:
    """Raise `ConfigError` unless an option is a finite number, not a boolean, in minimum..maximum (inclusive).

    With `integer`, it must be an integer within 64 bits; 3.0 is rejected. `name` is for the message.

    Example:
        >>> check_number("width", 64, 1, integer=True)
        >>> check_number("width", 3.5, 1, integer=True)
        Traceback (most recent call last):
        ...
        home_mjx.errors.ConfigError: `width` must be a whole number of at least 1, got 3.5
    """
    if _is_number(value, integer) and minimum <= float(value) <= maximum:
        return
    above = f" of at least {minimum:g}" if math.isfinite(minimum) else ""
    below = f"{' and' if above else ' of'} at most {maximum:g}" if math.isfinite(maximum) else ""
    kind = "whole" if integer else "finite"
    raise ConfigError(f"`{name}` must be a {kind} number{above}{below}, got {shorten(value)}")


def _is_number(value: object, whole: bool) -> TypeGuard[float]:
    """Return whether a value is a finite number, not a boolean; if `whole`, an integer within 64 bits, not 3.0."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral if whole else numbers.Real):
        return False
    try:
        finite = math.isfinite(value)
    except OverflowError:
        return False
    if isinstance(value, numbers.Integral) and whole:
        return abs(int(value)) < INT64_BOUND
    return finite


def shorten(value: object) -> str:
    """Return a value's `repr`; only its first 40 characters and its length if it exceeds `MAX_VALUE_LENGTH` characters.

    Integers that Python refuses to format yield a fixed phrase.

    Example:
        >>> shorten(10**400)
        '1000000000000000000000000000000000000000… (401 characters)'
    """
    try:
        text = repr(value)
    except ValueError:  # Python refuses to format integers with thousands of digits
        return "a number of thousands of digits"
    return text if len(text) <= MAX_VALUE_LENGTH else f"{text[:40]}… ({len(text)} characters)"


def check_shape(name: str, shape: tuple[int, ...], expected: tuple[int, ...]) -> None:
    """Raise `ConfigError` unless `shape`, that of an array of one environment, equals `expected`.

    Example:
        >>> check_shape("x", (64, 3), (3,))
        Traceback (most recent call last):
        ...
        home_mjx.errors.ConfigError: `x` must have the shape (3,), got (64, 3). For many environments use `jax.vmap`.
    """
    if tuple(shape) != expected:
        message = f"`{name}` must have the shape {expected}, got {tuple(shape)}"
        raise ConfigError(message, hint="For many environments use `jax.vmap`.")
