"""Environments: tasks in houses with observations, rewards and resets; extension points for tasks and sensors."""

from home_mjx.tasks.base.config import DEFAULT_SENSORS, SENSORS, AgentCamera, EnvConfig
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.base.sensor import Sensor, register_sensor
from home_mjx.tasks.base.snapshot import BodyContacts, ContactSemantics, Snapshot, contact_semantics
from home_mjx.tasks.base.specs import ArraySpec, DiscreteActions
from home_mjx.tasks.base.state import EnvParams, Episodes, State, World
from home_mjx.tasks.base.status import Status, StatusError, check_status
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.bound import Env
from home_mjx.tasks.env.episodes import load_episodes, sample_episodes, save_episodes
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.memory import MemoryEstimate, estimate_memory
from home_mjx.tasks.env.saved import dump_flagged, load_flagged, load_states, save_states
from home_mjx.tasks.experts.teacher import ExpertObservationEnv, add_expert
from home_mjx.tasks.experts.walk import expert_action
from home_mjx.tasks.language.splits import mask_new_combinations, mask_words
from home_mjx.tasks.language.vocabulary import detokenize, tokenize
from home_mjx.tasks.metrics.question_baselines import chance_accuracy, prior_accuracy
from home_mjx.tasks.metrics.top_down import CellOccupancy, MapMemory, TopDownMap, top_down_map, update_map_memory
from home_mjx.tasks.questions.communication import Communication
from home_mjx.tasks.questions.dialogue import Dialogue
from home_mjx.tasks.questions.house_qa import HouseQA
from home_mjx.tasks.questions.vqa import VQA
from home_mjx.tasks.rules.build import TaskRow, build_task_bank
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.row_task import RowState, RowTask
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.rules.words import FAILURE, SUCCESS, Feature
from home_mjx.tasks.scripted_agents.exploration import Exploration, ExplorationState
from home_mjx.tasks.scripted_agents.pied_piper import PiedPiper, PiedPiperState
from home_mjx.tasks.sounds.row import SoundEvent
from home_mjx.tasks.suite.audio_nav import AudioNav
from home_mjx.tasks.suite.handling import Fetch, Rearrange
from home_mjx.tasks.suite.instructions import InstructionFollowing
from home_mjx.tasks.suite.navigation import HouseTasks, NavigationTask, ObjectNav, PointGoals, RoomNav
from home_mjx.tasks.suite.point_nav import PointNav, PointNavState
from home_mjx.tasks.suite.task_lines import load_tasks, save_tasks
from home_mjx.tasks.variation.draw import VariationSample
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
    "BodyContacts",
    "CellOccupancy",
    "Communication",
    "Condition",
    "ContactSemantics",
    "Dialogue",
    "DiscreteActions",
    "Env",
    "EnvConfig",
    "EnvParams",
    "Episodes",
    "ExpertObservationEnv",
    "Exploration",
    "ExplorationState",
    "Feature",
    "Fetch",
    "HouseObject",
    "HouseQA",
    "HouseTasks",
    "HouseView",
    "HouseholdEnv",
    "InstructionFollowing",
    "MapMemory",
    "MemoryEstimate",
    "NavigationTask",
    "ObjectNav",
    "PiedPiper",
    "PiedPiperState",
    "PointGoals",
    "PointNav",
    "PointNavState",
    "Rearrange",
    "RoomNav",
    "RowState",
    "RowTask",
    "Selector",
    "Sensor",
    "Snapshot",
    "SoundEvent",
    "State",
    "Status",
    "StatusError",
    "Task",
    "TaskBank",
    "TaskRow",
    "TaskStage",
    "TopDownMap",
    "Transition",
    "Variation",
    "VariationSample",
    "World",
    "add_expert",
    "build_task_bank",
    "chance_accuracy",
    "check_status",
    "contact_semantics",
    "detokenize",
    "dump_flagged",
    "estimate_memory",
    "expert_action",
    "load_episodes",
    "load_flagged",
    "load_states",
    "load_tasks",
    "make_config",
    "mask_new_combinations",
    "mask_words",
    "prior_accuracy",
    "register_sensor",
    "sample_episodes",
    "save_episodes",
    "save_states",
    "save_tasks",
    "tokenize",
    "top_down_map",
    "update_map_memory",
]
