"""Vocabulary of the tasks' language: one token per word, the same for all houses and tasks."""

from collections.abc import Iterable, Sequence
from functools import cache

import numpy as np
from jaxtyping import Array, Int

from home_mjx.errors import ConfigError, did_you_mean
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies

PAD = 0
# Words other than names of objects and their properties. Append new ones to `LATER_WORDS`: tokens must not change.
FUNCTION_WORDS = (
    *("the", "a", "an", "is", "are", "in", "on", "of", "to", "and", "then", "before", "after", "it", "there", "any"),
    *("go", "walk", "find", "enter", "leave", "take", "pick", "up", "bring", "put", "place", "open", "close", "drop"),
    *("follow", "stop", "at", "next", "near", "with", "what", "which", "where", "how", "many", "colour", "material"),
    *("size", "made", "room", "thing", "yes", "no", "than", "larger", "smaller", "more", "fewer", "same", "as", "or"),
    *("house", "you", "do", "see", "from", "here", "first", "second", "sound", "look", "for", "your", "me", "person"),
)
NUMBERS = tuple(str(number) for number in range(11))
# After all others, so that existing tokens do not change.
LATER_WORDS = ("does", "have", "one", "ask", "tell", "number", "turn", "switch", "off", "that", "inside", "shut")
NAME_COLUMNS = (Semantic.COARSE, Semantic.FINE, Semantic.COLOR, Semantic.MATERIAL, Semantic.SIZE, Semantic.ROOM_TYPE)


def to_word(name: str) -> str:
    """Return the word for a name of a semantic vocabulary: in lower case, spaces as underscores.

    Example:
        >>> to_word("Living_Room"), to_word("decoration stone")
        ('living_room', 'decoration_stone')
    """
    return name.lower().replace(" ", "_")


@cache
def all_words() -> tuple[str, ...]:
    """Return all words in the order of their tokens; the first one is padding.

    Example:
        >>> all_words()[:3]
        ('', 'the', 'a')
    """
    named = (to_word(name) for column in NAME_COLUMNS for name in vocabularies()[column])
    return tuple(dict.fromkeys(("", *FUNCTION_WORDS, *NUMBERS, *named, *LATER_WORDS)))


@cache
def _tokens() -> dict[str, int]:
    """Return the token of each word."""
    return {word: token for token, word in enumerate(all_words())}


def tokenize(text: str) -> tuple[int, ...]:
    """Convert a text to tokens, one per word between white space; upper and lower case differ. () for an empty text.

    Raises:
        ConfigError: A word is not in the vocabulary.

    Example:
        >>> detokenize(tokenize("go to the red chair in the living_room"))
        'go to the red chair in the living_room'
    """
    unknown = [word for word in text.split() if word not in _tokens()]
    if unknown:
        raise ConfigError(f"unknown word `{unknown[0]:.100}`", hint=did_you_mean(unknown[0], all_words()))
    return tuple(_tokens()[word] for word in text.split())


def detokenize(tokens: Iterable[int] | Int[np.ndarray, " n"] | Int[Array, " n"]) -> str:
    """Convert tokens to a text, without padding.

    Raises:
        ConfigError: A token is out of range.
    """
    numbers: Sequence[int] = np.asarray(tokens).tolist()
    wrong = [number for number in numbers if not 0 <= number < len(all_words())]
    if wrong:
        raise ConfigError(f"a token must be from 0 to {len(all_words()) - 1}, got {wrong[0]}")
    return " ".join(all_words()[number] for number in numbers if number != PAD)
