"""Drivers of the viewer: pages take seats at agents, and their keys and gamepads drive these."""

import threading
from collections.abc import Callable
from typing import Any

from home_mjx.tasks.env.observers import Observer, RunStart
from home_mjx.viewer.episodes.held_keys import HeldKeys
from home_mjx.viewer.episodes.keyboard import key_help
from home_mjx.viewer.episodes.run import HUMAN

MAX_DRIVERS = 4  # agents that pages can drive; further ones do nothing
PAD_HELP = "; gamepad: sticks walk, turn and look, A pick, B drop, X open, Y close"


class Drivers(Observer):
    """Seats of pages at the agents of the watched environment; each agent has at most one driver.

    The first key or stick of a page takes the first free agent, unless the page has chosen one. A page that closes its
    connection frees its agent.

    Args:
        tell: Function that changes entries of all pages' state.
        tell_page: Function that sends entries to one page, by its number.

    Attributes:
        keys: What each agent's driver holds down.
    """

    def __init__(self, tell: Callable[..., Any], tell_page: Callable[..., Any]) -> None:
        self.keys = tuple(HeldKeys() for _ in range(MAX_DRIVERS))
        self._tell, self._tell_page = tell, tell_page
        self._seats: dict[int, int] = {}  # agents by page
        self._num_agents, self._is_human, self._lock = 1, False, threading.RLock()

    def on_run_start(self, start: RunStart) -> None:
        """Send the number of agents, and the key bindings of a human; of other agents none. All keys are released."""
        assert start.env is not None
        config = start.env.core.acting_config
        with self._lock:
            self._is_human, self._num_agents = start.name == HUMAN, min(config.num_agents, MAX_DRIVERS)
            for keys in self.keys:
                keys.handle({"type": "release"})
            for page, agent in list(self._seats.items()):
                if agent >= self._num_agents:
                    self._free(page)
        help_text = f"Keys: {key_help(config).removesuffix(', q quit')}; arrows{PAD_HELP}" if self._is_human else ""
        self._tell(drives=self._is_human, keys=help_text, agents=self._num_agents)

    def agent_of(self, page: int) -> int:
        """Return the agent that a page drives; the first one of pages that drive none."""
        return self._seats.get(page, 0)

    def handle(self, message: dict[str, Any]) -> None:
        """Handle a page's message: `drive` with an agent or None, `leave`, or those of `HeldKeys`."""
        with self._lock:
            self._handle(message["page"], message.get("type"), message)

    def _handle(self, page: int, kind: Any, message: dict[str, Any]) -> None:
        """Handle a message of a kind from a page."""
        if kind == "leave" or (kind == "drive" and message.get("agent") is None):
            self._free(page)
        elif kind == "drive" and isinstance(message["agent"], int):
            self._take(page, (message["agent"],))
        elif page not in self._seats and (kind == "keydown" or (kind == "axes" and message.get("values"))):
            self._take(page, range(self._num_agents))
        if page in self._seats:
            self.keys[self._seats[page]].handle(message)

    def _take(self, page: int, wanted: Any) -> None:
        """Give a page the first free one of the wanted agents, or tell it that they are taken."""
        taken = {agent for other, agent in self._seats.items() if other != page}
        free = [agent for agent in wanted if agent not in taken and 0 <= agent < self._num_agents]
        if not self._is_human or not free:
            names = " and ".join(f"agent {agent + 1}" for agent in wanted)
            reason = (
                f"another page drives {names}, until it is closed or lets go" if self._is_human else "nobody drives"
            )
            self._tell_page(page, notice=reason, seat=self._seats.get(page))
            return
        if self._seats.get(page) != free[0]:
            self._free(page)
            self._seats[page] = free[0]
        self._tell_page(page, seat=free[0], notice="")

    def _free(self, page: int) -> None:
        """Free the agent of a page, which then stands still."""
        agent = self._seats.pop(page, None)
        if agent is not None:
            self.keys[agent].handle({"type": "release"})
            self._tell_page(page, seat=None)
