"""Progress of a run: elapsed time, means of metrics, and a progress bar."""

import time
from typing import Any

from tqdm import tqdm


class RunClock:
    """Time of a run, without compilation."""

    def __init__(self, last: dict[str, Any]) -> None:
        self.begun = time.perf_counter()
        self.seconds, self.compile_seconds = (float(last.get(name, 0.0)) for name in ("seconds", "compile_seconds"))

    def start(self, steps: int) -> None:
        """Mark the end of compilation."""
        self.steps, self.time = steps, time.perf_counter()
        self.compile_seconds += self.time - self.begun

    def elapsed(self) -> float:
        """Return the seconds since the first step of the run."""
        return self.seconds + time.perf_counter() - self.time

    def lap(self, steps: int) -> dict[str, float]:
        """Return times since the first step of the run, and the rate since the last lap."""
        now = time.perf_counter()
        rate = (steps - self.steps) / (now - self.time)
        self.seconds, self.steps, self.time = self.seconds + now - self.time, steps, now
        return {"seconds": self.seconds, "compile_seconds": self.compile_seconds, "steps_per_second": rate}


class MetricMeans:
    """Metrics of several updates; those of episodes are averaged over the episodes that ended."""

    def __init__(self) -> None:
        self.count, self.sums = 0, {}

    def add(self, metrics: dict[str, Any]) -> None:
        """Add the metrics of an update; this blocks until they are computed."""
        self.count += 1
        self.sums = {name: self.sums.get(name, 0.0) + float(x) for name, x in metrics.items()}

    def means(self) -> dict[str, float]:
        """Return the means and reset; metrics of episodes are omitted if none ended."""
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


def progress_bar(done: int, total: int, progress: bool | None) -> tqdm:
    """Return a progress bar of environment steps; `progress=None` shows it in a terminal only."""
    hidden = None if progress is None else not progress
    return tqdm(total=total, initial=done, unit=" steps", unit_scale=True, disable=hidden)
