"""Parts of tasks whose episodes are rows of a task bank: selectors, conditions, stages, sounds and houses."""

from home_mjx.tasks.rules.build_bank import TaskGenerator, TaskRow, build_task_bank
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.sounds.sound_events import SoundEvent

__all__ = [
    "FAILURE",
    "SUCCESS",
    "Condition",
    "Feature",
    "HouseObject",
    "HouseView",
    "Selector",
    "SoundEvent",
    "TaskGenerator",
    "TaskRow",
    "TaskStage",
    "Transition",
    "build_task_bank",
]
