"""Environments: tasks on houses, with observations, rewards and resets."""

from home_mjx.tasks.autoreset import AutoReset
from home_mjx.tasks.config import SENSORS, AgentCamera, EnvConfig, make_config
from home_mjx.tasks.env import HouseholdEnv
from home_mjx.tasks.episodes import Episodes, load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.point_nav import PointNav
from home_mjx.tasks.state import State, World

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
