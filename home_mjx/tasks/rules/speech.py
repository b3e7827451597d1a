"""Speech of a row: the correct answer, the replies of an oracle, the recipients of the instruction."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.core.pytree import Pytree, array
from home_mjx.tasks.rules.enums import ALL_AGENTS, NO_WORD


class SpeechColumns(Pytree):
    """Speech columns of a row, or of t rows; words are tokens, -1 if none."""

    answer: Int[Array, "*t"] = array(
        "answer to the row's question; word that instructed agents say to the others",
        dtype=np.int16,
        values="token",
        fill=NO_WORD,
    )
    instructed_agents: Int[Array, "*t"] = array(
        "bit mask of the agents that receive the instruction; -1: all", dtype=np.int16, values="agents", fill=ALL_AGENTS
    )
    num_identifying_questions: Int[Array, "*t"] = array(
        "number of oracle questions, from the first, that identify the target", dtype=np.int8, values="replies", fill=0
    )
    oracle: Int[Array, "*t q 2"] = array(
        "questions and replies of the oracle", dtype=np.int16, values="token", fill=NO_WORD
    )


def oracle_replies(speech: SpeechColumns, said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return the oracle's reply to each agent; -1 if the agent did not say one of the oracle's questions.

    Of equal questions the first one is answered.

    Example:
        >>> from home_mjx.tasks.rules.declaration import extract
        >>> from home_mjx.tasks.rules.packing import pack_speech
        >>> speech = extract(SpeechColumns, {k: jnp.asarray(v) for k, v in pack_speech(oracle=[(7, 9)]).items()})
        >>> oracle_replies(speech, jnp.array([7, 8, -1])).tolist()
        [9, -1, -1]
    """
    match = (said[:, None] == speech.oracle[None, :, 0]) & (said[:, None] >= 0)
    found = jnp.take(speech.oracle[:, 1], jnp.argmax(match, axis=1))
    return jnp.where(jnp.any(match, axis=1), found, NO_WORD)


def is_instructed(speech: SpeechColumns, num_agents: int) -> Bool[Array, " a"]:
    """Return a mask of the agents that receive the instruction, by bits of `instructed_agents`; -1: all."""
    return (jnp.right_shift(speech.instructed_agents, jnp.arange(num_agents)) & 1) == 1


def words_of_others(said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return for each agent the word of the first other agent that spoke; -1 if none did.

    Example:
        >>> words_of_others(jnp.array([-1, 5, 6])).tolist()
        [5, 6, 5]
    """
    num = said.shape[0]
    speaks = (said[None] >= 0) & ~jnp.eye(num, dtype=bool)
    return jnp.where(jnp.any(speaks, axis=1), said[jnp.argmax(speaks, axis=1)], NO_WORD)


def observe_words(words: Int[Array, " a"]) -> Int[Array, "a 1"]:
    """Convert one word of each agent to its observation, with the padding token 0 for silence."""
    return jnp.maximum(words, 0)[:, None]
