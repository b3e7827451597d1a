"""Questions, and the words that answer them."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from home_mjx.schema.categories import COARSE, ROOM_TYPES
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.phrases import DISTINGUISHING_ATTRIBUTES, SEMANTIC_COLUMN, minimal_identifying_words
from home_mjx.tasks.language.vocabulary import to_word
from home_mjx.tasks.rules.enums import Attribute
from home_mjx.tasks.rules.house_view import HouseObject
from home_mjx.tasks.rules.program import Selector
from home_mjx.tasks.suite.navigation import EXCLUDED_CATEGORIES

YES_NO = ("yes", "no")
MAX_COUNT = 6  # maximum answer to questions of kind `count`
NOUNS = tuple(name for name in COARSE if name not in EXCLUDED_CATEGORIES)
ATTRIBUTE_OF_KIND = {
    "color": Attribute.COLOR,
    "material": Attribute.MATERIAL,
    "size": Attribute.SIZE,
    "location": Attribute.ROOM_TYPE,
}
ANSWERS = {
    "existence": YES_NO,
    "count": tuple(str(number) for number in range(1, MAX_COUNT + 1)),
    "color": vocabularies()[Semantic.COLOR],
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
    looks: tuple[Selector, ...] = ()


def answers_to(kinds: Sequence[str]) -> tuple[str, ...]:
    """Return the words that answer questions of some kinds, without duplicates.

    Example:
        >>> answers_to(("existence", "count"))[:3]
        ('yes', 'no', '1')
    """
    return tuple(dict.fromkeys(to_word(word) for kind in kinds for word in ANSWERS[kind]))


def askable_objects(things: Sequence[HouseObject]) -> list[HouseObject]:
    """Select the objects that questions may be about: neither parts of the house nor of unknown category."""
    return [thing for thing in things if thing.coarse not in EXCLUDED_CATEGORIES]


def indefinite_noun(name: str) -> str:
    """Return a category with its indefinite article: `an` before a, e, i, o or u.

    Example:
        >>> indefinite_noun("ottoman"), indefinite_noun("sofa")
        ('an ottoman', 'a sofa')
    """
    said = to_word(name)
    return f"{'an' if said[0] in 'aeiou' else 'a'} {said}"


def identifying_words(
    things: Sequence[HouseObject], thing: HouseObject, without: Sequence[Attribute] = ()
) -> list[dict[Attribute, int]]:
    """Return all smallest sets of attribute values that identify an object among `things`; [] if there are none.

    Sets with attributes that are unknown for any object of its category, and words of `without`, are excluded.
    """
    peers = [other for other in things if other.semantic(Semantic.COARSE) == thing.semantic(Semantic.COARSE)]
    found = minimal_identifying_words(
        things, thing, [word for word in DISTINGUISHING_ATTRIBUTES if word not in without]
    )
    return [
        words for words in found if all(peer.semantic(SEMANTIC_COLUMN[word]) >= 0 for peer in peers for word in words)
    ]


def unique_objects(things: Sequence[HouseObject]) -> list[HouseObject]:
    """Select the askable objects that are the only ones of their category, sorted by its name."""
    counts = Counter(thing.coarse for thing in things)
    return sorted((t for t in askable_objects(things) if counts[t.coarse] == 1), key=lambda thing: thing.coarse)


def is_on(thing: HouseObject, other: HouseObject) -> bool:
    """Return whether `thing` rests on `other` by its semantics, not by bounds."""
    return thing.semantic(Semantic.SUPPORTER) == other.object_id
