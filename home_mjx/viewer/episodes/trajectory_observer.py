"""Observer that records episodes as a data set of trajectories, such as those of a person who drives."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import numpy as np

from home_mjx.core.progress import say
from home_mjx.errors import HomeMjxError
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.tasks.experts.expert_observation import EXPERT, ExpertObservationEnv
from home_mjx.training.trajectories import TrajectoryWriter
from home_mjx.training.trajectories.minari_format import RESET_KEY, ROW

EDITED, LEFT = "edited", "left_early"  # notes of episodes that a person changed by a click, or ended


class TrajectoryObserver(Observer):
    """Recorder of episodes in the format of `home-mjx record`, in a folder for each environment and agent.

    A data set that is there already is continued. An episode that is left before its end is truncated at its last step,
    and has the note `left_early`. One whose state a person has changed, such as by a click on a door, has the note
    `edited`. Episodes that are joined after their first step are not recorded.

    Args:
        folder: Folder of the data sets, which are named `<environment id>_<agent>`.
        print_line: Callback for lines of text: errors of later environments, and what was recorded.

    Attributes:
        path: Folder of the current data set.

    Raises:
        ConfigError: The folder has a data set of other observations or actions; raised at the first run's start.

    Example:
        >>> env.view(observers=(TrajectoryObserver("demonstrations"),))  # doctest: +SKIP
    """

    def __init__(self, folder: str | Path, print_line: Callable[[str], Any] = say) -> None:
        self._folder, self._print = Path(folder), print_line
        self._open, self._writer, self._has_run = contextlib.ExitStack(), None, False
        self._rows: list[dict[str, Any]] = []

    def on_run_start(self, start: RunStart) -> None:
        """Open the data set of an environment and its agent, after that of the one before is closed."""
        try:
            self.close()
        except HomeMjxError as error:
            self._print(f"not all episodes are recorded: {error}")
        env, is_first, self._has_run = start.env, not self._has_run, True
        assert env is not None
        name = env.spec.id if env.spec is not None else type(env.task).__name__
        self._omit = (EXPERT,) if isinstance(env.core, ExpertObservationEnv) else ()
        self.path = self._folder / f"{name}_{start.name}"
        try:
            writer = TrajectoryWriter(self.path, env, start.name, self._omit, resume=True)
            self._writer = self._open.enter_context(writer)
        except HomeMjxError as error:
            if is_first:
                raise
            self._print(f"nothing is recorded: {error}")

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Begin an episode, after the one before is written."""
        self._finish()
        row = -1 if start.row is None else start.row
        own = {"task": start.task, "instruction": start.instruction, "house": start.house}
        self._notes = {**own, RESET_KEY: np.asarray(start.key).tolist(), ROW: row}

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Keep a step; one that repeats the last index shows a change by a person."""
        if step.index == len(self._rows):
            self._rows.append(self._read(step))
        elif self._rows:
            self._notes[EDITED] = True

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Write the episode."""
        self._finish()

    def close(self) -> None:
        """Write the current episode, and close the data set; raise `HomeMjxError` if not all could be written."""
        self._finish()
        writer, self._writer = self._writer, None
        self._open.close()
        if writer is not None:
            self._print(f"{writer.episodes} episodes, {writer.steps} steps in {self.path}")

    def _read(self, step: EpisodeStep) -> dict[str, Any]:
        """Return what a data set has of a step, as NumPy arrays."""
        state = step.state
        own = {"observations": state.obs, "rewards": state.reward, "metrics": state.metrics}
        flags = {"terminations": state.terminated, "truncations": state.truncated, "actions": step.action}
        return jax.device_get({**own, **flags})

    def _finish(self) -> None:
        """Write the episode, if it has a step."""
        rows, self._rows = self._rows, []
        if self._writer is None or len(rows) < 2:
            return
        last = rows[-1]
        if not (last["terminations"] or last["truncations"]):
            last["truncations"], self._notes[LEFT] = np.ones_like(last["truncations"]), True
        metrics = {name: float(value) for name, value in last["metrics"].items()}
        self._writer.add(pack_rows(rows, self._omit), {**self._notes, **metrics})


def pack_rows(rows: list[dict[str, Any]], omit: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return steps, of which the first is the reset, as `TrajectoryWriter.add` needs them; rewards are means of agents.

    Args:
        rows: Steps as of `TrajectoryObserver`.
        omit: Names of observations to omit.
    """
    seen = [name for name in rows[0]["observations"] if name not in omit]
    taken = {name: np.stack([row[name] for row in rows[1:]]) for name in ("actions", "terminations", "truncations")}
    return {
        "observations": {name: np.stack([row["observations"][name] for row in rows]) for name in seen},
        "rewards": np.array([np.mean(row["rewards"]) for row in rows[1:]]),
        **taken,
    }
