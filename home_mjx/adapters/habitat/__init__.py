"""Habitat: `Env`, `RLEnv` and `VectorEnv` with Habitat's actions, sensors and measures, and its episode files.

Example:
    >>> import home_mjx.adapters.habitat as habitat  # doctest: +SKIP
    >>> env = habitat.Env(habitat.get_config("benchmark/nav/pointnav/pointnav_gibson.yaml"))  # doctest: +SKIP
"""

from home_mjx.adapters.habitat.config import HabitatConfig, get_config
from home_mjx.adapters.habitat.env import HabitatEnv as Env
from home_mjx.adapters.habitat.env import HabitatRLEnv as RLEnv
from home_mjx.adapters.habitat.episodes import (
    NavigationDataset,
    NavigationEpisode,
    NavigationGoal,
    read_dataset,
    write_dataset,
)
from home_mjx.adapters.habitat.observations import HabitatSimActions
from home_mjx.adapters.habitat.rearrange import RearrangeDataset, RearrangeEpisode, read_rearrangement
from home_mjx.adapters.habitat.rows import to_episodes, to_tasks
from home_mjx.adapters.habitat.vector import HabitatVectorEnv as VectorEnv

__all__ = [
    "Env",
    "HabitatConfig",
    "HabitatSimActions",
    "NavigationDataset",
    "NavigationEpisode",
    "NavigationGoal",
    "RLEnv",
    "RearrangeDataset",
    "RearrangeEpisode",
    "VectorEnv",
    "get_config",
    "read_dataset",
    "read_rearrangement",
    "to_episodes",
    "to_tasks",
    "write_dataset",
]
