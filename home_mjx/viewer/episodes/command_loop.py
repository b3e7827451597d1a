"""Loop in real time that runs commands of other threads between two steps."""

import queue
import time
from collections.abc import Callable
from typing import Any

from home_mjx.errors import HomeMjxError

MAX_WAIT = 0.05  # [s], longest wait for commands


class CommandLoop:
    """Base of sessions: `run` calls `turn` whenever a step is due, and commands in between.

    All methods but `post` are for the loop's own thread.

    Args:
        on_error: Callback with the message of a command that failed.

    Attributes:
        is_paused: No step is due.
        speed: Simulated seconds per second.
        due: Time at which the next step is due, as of `time.perf_counter` [s].
        between_steps: Function that is called in each round of the loop, paused or not.
    """

    def __init__(self, on_error: Callable[[str], None] = lambda text: None) -> None:
        self.is_paused, self.speed, self.due = False, 1.0, 0.0
        self._is_stopped, self._on_error = False, on_error
        self._commands: queue.Queue[Callable[[], Any]] = queue.Queue()
        self.between_steps: Callable[[], None] = lambda: None

    def post(self, command: Callable[[], Any]) -> None:
        """Run a command between two steps, soon; from any thread."""
        self._commands.put(command)

    def stop(self) -> None:
        """End `run` after the current command."""
        self._is_stopped = True

    def turn(self) -> None:
        """Take the step that is due, and set `due`."""
        raise NotImplementedError

    def run(self) -> None:
        """Take steps in real time, and run commands, until `stop`."""
        while not self._is_stopped:
            wait = MAX_WAIT if self.is_paused else min(max(self.due - time.perf_counter(), 0.0), MAX_WAIT)
            self._run_command(wait)
            self.between_steps()
            if not self.is_paused and time.perf_counter() >= self.due:
                self.turn()

    def _run_command(self, wait: float) -> None:
        """Run the next command if one arrives within `wait` seconds; report its error of this package."""
        try:
            command = self._commands.get(timeout=wait) if wait > 0 else self._commands.get_nowait()
        except queue.Empty:
            return
        try:
            command()
        except HomeMjxError as error:
            self._on_error(str(error))
