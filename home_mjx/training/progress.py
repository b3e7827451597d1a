"""Progress of a run: elapsed time, means of metrics, and a progress bar."""

import time
from collections.abc import Mapping
from typing import Any

from tqdm import tqdm

from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart

PROGRESS_METRICS = ("success", "return")  # metrics beside the progress bar
MIN_SCALED_TOTAL = 1000  # totals from here are shown as 1.5k


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
    """Progress bar of a run, with the step of an episode or the latest metrics beside it.

    Args:
        is_shown: Show the bar; None: in a terminal only.
    """

    def __init__(self, is_shown: bool | None = None) -> None:
        self.is_hidden = None if is_shown is None else not is_shown
        self.bar: tqdm | None = None

    def on_run_start(self, start: RunStart) -> None:
        """Show the bar, from `start.done` to `start.total`."""
        scaled = start.total >= MIN_SCALED_TOTAL
        self.bar = tqdm(
            total=start.total, initial=start.done, unit=f" {start.unit}", unit_scale=scaled, disable=self.is_hidden
        )

    def on_phase(self, name: str, note: str = "") -> None:
        """Show the name before the bar and the note after it; no effect before the start of the run."""
        if self.bar is not None:
            self.bar.set_description(name)
            self.bar.set_postfix_str(note)

    def on_update(self, count: int) -> None:
        """Advance the bar by `count` units; no effect before the start of the run."""
        if self.bar is not None:
            self.bar.update(count)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Show the number of the step in the episode after the bar; no effect before the start of the run."""
        if self.bar is not None:
            self.bar.set_postfix_str(f"step {step.index}")

    def on_log(self, line: Mapping[str, float]) -> None:
        """Show those metrics of the line that are in `PROGRESS_METRICS` after the bar, with two decimals.

        No effect before the start of the run.
        """
        if self.bar is not None:
            self.bar.set_postfix({name: f"{line[name]:.2f}" for name in PROGRESS_METRICS if name in line})

    def close(self) -> None:
        """Close the bar, if there is one, so that a message starts on a new line."""
        if self.bar is not None:
            self.bar.close()
