"""Held-out tasks: those whose instruction has certain words, or that combine words in a held-out way.

They test compositional generalization: an agent trained on `red`, `chair` and `lamp` should understand `red lamp`.
"""

import hashlib
from collections.abc import Iterable
from typing import Any

import numpy as np
from jaxtyping import Bool, Int

from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.enums import ANY, Attribute
from home_mjx.tasks.rules.task_bank import TaskBank

SEED_RANGE = (-(2**63), 2**63 - 1)
COMBINED_ATTRIBUTES = (
    Attribute.FINE,
    Attribute.COARSE,
    Attribute.COLOR,
    Attribute.MATERIAL,
    Attribute.SIZE,
    Attribute.ROOM_TYPE,
)


def mask_words(tasks: TaskBank, words: Any) -> Bool[np.ndarray, " t"]:
    """Return a mask of the rows whose instruction has any of these words; all False without words.

    An item of several words counts as each of them.

    Raises:
        ConfigError: The vocabulary lacks a word, or `words` is no sequence of words, such as a single string.

    Example:
        >>> held_out = mask_words(tasks, ("bed", "sofa"))  # doctest: +SKIP
        >>> train, test = tasks.where(~held_out), tasks.where(held_out)  # doctest: +SKIP
    """
    if isinstance(words, str) or not isinstance(words, Iterable):
        raise ConfigError(f"expected a sequence of several words, got {words!r}", hint=f'Write ("{words}",).')
    tokens = [token for word in words for token in tokenize(word)]
    return np.asarray(np.isin(np.asarray(tasks.rows.columns["tokens"]), tokens).any(axis=-1))


def mask_new_combinations(tasks: TaskBank, fraction: float = 0.2, seed: int = 0) -> Bool[np.ndarray, " t"]:
    """Return a mask of the rows with a held-out combination of two or more words for one target.

    Only its words and the seed decide whether a combination is held out, so it is the same in all houses and tasks.

    Args:
        tasks: Task bank.
        fraction: Fraction of all combinations to hold out, from 0 to 1.
        seed: Seed of the choice of combinations.

    Raises:
        ConfigError: `fraction` or `seed` is out of range.

    Example:
        >>> held_out = mask_new_combinations(tasks)  # doctest: +SKIP
        >>> train, test = tasks.where(~held_out), tasks.where(held_out)  # doctest: +SKIP
    """
    return mask_new_descriptors(np.asarray(tasks.rows.columns["descriptor"]), fraction, seed)


def mask_new_descriptors(
    descriptors: Int[np.ndarray, "t d words"], fraction: float = 0.2, seed: int = 0
) -> Bool[np.ndarray, " t"]:
    """Return the mask of `mask_new_combinations` from the descriptors of rows (columns `Attribute`).

    Each combination is held out with probability `fraction`, by a hash. Raises `ConfigError` for numbers out of range.
    """
    check_number("fraction", fraction, 0, 1)
    check_number("seed", seed, *SEED_RANGE, integer=True)
    said = descriptors[..., list(COMBINED_ATTRIBUTES)]
    combined = (said != ANY).sum(axis=-1) >= 2
    distinct, which = np.unique(said.reshape(-1, len(COMBINED_ATTRIBUTES)), axis=0, return_inverse=True)
    held_out = np.array([_hash_to_unit(words, seed) < fraction for words in distinct], bool)
    return np.any(combined & held_out[which.reshape(combined.shape)], axis=-1)


def _hash_to_unit(words: np.ndarray, seed: int) -> float:
    """Hash words and seed to a number from 0 to 1, the same on any machine."""
    data = words.astype("<i4").tobytes() + seed.to_bytes(8, "little", signed=True)
    return int.from_bytes(hashlib.blake2b(data, digest_size=8).digest(), "little") / 2**64
