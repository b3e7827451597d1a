"""Lower bound on the number of steps before a task can succeed."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from home_mjx.tasks.rules.words import NUM_CONDITIONS, NUM_STAGES, SUCCESS, Feature


def min_steps(columns: Mapping[str, np.ndarray]) -> Float[np.ndarray, " t"]:
    """Return the minimum number of steps before a row can succeed: the least sum of `TIME` along its stages.

    All other conditions are assumed to hold at once. inf if no sequence of transitions leads to success.

    Args:
        columns: `require`, `next`, `feature` and `minimum` of the rows, see `Program`.

    Example:
        >>> columns = {"require": np.full((1, 6, 3), -1), "next": np.full((1, 6, 3), -1)}
        >>> columns |= {"feature": np.zeros((1, 8), int), "minimum": np.zeros((1, 8))}
        >>> columns["require"][0, 0, 0] = 0b10  # success needs the second condition
        >>> columns["feature"][0, 1], columns["minimum"][0, 1] = Feature.TIME, 80.0
        >>> least_steps(columns).tolist()
        [80.0]
    """
    needs, after = columns["require"], columns["next"].astype(int)
    taken = np.where(needs >= 0, 0.0, np.inf)  # minimum number of steps before each transition
    for condition in range(NUM_CONDITIONS):
        asked = (needs >= 0) & (needs.astype(int) >> condition & 1 == 1)
        time = columns["feature"][:, condition] == Feature.TIME
        wait = np.where(time, np.maximum(columns["minimum"][:, condition], 0.0), 0.0)
        taken = np.where(asked, np.maximum(taken, wait[:, None, None]), taken)
    arrived = np.full((len(needs), NUM_STAGES), np.inf)
    arrived[:, 0] = 0.0
    for _ in range(NUM_STAGES):
        left = arrived[:, :, None] + taken
        for stage in range(NUM_STAGES):
            there = np.where(after == stage, left, np.inf).min(axis=(1, 2))
            arrived[:, stage] = np.minimum(arrived[:, stage], there)
    return np.where(after == SUCCESS, arrived[:, :, None] + taken, np.inf).min(axis=(1, 2))
