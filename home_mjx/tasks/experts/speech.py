"""Speech of experts."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.actions import spoken_tokens
from home_mjx.tasks.rules.enums import NO_WORD, Feature
from home_mjx.tasks.rules.program import needs_only
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.rules.speech import is_instructed

REPEAT_PERIOD = 4  # [steps] between words of an informed agent, which walks out of the others' way in between


def insert_words(snapshot: Snapshot, state: RowState, values: Float[Array, "feature a d d"], actions: Array) -> Array:
    """Return actions of all agents, replaced by the speech action (index) of its next word where an agent has one.

    `values` are those of `features.FeatureValues`. Without speech actions nothing changes.
    """
    config = snapshot.config
    if not config.speech:
        return actions
    said = next_words(snapshot, state, values)
    match = jnp.asarray(spoken_tokens(config)[:-1]) == said[:, None]
    return jnp.where(jnp.any(match, axis=1) & (said >= 0), jnp.argmax(match, axis=1).astype(jnp.int32), actions)


def next_words(snapshot: Snapshot, state: RowState, values: Float[Array, "feature a d d"]) -> Int[Array, " a"]:
    """Return the token that each agent should say now; -1 none.

    All agents say the answer once `has_answer` is True. Before that, informed agents repeat it every `REPEAT_PERIOD`
    steps if others lack the instruction. Else agent 0 asks the identifying questions that the oracle has not answered.
    """
    talk, agents = state.speech, values.shape[1]
    told = is_instructed(talk, agents)
    tells = told & ~jnp.all(told) & (snapshot.step % REPEAT_PERIOD == 0)
    says = (tells | has_answer(state, values)) & (talk.answer >= 0)
    question = jnp.take(talk.oracle[:, 0], jnp.minimum(state.num_questions, talk.oracle.shape[0] - 1))
    asks = (state.num_questions < talk.num_identifying_questions) & (jnp.arange(agents) == 0)
    return jnp.where(says, talk.answer, jnp.where(asks, question, NO_WORD))


def has_answer(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether the stage can only end the task, and needs only that the answer is said; same for all agents."""
    program = state.program
    said = values.at[Feature.SAID].set(state.speech.answer.astype(jnp.float32))
    at = jnp.maximum(state.stage, 0)
    more = jnp.any((program.require[at] >= 0) & (program.next[at] >= 0))
    return needs_only(program, state.stage, values, said) & ~more
