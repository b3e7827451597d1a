"""Progress in words on stderr, while houses are made and programs compile.

It is shown by the commands of `home-mjx`, in a terminal and at an interactive prompt (IPython and notebooks as well).
Scripts whose stderr is a file or a pipe, and tests under pytest, are silent. An argument `progress=` of True or False,
or the environment variable `HOME_MJX_PROGRESS` of 1 or 0, overrides this.
"""

import os
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import TracebackType
from typing import TypeVar

from tqdm import tqdm

from home_mjx.errors import ConfigError

PROGRESS_VARIABLE = "HOME_MJX_PROGRESS"
PYTEST_VARIABLE = "PYTEST_VERSION"  # set by pytest, also for the processes that tests start
DELAY = 0.5  # [s], before a count appears; what takes less is not shown
LINE_INTERVAL = 5.0  # [s], between two lines of a count where stderr is not a terminal
T = TypeVar("T")

_is_command = False
_is_silent: ContextVar[bool] = ContextVar("home_mjx_is_silent", default=False)


@contextmanager
def command_progress() -> Iterator[None]:
    """Show progress within the block, also without a terminal, as commands do; `HOME_MJX_PROGRESS=0` hides it."""
    global _is_command
    before, _is_command = _is_command, True
    try:
        yield
    finally:
        _is_command = before


def is_progress_shown(progress: bool | None = None) -> bool:
    """Return whether progress is shown: the caller's choice, else that of `HOME_MJX_PROGRESS`, else by a rule.

    It is then shown in commands of `home-mjx`, at interactive prompts and on terminals, but not under pytest.

    Raises:
        ConfigError: The environment variable `HOME_MJX_PROGRESS` is neither 0 nor 1.

    Example:
        >>> is_progress_shown(True), is_progress_shown(False)
        (True, False)
    """
    if progress is not None:
        return progress
    chosen = os.environ.get(PROGRESS_VARIABLE, "")
    if chosen not in ("", "0", "1"):
        raise ConfigError(f"{PROGRESS_VARIABLE} must be 0 or 1, got `{chosen:.100}`", hint="Unset it for the default.")
    if chosen:
        return chosen == "1"
    if PYTEST_VARIABLE in os.environ or sys.stderr is None:
        return False
    return _is_command or hasattr(sys, "ps1") or sys.stderr.isatty()


def say(text: str, progress: bool | None = None) -> bool:
    """Write a line to stderr, above any progress bar, if progress is shown; return whether it was written.

    Nothing is written within `silence`.

    Args:
        text: Task that begins, and how long it takes if that is long, such as "compiling reset (once)".
        progress: As for `is_progress_shown`.
    """
    if _is_silent.get() or not is_progress_shown(progress):
        return False
    tqdm.write(f"home_mjx: {text}", file=sys.stderr)
    sys.stderr.flush()
    return True


@contextmanager
def silence() -> Iterator[None]:
    """Hide `say` and new `ProgressCount`s within the block, even with `progress=True`."""
    token = _is_silent.set(True)
    try:
        yield
    finally:
        _is_silent.reset(token)


class ProgressCount:
    """Count of finished items: a bar in a terminal, lines such as "compiling 8 houses 3/8" elsewhere.

    Args:
        text: What is done to the items.
        total: Number of items; None: unknown.
        unit: Name of an item.
        progress: As for `is_progress_shown`.

    Example:
        >>> with ProgressCount("compiling 2 houses", 2, "house", progress=False) as count:
        ...     count.update()
    """

    def __init__(self, text: str, total: int | None, unit: str, progress: bool | None = None) -> None:
        self.text, self.total, self.unit, self.done = text, total, unit, 0
        self.is_shown = is_progress_shown(progress) and not _is_silent.get()
        self._bar: tqdm | None = None
        self._next_line = time.monotonic() + DELAY

    def __enter__(self) -> "ProgressCount":
        if self.is_shown and sys.stderr.isatty():
            self._bar = tqdm(total=self.total, desc=self.text, unit=self.unit, delay=DELAY)
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()

    def describe(self, text: str) -> None:
        """Replace the text and, if progress is shown, show it at once; do nothing if it is unchanged."""
        if text == self.text:
            return
        self.text = text
        if self._bar is not None:
            self._bar.delay = 0
            self._bar.set_description(text)
        elif self.is_shown:
            self._write_line()

    def update(self) -> None:
        """Count one more item, and show the count if that is due."""
        self.done += 1
        if self._bar is not None:
            self._bar.update()
        elif self.is_shown and time.monotonic() >= self._next_line:
            self._write_line()

    def _write_line(self) -> None:
        """Write text and count to stderr, such as "compiling 8 houses 3/8"."""
        self._next_line = time.monotonic() + LINE_INTERVAL
        say(f"{self.text} {self.done}" + ("" if self.total is None else f"/{self.total}"), progress=True)


def plural(count: int, noun: str) -> str:
    """Return a number and its noun, with an "s" unless the number is 1.

    Example:
        >>> plural(1, "house"), plural(8, "house")
        ('1 house', '8 houses')
    """
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def track(
    items: Iterable[T], text: str, unit: str, progress: bool | None = None, total: int | None = None
) -> Iterator[T]:
    """Yield items and show the number of those finished; an item is finished when the caller asks for the next.

    Args:
        items: The items.
        text: Work on the items, such as "reading".
        unit: Name of an item.
        progress: As for `is_progress_shown`.
        total: Number of items; None: the length of `items` if it has one.

    Example:
        >>> list(track("ab", "reading", "letter", progress=False))
        ['a', 'b']
    """
    known = len(items) if total is None and hasattr(items, "__len__") else total  # pyright: ignore[reportArgumentType]
    with ProgressCount(text, known, unit, progress) as count:
        for item in items:
            yield item
            count.update()
