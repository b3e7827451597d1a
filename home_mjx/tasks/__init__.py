"""Environments: tasks on houses, with observations, rewards and resets; and the seams for further tasks and sensors."""

from typing import TYPE_CHECKING

from home_mjx import moved
from home_mjx.tasks.base.config import DEFAULT_SENSORS, SENSORS, AgentCamera, EnvConfig
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.base.sensor import Sensor, register_sensor
from home_mjx.tasks.base.snapshot import Snapshot, Touch, TouchMeaning, touch_meaning
from home_mjx.tasks.base.specs import ArraySpec, DiscreteActions
from home_mjx.tasks.base.state import EnvParams, Episodes, State, World
from home_mjx.tasks.base.status import Status, StatusError, check_status
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.environment.autoreset import AutoReset
from home_mjx.tasks.environment.bound import BoundEnv
from home_mjx.tasks.environment.episodes import load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.environment.household import HouseholdEnv
from home_mjx.tasks.environment.memory import MemoryEstimate, estimate_memory
from home_mjx.tasks.environment.saved import dump_flagged, load_flagged, load_states, save_states
from home_mjx.tasks.suite.point_nav import PointNav, PointNavState

__all__ = [
    "DEFAULT_SENSORS",
    "SENSORS",
    "AgentCamera",
    "AgentPose",
    "ArraySpec",
    "AutoReset",
    "BoundEnv",
    "DiscreteActions",
    "EnvConfig",
    "EnvParams",
    "Episodes",
    "HouseholdEnv",
    "MemoryEstimate",
    "PointNav",
    "PointNavState",
    "Sensor",
    "Snapshot",
    "State",
    "Status",
    "StatusError",
    "Task",
    "Touch",
    "TouchMeaning",
    "World",
    "check_status",
    "dump_flagged",
    "estimate_memory",
    "load_episodes",
    "load_flagged",
    "load_states",
    "make_config",
    "register_sensor",
    "sample_episodes",
    "save_episodes",
    "save_states",
    "touch_meaning",
]

if not TYPE_CHECKING:  # type checkers report missing names by themselves
    __getattr__ = moved.attributes_of(__name__)
