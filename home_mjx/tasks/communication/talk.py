"""Speech columns of rows: the correct answer, the replies of an oracle, the recipients of the instruction."""

from collections.abc import Mapping, Sequence

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

NUM_REPLIES = 6  # maximum number of questions that the oracle of a row answers
NONE = -1  # token of no word
EVERYBODY = -1


class Talk(Pytree):
    """Speech columns of a row, or of t rows; words are tokens, -1 if none."""

    answer: Int[Array, "*t"]  # to the row's question; word that instructed agents say to the others
    told: Int[Array, "*t"]  # bit mask of the agents that receive the instruction; -1: all
    ask: Int[Array, "*t"]  # number of oracle questions, from the first, that identify the target
    oracle: Int[Array, "*t q 2"]  # questions and replies of the oracle


def written_talk(
    answer: int = NONE, told: Sequence[int] | None = None, oracle: Sequence[tuple[int, int]] = (), ask: int = 0
) -> dict[str, np.ndarray]:
    """Pack speech options into the arrays of a `Talk`.

    Args:
        answer: Token of the correct answer.
        told: Indices of the agents that receive the instruction; None: all.
        oracle: Pairs of tokens: question and reply.
        ask: Number of oracle questions, from the first, that suffice to identify the target.

    Raises:
        ConfigError: There are more than `NUM_REPLIES` questions, or fewer than `ask`.

    Example:
        >>> written_talk(told=(1,))["told"].tolist()
        2
    """
    if not ask <= len(oracle) <= NUM_REPLIES:
        raise ConfigError(f"an oracle must have {ask} to {NUM_REPLIES} replies, got {len(oracle)}")
    table = np.full((NUM_REPLIES, 2), NONE, np.int16)
    table[: len(oracle)] = np.array(oracle, np.int16).reshape(-1, 2)
    bits = EVERYBODY if told is None else sum(1 << agent for agent in set(told))
    numbers = {"answer": np.int16(answer), "told": np.int16(bits), "ask": np.int8(ask)}
    return {name: np.asarray(value) for name, value in numbers.items()} | {"oracle": table}


def talk_of(columns: Mapping[str, Array]) -> Talk:
    """Extract the speech columns of one or many rows."""
    return Talk(**{name: columns[name].astype(jnp.int32) for name in Talk.__dataclass_fields__})


def replies(talk: Talk, said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return the oracle's reply to each agent; -1 if the agent did not say one of the oracle's questions.

    Example:
        >>> talk = talk_of({k: jnp.asarray(v) for k, v in written_talk(oracle=[(7, 9)]).items()})
        >>> replies(talk, jnp.array([7, 8, -1])).tolist()
        [9, -1, -1]
    """
    match = (said[:, None] == talk.oracle[None, :, 0]) & (said[:, None] >= 0)
    found = jnp.take(talk.oracle[:, 1], jnp.argmax(match, axis=1))
    return jnp.where(jnp.any(match, axis=1), found, NONE)


def is_told(talk: Talk, num_agents: int) -> Bool[Array, " a"]:
    """Return which agents receive the instruction."""
    return (jnp.right_shift(talk.told, jnp.arange(num_agents)) & 1) == 1


def of_others(said: Int[Array, " a"]) -> Int[Array, " a"]:
    """Return for each agent the word of the first other agent that spoke; -1 if none did.

    Example:
        >>> of_others(jnp.array([-1, 5, 6])).tolist()
        [5, 6, 5]
    """
    num = said.shape[0]
    speaks = (said[None] >= 0) & ~jnp.eye(num, dtype=bool)
    return jnp.where(jnp.any(speaks, axis=1), said[jnp.argmax(speaks, axis=1)], NONE)


def as_observed(words: Int[Array, " a"]) -> Int[Array, "a 1"]:
    """Convert one word of each agent to its observation, with the padding token 0 for silence."""
    return jnp.maximum(words, 0)[:, None]
