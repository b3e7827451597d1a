"""Bars in a terminal, and a clock that redraws them."""

import threading
from collections.abc import Callable
from typing import Any

from tqdm import tqdm

TICK = 1.0  # [s], between two redraws of the elapsed time
MIN_RATE_SECONDS = 3.0  # [s], minimum time of a measured rate
MIN_RATE_UPDATES = 2  # minimum number of updates of a measured rate


class Ticker:
    """Thread that calls a function every `TICK` seconds until `stop`; a daemon, which never delays the process's end.

    Args:
        tick: The function.
    """

    def __init__(self, tick: Callable[[], Any]) -> None:
        self._tick, self._stopped = tick, threading.Event()
        threading.Thread(target=self._run, name="home_mjx progress", daemon=True).start()

    def stop(self) -> None:
        """Stop the calls; one that is running may end after this."""
        self._stopped.set()

    def _run(self) -> None:
        while not self._stopped.wait(TICK):
            self._tick()


class TickingBar(tqdm):
    """Bar of `tqdm` whose elapsed time advances every second, and which predicts nothing from compilation.

    The first update often includes compilation. Rate and remaining time are those since the first update, and are
    shown from `MIN_RATE_UPDATES` later updates and `MIN_RATE_SECONDS` on.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        self._num_updates, self._first = 0, (0.0, 0.0)  # of the first update: its count and its time [s]
        self._ticker: Ticker | None = None
        super().__init__(*args, **options)
        if not self.disable:
            self._ticker = Ticker(self._redraw)

    @property
    def format_dict(self) -> dict[str, Any]:
        """Fields for tqdm's format, with our rate and the format that fits it."""
        fields, count = dict(super().format_dict), "{n_fmt}" if self.total is None else "{n_fmt}/{total_fmt}"
        fields["rate"] = rate = self._rate()
        bar = "{desc}: " if self.total is None else "{desc}: {percentage:3.0f}%|{bar}| "
        left = "" if rate is None else ", {rate_fmt}" if self.total is None else "<{remaining}, {rate_fmt}"
        fields["bar_format"] = self.bar_format or bar + count + " [{elapsed}" + left + "{postfix}]"
        return fields

    def update(self, n: float | None = 1) -> bool | None:
        """Advance by `n` units, as tqdm does; the rate is measured from the first call on."""
        shown = super().update(n)
        self._num_updates += 1
        if self._num_updates == 1:
            self._first = float(self.n), self._now()
        return shown

    def close(self) -> None:
        """Stop the clock and close the bar."""
        if self._ticker is not None:
            self._ticker.stop()
        super().close()

    def _now(self) -> float:
        """Return tqdm's time [s]."""
        return self._time()  # pyright: ignore[reportAttributeAccessIssue]

    def _rate(self) -> float | None:
        """Return the number of units per second since the first update; None if it is not known yet."""
        count, begun = self._first
        seconds = self._now() - begun if self._num_updates > MIN_RATE_UPDATES else 0.0
        return (self.n - count) / seconds if seconds >= MIN_RATE_SECONDS else None

    def _redraw(self) -> None:
        """Draw the bar, also one whose delay is over and which has no update yet."""
        with self.get_lock():
            if not self.disable:  # it is closed meanwhile
                self.delay = 0
                self.refresh(nolock=True)
