"""Phrases for things and rooms, and the fewest words by which one thing is meant alone."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.vocabulary import spoken
from home_mjx.tasks.rules.house_view import Thing
from home_mjx.tasks.rules.words import Word

# Words that tell things apart, in the order in which people prefer them: Dale and Reiter, "Computational
# Interpretations of the Gricean Maxims in the Generation of Referring Expressions", Cognitive Science 19, 1995.
TELLING = (Word.COLOR, Word.SIZE, Word.MATERIAL, Word.ROOM_TYPE)
COLUMN = {
    Word.FINE: Semantic.FINE,
    Word.COARSE: Semantic.COARSE,
    Word.COLOR: Semantic.BASIC,
    Word.SIZE: Semantic.SIZE,
    Word.MATERIAL: Semantic.MATERIAL,
    Word.ROOM_TYPE: Semantic.ROOM_TYPE,
}
BEFORE_NOUN = (Word.SIZE, Word.COLOR, Word.MATERIAL)


def name(word: Word, value: int) -> str:
    """How a value of a word is said.

    Example:
        >>> name(Word.SIZE, 3)
        'large'
    """
    return spoken(vocabularies()[COLUMN[word]][value])


def phrase(meant: dict[Word, int], article: str = "the") -> str:
    """A phrase for what has these words in common.

    Example:
        >>> phrase({Word.COARSE: 11, Word.SIZE: 3, Word.ROOM_TYPE: 1})
        'the large chair in the kitchen'
    """
    noun = next((word for word in (Word.FINE, Word.COARSE) if word in meant), None)
    parts = [article, *(name(word, meant[word]) for word in BEFORE_NOUN if word in meant)]
    parts += [name(noun, meant[noun])] if noun is not None else ["thing"]
    if Word.ROOM_TYPE in meant:
        parts += ["in", "the", name(Word.ROOM_TYPE, meant[Word.ROOM_TYPE])]
    return " ".join(parts)


def has(thing: Thing, word: Word, value: int) -> bool:
    """Whether a thing has a word; of colours any of its main ones counts."""
    columns = (Semantic.BASIC, Semantic.BASIC_2, Semantic.BASIC_3) if word == Word.COLOR else (COLUMN[word],)
    return any(thing.word(column) == value for column in columns)


def fitting(things: Sequence[Thing], meant: dict[Word, int]) -> list[Thing]:
    """The things that have all of some words."""
    return [thing for thing in things if all(has(thing, word, value) for word, value in meant.items())]


def telling(things: Sequence[Thing], thing: Thing, random: np.random.Generator) -> dict[Word, int] | None:
    """The fewest words that mean this thing alone; None: there are none.

    Where several sets of words are as few, one of them is drawn.
    """
    alone = fewest(things, thing)
    return alone[int(random.integers(len(alone)))] if alone else None


def fewest(things: Sequence[Thing], thing: Thing, telling: Sequence[Word] = TELLING) -> list[dict[Word, int]]:
    """All sets of the fewest words, of those by which things are told apart, that mean this thing alone."""
    noun = {Word.COARSE: thing.word(Semantic.COARSE)}
    known = [word for word in telling if thing.word(COLUMN[word]) >= 0]
    for count in range(len(known) + 1):
        sets = [noun | {word: thing.word(COLUMN[word]) for word in chosen} for chosen in combinations(known, count)]
        alone = [words for words in sets if fitting(things, words) == [thing]]
        if alone:
            return alone
    return []
