"""Shapes and bounds of observations and actions."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.schema.agent import AgentBody

ACTION_NAMES = ("forward", "left", "turn_left", "look_up")
HAND_NAMES = ("pick", "throw", "turn_door")  # see `hand_actions.decode_hand_commands`
TOGGLE = "toggle"  # of `EnvConfig.switches`; see `toggle_actions`
MOVE_NAMES = ("stop", "move_forward", "turn_left", "turn_right", "look_up", "look_down")  # Habitat's, in its order
LOOK_NAMES = ("look_up", "look_down")
WALK_NAMES = ("forward", "left", "move_forward")  # elements and moves that change the position, not only the heading
HAND_MOVE_NAMES = ("pick", "drop", "throw", "open", "close")


@dataclass(frozen=True)
class DiscreteActions:
    """Discrete actions: one move per step, with Habitat's names and step sizes.

    A move covers its whole distance or angle within the step if nothing is in the way.

    Attributes:
        forward_step_size: Distance of `move_forward` [m].
        turn_angle: Angle of `turn_left` and `turn_right` [degrees].
        tilt_angle: Angle of `look_up` and `look_down` [degrees]. None: there are no looks, as in Habitat's PointNav of
            four actions; hands need looks.

    Raises:
        ConfigError: A value is invalid.

    Example:
        >>> round(DiscreteActions(turn_angle=30).min_duration(AgentBody()), 3)  # [s], for a turn
        0.333
        >>> DiscreteActions(tilt_angle=None).move_names
        ('stop', 'move_forward', 'turn_left', 'turn_right')
    """

    forward_step_size: float = 0.25
    turn_angle: float = 10.0
    tilt_angle: float | None = 15.0

    def __post_init__(self) -> None:
        for option in fields(self):
            value = getattr(self, option.name)
            if value is not None or option.name != "tilt_angle":
                check_number(f"actions.{option.name}", value, 0)

    @property
    def move_names(self) -> tuple[str, ...]:
        """Names of the moves, in Habitat's order."""
        return tuple(name for name in MOVE_NAMES if self.tilt_angle is not None or name not in LOOK_NAMES)

    def min_duration(self, body: AgentBody) -> float:
        """Return the time that a body needs for its longest move or turn at full speed [s]; looks are not counted."""
        return max(self.forward_step_size / body.forward_speed, math.radians(self.turn_angle) / body.turn_rate)


@dataclass(frozen=True)
class ArraySpec:
    """Shape, type and bounds of an array.

    Attributes:
        shape: Shape for one agent.
        dtype: NumPy name of the element type.
        low: Minimum: one for all elements, or one per element of the last axis.
        high: Maximum, in the same form.
        text: Description with units.

    Example:
        >>> ArraySpec((3,), "float32", -1.0, 1.0, "a direction").for_agents(2).shape
        (2, 3)
    """

    shape: tuple[int, ...]
    dtype: str = "float32"
    low: float | tuple[float, ...] = -np.inf
    high: float | tuple[float, ...] = np.inf
    text: str = ""

    def for_agents(self, num_agents: int) -> "ArraySpec":
        """Return the spec of all agents, with a leading axis if there are several; unchanged for one."""
        shape = self.shape if num_agents == 1 else (num_agents, *self.shape)
        return ArraySpec(shape, self.dtype, self.low, self.high, self.text)

    def for_one_agent(self, num_agents: int) -> "ArraySpec":
        """Return the spec of one agent: without the leading axis, which is there for several agents; unchanged for one.

        Example:
            >>> ArraySpec((2, 3)).for_one_agent(2).shape
            (3,)
        """
        shape = self.shape if num_agents == 1 else self.shape[1:]
        return ArraySpec(shape, self.dtype, self.low, self.high, self.text)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Return minimum and maximum of every element, broadcast to the spec's shape and type.

        Integer types need finite bounds, else NumPy raises `OverflowError`.
        """
        low, high = (np.broadcast_to(np.asarray(x, self.dtype), self.shape) for x in (self.low, self.high))
        return low, high


Specs = Mapping[str, ArraySpec]
