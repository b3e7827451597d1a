"""State machine of task stages: from feature values to the next stage by integer compares, the same for every task."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.tasks.rules.program import TaskProgram
from home_mjx.tasks.rules.words import NUM_CONDITIONS


def evaluate_conditions(program: TaskProgram, table: Float[Array, "feature a d d"]) -> Bool[Array, " c"]:
    """Evaluate the conditions of a program.

    Args:
        program: Program of the episode.
        table: Feature values, see `features.FeatureValues`.

    Returns:
        Whether each condition holds.
    """
    first, second = jnp.maximum(program.first, 0), jnp.maximum(program.second, 0)
    value = table[program.feature, :, first, second]  # (c, a)
    holds = (value >= program.minimum[:, None]) & (value <= program.maximum[:, None])
    own = jnp.take_along_axis(holds, jnp.clip(program.agent, 0, table.shape[1] - 1)[:, None], axis=1)[:, 0]
    return jnp.where(program.agent < 0, jnp.any(holds, axis=1), own)


def take_transition(
    program: TaskProgram, stage: Int[Array, ""], holds: Bool[Array, " c"]
) -> tuple[Int[Array, ""], Float[Array, ""], Bool[Array, ""]]:
    """Take the first transition of a stage whose conditions hold.

    Args:
        program: Program of the episode.
        stage: Present stage; an episode that has ended stays in its final stage.
        holds: Whether each condition holds.

    Returns:
        The next stage, the transition's reward, and whether a transition was taken.
    """
    bits = jnp.sum(jnp.where(holds, jnp.left_shift(1, jnp.arange(NUM_CONDITIONS)), 0)).astype(jnp.int32)
    at = jnp.maximum(stage, 0)
    require, forbid = program.require[at], program.forbid[at]
    open_ = (require >= 0) & ((bits & require) == require) & ((bits & forbid) == 0) & (stage >= 0)
    way = jnp.argmax(open_)
    taken = jnp.any(open_)
    reward = jnp.where(taken, program.reward[at, way], 0.0)
    return jnp.where(taken, program.next[at, way], stage), reward, taken
