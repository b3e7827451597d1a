"""Metrics and baselines of tasks: top-down maps, and the accuracy of agents that only read questions."""

from home_mjx.tasks.metrics.question_baselines import chance_accuracy, prior_accuracy
from home_mjx.tasks.metrics.top_down import CellOccupancy, MapMemory, TopDownMap, top_down_map, update_map_memory

__all__ = [
    "CellOccupancy",
    "MapMemory",
    "TopDownMap",
    "chance_accuracy",
    "prior_accuracy",
    "top_down_map",
    "update_map_memory",
]
