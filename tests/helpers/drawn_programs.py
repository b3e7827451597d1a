"""Random stages of a task."""

import numpy as np

from home_mjx.tasks.rules.enums import FAILURE, NUM_CONDITIONS, NUM_DESCRIPTORS, NUM_STAGES, NUM_TRANSITIONS, Feature
from home_mjx.tasks.rules.program import Condition, TaskStage, Transition

AGENTS = 3


def drawn_when(random: np.random.Generator) -> Condition:
    low, high = np.sort(random.uniform(-1, 1, 2))
    return Condition(
        Feature(int(random.integers(len(Feature)))),
        int(random.integers(NUM_DESCRIPTORS)),
        int(random.integers(NUM_DESCRIPTORS)),
        int(random.integers(-1, AGENTS)),
        float(np.float32(low)),
        float(np.float32(high)),
    )


def drawn_stages(random: np.random.Generator) -> list[TaskStage]:
    pool = [drawn_when(random) for _ in range(NUM_CONDITIONS)]

    def some() -> tuple[Condition, ...]:
        return tuple(pool[i] for i in random.permutation(NUM_CONDITIONS)[: random.integers(0, 3)])

    count = int(random.integers(1, NUM_STAGES + 1))
    return [
        TaskStage(
            tuple(
                Transition(int(random.integers(FAILURE, count)), some(), some(), float(np.float32(random.normal())))
                for _ in range(random.integers(0, NUM_TRANSITIONS + 1))
            )
        )
        for _ in range(count)
    ]
