"""Keyboard player: keys become actions, in a terminal or from lines of text; no display is needed."""

import contextlib
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.actions import action_names

QUIT_KEYS = ("q", "\x03", "\x04")  # also Ctrl-D, and Ctrl-C of other streams; in a terminal it sends SIGINT
# Keys of discrete actions; other actions get the next unused key of `SPARE_KEYS`.
DISCRETE_KEYS = {
    "move_forward": "w", "turn_left": "a", "turn_right": "d", "look_up": "r", "look_down": "f", "stop": " ",
    "pick": "p", "drop": "o", "throw": "t", "open": "e", "close": "c",
}  # fmt: skip
SPARE_KEYS = "1234567890yuihjklbnm"
# Keys of continuous actions: action component and value.
CONTINUOUS_KEYS = {
    "w": ("forward", 1.0), "s": ("forward", -1.0), "z": ("left", 1.0), "x": ("left", -1.0),
    "a": ("turn_left", 1.0), "d": ("turn_left", -1.0), "r": ("look_up", 1.0), "f": ("look_up", -1.0),
    "p": ("pick", 1.0), "o": ("pick", -1.0), "t": ("throw", 1.0), "e": ("turn_door", 1.0), "c": ("turn_door", -1.0),
    " ": ("forward", 0.0),
}  # fmt: skip
TERMINAL_COLUMNS = 100  # width of an image in a terminal [characters]


def key_actions(config: EnvConfig) -> dict[str, Any]:
    """Map keys (one character each) to actions of one agent: indices of discrete actions, or arrays of all components.

    Example:
        >>> key_actions(EnvConfig(actions="discrete"))["w"]
        1
        >>> key_actions(EnvConfig())["a"].tolist()
        [0.0, 0.0, 1.0, 0.0]
    """
    names = action_names(config)
    if config.discrete is None:
        found = {}
        for key, (name, value) in CONTINUOUS_KEYS.items():
            if name in names:
                found[key] = np.zeros(len(names), np.float32)
                found[key][names.index(name)] = value
        return found
    spare = iter(SPARE_KEYS)
    return {DISCRETE_KEYS.get(name) or next(spare): number for number, name in enumerate(names)}


def key_help(config: EnvConfig) -> str:
    """Format the key bindings, `q` to quit included, as one line of text.

    Example:
        >>> key_help(EnvConfig(actions="discrete"))[:30]
        'space stop, w move_forward, a '
    """
    names = action_names(config)
    if config.discrete is None:
        said = [
            (key, f"{name} {value:+.0f}") for key, (name, value) in CONTINUOUS_KEYS.items() if name in names and value
        ]
        said.append((" ", "wait"))
    else:
        said = [(key, names[number]) for key, number in key_actions(config).items()]
    return ", ".join(f"{'space' if key == ' ' else key} {what}" for key, what in said) + ", q quit"


class KeyboardPlayer:
    """Player that reads the first agent's actions from keys; other agents do nothing.

    Args:
        config: Options of the environment, with the acting agents (`HouseholdEnv.acting_config`).
        source: Input stream; a terminal is read key by key, any other stream line by line.

    Example:
        >>> import io
        >>> player = KeyboardPlayer(EnvConfig(actions="discrete"), io.StringIO("wa q"))
        >>> [player.act(None) for _ in range(4)]
        [1, 2, 0, None]
    """

    def __init__(self, config: EnvConfig, source: Any = None) -> None:
        self.config = config
        self.actions, self.keys = key_actions(config), read_keys(source or sys.stdin)

    def reset(self) -> None:
        """Do nothing; a keyboard player has no state."""

    def act(self, state: State | Any) -> Any:
        """Wait for a key with an action, ignoring others; return all agents' actions, None at the end or on `q`.

        Upper case counts as lower case.
        """
        for key in self.keys:
            if key.lower() in QUIT_KEYS:
                return None
            if key.lower() in self.actions:
                return self._for_all(self.actions[key.lower()])
        return None

    def _for_all(self, action: Any) -> Any:
        """Return the first agent's action stacked with no-op actions of the others; unchanged for one agent."""
        agents = self.config.num_agents
        if agents == 1:
            return action
        others = np.zeros_like(action) if self.config.discrete is None else np.int32(-1)
        return np.stack([np.asarray(action), *[others] * (agents - 1)])


def read_keys(source: Any) -> Iterator[str]:
    """Yield keys of a terminal as they are pressed, or the characters of lines of another stream, until it ends.

    Ends of lines are omitted. A terminal is switched to single keys only while a key is awaited.
    """
    if not source.isatty():
        for line in source:
            yield from line.rstrip("\r\n")
        return
    while True:
        with _single_keys(source):
            key = source.read(1)
        if not key:
            return
        yield key


@contextlib.contextmanager
def _single_keys(terminal: Any) -> Iterator[None]:
    """Switch a terminal to input key by key without echo during the block; on Windows do nothing."""
    try:
        import termios
        import tty
    except ModuleNotFoundError:  # Windows: keys arrive at the end of a line
        yield
        return
    kept = termios.tcgetattr(terminal)
    try:
        tty.setcbreak(terminal, termios.TCSADRAIN)  # TCSADRAIN keeps keys that were pressed in the meantime
        yield
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, kept)


def image_to_text(image: UInt8[np.ndarray, "h w 3"], columns: int = TERMINAL_COLUMNS) -> str:
    r"""Format an image as coloured half blocks, `columns` characters wide, for a terminal with 24-bit colours.

    Example:
        >>> image_to_text(np.zeros((2, 1, 3), np.uint8), 1)
        '\x1b[38;2;0;0;0m\x1b[48;2;0;0;0m▀\x1b[0m'
    """
    height = max(1, round(columns * image.shape[0] / image.shape[1] / 2)) * 2
    small = np.asarray(Image.fromarray(image).resize((columns, height), Image.Resampling.BOX))
    lines = []
    for upper, lower in zip(small[::2], small[1::2], strict=True):
        cells = (_cell(a, b) for a, b in zip(upper.tolist(), lower.tolist(), strict=True))
        lines.append("".join(cells) + "\x1b[0m")
    return "\n".join(lines)


def _cell(upper: list[int], lower: list[int]) -> str:
    """Return a half block whose upper half has one colour (RGB), its lower half the other."""
    ink, ground = (";".join(map(str, colour)) for colour in (upper, lower))
    return f"\x1b[38;2;{ink}m\x1b[48;2;{ground}m▀"
