"""Embeddings of words that users bring: a registry of encoders, and their tables for the language of the tasks."""

import functools
from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.tasks.language.vocabulary import all_words

TOKEN_OBSERVATIONS = ("instruction", "reply", "heard_words")  # observations whose numbers are tokens of words
NO_ENCODER = ""  # name for embeddings that the network learns


@runtime_checkable
class TextEncoder(Protocol):
    """Interface of a user's encoder of words, such as the embeddings of a language model (host only).

    Underscores join the parts of a word, as in `living_room`; the first word is empty.

    Example:
        >>> def length(words):
        ...     return np.array([[len(word)] for word in words], np.float32)
        >>> register_text_encoder("length", length)
        >>> word_table("length").shape == (len(all_words()), 1)
        True
    """

    def __call__(self, words: Sequence[str]) -> Float[np.ndarray, "n f"]:
        """Return a row of numbers for each word, finite and near 1 in size; the same in every process."""
        ...


_REGISTRY: dict[str, TextEncoder] = {}


def register_text_encoder(name: str, encoder: TextEncoder) -> None:
    """Register an encoder for `NetworkConfig.text_encoder`; one of the same name is replaced.

    A run's files keep the name alone. Whoever loads its agent registers the encoder first, on the command line by
    `--import MODULE`.

    Raises:
        ConfigError: The name is empty.
    """
    if not name:
        raise ConfigError("a text encoder needs a name", hint='Write register_text_encoder("mine", encoder).')
    _REGISTRY[name] = encoder
    word_table.cache_clear()


@functools.lru_cache(maxsize=8)
def word_table(name: str) -> Float[np.ndarray, "n f"]:
    """Return the embeddings of all words by token, float32; cached, so do not change it.

    Raises:
        UnknownNameError: No encoder has this name.
        ConfigError: Its result is not a row of finite numbers for each word.
    """
    if name not in _REGISTRY:
        hint = f"{did_you_mean(name, _REGISTRY)} Register it first; on the command line, `--import MODULE`."
        raise UnknownNameError(f"unknown text encoder `{name}`", hint=hint)
    words = all_words()
    table = np.asarray(_REGISTRY[name](words))
    if table.ndim != 2 or len(table) != len(words) or table.dtype.kind not in "fiu" or not np.isfinite(table).all():
        message = f"text encoder `{name}` must return {len(words)} rows of finite numbers, got {table.dtype} of shape "
        raise ConfigError(f"{message}{table.shape}", element="text_encoder")
    return table.astype(np.float32)
