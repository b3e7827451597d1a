"""Player whose actions are the keys and sticks that people hold in the browser."""

import math
import threading
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.actions import action_names
from home_mjx.viewer.episodes.keyboard import CONTINUOUS_KEYS, key_actions

MAX_PRESSES = 3  # presses that wait for a discrete action; further ones are dropped
MIN_TILT = 0.5  # of a stick, that counts as a key


class HeldKeys:
    """Keys, sticks and waiting presses of one person; methods may be called from any thread."""

    def __init__(self) -> None:
        self._held: dict[str, None] = {}
        self._presses: deque[str] = deque(maxlen=MAX_PRESSES)
        self._tilts: dict[str, float] = {}
        self._lock = threading.Lock()

    def handle(self, message: Any) -> None:
        """Handle a page's message; others are ignored.

        They are `keydown` or `keyup` with a `key`, `axes` with `values` in [-1, 1] of components of actions by name, as
        of a gamepad's sticks, and `release` of all.
        """
        kind, key = message.get("type"), message.get("key")
        with self._lock:
            if kind == "release":
                self._held.clear()
                self._tilts = {}
            elif kind == "axes" and isinstance(message.get("values"), dict):
                self._tilts = {str(name): x for name, x in message["values"].items() if _is_tilt(x)}
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
        """Remove and return the oldest press; if there is none, the last key that is held down, or None.

        A stick that is tilted by more than `MIN_TILT` counts as its component's key.
        """
        with self._lock:
            if self._presses:
                return self._presses.popleft()
            return next(reversed(self._held), None) or next(iter(self._tilted_keys()), None)

    def tilts(self) -> dict[str, float]:
        """Return the tilts of sticks by component of the action."""
        with self._lock:
            return dict(self._tilts)

    def _tilted_keys(self) -> list[str]:
        """Return the keys of the components by which sticks are tilted, the most tilted first."""
        by_tilt = sorted(self._tilts.items(), key=lambda item: -abs(item[1]))
        wanted = [(name, math.copysign(1.0, x)) for name, x in by_tilt if abs(x) > MIN_TILT]
        return [key for pair in wanted for key, bound in CONTINUOUS_KEYS.items() if bound == pair]


class HeldKeysPlayer:
    """Player of agents by keys, as `KeyboardPlayer` binds them, and by sticks.

    Continuous actions add up over the keys that are held down and the sticks, and are 0 without any. A discrete action
    needs a press by one person: without one, `act` returns None, and the environment waits; agents without do nothing.

    Args:
        config: Options of the environment, with the acting agents (`HouseholdEnv.acting_config`).
        keys: The keys of the first agents, one person each; further agents do nothing.
    """

    def __init__(self, config: EnvConfig, keys: Sequence[HeldKeys]) -> None:
        self.config, self.keys, self.actions = config, keys[: config.num_agents], key_actions(config)
        self._names = action_names(config)

    def reset(self) -> None:
        """Do nothing; keys stay held down."""

    def act(self, state: State | Any) -> Any:
        """Return the action of all agents; None while a discrete action is awaited."""
        find = self._press if self.config.discrete is not None else self._sum
        found = [find(keys) for keys in self.keys]
        if all(action is None for action in found):
            return None
        nothing = np.int32(-1) if self.config.discrete is not None else np.zeros(len(self._names), np.float32)
        chosen = [nothing if action is None else action for action in found]
        agents = self.config.num_agents
        return chosen[0] if agents == 1 else np.stack([*chosen, *[nothing] * (agents - len(chosen))])

    def _press(self, keys: HeldKeys) -> Any:
        """Return the discrete action of a person's next press; None without."""
        key = keys.next_press()
        return None if key not in self.actions else np.int32(self.actions[key])

    def _sum(self, keys: HeldKeys) -> Any:
        """Return a person's continuous action."""
        held, tilts = [self.actions[key] for key in keys.held() if key in self.actions], keys.tilts()
        tilt = np.array([tilts.get(name, 0.0) for name in self._names], np.float32)
        return np.clip(np.sum([tilt, *held], axis=0), -1, 1)


def _is_tilt(value: Any) -> bool:
    """Return whether a value of a page's message is a tilt."""
    return isinstance(value, int | float) and -1 <= value <= 1
