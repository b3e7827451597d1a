"""Observer that shows a running job in browser pages: the environment that is watched, and figures of training."""

import json
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import jax
import numpy as np

from home_mjx.core.progress import say
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.observers import EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.viewer.attached.job_panels import JobPanels
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.run import ViewOptions, print_address
from home_mjx.viewer.browser.scene.scene_tree import SceneTree
from home_mjx.viewer.browser.serving.server import ViewServer
from home_mjx.viewer.browser.tiles import choose_tiles
from home_mjx.viewer.episodes.goal_markers import get_instruction

MAX_SHARE = 0.08  # largest part of the job's time that drawing takes, below the 10 % that are promised


class JobViewer(Observer):
    """Viewer of a running job, for `home-mjx train --viewer` and `home-mjx play --viewer`.

    Without an open page it does nothing. With one it draws the watched environment as often as `DrawBudget` allows.
    Sound is not sent: jobs do not run in real time.

    Args:
        options: Address, and options of the picture.
        print_line: Callback for lines of text, such as the address.

    Attributes:
        server: The server; `server.address` is the page's.
        watched: Number of the watched environment.

    Raises:
        ConfigError: The extra `view` is not installed, or no port is free.

    Example:
        >>> train(config, folder, observers=[JobViewer()])  # doctest: +SKIP
    """

    def __init__(self, options: ViewOptions | None = None, print_line: Callable[[str], Any] = say) -> None:
        options = options or ViewOptions()
        self.server = ViewServer(options.host, options.port, self._handle, self._greet, self._greet_sound)
        print_address(options, self.server, print_line)
        tree = SceneTree(self.server.scene, lambda group, index: None)
        self.broadcast, self.overlays = Broadcast(self.server, tree, options.picture), Overlays(self.server.scene)
        self.panels = JobPanels(self.server.scene, self.broadcast, self.overlays, self.watch)
        self.watched, self._budget, self._lock = 0, DrawBudget(), threading.RLock()
        self._states: State | None = None
        self._shown: tuple[int, int, int] | None = None  # environment, house and step that are drawn
        self._pick = jax.jit(lambda states, number: jax.tree.map(lambda x: x[number], states))

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment."""
        self._start = start
        self.broadcast.on_run_start(start)
        self.overlays.on_run_start(start)
        self.panels.begin_run(start)
        self.broadcast.has_sound = False
        self.broadcast.tell(sound=False, status=f"{start.name}: waiting for the first step")

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Show the instruction."""
        with self._lock:
            self.broadcast.on_episode_start(start)
            self.overlays.on_episode_start(start)
            self.panels.begin_episode()

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Draw the step, if a page is open and a drawing is due; its reward's terms are plotted in any case."""
        if self.server.live.num_pages:
            self.panels.add_step(step)
        if self._is_due():
            with self._lock, self._budget.spend():
                self._draw(step)

    def on_states(self, states: State) -> None:
        """Draw the watched environment of a batch, if a page is open and a drawing is due."""
        if not self._is_due():
            self._states = None if self.server.live.num_pages == 0 else states
            return
        self._states = jax.block_until_ready(states)  # the job's own work is not the viewer's
        with self._lock, self._budget.spend():
            self._draw_watched()

    def on_log(self, line: Mapping[str, float]) -> None:
        """Plot a line of training metrics."""
        self.panels.add_line(line)

    def watch(self, number: int) -> None:
        """Watch another environment of the batch, at once; from any thread."""
        with self._lock:
            self.watched = number
            self.panels.clear_watched()
            if self._states is not None:
                self._draw_watched()

    def close(self) -> None:
        """Stop the server."""
        self.server.close()

    def _is_due(self) -> bool:
        """Return whether a page is open and the budget allows a drawing."""
        return self.server.live.num_pages > 0 and self._budget.is_due()

    def _draw_watched(self) -> None:
        """Draw the watched environment of the last batch."""
        assert self._states is not None
        assert self._start.env is not None
        count = int(self._states.done.shape[0])
        self.watched = int(np.clip(self.watched, 0, count - 1))
        state = self._pick(self._states, self.watched)
        instruction = get_instruction(self._start.env, state)
        self.broadcast.tell(instruction=f"environment {self.watched} of {count}: {instruction.text}")
        self._draw(EpisodeStep(int(state.world.step), state, None, 0.0))
        if self.panels.num_tiles:
            numbers, states = choose_tiles(self.watched, count, self.panels.num_tiles), self._states
            self.broadcast.draw_tiles(numbers.tolist(), self.watched, lambda: self._pick(states, numbers))

    def _draw(self, step: EpisodeStep) -> None:
        """Send scene, picture, overlays and figures of a step."""
        house, last = int(step.state.world.house), self._shown
        if last is not None and (last[:2] != (self.watched, house) or step.index < last[2]):
            self.overlays.clear()  # observers of a batch get no event when an episode begins
        self._shown = self.watched, house, step.index
        self.overlays.on_episode_step(step)
        self.broadcast.on_episode_step(step)
        self.panels.show(step)

    def _handle(self, message: dict[str, Any]) -> None:
        """Watch the environment of a tile that was clicked."""
        if message.get("type") == "watch" and isinstance(message.get("number"), int):
            self.watch(message["number"])

    def _greet(self) -> str:
        """Return the state for a new page, with the last picture."""
        return json.dumps(self.broadcast.state if hasattr(self, "broadcast") else {})

    def _greet_sound(self) -> str:
        """Return the format of the sound."""
        return self.broadcast.sound_format()


class DrawBudget:
    """Share of a job's time: after each drawing, none is due until its time is at most a share of all time since.

    The first drawing, which compiles, is not counted.

    Args:
        share: The share.
        clock: Function that returns the time [s].

    Example:
        >>> times = iter([0.0, 5.0, 10.0, 11.0, 15.0, 21.0])
        >>> budget = DrawBudget(0.1, lambda: next(times))
        >>> with budget.spend():  # from 0 to 5 s: the first
        ...     pass
        >>> with budget.spend():  # from 10 to 11 s
        ...     pass
        >>> budget.is_due(), budget.is_due()  # at 15 s, at 21 s
        (False, True)
    """

    def __init__(self, share: float = MAX_SHARE, clock: Callable[[], float] = time.perf_counter) -> None:
        self.share, self._clock, self._due, self._is_first = share, clock, 0.0, True

    def is_due(self) -> bool:
        """Return whether a drawing is due."""
        return self._is_first or self._clock() >= self._due

    @contextmanager
    def spend(self) -> Iterator[None]:
        """Measure the block's time, and set when the next drawing is due."""
        began = self._clock()
        yield
        end = self._clock()
        self._due = end if self._is_first else began + (end - began) / self.share
        self._is_first = False
