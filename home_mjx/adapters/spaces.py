"""Gymnasium spaces of an environment's specs."""

import gymnasium
import numpy as np

from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.env.bound import BoundEnv


def observation_space(env: BoundEnv) -> gymnasium.spaces.Dict:
    """One box per observation."""
    return gymnasium.spaces.Dict({name: box(spec) for name, spec in env.observation_spec.items()})


def action_space(env: BoundEnv) -> gymnasium.Space:
    """A box with every number of an action in [-1, 1], or the numbers of discrete actions; one per agent."""
    if env.num_agents == 1:
        return agent_space(env)
    if env.config.discrete is None:
        return box(env.action_spec)
    return gymnasium.spaces.MultiDiscrete([env.action_size] * env.num_agents)


def agent_space(env: BoundEnv) -> gymnasium.Space:
    """The actions of one agent: a box, or discrete ones."""
    if env.config.discrete is not None:
        return gymnasium.spaces.Discrete(env.action_size)
    return box(env.action_spec.of_one(env.num_agents))


def box(spec: ArraySpec) -> gymnasium.spaces.Box:
    """The space of one array; booleans become 0 and 1 in int8, as Gymnasium has no box of booleans."""
    dtype = np.dtype("int8") if spec.dtype == "bool" else np.dtype(spec.dtype)
    low, high = (np.asarray(bound, dtype) for bound in spec.bounds())
    return gymnasium.spaces.Box(low, high, spec.shape, dtype.type)
