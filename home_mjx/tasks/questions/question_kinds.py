"""Generation of all questions that a house can answer, by kind."""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, permutations

import numpy as np

from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN, attribute_text, noun_phrase
from home_mjx.tasks.language.vocabulary import to_word
from home_mjx.tasks.questions.question import (
    ATTRIBUTE_OF_KIND,
    MAX_COUNT,
    NOUNS,
    YES_NO,
    Question,
    askable_objects,
    identifying_words,
    indefinite_noun,
    is_on,
    unique_objects,
)
from home_mjx.tasks.rules.enums import Attribute
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Selector
from home_mjx.tasks.suite.portable_objects import box_gap

MIN_VOLUME_RATIO = 2.0  # minimum ratio of the volumes of bounds in questions about size
MAX_GAP_NEXT_TO, MIN_GAP_AWAY = 0.3, 1.5  # [m] maximum gap between bounds next to each other; minimum gap otherwise
SMALL_CATEGORIES = (
    *("vase", "indoor_lamp", "television", "computer", "music", "books", "plant", "kitchen_appliance", "toy", "candle"),
    *("clock", "decoration", "kitchenware", "household_appliance", "picture_frame", "trinket", "magazines", "pillow"),
)
ATTRIBUTES = {
    "color": ("what colour is {}", "what is the colour of {}"),
    "material": ("what is {} made of", "of which material is {}"),
    "size": ("what size is {}", "what is the size of {}"),
    "location": ("in which room is {}", "where is {}"),
}


def attribute_questions(
    things: Sequence[HouseObject], kind: str, about: Sequence[HouseObject] | None = None
) -> Iterator[Question]:
    """Yield questions about an attribute of single objects, or about the room they are in.

    There is one for each smallest set of words that identifies an object. Objects whose value is unknown have none,
    those with several main colours none about colour, and those in rooms of several labels none about place.

    Args:
        things: Objects among which a phrase must identify one.
        kind: A key of `ATTRIBUTES`.
        about: Objects to ask about; None: all.
    """
    word = ATTRIBUTE_OF_KIND[kind]
    for thing in askable_objects(things if about is None else about):
        values = thing.room_types if word == Attribute.ROOM_TYPE else (thing.semantic(SEMANTIC_COLUMN[word]),)
        several = word == Attribute.COLOR and thing.semantic(Semantic.COLOR_2) >= 0  # more than one main colour
        if len(values) != 1 or values[0] < 0 or several:
            continue
        for words in identifying_words(things, thing, (word,)):
            texts = tuple(text.format(noun_phrase(words)) for text in ATTRIBUTES[kind])
            yield Question(kind, texts, attribute_text(word, values[0]), (Selector.objects_with(words),))


def unique_rooms(view: HouseView) -> list[tuple[int, int]]:
    """Return (room, index into ROOM_TYPES) for each type that exactly one room has; a room of several types repeats."""
    return [(rooms[0], kind) for kind, rooms in view.rooms_by_type.items() if len(rooms) == 1]


def count_in_rooms(view: HouseView) -> Iterator[tuple[str, int, int]]:
    """Yield a category, a room type (index into ROOM_TYPES), and the number of its objects in that room, 0 included.

    Only for rooms that are unique in their type, and for categories whose objects are all visible and in a room.
    """
    things: dict[str, list[HouseObject]] = {name: [] for name in NOUNS}
    for thing in askable_objects(view.objects):
        things[thing.coarse].append(thing)
    known = {name for name, own in things.items() if all(view.is_visible(t) and _is_in_room(t) for t in own)}
    for (room, kind), category in ((r, c) for r in unique_rooms(view) for c in sorted(known)):
        yield category, kind, sum(thing.semantic(Semantic.ROOM) == room for thing in things[category])


def _is_in_room(thing: HouseObject) -> bool:
    """Return whether an object is in a room of the house."""
    return thing.semantic(Semantic.ROOM) >= 0


def existence_questions(view: HouseView) -> Iterator[Question]:
    """Yield yes-no questions about the presence of a category in a room, for each of `count_in_rooms`."""
    for category, kind, number in count_in_rooms(view):
        place = to_word(ROOM_TYPES[kind])
        texts = (
            f"is there {indefinite_noun(category)} in the {place}",
            f"does the {place} have {indefinite_noun(category)}",
        )
        yield Question("existence", texts, YES_NO[number == 0], (Selector.rooms(room_type=kind),))


def count_questions(view: HouseView) -> Iterator[Question]:
    """Yield questions about the number of a category's objects in a room, where it is 1 to `MAX_COUNT`."""
    for category, kind, number in count_in_rooms(view):
        if 1 <= number <= MAX_COUNT:
            place, thing = to_word(ROOM_TYPES[kind]), to_word(category)
            texts = f"how many {thing} are there in the {place}", f"what is the number of {thing} in the {place}"
            yield Question("count", texts, str(number), (Selector.rooms(room_type=kind),))


