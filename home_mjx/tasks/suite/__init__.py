"""Tasks: navigation, fetching, questions, dialogue, exploration; classes of the registered environments."""

from home_mjx.tasks.questions.communication import Communication
from home_mjx.tasks.questions.dialogue import Dialogue
from home_mjx.tasks.questions.house_qa import HouseQA
from home_mjx.tasks.questions.vqa import VQA
from home_mjx.tasks.scripted_agents.exploration import Exploration
from home_mjx.tasks.scripted_agents.pied_piper import PiedPiper
from home_mjx.tasks.suite.audio_nav import AudioNav
from home_mjx.tasks.suite.containers import FetchFromContainer
from home_mjx.tasks.suite.instruction_following import InstructionFollowing
from home_mjx.tasks.suite.navigation import HouseTasks, NavigationTask, ObjectNav, PointGoals, RoomNav
from home_mjx.tasks.suite.point_nav import PointNav
from home_mjx.tasks.suite.rearrangement import Fetch, Rearrange
from home_mjx.tasks.suite.toggle import Toggle

__all__ = [
    "VQA",
    "AudioNav",
    "Communication",
    "Dialogue",
    "Exploration",
    "Fetch",
    "FetchFromContainer",
    "HouseQA",
    "HouseTasks",
    "InstructionFollowing",
    "NavigationTask",
    "ObjectNav",
    "PiedPiper",
    "PointGoals",
    "PointNav",
    "Rearrange",
    "RoomNav",
    "Toggle",
]
