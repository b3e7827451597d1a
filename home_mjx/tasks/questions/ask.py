"""Generation of all questions that a house can answer, by kind."""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, permutations

import numpy as np

from home_mjx.schema.categories import COARSE, ROOM_TYPES
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import COLUMN, name, phrase
from home_mjx.tasks.language.vocabulary import spoken
from home_mjx.tasks.questions.question import (
    MOST,
    NOUNS,
    OF_WORD,
    YES_NO,
    Question,
    alone,
    askable,
    described,
    is_on,
    noun,
    one_of,
)
from home_mjx.tasks.rules.house_view import HouseView, Thing
from home_mjx.tasks.rules.program import Meant
from home_mjx.tasks.rules.words import Word

MARGIN = 2.0  # minimum ratio of the volumes of bounds in questions about size
NEXT_TO, AWAY = 0.3, 1.5  # [m] maximum gap between bounds next to each other; minimum gap otherwise
SMALL = (
    *("vase", "indoor_lamp", "television", "computer", "music", "books", "plant", "kitchen_appliance", "toy", "candle"),
    *("clock", "decoration", "kitchenware", "household_appliance", "picture_frame", "trinket", "magazines", "pillow"),
)
ATTRIBUTES = {
    "colour": ("what colour is {}", "what is the colour of {}"),
    "material": ("what is {} made of", "of which material is {}"),
    "size": ("what size is {}", "what is the size of {}"),
    "location": ("in which room is {}", "where is {}"),
}


def attributes(things: Sequence[Thing], kind: str, about: Sequence[Thing] | None = None) -> Iterator[Question]:
    """Yield questions about an attribute of single objects, or about the room they are in.

    Args:
        things: Objects among which a phrase must identify one.
        kind: A key of `ATTRIBUTES`.
        about: Objects to ask about; None: all.
    """
    word = OF_WORD[kind]
    for thing in askable(things if about is None else about):
        value = thing.word(COLUMN[word])
        several = word == Word.COLOR and thing.word(Semantic.BASIC_2) >= 0  # more than one main colour
        if value < 0 or several:
            continue
        for words in described(things, thing, (word,)):
            texts = tuple(text.format(phrase(words)) for text in ATTRIBUTES[kind])
            yield Question(kind, texts, name(word, value), (Meant.of(words),))


def rooms(view: HouseView) -> list[tuple[int, int]]:
    """Return index and type of the rooms that are unique in their type."""
    types = view.room_types.tolist()
    return [(room, kind) for room, kind in enumerate(types) if kind >= 0 and types.count(kind) == 1]


def in_rooms(view: HouseView) -> Iterator[tuple[str, int, int]]:
    """Yield an object category, a room type, and the number of objects of the category in that room.

    Only for rooms that are unique in their type, and for categories whose objects are all visible and in a room.
    """
    things: dict[str, list[Thing]] = {name: [] for name in NOUNS}
    for thing in askable(view.things):
        things[noun(thing)].append(thing)
    known = {name for name, own in things.items() if all(view.can_be_seen(t) and _is_in_room(t) for t in own)}
    for (room, kind), category in ((r, c) for r in rooms(view) for c in sorted(known)):
        yield category, kind, sum(thing.word(Semantic.ROOM) == room for thing in things[category])


def _is_in_room(thing: Thing) -> bool:
    return thing.word(Semantic.ROOM) >= 0


def existence(view: HouseView) -> Iterator[Question]:
    """Yield questions about the presence of a category in a room."""
    for category, kind, number in in_rooms(view):
        place = spoken(ROOM_TYPES[kind])
        texts = f"is there {one_of(category)} in the {place}", f"does the {place} have {one_of(category)}"
        yield Question("existence", texts, YES_NO[number == 0], (Meant.space(room_type=kind),))


def count(view: HouseView) -> Iterator[Question]:
    """Yield questions about the number of objects of a category in a room."""
    for category, kind, number in in_rooms(view):
        if 1 <= number <= MOST:
            place, thing = spoken(ROOM_TYPES[kind]), spoken(category)
            texts = f"how many {thing} are there in the {place}", f"what is the number of {thing} in the {place}"
            yield Question("count", texts, str(number), (Meant.space(room_type=kind),))