def comparison_questions(view: HouseView) -> Iterator[Question]:
    """Yield yes-no questions that compare two `unique_objects`, by clearly different volume or by main colour.

    Volumes differ by a factor of at least `MIN_VOLUME_RATIO`, and both orders are asked. Colours are compared, once,
    only if both objects have exactly one.
    """
    own = unique_objects(view.objects)
    for a, b in permutations(own, 2):
        ratio = volume(a) / volume(b)
        if max(ratio, 1 / ratio) >= MIN_VOLUME_RATIO:
            texts = (
                f"is {definite_noun(a)} larger than {definite_noun(b)}",
                f"is {definite_noun(b)} smaller than {definite_noun(a)}",
            )
            yield Question("comparison", texts, YES_NO[ratio < 1], (select_unique(a), select_unique(b)))
    for a, b in combinations(own, 2):
        if has_one_color(a) and has_one_color(b):
            texts = (
                f"is {definite_noun(a)} the same colour as {definite_noun(b)}",
                f"do {definite_noun(a)} and {definite_noun(b)} have the same colour",
            )
            same = a.semantic(Semantic.COLOR) == b.semantic(Semantic.COLOR)
            yield Question("comparison", texts, YES_NO[not same], (select_unique(a), select_unique(b)))


def relation_questions(view: HouseView) -> Iterator[Question]:
    """Yield questions on what an object carries, and whether two `unique_objects` are near; not for doubtful gaps.

    Near is a gap up to `MAX_GAP_NEXT_TO`, not near one from `MIN_GAP_AWAY` on. Objects that carry nothing are not asked
    about.
    """
    bearers = {thing.semantic(Semantic.SUPPORTER) for thing in view.objects}
    for thing in askable_objects(view.objects):
        if thing.object_id in bearers:
            for words in identifying_words(view.objects, thing):
                yield from _support_questions(view, thing, words)
    for a, b in combinations(unique_objects(view.objects), 2):
        gap = box_gap(a, b)
        if gap <= MAX_GAP_NEXT_TO or gap >= MIN_GAP_AWAY:
            texts = (
                f"is {definite_noun(a)} next to {definite_noun(b)}",
                f"is {definite_noun(a)} near {definite_noun(b)}",
            )
            yield Question("relation", texts, YES_NO[gap >= MIN_GAP_AWAY], (select_unique(a), select_unique(b)))


def _support_questions(view: HouseView, thing: HouseObject, words: dict[Attribute, int]) -> Iterator[Question]:
    """Yield questions what is on an object, and whether each of `SMALL_CATEGORIES` is on it.

    The first is asked only if all that it carries is of one category, one of `NOUNS`. `words` identify the object in
    the text. Yields none if something that it carries is not visible from beside it.
    """
    carried = [other for other in view.objects if is_on(other, thing)]
    if not all(view.is_visible(other) for other in carried):
        return
    what, looks = noun_phrase(words), (Selector.objects_with(words),)
    kinds = {other.coarse for other in carried}
    if len(kinds) == 1 and kinds <= set(NOUNS):
        yield Question("relation", (f"what is on {what}", f"which thing is on {what}"), to_word(*kinds), looks)
    for category in SMALL_CATEGORIES:
        texts = f"is there {indefinite_noun(category)} on {what}", f"does {what} have {indefinite_noun(category)} on it"
        yield Question("relation", texts, YES_NO[category not in kinds], looks)


def definite_noun(thing: HouseObject) -> str:
    """Return the name of an object that is the only one of its category, with article, such as `the sofa`."""
    return f"the {to_word(thing.coarse)}"


def select_unique(thing: HouseObject) -> Selector:
    """Return a descriptor of an object that is the only one of its category."""
    return Selector.objects(coarse=thing.semantic(Semantic.COARSE))


def has_one_color(thing: HouseObject) -> bool:
    """Return whether an object has exactly one main colour."""
    return thing.semantic(Semantic.COLOR) >= 0 and thing.semantic(Semantic.COLOR_2) < 0


def volume(thing: HouseObject) -> float:
    """Compute the volume of an object's bounds [m^3]; at least 1e-6."""
    return max(float(np.prod(thing.box[1] - thing.box[0])), 1e-6)


def _attribute_generator(kind: str) -> Callable[[HouseView], Iterator[Question]]:
    """Return the generator of a house's questions about one attribute."""
    return lambda view: attribute_questions(view.objects, kind)


QUESTION_GENERATORS: dict[str, Callable[[HouseView], Iterator[Question]]] = {
    "existence": existence_questions,
    "count": count_questions,
    **{kind: _attribute_generator(kind) for kind in ATTRIBUTES},
    "comparison": comparison_questions,
    "relation": relation_questions,
}
