"""Panels of a replay: episodes and failures, the step slider with marks of events, figures and plots."""

from typing import TYPE_CHECKING, Any

import numpy as np

from home_mjx.tasks.env.observers import EpisodeStart, EpisodeStep, Observer
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.controls import ViewControls, name_houses
from home_mjx.viewer.browser.markdown import format_list, format_table
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.replay.events import KINDS
from home_mjx.viewer.replay.export import ExportButtons
from home_mjx.viewer.replay.recorder import REWARD
from home_mjx.viewer.replay.session import ReplaySession

if TYPE_CHECKING:
    import viser

SPEEDS = ("0.25", "0.5", "1", "2", "4")
MAX_MARKS = 40  # events that are marked on the slider; the others are in the list
MAX_LISTED = 12  # events around the shown step that are listed
MAX_TITLE = 60  # [characters], of an episode in the list


class ReplayPanels(Observer):
    """Controls and figures of a replay in viser's panel; it is the last observer.

    Args:
        server: viser's server.
        broadcast: Scene and picture.
        overlays: Overlays of the scene.
    """

    def __init__(self, server: "viser.ViserServer", broadcast: Broadcast, overlays: Overlays) -> None:
        self._server, self._broadcast, self._overlays = server, broadcast, overlays
        self._plots: list[Any] = []
        self._slider: Any = None
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)

    def attach(self, session: ReplaySession) -> None:
        """Add all controls; called once, after the session exists."""
        self._session, gui = session, self._server.gui
        with gui.add_folder("Replay"):
            self._add_episodes()
            self._slider_folder = gui.add_folder("Step")
            self._pause = gui.add_checkbox("pause", initial_value=session.is_paused)
            self._pause.on_update(lambda event: session.post(self._set_pause))
            speed = gui.add_dropdown("speed", SPEEDS, initial_value="1")
            speed.on_update(lambda event: session.post(lambda: setattr(session, "speed", float(speed.value))))
            self._add_events()
            ExportButtons(self._server, session, self._broadcast.warn)
        with gui.add_folder("Figures"):
            self._figures = gui.add_markdown("")
        self._controls = ViewControls(self._server, self._broadcast, self._overlays, session.post)
        self._plots_folder = gui.add_folder("Plots")
        self._controls.add_folders()
        self._show_episode()
        self._show_step()

    def show_card(self, text: str) -> None:
        """Show the card of a clicked object (Markdown)."""
        self._controls.show_card(text)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Show another episode's events and plots."""
        if hasattr(self, "_session"):
            self._show_episode()

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Show figures and events of a step."""
        if hasattr(self, "_session"):
            self._show_step()

    def _add_episodes(self) -> None:
        """Add the list of episodes, and buttons to failures."""
        gui, session = self._server.gui, self._session
        self._titles = [_title(n, track.notes) for n, track in enumerate(session.replay.tracks)]
        self._episode = gui.add_dropdown("episode", self._titles, initial_value=self._titles[0])
        self._episode.on_update(lambda event: self._choose(self._episode.value))
        failures = gui.add_button_group("failure", ("previous", "next"))
        steps = {"previous": -1, "next": 1}
        failures.on_click(
            lambda event: session.post(lambda: session.go(lambda: session.find_failure(steps[failures.value])))
        )

    def _add_events(self) -> None:
        """Add the kind of events, buttons to the previous and the next one, and their list."""
        gui, session = self._server.gui, self._session
        kind, steps = gui.add_dropdown("events", ("all", *KINDS), initial_value="all"), {"previous": -1, "next": 1}
        buttons = gui.add_button_group("event", ("previous", "next"))

        def find() -> Any:
            """Return the event in the direction of the clicked button."""
            kinds = KINDS if kind.value == "all" else (kind.value,)
            return session.find_event(steps[buttons.value], kinds)

        buttons.on_click(lambda event: session.post(lambda: session.go(find)))
        self._events = gui.add_markdown("")

    def _choose(self, title: str) -> None:
        """Show the chosen episode."""
        number, session = self._titles.index(title), self._session
        if number != session.number:
            session.post(lambda: session.choose(number))

    def _scrub(self) -> None:
        """Show the step of the slider, unless it only follows the playback."""
        if int(self._slider.value) != self._session.index:
            self._session.post(self._show_slider)

    def _show_slider(self) -> None:
        """Show the step at which the slider is now: of many changes only the last is drawn."""
        session, chosen = self._session, int(self._slider.value)
        if chosen != session.index:
            session.is_paused = True
            session.show(chosen)

    def _set_pause(self) -> None:
        """Pause or go on, from the start if the episode is over."""
        session = self._session
        session.is_paused = self._pause.value
        if not session.is_paused and session.index == session.track.num_steps:
            session.show(0)

    def _show_episode(self) -> None:
        """Show an episode: its name, marks on the slider, plots."""
        session, track = self._session, self._session.track
        self._set(self._episode, self._titles[session.number])
        self._add_slider()
        self._controls.show_levels()
        for plot in self._plots:
            plot.remove()
        with self._plots_folder:
            self._plots = [self._plot(name, values) for name, values in plot_series(track.series).items()]

    def _add_slider(self) -> None:
        """Replace the slider by that of the shown episode, with marks at its events."""
        if self._slider is not None:
            self._slider.remove()
        session, track = self._session, self._session.track
        steps = list(dict.fromkeys(event.step for event in track.events))
        marks = tuple(steps[:: len(steps) // MAX_MARKS + 1]) or None
        with self._slider_folder:
            last = max(track.num_steps, 1)
            self._slider = self._server.gui.add_slider("step", 0, last, 1, session.index, marks=marks)
        self._slider.on_update(lambda event: self._scrub())

    def _plot(self, name: str, values: np.ndarray) -> Any:
        """Add the plot of a figure over steps."""
        series: Any = ({}, {"label": name, "stroke": "#4caf72"})
        data = np.arange(len(values), dtype=float), np.asarray(values, float)
        return self._server.gui.add_uplot(data, series, title=name, scales={"x": {"time": False}}, aspect=3.0)

    def _show_step(self) -> None:
        """Show the slider's place, figures, events and the path of the shown step."""
        session, track = self._session, self._session.track
        self._set(self._slider, session.index)
        self._set(self._pause, session.is_paused)
        self._overlays.draw_path(track.feet[: session.index + 1])
        notes = track.notes
        rows = {
            "house": name_houses([notes["house"]])[0],
            "task": notes["instruction"],
            "step": f"{session.index} of {track.num_steps}",
            **{name: f"{values[session.index]:.3f}" for name, values in plot_series(track.series).items()},
            "result": "failure" if track.is_failure else "success",
        }
        self._figures.content = format_table(rows)
        near = sorted(track.events, key=lambda event: abs(event.step - session.index))[:MAX_LISTED]
        self._events.content = format_list((e.step, e.text, e.step == session.index) for e in sorted(near))

    def _set(self, control: Any, value: Any) -> None:
        """Set a control if it differs; callbacks find that there is nothing to do."""
        if control.value != value:
            control.value = value


def plot_series(series: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the figures to plot over steps, by name: reward, return, and the task's metrics.

    Example:
        >>> {name: x.tolist() for name, x in plot_series({"reward": np.ones(3), "distance": np.zeros(3)}).items()}
        {'reward': [1.0, 1.0, 1.0], 'return': [1.0, 2.0, 3.0], 'distance': [0.0, 0.0, 0.0]}
    """
    rest = {name: values for name, values in series.items() if name != REWARD}
    return {REWARD: series[REWARD], "return": np.cumsum(series[REWARD]), **rest}


def _title(number: int, notes: dict[str, Any]) -> str:
    """Return an episode's line in the list."""
    mark = "✓" if notes.get("success", 0.0) > 0 else "✗"
    return f"{number + 1} {mark} {notes['instruction']}"[:MAX_TITLE]
