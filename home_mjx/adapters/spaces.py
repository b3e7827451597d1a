"""Gymnasium spaces of the observations and actions."""

import gymnasium
import numpy as np

from home_mjx.tasks.environment.household import HouseholdEnv

UNBOUNDED = 1e6  # metres, pressures, speeds: no house is larger; Gymnasium's checker warns about infinity


def observation_space(env: HouseholdEnv) -> gymnasium.spaces.Dict:
    """One box per observation, in the order of the environment's sensors."""
    shapes = env.observation_shapes
    return gymnasium.spaces.Dict({name: _box(env, name, leaf.shape, leaf.dtype) for name, leaf in shapes.items()})


def action_space(env: HouseholdEnv) -> gymnasium.spaces.Box:
    """Forward, left, turn left and look up, each in [-1, 1]; a leading agent axis for several agents."""
    shape = (env.action_size,) if env.num_agents == 1 else (env.num_agents, env.action_size)
    return gymnasium.spaces.Box(-1.0, 1.0, shape, np.float32)


def _box(env: HouseholdEnv, name: str, shape: tuple[int, ...], dtype: np.dtype) -> gymnasium.spaces.Box:
    low, high = _bounds(env, name)
    return gymnasium.spaces.Box(low, high, shape, np.dtype(dtype).type)


def _bounds(env: HouseholdEnv, name: str) -> tuple[float, float]:
    if name.startswith("ids/"):
        return -1, np.iinfo(np.int32).max
    kind = name.rsplit("_", 1)[-1]
    bounds = {"rgb": (0, 255), "depth": (0, env.config.depth_max), "normal": (-1, 1)}
    return bounds.get(kind, (-UNBOUNDED, UNBOUNDED))
