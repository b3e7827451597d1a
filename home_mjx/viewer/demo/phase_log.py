"""Phases of the demo, each with its number and its seconds."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack

from home_mjx.core.progress import ProgressCount, ProgressPhase
from home_mjx.tasks.env.observers import Observer


class PhaseLog(Observer):
    """Observer that shows each phase on a line of its own, such as "2/6 compiling [00:41]".

    There is no bar over all phases: their times depend on the machine and on its caches.

    Args:
        names: Names of all phases, in order.
        totals: Number of steps of those phases that count steps, by name.
    """

    def __init__(self, names: Sequence[str], totals: Mapping[str, int]) -> None:
        self.names, self.totals, self.stack = names, totals, ExitStack()
        self.phase: ProgressPhase | None = None

    def on_phase(self, name: str, note: str = "") -> None:
        """End the last phase and begin the one with this name."""
        self.close()
        text, total = f"{self.names.index(name) + 1}/{len(self.names)} {name}", self.totals.get(name)
        phase = ProgressPhase(text) if total is None else ProgressCount(text, total, "steps")
        self.phase = self.stack.enter_context(phase)

    def on_update(self, count: int) -> None:
        """Count steps of the current phase; no effect in phases without a number of steps."""
        if isinstance(self.phase, ProgressCount):
            self.phase.update(count)

    def close(self) -> None:
        """End the last phase."""
        self.stack.close()
