"""Gymnasium spaces of an environment's specs."""

import gymnasium
import numpy as np

from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.environment.bound import BoundEnv


def observation_space(env: BoundEnv) -> gymnasium.spaces.Dict:
    """One box per observation."""
    return gymnasium.spaces.Dict({name: box(spec) for name, spec in env.observation_spec.items()})


def action_space(env: BoundEnv) -> gymnasium.spaces.Box:
    """Forward, left, turn left and look up, each in [-1, 1]; a leading agent axis for several agents."""
    return box(env.action_spec)


def box(spec: ArraySpec) -> gymnasium.spaces.Box:
    """The space of one array; booleans become 0 and 1 in int8, as Gymnasium has no box of booleans."""
    dtype = np.dtype("int8") if spec.dtype == "bool" else np.dtype(spec.dtype)
    low, high = (np.asarray(bound, dtype) for bound in spec.bounds())
    return gymnasium.spaces.Box(low, high, spec.shape, dtype.type)
