"""Speech columns of rows: the correct answer, the replies of an oracle, the recipients of the instruction."""

from collections.abc import Mapping, Sequence

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

NUM_REPLIES = 6  # maximum number of questions that the oracle of a row answers
NO_WORD = -1  # token of no word
ALL_AGENTS = -1


class SpeechColumns(Pytree):
    """Speech columns of a row, or of t rows; words are tokens, -1 if none."""

    answer: Int[Array, "*t"]  # to the row's question; word that instructed agents say to the others
    instructed_agents: Int[Array, "*t"]  # bit mask of the agents that receive the instruction; -1: all
    num_identifying_questions: Int[Array, "*t"]  # number of oracle questions, from the first, that identify the target
    oracle: Int[Array, "*t q 2"]  # questions and replies of the oracle


def pack_speech(
    answer: int = NO_WORD,
    instructed_agents: Sequence[int] | None = None,
    oracle: Sequence[tuple[int, int]] = (),
    num_identifying_questions: int = 0,
) -> dict[str, np.ndarray]:
    """Pack speech options into the arrays of a `SpeechColumns`.

    Args:
        answer: Token of the correct answer.
        instructed_agents: Indices of the agents that receive the instruction; None: all.
        oracle: Pairs of tokens: question and reply.
        num_identifying_questions: Number of oracle questions, from the first, that suffice to identify the target.

    Raises:
        ConfigError: There are more than `NUM_REPLIES` questions, or fewer than `num_identifying_questions`.

    Example:
        >>> written_talk(instructed_agents=(1,))["instructed_agents"].tolist()
        2
    """
    if not num_identifying_questions <= len(oracle) <= NUM_REPLIES:
        raise ConfigError(
            f"an oracle must have {num_identifying_questions} to {NUM_REPLIES} replies, got {len(oracle)}"
        )
    table = np.full((NUM_REPLIES, 2), NO_WORD, np.int16)
    table[: len(oracle)] = np.array(oracle, np.int16).reshape(-1, 2)
    bits = ALL_AGENTS if instructed_agents is None else sum(1 << agent for agent in set(instructed_agents))
    numbers = {
        "answer": np.int16(answer),
        "instructed_agents": np.int16(bits),
        "num_identifying_questions": np.int8(num_identifying_questions),
    }
    return {name: np.asarray(value) for name, value in numbers.items()} | {"oracle": table}


def extract_speech(columns: Mapping[str, Array]) -> SpeechColumns:
    """Extract the speech columns of one or many rows."""
    return SpeechColumns(**{name: columns[name].astype(jnp.int32) for name in SpeechColumns.__dataclass_fields__})


def oracle_replies(talk: SpeechColumns, said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return the oracle's reply to each agent; -1 if the agent did not say one of the oracle's questions.

    Example:
        >>> talk = talk_of({k: jnp.asarray(v) for k, v in written_talk(oracle=[(7, 9)]).items()})
        >>> replies(talk, jnp.array([7, 8, -1])).tolist()
        [9, -1, -1]
    """
    match = (said[:, None] == talk.oracle[None, :, 0]) & (said[:, None] >= 0)
    found = jnp.take(talk.oracle[:, 1], jnp.argmax(match, axis=1))
    return jnp.where(jnp.any(match, axis=1), found, NO_WORD)


def is_instructed(talk: SpeechColumns, num_agents: int) -> Bool[Array, " a"]:
    """Return which agents receive the instruction."""
    return (jnp.right_shift(talk.instructed_agents, jnp.arange(num_agents)) & 1) == 1


def words_of_others(said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return for each agent the word of the first other agent that spoke; -1 if none did.

    Example:
        >>> of_others(jnp.array([-1, 5, 6])).tolist()
        [5, 6, 5]
    """
    num = said.shape[0]
    speaks = (said[None] >= 0) & ~jnp.eye(num, dtype=bool)
    return jnp.where(jnp.any(speaks, axis=1), said[jnp.argmax(speaks, axis=1)], NO_WORD)


def observe_words(words: Int[Array, " a"]) -> Int[Array, "a 1"]:
    """Convert one word of each agent to its observation, with the padding token 0 for silence."""
    return jnp.maximum(words, 0)[:, None]
