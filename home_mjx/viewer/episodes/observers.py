"""Observers of episodes: film, terminal, and files of results."""

import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from home_mjx.core.files import write_json_lines
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart, register_observer
from home_mjx.tasks.sensors.selection import state_owners
from home_mjx.viewer.episodes.camera import CameraShot, FilmCamera, scene_without_agents
from home_mjx.viewer.episodes.episode import format_status
from home_mjx.viewer.episodes.goal_markers import get_goal_markers, get_utterances
from home_mjx.viewer.episodes.keyboard import image_to_text, key_help
from home_mjx.viewer.episodes.overlay import TopDownOverlay
from home_mjx.viewer.episodes.video import VideoWriter, compose_frame

SOUND_STATE = "audio"  # sensor state with the sound frame, for observations as waveforms or spectra
DEFAULT_WIDTH, DEFAULT_HEIGHT = 480, 360  # [px] size of the agent's view
CLEAR = "\x1b[H\x1b[J"  # moves a terminal's cursor home and clears what is below


class ShotCache:
    """Views of the first agent, rendered at most once per step and only if an observer asks for them.

    Args:
        width: Width of the view [px].
        height: Height of the view [px].
        samples: Rays per pixel.
    """

    def __init__(self, width: int = DEFAULT_WIDTH, height: int = DEFAULT_HEIGHT, samples: int = 1) -> None:
        self.size = width, height, samples
        self._camera: FilmCamera | None = None
        self._last: tuple[EpisodeStep, CameraShot] | None = None

    def get(self, env: Env[HouseholdEnv], step: EpisodeStep) -> CameraShot:
        """Return view and positions of a step; render them unless the last call was for this very step."""
        if self._camera is None or self._camera.env is not env:
            self._camera = FilmCamera(env, *self.size)
        if self._last is None or self._last[0] is not step:
            self._last = step, self._camera.capture(step.state)
        return self._last[1]


class FilmObserver(Observer):
    """Film of the episodes with their sound, and an image with the last frame of each.

    Args:
        shots: Views of the first agent.
        name: Name of the files.

    Example:
        >>> run_play(options, observers=[FilmObserver(ShotCache(), "film")])  # doctest: +SKIP
    """

    def __init__(self, shots: ShotCache, name: str) -> None:
        self.shots, self.name = shots, name

    def on_run_start(self, start: RunStart) -> None:
        """Create the video writer, with sound if the environment has the sensor `audio` or spectra of it."""
        assert start.env is not None
        self.env, self.agent = start.env, start.name
        self.has_sound = SOUND_STATE in {sensor.name for sensor in state_owners(self.env.core.sensors)}
        self.video = VideoWriter(self.env.dt, self.env.config.audio.sample_rate if self.has_sound else None)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Store the instruction; drop the views and utterances of the previous episode."""
        self.instruction, self.sights = start.instruction, []
        self.words: dict[str, None] = {}  # utterances, each once, in their order

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Add a frame, the agent's view beside the plan, and the sound of the step."""
        is_first, state = step.index == 0, step.state
        if is_first:
            self.plan = TopDownOverlay(self.env.bank, int(state.world.house))
        self.words |= dict.fromkeys(get_utterances(state))
        self.sights.append(self.shots.get(self.env, step))
        if is_first or not state.terminated:  # no goal is left in a terminal state
            self.goals = get_goal_markers(self.env.bank, state, self.sights[-1].boxes)
        is_changed = is_first or self.env.config.hands
        scene = scene_without_agents(self.env, state) if is_changed else None
        self.top = self.plan.draw(scene, self.sights, self.goals)
        self.video.add(self._frame(format_status(self.env, step, self.agent)), self._sound(step))

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Add the last frame again, held for 1.5 s, with the result below."""
        spl = "" if np.isnan(result.spl) else f"   SPL {result.spl:.2f}"
        how = "success" if result.success else "failure"
        words = f"   said {', '.join(self.words)}" if self.words else ""
        text = f"{self.agent}   {how}{spl}   {result.steps} steps   return {result.episode_return:+.2f}{words}"
        self.video.add_final(self._frame(text, result.success > 0))

    def write(self, folder: Path) -> None:
        """Write `<self.name>.mp4`, the film, and `<self.name>.png`, the last frames."""
        self.video.write(folder, self.name)

    def _frame(self, status: str, success: bool | None = None) -> np.ndarray:
        """Compose the current frame of the film."""
        return compose_frame(self.sights[-1].view, self.top, self.instruction, status, success)

    def _sound(self, step: EpisodeStep) -> np.ndarray | None:
        """Return the first agent's sound of a step, (2, n); None without sound."""
        return np.asarray(step.state.world.sensor_states[SOUND_STATE].frame)[0] if self.has_sound else None


class TerminalObserver(Observer):
    """Text of each step: the instruction and the status, below the first agent's view in a terminal.

    Args:
        shots: Views of the first agent; None: its own.
        has_keys: The reader acts by keys: print their bindings at the start of each episode, and `you` as the name.
        stream: Output stream; None: standard output. The view is printed only if it is a terminal.
    """

    def __init__(self, shots: ShotCache | None = None, has_keys: bool = False, stream: TextIO | None = None) -> None:
        self.shots, self.has_keys = shots or ShotCache(), has_keys
        self.stream = stream or sys.stdout

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment, whose state is printed, and the agent's name."""
        assert start.env is not None
        self.env, self.name = start.env, "you" if self.has_keys else start.name

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Store the instruction."""
        self.instruction = start.instruction

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Print view (in a terminal), keys (once, with `has_keys`), instruction, status; nothing in a final state."""
        if step.state.done:
            return
        in_terminal = self.stream.isatty()
        lines = [image_to_text(self.shots.get(self.env, step).view)] if in_terminal else []
        if self.has_keys and step.index == 0:
            lines += [key_help(self.env.config)]
        lines += [self.instruction, format_status(self.env, step, self.name)]
        self.stream.write((CLEAR if in_terminal else "") + "\n".join(lines) + "\n")
        self.stream.flush()


class ResultsObserver(Observer):
    """Results of the episodes, as lines of text while they end and as a file of JSON lines.

    Args:
        name: Name of the file.
        print_line: Callback for the line of each episode.
    """

    def __init__(self, name: str, print_line: Callable[[str], Any]) -> None:
        self.name, self.print_line = name, print_line
        self.results: list[EpisodeResult] = []

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Store the result and pass its line to `print_line`."""
        self.results.append(result)
        self.print_line(result.format_line())

    def write(self, folder: Path) -> None:
        """Write `<self.name>.jsonl`, one result per line."""
        write_json_lines(folder / f"{self.name}.jsonl", map(dataclasses.asdict, self.results), "outcomes")


register_observer("terminal", TerminalObserver)
