"""Referring expressions: phrases for objects and rooms, and the smallest set of words that identifies an object."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.vocabulary import spoken
from home_mjx.tasks.rules.house_view import Thing
from home_mjx.tasks.rules.words import Word

# Words that distinguish objects of a category, in the order of people's preference: Dale and Reiter, "Computational
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
    """Return the token text of a word's value.

    Example:
        >>> name(Word.SIZE, 3)
        'large'
    """
    return spoken(vocabularies()[COLUMN[word]][value])


def phrase(meant: dict[Word, int], article: str = "the") -> str:
    """Return a noun phrase for the objects that have all of these words.

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
    """Return whether an object has a word's value; for colour, any of its main colours counts."""
    columns = (Semantic.BASIC, Semantic.BASIC_2, Semantic.BASIC_3) if word == Word.COLOR else (COLUMN[word],)
    return any(thing.word(column) == value for column in columns)


def fitting(things: Sequence[Thing], meant: dict[Word, int]) -> list[Thing]:
    """Select the objects that have all of the given words."""
    return [thing for thing in things if all(has(thing, word, value) for word, value in meant.items())]


def telling(things: Sequence[Thing], thing: Thing, random: np.random.Generator) -> dict[Word, int] | None:
    """Return a smallest set of words that identifies an object; None if there is no such set.

    Among several smallest sets one is drawn at random.
    """
    alone = fewest(things, thing)
    return alone[int(random.integers(len(alone)))] if alone else None


def fewest(things: Sequence[Thing], thing: Thing, telling: Sequence[Word] = TELLING) -> list[dict[Word, int]]:
    """Return all smallest sets of words that identify an object: its category and words from `telling`."""
    noun = {Word.COARSE: thing.word(Semantic.COARSE)}
    known = [word for word in telling if thing.word(COLUMN[word]) >= 0]
    for count in range(len(known) + 1):
        sets = [noun | {word: thing.word(COLUMN[word]) for word in chosen} for chosen in combinations(known, count)]
        alone = [words for words in sets if fitting(things, words) == [thing]]
        if alone:
            return alone
    return []
