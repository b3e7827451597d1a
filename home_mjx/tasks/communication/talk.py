"""What a row says of speaking: the right answer, what an oracle replies, who is told what is to be done."""

from collections.abc import Mapping, Sequence

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

NUM_REPLIES = 6  # questions that the oracle of a row answers
NONE = -1  # token of no word
EVERYBODY = -1


class Talk(Pytree):
    """The columns of a row, or of t rows, that are about speaking; words are tokens, -1 none."""

    answer: Int[Array, "*t"]  # to the row's question; where only some agents are told, what these say to the others
    told: Int[Array, "*t"]  # bits of the agents that are told what is to be done; -1 everybody
    ask: Int[Array, "*t"]  # so many of the oracle's first questions tell apart what is meant
    oracle: Int[Array, "*t q 2"]  # questions, and what the oracle replies


def written_talk(
    answer: int = NONE, told: Sequence[int] | None = None, oracle: Sequence[tuple[int, int]] = (), ask: int = 0
) -> dict[str, np.ndarray]:
    """The arrays of a `Talk`.

    Args:
        answer: Token of the right answer.
        told: Numbers of the agents that are told what is to be done; None: all.
        oracle: Tokens of questions, and of replies.
        ask: How many of them, from the first, tell apart what is meant.

    Raises:
        ConfigError: There are more questions than a row has room for, or fewer than are to be asked.

    Example:
        >>> written_talk(told=(1,))["told"].tolist()
        2
    """
    if not ask <= len(oracle) <= NUM_REPLIES:
        raise ConfigError(f"an oracle has room for {ask} to {NUM_REPLIES} replies, got {len(oracle)}")
    table = np.full((NUM_REPLIES, 2), NONE, np.int16)
    table[: len(oracle)] = np.array(oracle, np.int16).reshape(-1, 2)
    bits = EVERYBODY if told is None else sum(1 << agent for agent in set(told))
    numbers = {"answer": np.int16(answer), "told": np.int16(bits), "ask": np.int8(ask)}
    return {name: np.asarray(value) for name, value in numbers.items()} | {"oracle": table}


def talk_of(columns: Mapping[str, Array]) -> Talk:
    """What the columns of a row, or of many, say of speaking."""
    return Talk(**{name: columns[name].astype(jnp.int32) for name in Talk.__dataclass_fields__})


def replies(talk: Talk, said: Int[Array, " a"]) -> Int[Array, " a"]:
    """What the oracle replies to each agent; -1 nothing, as it was asked nothing that it knows.

    Example:
        >>> talk = talk_of({k: jnp.asarray(v) for k, v in written_talk(oracle=[(7, 9)]).items()})
        >>> replies(talk, jnp.array([7, 8, -1])).tolist()
        [9, -1, -1]
    """
    match = (said[:, None] == talk.oracle[None, :, 0]) & (said[:, None] >= 0)
    found = jnp.take(talk.oracle[:, 1], jnp.argmax(match, axis=1))
    return jnp.where(jnp.any(match, axis=1), found, NONE)


def is_told(talk: Talk, num_agents: int) -> Bool[Array, " a"]:
    """Which agents are told what is to be done."""
    return (jnp.right_shift(talk.told, jnp.arange(num_agents)) & 1) == 1


def of_others(said: Int[Array, " a"]) -> Int[Array, " a"]:
    """What each agent hears of the others: the word of the first one that has spoken; -1 nobody has.

    Example:
        >>> of_others(jnp.array([-1, 5, 6])).tolist()
        [5, 6, 5]
    """
    num = said.shape[0]
    speaks = (said[None] >= 0) & ~jnp.eye(num, dtype=bool)
    return jnp.where(jnp.any(speaks, axis=1), said[jnp.argmax(speaks, axis=1)], NONE)


def as_observed(words: Int[Array, " a"]) -> Int[Array, "a 1"]:
    """One word of each agent as it is observed: silence is the token of padding, 0."""
    return jnp.maximum(words, 0)[:, None]
