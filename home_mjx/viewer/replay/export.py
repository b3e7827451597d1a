"""Export of a recorded episode: a film with its sound, or a page without a server."""

import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jax

from home_mjx.core.files import convert_write_errors
from home_mjx.errors import HomeMjxError
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import Observer, ObserverGroup, RunStart
from home_mjx.viewer.episodes.observers import FilmObserver, ShotCache
from home_mjx.viewer.replay.page import PageRecorder
from home_mjx.viewer.replay.session import ReplaySession, episode_result, episode_start, episode_step
from home_mjx.viewer.replay.track import Replay, blank_state

if TYPE_CHECKING:
    import viser

FORMATS = {"MP4 with sound": ".mp4", "HTML page": ".html"}
NAME = "episode"  # of the files, before the episode's number


def export_episode(
    env: Env[HouseholdEnv],
    replay: Replay,
    number: int,
    suffix: str,
    shots: ShotCache | None = None,
    on_progress: Callable[[float], Any] = lambda part: None,
) -> bytes:
    """Return the file of one episode of a replay, rendered again from its states.

    Args:
        env: The environment of the replay.
        replay: The episodes.
        number: Number of the episode, from 0.
        suffix: One of the values of `FORMATS`: a film as of `home-mjx play`, or a page as of `play --html`.
        shots: Views of the first agent; None: of the size of these commands.
        on_progress: Callback with the part of the steps that is done, from 0 to 1.

    Raises:
        HomeMjxError: The file cannot be written, such as on a full disk.
        DatasetError: The replay is of another environment.
    """
    track, blank, name = replay.tracks[number], blank_state(env), f"{NAME}_{number + 1}"
    observer: Observer = PageRecorder(name, shots) if suffix == ".html" else FilmObserver(shots or ShotCache(), name)
    with (
        convert_write_errors("an export", Path(tempfile.gettempdir())),
        ObserverGroup((observer,)) as group,
        tempfile.TemporaryDirectory(prefix="home_mjx_export_") as folder,
    ):
        group.on_run_start(RunStart(replay.agent, env, "episodes", 1))
        group.on_episode_start(episode_start(track, number))
        for index in range(track.num_steps + 1):
            step = episode_step(track, index, blank)
            group.on_episode_step(step._replace(state=jax.device_put(step.state)))
            on_progress(index / (track.num_steps + 1))
        group.on_episode_end(episode_result(track, number))
        group.write(Path(folder))
        return (Path(folder) / (name + suffix)).read_bytes()


class ExportButtons:
    """Buttons that export the shown episode in a thread, and send the file to the page that asked for it.

    Args:
        server: viser's server; the buttons are added to its current folder.
        session: The replay.
        on_error: Callback with the message of an export that failed.
    """

    def __init__(self, server: "viser.ViserServer", session: ReplaySession, on_error: Callable[[str], None]) -> None:
        self._session, self._on_error, self._lock = session, on_error, threading.Lock()
        self._choice = server.gui.add_dropdown("export", tuple(FORMATS), initial_value=next(iter(FORMATS)))
        self._button = server.gui.add_button("export this episode")
        self._button.on_click(lambda event: self._start(event.client))

    def _start(self, client: Any) -> None:
        """Export the shown episode, unless another export is under way."""
        if client is not None and self._lock.acquire(blocking=False):
            number, suffix = self._session.number, FORMATS[self._choice.value]
            threading.Thread(target=self._export, args=(client, number, suffix), daemon=True).start()

    def _export(self, client: Any, number: int, suffix: str) -> None:
        """Export an episode, and send the file to a page; the body of a thread."""
        idle, session = self._button.label, self._session
        self._button.disabled = True

        def show(part: float) -> None:
            """Show the progress on the button."""
            self._button.label = f"writing: {part:.0%}"

        try:
            content = export_episode(session.env, session.replay, number, suffix, on_progress=show)
            client.send_file_download(f"{NAME}_{number + 1}{suffix}", content, save_immediately=True)
        except HomeMjxError as error:
            self._on_error(str(error))
        finally:
            self._button.label, self._button.disabled = idle, False
            self._lock.release()
