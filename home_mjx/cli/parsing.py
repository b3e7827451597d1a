"""Argument parser that raises our typed errors, with a hint, and argument types."""

import argparse
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean

MAX_DIGITS = 40  # maximum number of digits of a number
MAX_HOUSES = 1_000_000  # maximum number of houses of a command; SUNCG has 45,622
MAX_WORKERS = 1024  # maximum number of processes


class Parser(argparse.ArgumentParser):
    """`argparse.ArgumentParser` that raises `ConfigError` and suggests the closest option."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(allow_abbrev=False, **kwargs)
        # No option is a number, so that values such as `-3:2` and `-1e-3` are values, not unknown options.
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)
        self.add_argument("--debug", action="store_true", help="show the traceback of an error")

    def parse_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:
        """Parse arguments; None: those of this process.

        Raises:
            UnknownNameError: An option is unknown.
            ConfigError: An argument is invalid or unexpected.
        """
        parsed, extra = self.parse_known_args(args, namespace)
        if extra:
            self._refuse(extra[0])
        return parsed

    def error(self, message: str) -> NoReturn:
        """Raise `ConfigError` with `message`, and a hint at `--help`, instead of exiting the process."""
        raise ConfigError(message, hint=f"See `{self.prog} --help`")

    def _refuse(self, argument: str) -> NoReturn:
        """Raise the error for an argument that no option takes.

        It is `UnknownNameError` for a text that starts with `-`, with the closest visible long option as hint. For any
        other text it is `ConfigError`.
        """
        if not argument.startswith("-"):
            self.error(f"unexpected argument `{argument}`")
        name = argument.split("=")[0]
        shown = [action for action in self._actions if action.help != argparse.SUPPRESS]
        known = [option for action in shown for option in action.option_strings if option.startswith("--")]
        raise UnknownNameError(f"unknown option `{name}`", hint=did_you_mean(name, known))


def parse_seed_range(text: str) -> range:
    """Parse one seed, or seeds `A:B` with 0 <= A < B <= 2**63, B excluded; raise `ArgumentTypeError` otherwise.

    It is also raised for more than `MAX_HOUSES` seeds.

    Example:
        >>> list(parse_seed_range("3:6")), list(parse_seed_range("7"))
        ([3, 4, 5], [7])
    """
    first, colon, last = text.partition(":")
    try:
        start = int(first)
        stop = int(last) if colon else start + 1
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected SEED or A:B with whole numbers, got `{text}`") from None
    if not 0 <= start < stop <= 2**63:
        raise argparse.ArgumentTypeError(f"expected 0 <= A < B <= 2**63, got `{text}`")
    if stop - start > MAX_HOUSES:
        raise argparse.ArgumentTypeError(f"at most {MAX_HOUSES} houses at once, got `{text}`")
    return range(start, stop)


def parse_path(text: str) -> Path:
    """Parse a path, which may not exist; `~` is not expanded.

    A blank text, such as an unset shell variable, or one with a null byte raises `ArgumentTypeError`.
    """
    if not text.strip() or "\0" in text:
        raise argparse.ArgumentTypeError(f"expected a path, got {text!r}")
    return Path(text)


def parse_dataset(text: str) -> Path | str:
    """Parse the root of a dataset: a text `scheme:...`, such as `procedural:16?seed=0`, is returned; others as a path.

    Whether the scheme is known is not checked, nor whether the path exists. A text `scheme:...` that is an existing
    path is returned as a path, and so is `C:/houses`. In a path `~` is not expanded; a blank one, or one with a null
    byte, raises `ArgumentTypeError`, see `parse_path`.

    Example:
        >>> parse_dataset("procedural:16"), parse_dataset("houses").name
        ('procedural:16', 'houses')
    """
    from home_mjx.datasets.registry import has_scheme

    return text if has_scheme(text) else parse_path(text)


def parse_names(text: str) -> tuple[str, ...]:
    """Parse names separated by commas, without spaces around them; raise `ArgumentTypeError` if one is empty.

    Example:
        >>> parse_names("depth, goal")
        ('depth', 'goal')
    """
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"expected names separated by commas, got `{text}`")
    return names


def number_type(low: float = -1e6, high: float = 1e6) -> Callable[[str], float]:
    """Return a parser of numbers from `low` to `high`, both included; it raises `ArgumentTypeError` for other texts.

    Example:
        >>> number_type(low=0)("2.5")
        2.5
    """

    def parse(text: str) -> float:
        """Parse one number; raise `ArgumentTypeError` for NaN, a number out of range, or another text."""
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:  # rejects NaN as well
            raise argparse.ArgumentTypeError(f"expected a number from {low:g} to {high:g}, got `{text}`")
        return value

    return parse


def parse_seed(text: str) -> int:
    """Parse a seed from 0 to 2**32 - 1; raise `ArgumentTypeError` for other texts."""
    if not text.isdecimal() or len(text) > MAX_DIGITS or int(text) >= 2**32:
        raise argparse.ArgumentTypeError(f"expected a whole number from 0 to {2**32 - 1}, got `{text:.{MAX_DIGITS}}`")
    return int(text)


def parse_natural(text: str) -> int:
    """Parse a whole number from 0 to 2**31 - 1; raise `ArgumentTypeError` for other texts."""
    if not text.isdecimal() or len(text) > MAX_DIGITS or int(text) >= 2**31:
        raise argparse.ArgumentTypeError(f"expected a whole number of 0 or more, got `{text:.{MAX_DIGITS}}`")
    return int(text)


def whole_number_type(maximum: int) -> Callable[[str], int]:
    """Return a parser of whole numbers from 1 to `maximum`, included; it raises `ArgumentTypeError` for others."""

    def parse(text: str) -> int:
        """Parse decimal digits without a sign; raise `ArgumentTypeError` unless 1 <= value <= `maximum`."""
        if not text.isdecimal() or len(text) > MAX_DIGITS or not 0 < int(text) <= maximum:
            limit = f" and at most {maximum}" if text.isdecimal() and text.strip("0") else ""
            raise argparse.ArgumentTypeError(f"expected a whole number above 0{limit}, got `{text:.{MAX_DIGITS}}`")
        return int(text)

    return parse


positive_int_type = whole_number_type(2**31 - 1)
house_count_type = whole_number_type(MAX_HOUSES)
image_side_type = whole_number_type(8192)  # maximum width and height of an image