def comparison(view: HouseView) -> Iterator[Question]:
    """Yield questions that compare two objects by size or by colour."""
    own = alone(view.things)
    for a, b in permutations(own, 2):
        ratio = volume(a) / volume(b)
        if max(ratio, 1 / ratio) >= MARGIN:
            texts = f"is {the(a)} larger than {the(b)}", f"is {the(b)} smaller than {the(a)}"
            yield Question("comparison", texts, YES_NO[ratio < 1], (meant(a), meant(b)))
    for a, b in combinations(own, 2):
        if is_plain(a) and is_plain(b):
            texts = f"is {the(a)} the same colour as {the(b)}", f"do {the(a)} and {the(b)} have the same colour"
            same = a.word(Semantic.BASIC) == b.word(Semantic.BASIC)
            yield Question("comparison", texts, YES_NO[not same], (meant(a), meant(b)))


def relation(view: HouseView) -> Iterator[Question]:
    """Yield questions about the objects on a support, and about the proximity of two objects."""
    bearers = {thing.word(Semantic.SUPPORTER) for thing in view.things}
    for thing in askable(view.things):
        if thing.object_id in bearers:
            for words in described(view.things, thing):
                yield from _on(view, thing, words)
    for a, b in combinations(alone(view.things), 2):
        gap = gap_between(a, b)
        if gap <= NEXT_TO or gap >= AWAY:
            texts = f"is {the(a)} next to {the(b)}", f"is {the(a)} near {the(b)}"
            yield Question("relation", texts, YES_NO[gap >= AWAY], (meant(a), meant(b)))


def _on(view: HouseView, thing: Thing, words: dict[Word, int]) -> Iterator[Question]:
    carried = [other for other in view.things if is_on(other, thing)]
    if not all(view.can_be_seen(other) for other in carried):
        return
    what, looks = phrase(words), (Meant.of(words),)
    kinds = {COARSE[other.word(Semantic.COARSE)] for other in carried}
    if len(kinds) == 1 and kinds <= set(NOUNS):
        yield Question("relation", (f"what is on {what}", f"which thing is on {what}"), spoken(*kinds), looks)
    for category in SMALL:
        texts = f"is there {one_of(category)} on {what}", f"does {what} have {one_of(category)} on it"
        yield Question("relation", texts, YES_NO[category not in kinds], looks)


def the(thing: Thing) -> str:
    """Return a noun phrase for an object that is the only one of its category.

    Example:
        >>> the(thing)  # doctest: +SKIP
        'the sofa'
    """
    return f"the {spoken(noun(thing))}"


def meant(thing: Thing) -> Meant:
    """Return a descriptor of an object that is the only one of its category."""
    return Meant.thing(coarse=thing.word(Semantic.COARSE))


def is_plain(thing: Thing) -> bool:
    """Return whether an object has exactly one main colour."""
    return thing.word(Semantic.BASIC) >= 0 and thing.word(Semantic.BASIC_2) < 0


def volume(thing: Thing) -> float:
    """Compute the volume of an object's bounds [m^3]; at least 1e-6."""
    return max(float(np.prod(thing.box[1] - thing.box[0])), 1e-6)


def gap_between(a: Thing, b: Thing) -> float:
    """Compute the gap between the bounds of two objects [m]."""
    return float(np.linalg.norm(np.maximum(np.maximum(a.box[0] - b.box[1], b.box[0] - a.box[1]), 0)))


def _attribute(kind: str) -> Callable[[HouseView], Iterator[Question]]:
    return lambda view: attributes(view.things, kind)


ASK: dict[str, Callable[[HouseView], Iterator[Question]]] = {
    "existence": existence,
    "count": count,
    **{kind: _attribute(kind) for kind in ATTRIBUTES},
    "comparison": comparison,
    "relation": relation,
}
