"""Time that a viewer may take from the job that it is attached to."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

MAX_SHARE = 0.08  # largest part of the job's time that drawing takes, below the 10 % that are promised


class DrawBudget:
    """Share of a job's time: after each drawing, none is due until its time is at most a share of all time since.

    The first drawing, which compiles, is not counted.

    Args:
        share: The share.
        clock: Function that returns the time [s].

    Example:
        >>> times = iter([0.0, 5.0, 10.0, 11.0, 15.0, 21.0])
        >>> budget = DrawBudget(0.1, lambda: next(times))
        >>> with budget.spend():  # from 0 to 5 s: the first
        ...     pass
        >>> with budget.spend():  # from 10 to 11 s
        ...     pass
        >>> budget.is_due(), budget.is_due()  # at 15 s, at 21 s
        (False, True)
    """

    def __init__(self, share: float = MAX_SHARE, clock: Callable[[], float] = time.perf_counter) -> None:
        self.share, self._clock, self._due, self._is_first = share, clock, 0.0, True

    def is_due(self) -> bool:
        """Return whether a drawing is due."""
        return self._is_first or self._clock() >= self._due

    @contextmanager
    def spend(self) -> Iterator[None]:
        """Measure the block's time, and set when the next drawing is due."""
        began = self._clock()
        yield
        end = self._clock()
        self._due = end if self._is_first else began + (end - began) / self.share
        self._is_first = False
