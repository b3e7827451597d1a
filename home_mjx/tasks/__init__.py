"""Environments: tasks in houses with observations, rewards and resets; extension points for tasks and sensors.

The tasks themselves are in `home_mjx.tasks.suite`, the parts of own ones in `home_mjx.tasks.rules`.
"""

from home_mjx.tasks.base.config import AgentCamera, EnvConfig
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.sensor import Sensor, register_sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, DiscreteActions
from home_mjx.tasks.base.state import EnvParams, Episodes, State
from home_mjx.tasks.base.status import Status, StatusError, check_status
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.episodes import load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.memory import estimate_memory
from home_mjx.tasks.env.state_io import dump_flagged, load_flagged, load_states, save_states
from home_mjx.tasks.experts.expert_observation import ExpertObservationEnv, add_expert
from home_mjx.tasks.experts.path_follower import expert_action
from home_mjx.tasks.rules.row_task import RowTask
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.suite.task_io import load_tasks, save_tasks
from home_mjx.tasks.variation.ranges import Variation

__all__ = [
    "AgentCamera",
    "ArraySpec",
    "AutoReset",
    "DiscreteActions",
    "Env",
    "EnvConfig",
    "EnvParams",
    "Episodes",
    "ExpertObservationEnv",
    "HouseholdEnv",
    "RowTask",
    "Sensor",
    "Snapshot",
    "State",
    "Status",
    "StatusError",
    "Task",
    "TaskBank",
    "Variation",
    "add_expert",
    "check_status",
    "dump_flagged",
    "estimate_memory",
    "expert_action",
    "load_episodes",
    "load_flagged",
    "load_states",
    "load_tasks",
    "make_config",
    "register_sensor",
    "sample_episodes",
    "save_episodes",
    "save_states",
    "save_tasks",
]
