"""Environments: tasks on houses, with observations, rewards and resets."""

from home_mjx.tasks.base.config import SENSORS, AgentCamera, EnvConfig, make_config
from home_mjx.tasks.base.state import State, World
from home_mjx.tasks.environment.autoreset import AutoReset
from home_mjx.tasks.environment.episodes import Episodes, load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.environment.household import HouseholdEnv
from home_mjx.tasks.suite.point_nav import PointNav

__all__ = [
    "SENSORS",
    "AgentCamera",
    "AutoReset",
    "EnvConfig",
    "Episodes",
    "HouseholdEnv",
    "PointNav",
    "State",
    "World",
    "load_episodes",
    "make_config",
    "sample_episodes",
    "save_episodes",
]
