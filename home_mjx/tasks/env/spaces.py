"""Gymnasium spaces of an environment's observations and actions."""

import gymnasium
import numpy as np

from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.env.env import Env


def observation_space(env: Env) -> gymnasium.spaces.Dict:
    """Return a dictionary space with one box per observation; with several agents, each has a leading agent axis."""
    return gymnasium.spaces.Dict({name: make_gym_box(spec) for name, spec in env.observation_spec.items()})


def action_space(env: Env) -> gymnasium.Space:
    """Return a Box in [-1, 1] or Discrete; for several agents, a Box with a leading agent axis or MultiDiscrete."""
    if env.num_agents == 1:
        return agent_action_space(env)
    if env.config.discrete is None:
        return make_gym_box(env.action_spec)
    return gymnasium.spaces.MultiDiscrete([env.action_size] * env.num_agents)


def agent_action_space(env: Env) -> gymnasium.Space:
    """Return the action space of one agent: a box, or discrete actions."""
    if env.config.discrete is not None:
        return gymnasium.spaces.Discrete(env.action_size)
    return make_gym_box(env.action_spec.for_one_agent(env.num_agents))


def make_gym_box(spec: ArraySpec) -> gymnasium.spaces.Box:
    """Return the box of one array; booleans become int8 from 0 to 1, because Gymnasium has no box of booleans."""
    dtype = np.dtype("int8") if spec.dtype == "bool" else np.dtype(spec.dtype)
    low, high = (np.asarray(bound, dtype) for bound in spec.bounds())
    return gymnasium.spaces.Box(low, high, spec.shape, dtype.type)
