"""Observer that records episodes state by state."""

from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.viewer.replay.events import EventLog
from home_mjx.viewer.replay.track import (
    SUFFIX,
    Leaves,
    Replay,
    Track,
    keep_leaves,
    spec_text,
    stack_leaves,
    write_replay,
)

REWARD = "reward"


class ReplayRecorder(Observer):
    """Recorder of all states of episodes, for `home-mjx view --replay`.

    Args:
        name: Name of the file, without suffix.

    Attributes:
        replay: The episodes that have ended.

    Example:
        >>> run_play(options, observers=[ReplayRecorder("walk")])  # doctest: +SKIP
    """

    def __init__(self, name: str = "episodes") -> None:
        self.name = name

    def on_run_start(self, start: RunStart) -> None:
        """Begin a replay of the run's environment."""
        assert start.env is not None
        self.log = EventLog(start.env)
        self.replay = Replay(start.name, spec_text(start.env), tuple(start.env.bank.house_ids))

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Begin an episode."""
        self.log.clear()
        self._leaves: list[Leaves] = []
        self._actions: list[Any] = []
        self._series: list[dict[str, float]] = []

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Keep the state of a step, its action, figures and events."""
        self.log.add(step)
        self._leaves.append(keep_leaves(step.state))
        if step.action is not None:
            self._actions.append(np.asarray(step.action))
        self._series.append(step_figures(step))

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Add the episode to the replay."""
        names = ("number", "house", "task", "instruction", "success", "spl", "steps", "episode_return")
        self.replay.tracks.append(
            Track(
                {name: getattr(result, name) for name in names},
                stack_leaves(self._leaves),
                np.stack(self._actions) if self._actions else np.zeros(0),
                {name: np.array([row[name] for row in self._series]) for name in self._series[0]},
                np.stack(self.log.feet),
                tuple(self.log.events),
            )
        )

    def write(self, folder: Path) -> None:
        """Write `<self.name>.replay.npz`."""
        write_replay(folder / f"{self.name}{SUFFIX}", self.replay)


def step_figures(step: EpisodeStep) -> dict[str, float]:
    """Return the first agent's reward of a step, and the task's metrics, by name."""
    own = {REWARD: float(np.reshape(step.state.reward, -1)[0])}
    return own | {name: float(value) for name, value in step.state.metrics.items()}
