"""Vocabulary, phrases and tokens of task instructions."""

from home_mjx.tasks.language.splits import mask_new_combinations, mask_words
from home_mjx.tasks.language.text_observation import describe
from home_mjx.tasks.language.vocabulary import detokenize, tokenize

__all__ = [
    "describe",
    "detokenize",
    "mask_new_combinations",
    "mask_words",
    "tokenize",
]
