"""Phases and counts of finished items: bars in a terminal, lines elsewhere."""

import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TypeVar

from home_mjx.core.compile_cache import describe_compile
from home_mjx.core.progress.bar import Ticker, TickingBar
from home_mjx.core.progress.visibility import is_progress_shown, is_silent, say, silence

DELAY = 0.5  # [s], before a count appears; what takes less is not shown
LINE_INTERVAL = 5.0  # [s], minimum time between two lines where stderr is not a terminal
LINE_SHARE = 0.1  # of the elapsed time; minimum time between two lines of long work
MIN_SCALED_TOTAL = 1000  # totals from here are shown as 1.5k
T = TypeVar("T")


class ProgressPhase:
    """Work without a count, such as compiling: its text and its seconds, which advance every second in a terminal.

    Elsewhere a line says that the phase begins. Further lines have its seconds, at first every `LINE_INTERVAL`, later
    at intervals of `LINE_SHARE` of the elapsed time.

    Args:
        text: The work, such as "compiling reset".
        progress: As for `is_progress_shown`.

    Example:
        >>> with ProgressPhase("compiling reset", progress=False) as phase:
        ...     phase.describe("compiling step")
    """

    def __init__(self, text: str, progress: bool | None = None) -> None:
        self.text, self.note = text, ""
        self.is_shown = is_progress_shown(progress) and not is_silent()
        self._bar: TickingBar | None = None
        self._ticker: Ticker | None = None

    def __enter__(self) -> "ProgressPhase":
        self._open()
        if self._ticker is not None:
            self._write_line()
        return self

    def _open(self) -> None:
        """Show the beginning."""
        self._started = time.monotonic()
        self._next_line = self._started + DELAY
        if self.is_shown and sys.stderr.isatty():
            self._bar = self._make_bar()
        elif self.is_shown:
            self._ticker = Ticker(self._write_due_line)

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()
        if self._ticker is not None:
            self._ticker.stop()

    def describe(self, text: str) -> None:
        """Replace the text and, if progress is shown, show it at once; do nothing if it is unchanged."""
        if text == self.text:
            return
        self.text = text
        if self._bar is not None:
            self._bar.delay = 0
            self._bar.set_description_str(text)
        elif self.is_shown:
            self._write_line()

    def add_note(self, note: str) -> None:
        """Show a text after the bar, or at the end of the next line, instead of the last one."""
        self.note = note
        if self._bar is not None:
            self._bar.set_postfix_str(note)

    def _make_bar(self) -> TickingBar:
        """Return a new bar."""
        return TickingBar(desc=self.text, bar_format="{desc} [{elapsed}{postfix}]", delay=DELAY)

    def _format_count(self) -> str:
        """Return the text after `text` in a line."""
        return ""

    def _write_due_line(self) -> None:
        """Write a line if it is time for one."""
        if time.monotonic() >= self._next_line:
            self._write_line()

    def _write_line(self) -> None:
        """Write text, count, seconds (from 1 s on) and note, such as "compiling 8 houses 3/8 (12 s)"."""
        now = time.monotonic()
        seconds = now - self._started
        self._next_line = now + max(LINE_INTERVAL, LINE_SHARE * seconds)
        more = (f"{seconds:.0f} s" if seconds >= 1 else "", self.note)
        details = ", ".join(part for part in more if part)
        say(self.text + self._format_count() + (f" ({details})" if details else ""), progress=True)


class ProgressCount(ProgressPhase):
    """Count of finished items: a bar in a terminal, lines such as "compiling 8 houses 3/8" elsewhere.

    The bar shows no remaining time while the only known rate includes compilation, see `TickingBar`.

    Args:
        text: Work on the items.
        total: Number of items; None: unknown.
        unit: Name of an item.
        progress: As for `is_progress_shown`.
        done: Number of items that are finished before this.

    Example:
        >>> with ProgressCount("compiling 2 houses", 2, "house", progress=False) as count:
        ...     count.update()
    """

    def __init__(self, text: str, total: int | None, unit: str, progress: bool | None = None, done: int = 0) -> None:
        super().__init__(text, progress)
        self.total, self.unit, self.done = total, unit, done
        self._is_scaled = (total or 0) >= MIN_SCALED_TOTAL

    def __enter__(self) -> "ProgressCount":
        self._open()
        return self

    def update(self, count: int = 1) -> None:
        """Count more items, and show the count if that is due."""
        self.done += count
        if self._bar is not None:
            self._bar.update(count)
        elif self.is_shown:
            self._write_due_line()

    def _make_bar(self) -> TickingBar:
        return TickingBar(
            total=self.total,
            initial=self.done,
            desc=self.text,
            unit=f" {self.unit}",
            unit_scale=self._is_scaled,
            delay=DELAY,
        )

    def _format_count(self) -> str:
        done, total = (TickingBar.format_sizeof(x) if self._is_scaled else str(x) for x in (self.done, self.total or 0))
        return f" {done}" + ("" if self.total is None else f"/{total}")


@contextmanager
def show_compile(name: str, progress: bool | None = None) -> Iterator[None]:
    """Show that a program compiles while the block runs, which should be its first call; hide all else in the block.

    Args:
        name: Name of the program, such as "step".
        progress: As for `is_progress_shown`.
    """
    with ProgressPhase(describe_compile(name), progress), silence():
        yield


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
