"""Session of recorded episodes: the step that is shown, and playback in real time."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.viewer.episodes.command_loop import CommandLoop
from home_mjx.viewer.replay.recorder import REWARD
from home_mjx.viewer.replay.track import Event, Replay, Track, blank_state, check_houses, fill_state

MAX_LAG = 0.25  # [s], delay of steps that is caught up


class ReplaySession(CommandLoop):
    """Recorded episodes, one step of which is shown.

    Args:
        env: The environment of the episodes.
        replay: The episodes; at least one.
        observer: Observer of the shown steps; indices of successive steps may jump.
        on_error: Callback with the message of a command that failed.

    Attributes:
        number: Number of the shown episode, from 0.
        index: Number of the shown step; 0 is the reset.

    Raises:
        ConfigError: The environment has other houses.
        DatasetError: The replay is of another environment.
    """

    def __init__(
        self,
        env: Env[HouseholdEnv],
        replay: Replay,
        observer: Observer,
        on_error: Callable[[str], None] = lambda text: None,
    ) -> None:
        super().__init__(on_error)
        check_houses(replay, env.bank.house_ids)
        self.env, self.replay, self.observer = env, replay, observer
        self._blank, self.number, self.index = blank_state(env), 0, 0
        observer.on_run_start(RunStart(replay.agent, env, "episodes", len(replay.tracks)))
        self.choose(0)

    @property
    def track(self) -> Track:
        """The shown episode."""
        return self.replay.tracks[self.number]

    def choose(self, number: int) -> None:
        """Show the first step of an episode."""
        self.number = number
        self.observer.on_episode_start(episode_start(self.track, number))
        self.show(0)

    def show(self, index: int) -> None:
        """Show a step of the episode; indices beyond its ends are clipped."""
        self.index = index = int(np.clip(index, 0, self.track.num_steps))
        self.observer.on_episode_step(episode_step(self.track, index, self._blank))
        self.due = max(self.due, time.perf_counter() - MAX_LAG) + self.env.dt / self.speed

    def turn(self) -> None:
        """Show the next step; pause after the last one."""
        if self.index < self.track.num_steps:
            self.show(self.index + 1)
        else:
            self.is_paused = True

    def find_failure(self, direction: int) -> int | None:
        """Return the number of the next failed episode, or of the one before for direction -1; None if none is left."""
        numbers = range(self.number + direction, len(self.replay.tracks) if direction > 0 else -1, direction)
        return next((n for n in numbers if self.replay.tracks[n].is_failure), None)

    def find_event(self, direction: int, kinds: tuple[str, ...]) -> Event | None:
        """Return the next event of some kinds after the shown step, or the last one before it for direction -1."""
        found = [e for e in self.track.events if e.kind in kinds and (e.step - self.index) * direction > 0]
        return (found[0] if direction > 0 else found[-1]) if found else None

    def go(self, find: Callable[[], Any]) -> None:
        """Show the episode or event that `find` returns; nothing happens for None."""
        target = find()
        if isinstance(target, Event):
            self.show(target.step)
        elif target is not None:
            self.choose(target)


def episode_start(track: Track, number: int) -> EpisodeStart:
    """Return the start of a recorded episode, the `number`th from 0 on."""
    notes = track.notes
    house, task, instruction = (str(notes[name]) for name in ("house", "task", "instruction"))
    return EpisodeStart(number + 1, None, house, task, instruction, float("nan"))


def episode_step(track: Track, index: int, blank: State) -> EpisodeStep:
    """Return a step of a recorded episode; `blank` has what its states do not keep, and index 0 is the reset.

    Raises:
        DatasetError: The episode is of another environment.
    """
    action = track.actions[index - 1] if index else None
    total = float(track.series[REWARD][1 : index + 1].sum())
    return EpisodeStep(index, fill_state(blank, track.at(index)), action, total)


def episode_result(track: Track, number: int) -> EpisodeResult:
    """Return the result of a recorded episode, the `number`th from 0 on."""
    notes = track.notes
    return EpisodeResult(
        number=number + 1,
        task=str(notes["task"]),
        instruction=str(notes["instruction"]),
        house=str(notes["house"]),
        success=float(notes.get("success", 0.0)),
        spl=float(notes.get("spl", np.nan)),
        steps=track.num_steps,
        episode_return=float(track.series[REWARD][1:].sum()),
        metrics={name: float(values[-1]) for name, values in track.series.items() if name != REWARD},
    )
