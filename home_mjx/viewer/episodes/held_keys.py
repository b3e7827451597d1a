"""Player whose actions are the keys that a person holds down in the browser."""

import threading
from collections import deque
from typing import Any

import numpy as np

from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.state import State
from home_mjx.viewer.episodes.keyboard import key_actions

MAX_PRESSES = 3  # presses that wait for a discrete action; further ones are dropped


class HeldKeys:
    """Keys that are held down and presses since the last action; all methods may be called from any thread."""

    def __init__(self) -> None:
        self._held: dict[str, None] = {}
        self._presses: deque[str] = deque(maxlen=MAX_PRESSES)
        self._lock = threading.Lock()

    def handle(self, message: Any) -> None:
        """Handle a page's message: `keydown` or `keyup` with a key, or `release` of all keys; others are ignored."""
        kind, key = message.get("type"), message.get("key")
        with self._lock:
            if kind == "release":
                self._held.clear()
            elif isinstance(key, str) and len(key) == 1 and kind == "keydown":
                self._held[key] = None
                self._presses.append(key)
            elif isinstance(key, str) and kind == "keyup":
                self._held.pop(key, None)

    def held(self) -> tuple[str, ...]:
        """Return the keys that are held down or were pressed since the last call, in this order; clear the presses."""
        with self._lock:
            keys = dict.fromkeys((*self._held, *self._presses))
            self._presses.clear()
            return tuple(keys)

    def next_press(self) -> str | None:
        """Remove and return the oldest press; if there is none, the last key that is held down, or None."""
        with self._lock:
            if self._presses:
                return self._presses.popleft()
            return next(reversed(self._held), None)


class HeldKeysPlayer:
    """Player of the first agent by keys, as `KeyboardPlayer` binds them; other agents do nothing.

    Continuous actions add up over the keys that are held down, and are 0 without any. A discrete action needs a press:
    without one, `act` returns None, and the environment waits.

    Args:
        config: Options of the environment, with the acting agents (`HouseholdEnv.acting_config`).
        keys: The keys.
    """

    def __init__(self, config: EnvConfig, keys: HeldKeys) -> None:
        self.config, self.keys, self.actions = config, keys, key_actions(config)

    def reset(self) -> None:
        """Do nothing; keys stay held down."""

    def act(self, state: State | Any) -> Any:
        """Return the action of all agents; None while a discrete action is awaited."""
        if self.config.discrete is None:
            held = [self.actions[key] for key in self.keys.held() if key in self.actions]
            blank = np.zeros_like(next(iter(self.actions.values())))
            return self._for_all(np.clip(np.sum([blank, *held], axis=0), -1, 1), blank)
        key = self.keys.next_press()
        return None if key not in self.actions else self._for_all(np.int32(self.actions[key]), np.int32(-1))

    def _for_all(self, action: Any, nothing: Any) -> Any:
        """Return the first agent's action stacked with no-op actions of the others; unchanged for one agent."""
        agents = self.config.num_agents
        return action if agents == 1 else np.stack([action, *[nothing] * (agents - 1)])
