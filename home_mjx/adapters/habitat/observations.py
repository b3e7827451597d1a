"""Observations, actions and measures with Habitat's names, shapes and units, from those of an environment."""

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Any

import gymnasium
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.rules.enums import Attribute
from home_mjx.tasks.sensors.cameras import observation_name

# Our sensor behind each of Habitat's.
SENSORS = {
    "rgb": "rgb",
    "depth": "depth",
    "semantic": "instance",
    "pointgoal_with_gps_compass": "goal",
    "gps": "gps_compass",
    "compass": "gps_compass",
    "heading": "state",
    "objectgoal": "goal_words",
    "imagegoal": "rgb",
}
EPISODE_SENSORS = ("imagegoal",)  # observations that are fixed over an episode, not made by `convert`
NO_LIMIT = np.finfo(np.float32).max
IMAGES = {  # number of channels, maximum, type; others have numbers of objects
    "rgb": (3, 255, np.uint8),
    "imagegoal": (3, 255, np.uint8),
    "depth": (1, 1.0, np.float32),
}
VECTORS = {  # shape, minimum, maximum, type
    "pointgoal_with_gps_compass": ((2,), -NO_LIMIT, NO_LIMIT, np.float32),
    "gps": ((2,), -NO_LIMIT, NO_LIMIT, np.float32),
    "compass": ((1,), -np.pi, np.pi, np.float32),
    "heading": ((1,), -np.pi, np.pi, np.float32),
    "objectgoal": ((1,), 0, 32767, np.int64),
}


class HabitatSimActions(IntEnum):
    """Discrete actions by number, as in Habitat; capital letters are aliases."""

    stop = 0
    move_forward = 1
    turn_left = 2
    turn_right = 3
    look_up = 4
    look_down = 5
    STOP = 0
    MOVE_FORWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3
    LOOK_UP = 4
    LOOK_DOWN = 5


def polar_goal(goal: Float[Array, "*n 4"]) -> Float[Array, "*n 2"]:
    """Return `pointgoal_with_gps_compass` of the observation `goal`: plan distance [m], bearing [rad], left positive.

    The bearing is 0 where the distance is 0.
    """
    bearing = jnp.where(goal[..., 0] > 0, jnp.arctan2(goal[..., 2], goal[..., 1]), 0.0)
    return jnp.stack([goal[..., 0], bearing], axis=-1)


def heading_of(state: Float[Array, "*n 10"]) -> Float[Array, "*n 1"]:
    """Return `heading` [rad] of the observation `state`: the turn to the left from Habitat's -z, which is our +y."""
    return jnp.arctan2(-state[..., 3:4], state[..., 4:5])


def normalize_depth(depth: Float[Array, "*n"], low: float, high: float) -> Float[Array, "*n"]:
    """Return depths [m] clipped to `low` to `high`, scaled to 0 to 1."""
    return (jnp.clip(depth, low, high) - low) / (high - low)


def convert(names: Sequence[str], obs: Mapping[str, Array], min_depth: float, max_depth: float) -> dict[str, Array]:
    """Return observations by Habitat's names, of one environment or a batch, also inside `jit`.

    Args:
        names: Names of the observations, of `SENSORS`; `EPISODE_SENSORS` are left out.
        obs: Observations of an environment with the sensors behind them.
        min_depth: Depth that becomes 0 [m].
        max_depth: Depth that becomes 1 [m].
    """
    found = {
        "rgb": lambda: obs[observation_name("head", "rgb")],
        "depth": lambda: normalize_depth(obs[observation_name("head", "depth")], min_depth, max_depth),
        "semantic": lambda: jnp.maximum(obs[observation_name("head", "instance")], 0)[..., None],
        "pointgoal_with_gps_compass": lambda: polar_goal(obs["goal"]),
        "gps": lambda: obs["gps"][..., :2] * jnp.array([1.0, -1.0], jnp.float32),  # forward, right
        "compass": lambda: jnp.arctan2(obs["compass"][..., 1:], obs["compass"][..., :1]),
        "heading": lambda: heading_of(obs["state"]),
        "objectgoal": lambda: _object_goal(obs["goal_words"]),
    }
    return {name: found[name]() for name in names if name not in EPISODE_SENSORS}


def _object_goal(words: Int[Array, "*n words"]) -> Int[Array, "*n 1"]:
    """Return the number of the coarse category to find, of `Semantic.COARSE`; 0 for other goals."""
    return jnp.maximum(words[..., Attribute.COARSE, None], 0)


def make_space(names: Sequence[str], specs: Specs) -> gymnasium.spaces.Dict:
    """Return the space of the observations of one environment, whose own specs give the image size."""
    box, spaces = gymnasium.spaces.Box, {}
    for name in names:
        if name in VECTORS:
            shape, low, high, dtype = VECTORS[name]
            spaces[name] = box(low, high, shape, dtype)
            continue
        rows, columns = specs[observation_name("head", SENSORS[name])].shape[:2]
        channels, high, dtype = IMAGES.get(name, (1, np.iinfo(np.int32).max, np.int32))
        spaces[name] = box(0, high, (rows, columns, channels), dtype)
    return gymnasium.spaces.Dict(spaces)


def to_host(obs: Mapping[str, Any], space: gymnasium.spaces.Dict) -> dict[str, np.ndarray]:
    """Return copies of observations in the types of their space."""
    return {name: np.array(value, space[name].dtype) for name, value in obs.items()}


def action_index(action: Any, names: Sequence[str]) -> int:
    """Return the number of an action: an integer, an array of one, a name, or a dictionary with `action`.

    Raises:
        ConfigError: There is no such action.

    Example:
        >>> action_index({"action": "MOVE_FORWARD"}, ("stop", "move_forward"))
        1
    """
    if isinstance(action, Mapping):
        check_known("key of an action", action, ("action", "action_args"))
        action = action.get("action")
    if isinstance(action, str):
        check_known("action", [action.lower()], names)
        return names.index(action.lower())
    number = np.asarray(action)
    if number.size != 1 or number.dtype.kind not in "iu" or not 0 <= number.item() < len(names):
        raise ConfigError(f"expected an action of 0 to {len(names) - 1}, got {action!r}", hint=", ".join(names))
    return int(number.item())


def measures(metrics: Mapping[str, Any], num_steps: int, collisions_before: float) -> dict[str, Any]:
    """Return Habitat's measures of one environment as Python numbers.

    Args:
        metrics: Metrics of the environment after a step.
        num_steps: Number of steps since the reset.
        collisions_before: Number of collisions before the step.
    """
    count = float(metrics["collisions"])
    return {
        "distance_to_goal": float(metrics["distance"]),
        "success": float(metrics["success"]),
        "spl": float(metrics["spl"]),
        "soft_spl": float(metrics["soft_spl"]),
        "num_steps": num_steps,
        "collisions": {"count": int(count), "is_collision": count > collisions_before},
    }
