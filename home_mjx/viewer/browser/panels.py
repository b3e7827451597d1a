"""Panels of the viewer: controls of session, picture and scene, and figures of the episode."""

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from home_mjx.registry import list_envs
from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.controls import ViewControls, name_houses
from home_mjx.viewer.browser.curves import EpisodeCurves
from home_mjx.viewer.browser.markdown import format_table
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.session import Session

if TYPE_CHECKING:
    import viser

ANY_HOUSE = "any house"
SPEEDS = ("0.25", "0.5", "1", "2", "4", "8")
MIN_SECONDS = 0.2  # [s], time between updates of figures and plot


class Panels(Observer):
    """Controls and figures in viser's panel; it is the last observer, so that the scene exists.

    Args:
        server: viser's server.
        broadcast: Scene and picture.
        agents: Names of agents that can be chosen.
        load_task: Function that makes the environment of an id and loads it into the session.
    """

    def __init__(
        self,
        server: "viser.ViserServer",
        broadcast: Broadcast,
        agents: tuple[str, ...],
        load_task: Callable[[str], None],
    ) -> None:
        self._server, self._broadcast, self._agents, self._load_task = server, broadcast, agents, load_task
        self._results: list[EpisodeResult] = []
        self._curves = EpisodeCurves(server, broadcast)
        self._shown_at = 0.0
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)

    def attach(self, session: Session, overlays: Overlays) -> None:
        """Add all controls; called once, after the session exists."""
        self.session, gui = session, self._server.gui
        with gui.add_folder("Episode"):
            self._figures = gui.add_markdown("")
            self._curves.add_folder()
        self._controls = ViewControls(self._server, self._broadcast, overlays, session.post)
        with gui.add_folder("Run"):
            self._add_run_controls()
        with gui.add_folder("Environment"):
            self._add_environment_controls()
        self._controls.add_folders()
        self._show_environment()

    def on_run_start(self, start: RunStart) -> None:
        """Clear the results of another environment or agent."""
        self._results = []
        assert start.env is not None
        self._curves.begin_run(start.env)
        if hasattr(self, "session"):
            self.session.post(self._show_environment)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Show the episode's house, and clear its plot."""
        self._start = start
        self._curves.begin_episode()
        if hasattr(self, "session"):
            self.session.post(self._controls.show_levels)
            if hasattr(self, "_checkpoint") and self._checkpoint.options != self.session.checkpoints.names():
                self._checkpoint.options = self.session.checkpoints.names()
                self._checkpoint.value = self.session.checkpoints.name

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Show figures and curves of the episode."""
        if hasattr(self, "session"):
            self._curves.add_step(step, self.session.value)
        is_due = time.monotonic() - self._shown_at > MIN_SECONDS or step.state.done or not step.index
        if hasattr(self, "session") and (is_due or self.session.is_paused):
            self._shown_at = time.monotonic()
            self._show_figures(step)

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Store the result; success rate and SPL are those of all stored ones."""
        self._results.append(result)
        self._curves.add_result(result)

    def _add_run_controls(self) -> None:
        """Add agent, pause, step, reset, seed and speed."""
        gui, session = self._server.gui, self.session
        self._agent = gui.add_dropdown("agent", self._agents, initial_value=session.agent)
        self._agent.on_update(lambda event: session.post(self._choose_agent))
        pause, speed = (
            gui.add_checkbox("pause", initial_value=False),
            gui.add_dropdown("speed", SPEEDS, initial_value="1"),
        )
        pause.on_update(lambda event: session.post(lambda: setattr(session, "is_paused", pause.value)))
        speed.on_update(lambda event: session.post(lambda: setattr(session, "speed", float(speed.value))))
        step, seed = (
            gui.add_button("step"),
            gui.add_number("seed", initial_value=session.seed, min=0, max=2**32 - 1, step=1),
        )
        step.on_click(lambda event: session.post(session.advance))
        if session.checkpoints.path is not None:
            self._checkpoint: Any = gui.add_dropdown(
                "checkpoint", session.checkpoints.names(), initial_value=session.checkpoints.name
            )
            self._checkpoint.on_update(lambda event: session.post(self._choose_checkpoint))
        again, following = gui.add_button("reset with this seed"), gui.add_button("next episode")
        again.on_click(lambda event: session.post(lambda: session.reset(int(seed.value))))
        following.on_click(lambda event: session.post(session.reset))

    def _add_environment_controls(self) -> None:
        """Add number of the watched environment, task and house."""
        gui, session = self._server.gui, self.session
        if session.num_envs > 1:
            number = gui.add_number("environment", 0, min=0, max=session.num_envs - 1, step=1)
            number.on_update(lambda event: session.post(lambda: session.watch(int(number.value))))
        spec = session.env.spec
        names = list_envs() if spec is None or spec.id in list_envs() else [spec.id, *list_envs()]
        self._task = gui.add_dropdown("task", names, initial_value=spec.id if spec else names[0])
        self._task.on_update(lambda event: session.post(self._choose_task))
        self._house: Any = gui.add_dropdown("house", (ANY_HOUSE,), initial_value=ANY_HOUSE)
        self._house.on_update(lambda event: session.post(self._choose_house))

    def show_card(self, text: str) -> None:
        """Show the card of a clicked object (Markdown), below the episode."""
        self._controls.show_card(text)

    def _choose_agent(self) -> None:
        """Load the chosen agent; go back to the current one if it cannot play."""
        if self._agent.value != self.session.agent:
            try:
                self.session.set_agent(self._agent.value)
            finally:
                self._agent.value = self.session.agent

    def _choose_checkpoint(self) -> None:
        """Load the chosen checkpoint; go back to the current one if that fails."""
        session = self.session
        if session.agent == "trained" and self._checkpoint.value != session.checkpoints.name:
            try:
                session.choose_checkpoint(self._checkpoint.value)
            finally:
                self._checkpoint.value = session.checkpoints.name

    def _choose_task(self) -> None:
        """Load the chosen task; go back to the current one if that fails."""
        spec = self.session.env.spec
        if spec is None or self._task.value != spec.id:
            try:
                self._load_task(self._task.value)
            finally:
                spec = self.session.env.spec
                self._task.value = spec.id if spec else self._task.value

    def _choose_house(self) -> None:
        """Start an episode in the chosen house."""
        name, names = self._house.value, name_houses(self.session.env.bank.house_ids)
        house = None if name not in names else names.index(name)
        if house != self.session.house:
            self.session.house = house
            self.session.reset(self.session.seed)

    def _show_environment(self) -> None:
        """Show agent, houses and levels of the environment."""
        names = name_houses(self.session.env.bank.house_ids)
        self._house.options = (ANY_HOUSE, *names)
        self._house.value = ANY_HOUSE if self.session.house is None else names[self.session.house]
        self._agent.value = self.session.agent
        self._controls.show_levels()
        self._show_figures(self.session.episode.step)

    def _show_figures(self, step: EpisodeStep) -> None:
        """Show the figures and the curves up to a step."""
        self._figures.content = format_table(self._rows(step))
        self._curves.show()

    def _rows(self, step: EpisodeStep) -> dict[str, str]:
        """Return instruction, figures and status of a step by name."""
        session, results = self.session, self._results
        rows = {
            "house": name_houses(session.env.bank.house_ids)[int(step.state.world.house)],
            "task": self._start.instruction,
            **({"checkpoint": session.checkpoints.describe()} if session.agent == "trained" else {}),
            "step": f"{step.index} of {session.env.config.episode_length}",
            "return": f"{step.episode_return:+.3f}",
            **{name: f"{float(value):.3f}" for name, value in step.state.metrics.items()},
            "status": ", ".join(Status.names(step.state.status)) or "no flag",
            "real-time factor": f"{session.real_time_factor:.2f}",
            "picture": f"{1000 * self._broadcast.picture_seconds:.0f} ms",
        }
        if results:
            spl = [result.spl for result in results if not math.isnan(result.spl)]
            rows["episodes"] = f"{len(results)}, success {np.mean([r.success > 0 for r in results]):.0%}"
            rows["mean SPL"] = f"{np.mean(spl):.2f}" if spl else "unknown"
        return rows
