"""Page of episodes in one HTML file: 3D scene, the agent's film with sound, and plots, without server or network."""

import base64
import contextlib
import io
import json
import re
import tempfile
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.tasks.sensors.selection import state_owners
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.scene.scene_tree import SceneObserver, SceneTree
from home_mjx.viewer.browser.serving.server import load_viser
from home_mjx.viewer.episodes.observers import SOUND_STATE, ShotCache
from home_mjx.viewer.episodes.video import VideoWriter
from home_mjx.viewer.pictures import media
from home_mjx.viewer.replay.events import EventLog
from home_mjx.viewer.replay.recorder import step_figures

if TYPE_CHECKING:
    import viser

PLOTS = ("reward", "distance", "success")  # figures that are plotted, if the task has them
VIEW_WIDTH, VIEW_HEIGHT = 320, 240  # [px], of the film
FOLDER = "episode_page"  # files of the page beside this module


class PageRecorder(Observer):
    """Recorder of episodes as one HTML file.

    The page has viser's viewer in it, which follows the time of the film.

    Args:
        name: Name of the file, without suffix.
        shots: Views of the first agent; None: its own.

    Raises:
        ConfigError: The extra `view` is not installed.

    Example:
        >>> run_play(options, observers=[PageRecorder("walk")])  # doctest: +SKIP
    """

    def __init__(self, name: str, shots: ShotCache | None = None) -> None:
        self.name, self._shots = name, shots or ShotCache(VIEW_WIDTH, VIEW_HEIGHT)
        with contextlib.redirect_stdout(io.StringIO()):  # viser prints an address that nobody needs
            self._server: viser.ViserServer = load_viser().ViserServer("127.0.0.1", 0, verbose=False)
        self._overlays = Overlays(self._server)
        self._scene = SceneObserver(SceneTree(self._server, lambda group, index: None))
        self._recording = self._server.get_scene_serializer()
        self._figures: list[dict[str, float]] = []
        self._marks: list[tuple[int, str, str]] = []

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment."""
        assert start.env is not None
        self._env, self._log = start.env, EventLog(start.env)
        self._has_sound = SOUND_STATE in {sensor.name for sensor in state_owners(self._env.core.sensors)}
        self._video = VideoWriter(self._env.dt, self._env.config.audio.sample_rate if self._has_sound else None)
        self._scene.on_run_start(start)
        self._overlays.on_run_start(start)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Clear path and events."""
        self._first, self._title = len(self._video.frames), f"{start.number}: {start.instruction}"
        self._marks.append((self._first, "start", self._title))
        self._log.clear()
        self._overlays.on_episode_start(start)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Record scene, view, sound and figures of a step."""
        self._scene.on_episode_step(step)
        self._overlays.on_episode_step(step)
        self._log.add(step)
        self._figures.append(step_figures(step))
        self._view = self._shots.get(self._env, step).view
        frame = np.asarray(step.state.world.sensor_states[SOUND_STATE].frame)[0] if self._has_sound else None
        self._video.add(self._view, frame)
        self._recording.insert_sleep(self._env.dt)

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Hold the last step."""
        self._marks += [(self._first + event.step, event.kind, event.text) for event in self._log.events]
        before = len(self._video.frames)
        self._video.add_final(self._view)
        count = len(self._video.frames) - before
        self._figures += [self._figures[-1]] * count
        self._recording.insert_sleep(count * self._env.dt)

    def write(self, folder: Path) -> None:
        """Write `<self.name>.html`."""
        page = self._recording.as_html(dark_mode=True)
        end = page.rindex("</body>")
        (folder / f"{self.name}.html").write_text(page[:end] + self._panel() + page[end:])

    def close(self) -> None:
        """Stop viser's server, which no page has used."""
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()

    def _panel(self) -> str:
        """Return the HTML of film and plots."""
        names = [name for name in PLOTS if all(name in row for row in self._figures)]
        data: dict[str, Any] = {
            "fps": self._video.fps,
            "dt": self._env.dt,
            "series": {name: [round(row[name], 4) for row in self._figures] for name in names},
            "marks": self._marks,
        }
        text = json.dumps(data).replace("<", "\\u003c")  # an instruction must not end the script
        page = (resources.files("home_mjx.viewer.replay") / FOLDER / "panel.html").read_text()
        return fill_page(page, {**self._films(), "data": text})

    def _films(self) -> dict[str, str]:
        """Return the film with its sound by format, `mp4` and `webm`, as base64: a browser takes what it plays."""
        frames, films = np.stack(self._video.frames), {"mp4": media.write_mp4, "webm": media.write_webm}
        with tempfile.TemporaryDirectory(prefix="home_mjx_page_") as name:
            folder, wav = Path(name), Path(name) / "sound.wav" if self._has_sound else None
            if wav is not None:
                media.write_wav(wav, np.concatenate(self._video.sounds, axis=-1), self._env.config.audio.sample_rate)
            for suffix, write in films.items():
                write(folder / f"film.{suffix}", frames, self._video.fps, wav)
            return {suffix: base64.b64encode((folder / f"film.{suffix}").read_bytes()).decode() for suffix in films}


def fill_page(page: str, values: Mapping[str, str]) -> str:
    """Return a page with values for its names in double braces, in one pass: values are never searched for names.

    Example:
        >>> fill_page("{{film}} and {{data}}", {"film": "{{data}}", "data": "1"})
        '{{data}} and 1'
    """
    return re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], page)
