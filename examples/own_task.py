"""Define a task: a class that generates rows, each with the objects it refers to and its conditions."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import home_mjx
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import add_expert
from home_mjx.tasks.rules import (
    FAILURE,
    SUCCESS,
    Condition,
    Feature,
    HouseView,
    Selector,
    TaskRow,
    TaskStage,
    Transition,
)
from home_mjx.tasks.suite import NavigationTask
from home_mjx.training import evaluate, expert_policy


@dataclass(frozen=True)
class HurryToBed(NavigationTask):
    """Reach a bed within a time limit.

    Attributes:
        most_steps: Maximum number of steps; more are a failure.
    """

    most_steps: int = 150

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield one task per bed; start poses are sampled by the environment."""
        near, late = Condition(Feature.DISTANCE, 0, maximum=1.0), Condition(Feature.TIME, minimum=self.most_steps)
        for thing in view.objects:
            if thing.semantic(Semantic.COARSE) == COARSE.index("bed"):
                stage = TaskStage((Transition(SUCCESS, (near,), reward=1.0), Transition(FAILURE, (late,))), guide=0)
                yield TaskRow([Selector.objects(object_id=thing.object_id)], [stage])


home_mjx.use_compile_cache()
home_mjx.register("HurryToBed-v0", HurryToBed, {"actions": "discrete"})
env = home_mjx.make("HurryToBed-v0", num_houses=2, sensors=("state",), impl="kinematic", min_length=2.0)
figures = evaluate(add_expert(env), expert_policy, num_episodes=16)
print(f"expert: success {figures['success'].mean():.2f} in {figures['episode_steps'].mean():.0f} steps")
