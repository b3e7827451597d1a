"""Panels of a running job: the watched environment, its figures, and curves of training."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.observers import EpisodeStep, RunStart
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.controls import ViewControls
from home_mjx.viewer.browser.curves import CurvePlot, EpisodeCurves
from home_mjx.viewer.browser.markdown import format_table
from home_mjx.viewer.browser.overlays import Overlays

if TYPE_CHECKING:
    import viser

CURVES = ("success", "return", "loss/value")  # training metrics that are plotted
TILES = ("none", "4", "9")  # numbers of environments in the grid
MAX_LINES = 2000  # lines of training that are kept
MAX_ENVIRONMENT = 1_000_000


class JobPanels:
    """Controls and figures of a job in viser's panel.

    Args:
        server: viser's server.
        broadcast: Scene and picture.
        overlays: Overlays of the scene.
        watch: Function that watches another environment, by its number.

    Attributes:
        num_tiles: Number of environments in the grid.
    """

    def __init__(
        self, server: "viser.ViserServer", broadcast: Broadcast, overlays: Overlays, watch: Callable[[int], None]
    ) -> None:
        self._server, self._lines = server, []
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        with server.gui.add_folder("Watch"):
            number = server.gui.add_number("environment", 0, min=0, max=MAX_ENVIRONMENT, step=1)
            tiles = server.gui.add_dropdown("grid", TILES, initial_value=TILES[0])
            self._figures = server.gui.add_markdown("")
            self._watched = CurvePlot(server, None, "watched environment, at each picture")
        self.num_tiles, self._rows = 0, list[dict[str, float]]()
        self._terms = EpisodeCurves(server, broadcast)
        self._terms.add_folder()
        tiles.on_update(lambda event: setattr(self, "num_tiles", 0 if tiles.value == TILES[0] else int(tiles.value)))
        number.on_update(lambda event: watch(int(number.value)))
        self._curves, self._plots = server.gui.add_folder("Training", visible=False), {}
        self._controls = ViewControls(server, broadcast, overlays, lambda command: command())
        self._controls.add_folders()
        self._house = -1

    def begin_run(self, start: RunStart) -> None:
        """Clear the curves, and make the program for the reward's terms."""
        assert start.env is not None
        self._terms.begin_run(start.env)

    def begin_episode(self) -> None:
        """Clear the curves of an episode."""
        self._terms.begin_episode()

    def clear_watched(self) -> None:
        """Clear the curves of the watched environment, as another one is watched."""
        self._rows = []

    def add_step(self, step: EpisodeStep) -> None:
        """Add a step to the curves; terms of the reward are known if it follows the one before."""
        self._terms.add_step(step, None)

    def show(self, step: EpisodeStep) -> None:
        """Show the figures of a step, and the curves up to it."""
        state = step.state
        row = {"reward": float(np.mean(state.reward)), **{name: float(x) for name, x in state.metrics.items()}}
        self._rows = [*self._rows, row][-MAX_LINES:]
        curves = {name: np.array([known.get(name, np.nan) for known in self._rows]) for name in row}
        self._watched.show(np.arange(len(self._rows)), curves)
        self._terms.show()
        rows = {
            "step": step.index,
            "reward": f"{float(np.mean(state.reward)):+.3f}",
            **{name: f"{float(value):.3f}" for name, value in state.metrics.items()},
            "status": ", ".join(Status.names(state.status)) or "no flag",
        }
        self._figures.content = format_table(rows)
        if int(state.world.house) != self._house:
            self._house = int(state.world.house)
            self._controls.show_levels()

    def add_line(self, line: Mapping[str, float]) -> None:
        """Add a line of training metrics to the curves."""
        self._lines = [*self._lines, dict(line)][-MAX_LINES:]
        self._curves.visible = True
        for name in CURVES:
            known = [(row["steps"], row[name]) for row in self._lines if np.isfinite(row.get(name, np.nan))]
            if known:
                self._plot(name, np.array(known, float))

    def _plot(self, name: str, points: np.ndarray) -> None:
        """Plot a metric over steps."""
        data: Any = (points[:, 0].copy(), points[:, 1].copy())
        if name in self._plots:
            self._plots[name].data = data
            return
        series: Any = ({}, {"label": name, "stroke": "#4caf72"})
        with self._curves:
            self._plots[name] = self._server.gui.add_uplot(
                data, series, title=name, scales={"x": {"time": False}}, aspect=3.0
            )
