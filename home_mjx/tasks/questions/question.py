"""Questions, and the words that answer them."""

from collections.abc import Sequence
from dataclasses import dataclass

from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.schema.categories import COARSE, ROOM_TYPES
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import COLUMN, TELLING, fewest
from home_mjx.tasks.language.vocabulary import spoken
from home_mjx.tasks.rules.house_view import Thing
from home_mjx.tasks.rules.program import Meant
from home_mjx.tasks.rules.words import Word
from home_mjx.tasks.suite.navigation import NO_GOALS

YES_NO = ("yes", "no")
MOST = 6  # maximum answer to questions of kind `count`
NOUNS = tuple(name for name in COARSE if name not in NO_GOALS)
OF_WORD = {"colour": Word.COLOR, "material": Word.MATERIAL, "size": Word.SIZE, "location": Word.ROOM_TYPE}
ANSWERS = {
    "existence": YES_NO,
    "count": tuple(str(number) for number in range(1, MOST + 1)),
    "colour": vocabularies()[Semantic.BASIC],
    "material": vocabularies()[Semantic.MATERIAL],
    "size": vocabularies()[Semantic.SIZE],
    "location": ROOM_TYPES,
    "comparison": YES_NO,
    "relation": (*YES_NO, *NOUNS),
}


@dataclass(frozen=True)
class Question:
    """Question about a house, with its answer.

    Attributes:
        kind: A key of `ANSWERS`.
        texts: Equivalent wordings; the first one is its name.
        answer: One word.
        looks: Objects or rooms to look at before answering, in this order.
    """

    kind: str
    texts: tuple[str, ...]
    answer: str
    looks: tuple[Meant, ...] = ()


def answers_to(kinds: Sequence[str]) -> tuple[str, ...]:
    """Return the words that answer questions of some kinds, without duplicates.

    Example:
        >>> answers_to(("existence", "count"))[:3]
        ('yes', 'no', '1')
    """
    return tuple(dict.fromkeys(spoken(word) for kind in kinds for word in ANSWERS[kind]))


def noun(thing: Thing) -> str:
    """Return the name of an object's coarse category."""
    return COARSE[thing.word(Semantic.COARSE)]


def askable(things: Sequence[Thing]) -> list[Thing]:
    """Select the objects that questions may be about: neither parts of the house nor of unknown category."""
    return [thing for thing in things if thing.word(Semantic.COARSE) >= 0 and noun(thing) not in NO_GOALS]


def one_of(name: str) -> str:
    """Return a category with its indefinite article.

    Example:
        >>> one_of("ottoman"), one_of("sofa")
        ('an ottoman', 'a sofa')
    """
    said = spoken(name)
    return f"{'an' if said[0] in 'aeiou' else 'a'} {said}"


def described(things: Sequence[Thing], thing: Thing, without: Sequence[Word] = ()) -> list[dict[Word, int]]:
    """Return the smallest sets of words that identify an object and are known of all objects of its category.

    Args:
        things: Objects among which it is identified.
        thing: One of them.
        without: Words that must not be used.
    """
    peers = [other for other in things if other.word(Semantic.COARSE) == thing.word(Semantic.COARSE)]
    found = fewest(things, thing, [word for word in TELLING if word not in without])
    return [words for words in found if all(peer.word(COLUMN[word]) >= 0 for peer in peers for word in words)]


def alone(things: Sequence[Thing]) -> list[Thing]:
    """Select the askable objects that are the only ones of their category, sorted by its name."""
    nouns = [thing.word(Semantic.COARSE) for thing in things]
    return sorted((t for t in askable(things) if nouns.count(t.word(Semantic.COARSE)) == 1), key=noun)


def is_on(thing: Thing, other: Thing) -> bool:
    """Return whether an object rests on another one."""
    return thing.word(Semantic.SUPPORTER) == other.object_id
