"""Progress of a run: elapsed time, means of metrics, and a progress bar."""

import time
from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

from home_mjx.core.progress import ProgressCount
from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart

PROGRESS_METRICS = ("success", "return")  # metrics beside the progress bar


class RunClock:
    """Time of a run, without compilation; continues from `last`, its last line of metrics ({}: a new run).

    Compilation lasts from construction to `start`, which `elapsed` and `lap` require.
    """

    def __init__(self, last: dict[str, Any]) -> None:
        self.begun = time.perf_counter()
        self.seconds, self.compile_seconds = (float(last.get(name, 0.0)) for name in ("seconds", "compile_seconds"))

    def start(self, steps: int) -> None:
        """Mark the end of compilation; the first `lap` counts steps beyond `steps`, which are already done."""
        self.steps, self.time = steps, time.perf_counter()
        self.compile_seconds += self.time - self.begun

    def elapsed(self) -> float:
        """Return the seconds of the run without compilation, including those before it was resumed."""
        return self.seconds + time.perf_counter() - self.time

    def lap(self, steps: int) -> dict[str, float]:
        """Return times of the run without compilation [s] and the rate since the last lap [1/s]; begin a new lap."""
        now = time.perf_counter()
        rate = (steps - self.steps) / (now - self.time)
        self.seconds, self.steps, self.time = self.seconds + now - self.time, steps, now
        return {"seconds": self.seconds, "compile_seconds": self.compile_seconds, "steps_per_second": rate}


class MetricMeans:
    """Metrics of several updates; those of episodes are averaged over the episodes that ended."""

    def __init__(self) -> None:
        self.count, self.sums = 0, {}

    def add(self, metrics: dict[str, Any]) -> None:
        """Add the scalar metrics of an update; this blocks until they are computed.

        Names should be those of earlier updates: sums under other names are dropped.
        """
        self.count += 1
        self.sums = {name: self.sums.get(name, 0.0) + float(x) for name, x in metrics.items()}

    def means(self) -> dict[str, float]:
        """Return means since the last call and reset; `episode/x` becomes `x` per episode, omitted if none ended.

        `episodes` is their number. At least one update must have been added, else `KeyError`.
        """
        episodes, found = self.sums["episode/episodes"], {}
        for name, x in self.sums.items():
            if not name.startswith("episode/"):
                found[name] = x / self.count
            elif name == "episode/episodes":
                found["episodes"] = x
            elif episodes:
                found[name.removeprefix("episode/")] = x / episodes
        self.count, self.sums = 0, {}
        return found


class ProgressBar(Observer):
    """Progress of a run as a `ProgressCount`, with the step of an episode or the latest metrics beside it.

    Args:
        is_shown: Show it; None: by the rule of `home_mjx.core.progress`.
    """

    def __init__(self, is_shown: bool | None = None) -> None:
        self.is_shown, self.stack = is_shown, ExitStack()
        self.count: ProgressCount | None = None

    def on_run_start(self, start: RunStart) -> None:
        """Show the count, from `start.done` to `start.total`, with the name of the run."""
        count = ProgressCount(start.name, start.total, start.unit, self.is_shown, start.done)
        self.count = self.stack.enter_context(count)

    def on_phase(self, name: str, note: str = "") -> None:
        """Show the name before the count, with the note in brackets; no effect before the start of the run."""
        if self.count is not None:
            self.count.describe(f"{name} ({note})" if note else name)

    def on_update(self, count: int) -> None:
        """Count `count` more units; no effect before the start of the run."""
        if self.count is not None:
            self.count.update(count)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Show the number of the step in the episode after the count; no effect before the start of the run."""
        if self.count is not None:
            self.count.add_note(f"step {step.index}")

    def on_log(self, line: Mapping[str, float]) -> None:
        """Show those metrics of the line that are in `PROGRESS_METRICS` after the count, with two decimals.

        No effect before the start of the run.
        """
        if self.count is not None:
            self.count.add_note(", ".join(f"{name} {line[name]:.2f}" for name in PROGRESS_METRICS if name in line))

    def close(self) -> None:
        """Close the bar, if there is one, so that a message starts on a new line."""
        self.stack.close()
