"""Environments: tasks in houses with observations, rewards and resets; extension points for tasks and sensors."""

from home_mjx.tasks.base.config import DEFAULT_SENSORS, SENSORS, AgentCamera, EnvConfig
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.base.sensor import Sensor, register_sensor
from home_mjx.tasks.base.snapshot import Snapshot, Touch, TouchMeaning, touch_meaning
from home_mjx.tasks.base.specs import ArraySpec, DiscreteActions
from home_mjx.tasks.base.state import EnvParams, Episodes, State, World
from home_mjx.tasks.base.status import Status, StatusError, check_status
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.bound import BoundEnv
from home_mjx.tasks.env.episodes import load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.memory import MemoryEstimate, estimate_memory
from home_mjx.tasks.env.saved import dump_flagged, load_flagged, load_states, save_states
from home_mjx.tasks.experts.teacher import WithExpert, with_expert
from home_mjx.tasks.experts.walk import expert_action
from home_mjx.tasks.language.splits import mentions, new_combinations
from home_mjx.tasks.language.vocabulary import detokenize, tokenize
from home_mjx.tasks.metrics.top_down import Ground, MapMemory, TopDownMap, remember_map, top_down_map
from home_mjx.tasks.questions.balance import chance, prior_accuracy
from home_mjx.tasks.questions.communication import Communication
from home_mjx.tasks.questions.dialogue import Dialogue
from home_mjx.tasks.questions.house_qa import HouseQA
from home_mjx.tasks.questions.vqa import VQA
from home_mjx.tasks.rules.build import Row, build_task_bank
from home_mjx.tasks.rules.house_view import HouseView, Thing
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.row_task import RowState, RowTask
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.rules.words import FAILURE, SUCCESS, Feature
from home_mjx.tasks.scripted_agents.exploration import Exploration, ExplorationState
from home_mjx.tasks.scripted_agents.pied_piper import PiedPiper, PiedPiperState
from home_mjx.tasks.sounds.row import Sound
from home_mjx.tasks.suite.audio_nav import AudioNav
from home_mjx.tasks.suite.handling import Fetch, Rearrange
from home_mjx.tasks.suite.instructions import InstructionFollowing
from home_mjx.tasks.suite.navigation import HouseTasks, Navigation, ObjectNav, PointGoals, RoomNav
from home_mjx.tasks.suite.point_nav import PointNav, PointNavState
from home_mjx.tasks.suite.task_lines import load_tasks, save_tasks
from home_mjx.tasks.variation.draw import Drawn
from home_mjx.tasks.variation.ranges import Variation

__all__ = [
    "DEFAULT_SENSORS",
    "FAILURE",
    "SENSORS",
    "SUCCESS",
    "VQA",
    "AgentCamera",
    "AgentPose",
    "ArraySpec",
    "AudioNav",
    "AutoReset",
    "BoundEnv",
    "Communication",
    "Dialogue",
    "DiscreteActions",
    "Drawn",
    "EnvConfig",
    "EnvParams",
    "Episodes",
    "Exploration",
    "ExplorationState",
    "Feature",
    "Fetch",
    "Go",
    "Ground",
    "HouseQA",
    "HouseTasks",
    "HouseView",
    "HouseholdEnv",
    "InstructionFollowing",
    "MapMemory",
    "Meant",
    "MemoryEstimate",
    "Navigation",
    "ObjectNav",
    "PiedPiper",
    "PiedPiperState",
    "PointGoals",
    "PointNav",
    "PointNavState",
    "Rearrange",
    "RoomNav",
    "Row",
    "RowState",
    "RowTask",
    "Sensor",
    "Snapshot",
    "Sound",
    "Stage",
    "State",
    "Status",
    "StatusError",
    "Task",
    "TaskBank",
    "Thing",
    "TopDownMap",
    "Touch",
    "TouchMeaning",
    "Variation",
    "When",
    "WithExpert",
    "World",
    "build_task_bank",
    "chance",
    "check_status",
    "detokenize",
    "dump_flagged",
    "estimate_memory",
    "expert_action",
    "load_episodes",
    "load_flagged",
    "load_states",
    "load_tasks",
    "make_config",
    "mentions",
    "new_combinations",
    "prior_accuracy",
    "register_sensor",
    "remember_map",
    "sample_episodes",
    "save_episodes",
    "save_states",
    "save_tasks",
    "tokenize",
    "top_down_map",
    "touch_meaning",
    "with_expert",
]
