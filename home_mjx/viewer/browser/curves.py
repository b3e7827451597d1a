"""Curves of the viewer: terms of the reward and value in each step, and results of past episodes."""

import math
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from home_mjx.core import notebook_html
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStep
from home_mjx.viewer.browser.broadcast import Broadcast

if TYPE_CHECKING:
    import viser

MAX_POINTS = 2000  # steps and episodes that are plotted
COLOURS = (*notebook_html.COLOURS, "#c9c94e", "#c0c0c0")
REWARD, RETURN, VALUE = "reward", "return", "value"
RESULTS = ("success", "SPL", RETURN)


class EpisodeCurves:
    """Plots in viser's panel: reward and its terms, return and value of the episode, and results of past episodes.

    Terms are those of `Task.reward_terms`; they are computed only while a page is open.

    Args:
        server: viser's server.
        broadcast: Scene and picture, whose pages are counted.
    """

    def __init__(self, server: "viser.ViserServer", broadcast: Broadcast) -> None:
        self._server, self._broadcast = server, broadcast
        self._rows: list[dict[str, float]] = []
        self._results: list[tuple[float, ...]] = []
        self._plots: dict[str, CurvePlot] = {}
        self._last: EpisodeStep | None = None

    def add_folder(self) -> None:
        """Add the folder with the plots."""
        with self._server.gui.add_folder("Curves", expand_by_default=True) as folder:
            for name in ("reward", "return and value", "past episodes"):
                self._plots[name] = CurvePlot(self._server, folder, name)

    def begin_run(self, env: Env[HouseholdEnv]) -> None:
        """Clear the results of another environment or agent, and make the program for its reward's terms."""
        self._env, self._results = env, []
        self._terms = jax.jit(env.core.reward_terms)
        self.begin_episode()

    def begin_episode(self) -> None:
        """Clear the curves of an episode."""
        self._rows, self._last = [], None

    def add_step(self, step: EpisodeStep, value: float | None) -> None:
        """Add a step, and the value of the state before it; None if there is none."""
        last, self._last = self._last, step
        if last is None or step.index != last.index + 1:  # not again after a door was opened
            return
        row = {"step": float(step.index), REWARD: _first(step.state.reward), RETURN: step.episode_return}
        if value is not None:
            row[VALUE] = value
        self._rows = [*self._rows, row | self._split(last.state, step.state)][-MAX_POINTS:]

    def add_result(self, result: EpisodeResult) -> None:
        """Add a past episode."""
        row = float(result.number), float(result.success > 0), result.spl, result.episode_return
        self._results = [*self._results, row][-MAX_POINTS:]

    def show(self) -> None:
        """Show all curves."""
        if not self._plots:
            return
        names = list(dict.fromkeys(name for row in self._rows for name in row if name != "step"))
        lines = {name: np.array([row.get(name, math.nan) for row in self._rows]) for name in names}
        steps = np.array([row["step"] for row in self._rows])
        wholes = {name: lines.pop(name) for name in (RETURN, VALUE) if name in lines}
        self._plots["reward"].show(steps, lines)
        self._plots["return and value"].show(steps, wholes)
        if self._results:
            number, *results = np.array(self._results).T
            self._plots["past episodes"].show(number, dict(zip(RESULTS, results, strict=True)))

    def _split(self, before: State, after: State) -> dict[str, float]:
        """Return the terms of a step's reward by name; none without a page."""
        if not self._broadcast.server.live.num_pages:
            return {}
        return {name: _first(term) for name, term in self._terms(self._env.params, before, after).items()}


class CurvePlot:
    """Plot whose curves are replaced when their names change.

    Args:
        server: viser's server.
        folder: Folder of the plot; None: the one that is open now.
        title: Title of the plot.
    """

    def __init__(self, server: "viser.ViserServer", folder: Any, title: str) -> None:
        self._server, self._title = server, title
        self._folder = server.gui.add_folder(title) if folder is None else folder
        self._names: tuple[str, ...] = ()
        self._handle: Any = None

    def show(self, x: np.ndarray, curves: dict[str, np.ndarray]) -> None:
        """Show curves over x by name."""
        data = (x.astype(float), *(y.astype(float) for y in curves.values()))
        if tuple(curves) == self._names and self._handle is not None:
            self._handle.data = data
        elif curves:
            self._add(tuple(curves), data)

    def _add(self, names: tuple[str, ...], data: Any) -> None:
        """Add the plot, in the place of that with other curves."""
        series: Any = ({}, *({"label": name, "stroke": COLOURS[n % len(COLOURS)]} for n, name in enumerate(names)))
        order = None if self._handle is None else self._handle.order
        if self._handle is not None:
            self._handle.remove()
        with self._folder:
            self._handle = self._server.gui.add_uplot(
                data, series, title=self._title, scales={"x": {"time": False}}, aspect=2.0, order=order
            )
        self._names = names


def _first(values: Any) -> float:
    """Return the first agent's value."""
    return float(np.reshape(values, -1)[0])
