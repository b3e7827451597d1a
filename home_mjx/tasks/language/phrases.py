"""Referring expressions: phrases for objects, rooms and goals, and minimal words that identify an object."""

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np
from jaxtyping import Bool, Int

from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.vocabulary import detokenize, to_word
from home_mjx.tasks.rules.enums import ANY, Attribute, TargetKind
from home_mjx.tasks.rules.house_view import HouseObject

# Words that distinguish objects of a category, in the order of people's preference: Dale and Reiter, "Computational
# Interpretations of the Gricean Maxims in the Generation of Referring Expressions", Cognitive Science 19, 1995.
DISTINGUISHING_ATTRIBUTES = (Attribute.COLOR, Attribute.SIZE, Attribute.MATERIAL, Attribute.ROOM_TYPE)
SEMANTIC_COLUMN = {
    Attribute.FINE: Semantic.FINE,
    Attribute.COARSE: Semantic.COARSE,
    Attribute.COLOR: Semantic.COLOR,
    Attribute.SIZE: Semantic.SIZE,
    Attribute.MATERIAL: Semantic.MATERIAL,
    Attribute.ROOM_TYPE: Semantic.ROOM_TYPE,
}
ADJECTIVE_ORDER = (Attribute.SIZE, Attribute.COLOR, Attribute.MATERIAL)


def attribute_text(word: Attribute, value: int) -> str:
    """Return the word of the tasks' language for a value (index in its vocabulary) of an attribute.

    The value must be known: -1 has no word, but raises no error.

    Example:
        >>> attribute_text(Attribute.SIZE, 3)
        'large'
    """
    return to_word(vocabularies()[SEMANTIC_COLUMN[word]][value])


def noun_phrase(
    meant: dict[Attribute, int],
    article: str = "the",
    is_on: bool | None = None,
    is_open: bool | None = None,
    container: str = "",
) -> str:
    """Return a noun phrase for objects with these attribute values; "thing" without a category.

    The fine category is the noun if there is one, else the coarse one. Attributes other than size, colour, material and
    type of room are left out. With a state, `is_on`, it ends in "that is on" or "that is off"; with `is_open` in "that
    is open" or "that is shut". `container` is the noun phrase of the furniture that they are inside of; "": none.

    Example:
        >>> noun_phrase({Attribute.COARSE: 11, Attribute.SIZE: 3, Attribute.ROOM_TYPE: 1})
        'the large chair in the kitchen'
        >>> noun_phrase({}, is_on=True)
        'the thing that is on'
        >>> noun_phrase({}, container=noun_phrase({Attribute.ROOM_TYPE: 1}, is_open=False))
        'the thing inside the thing in the kitchen that is shut'
    """
    noun = next((word for word in (Attribute.FINE, Attribute.COARSE) if word in meant), None)
    parts = [article, *(attribute_text(word, meant[word]) for word in ADJECTIVE_ORDER if word in meant)]
    parts += [attribute_text(noun, meant[noun])] if noun is not None else ["thing"]
    if Attribute.ROOM_TYPE in meant:
        parts += ["in", "the", attribute_text(Attribute.ROOM_TYPE, meant[Attribute.ROOM_TYPE])]
    if is_on is not None:
        parts += ["that", "is", "on" if is_on else "off"]
    if is_open is not None:
        parts += ["that", "is", "open" if is_open else "shut"]
    if container:
        parts += ["inside", container]
    return " ".join(parts)


def select_matching(things: Sequence[HouseObject], meant: dict[Attribute, int]) -> list[HouseObject]:
    """Select the objects that have all of these attribute values, in their order; all objects if `meant` is empty.

    Attributes are those of `SEMANTIC_COLUMN`; others raise `KeyError`.
    """
    table = _semantic_table(things)
    having = np.logical_and.reduce([np.ones(len(things), bool), *(_have(table, *word) for word in meant.items())])
    return [thing for thing, is_meant in zip(things, having, strict=True) if is_meant]


def _semantic_table(things: Sequence[HouseObject]) -> Int[np.ndarray, "n columns"]:
    """Stack the semantic rows of objects (one per object, columns `Semantic`)."""
    return np.array([thing.semantics for thing in things]).reshape(len(things), len(Semantic))


def _have(table: Int[np.ndarray, "n columns"], word: Attribute, value: int) -> Bool[np.ndarray, " n"]:
    """Return which rows have an attribute's value: any of their main colours, any label of their room.

    A value of -1 matches unknown ones, except for ROOM_TYPE, where it must be known.
    """
    if word == Attribute.ROOM_TYPE:
        labels = table[:, Semantic.ROOM_LABELS]
        return (labels > 0) & (labels >> value & 1 > 0)
    columns = (
        [Semantic.COLOR, Semantic.COLOR_2, Semantic.COLOR_3] if word == Attribute.COLOR else [SEMANTIC_COLUMN[word]]
    )
    return (table[:, columns] == value).any(axis=1)


def draw_identifying_words(
    things: Sequence[HouseObject], thing: HouseObject, random: np.random.Generator
) -> dict[Attribute, int] | None:
    """Return a smallest set of attribute values that identifies `thing` among `things`; None if there is no such set.

    Among several smallest sets one is drawn at random.
    """
    alone = minimal_identifying_words(things, thing)
    return alone[int(random.integers(len(alone)))] if alone else None


def identify_objects(
    things: Sequence[HouseObject], chosen: Sequence[HouseObject], random: np.random.Generator
) -> list[tuple[HouseObject, dict[Attribute, int]]]:
    """Return those of `chosen` that `draw_identifying_words` identifies among `things`, each with its words."""
    drawn = [(thing, draw_identifying_words(things, thing, random)) for thing in chosen]
    return [(thing, words) for thing, words in drawn if words is not None]


def minimal_identifying_words(
    things: Sequence[HouseObject], thing: HouseObject, attributes: Sequence[Attribute] = DISTINGUISHING_ATTRIBUTES
) -> list[dict[Attribute, int]]:
    """Return all smallest sets of values that only `thing` has: its category and some of `attributes`.

    [] if even all attributes do not single it out among `things`, of which it must be one. Its unknown attributes are
    left out.
    """
    noun = {Attribute.COARSE: thing.semantic(Semantic.COARSE)}
    known = [word for word in attributes if thing.semantic(SEMANTIC_COLUMN[word]) >= 0]
    peers = _semantic_table(select_matching(things, noun))
    having = {(word, value): _have(peers, word, value) for word in known for value in _naming_values(thing, word)}
    for count in range(len(known) + 1):
        sets = [
            dict(zip(chosen, values, strict=True))
            for chosen in combinations(known, count)
            for values in product(*(_naming_values(thing, word) for word in chosen))
        ]
        everyone = np.ones(len(peers), bool)
        alone = [
            noun | words
            for words in sets
            if np.logical_and.reduce([everyone, *(having[pair] for pair in words.items())]).sum() == 1
        ]
        if alone:
            return alone
    return []


def _naming_values(thing: HouseObject, word: Attribute) -> tuple[int, ...]:
    """Return attribute values that may name an object: its main one (-1 if unknown), or any label of its room."""
    return thing.room_types if word == Attribute.ROOM_TYPE else (thing.semantic(SEMANTIC_COLUMN[word]),)


def describe_goal(task: str, tokens: Int[np.ndarray, " n"], descriptors: Int[np.ndarray, "d words"]) -> str:
    """Return the instruction of a row; without tokens, the task's name and phrases for all its descriptors.

    Example:
        >>> row = np.full((1, len(Attribute)), ANY)
        >>> row[0, [Attribute.KIND, Attribute.ROOM_TYPE]] = TargetKind.ROOM, 1
        >>> describe_goal("RoomNav", np.zeros(32, int), row)
        'RoomNav: the kitchen'
    """
    parts = [_describe_target(row) for row in descriptors if row[Attribute.KIND] != TargetKind.NOTHING]
    return detokenize(tokens) or (f"{task}: {', '.join(parts)}" if parts else task)


def _describe_target(row: np.ndarray) -> str:
    """Return a phrase for the target of a descriptor: a place, an agent, a room or an object."""
    if row[Attribute.KIND] == TargetKind.PLACE:
        return "a place"
    if row[Attribute.KIND] == TargetKind.AGENT:
        return f"agent {row[Attribute.AGENT]}"
    words = {word: int(row[word]) for word in SEMANTIC_COLUMN if row[word] != ANY}
    if row[Attribute.KIND] == TargetKind.ROOM:
        return (
            f"the {attribute_text(Attribute.ROOM_TYPE, words[Attribute.ROOM_TYPE])}"
            if Attribute.ROOM_TYPE in words
            else "a room"
        )
    return noun_phrase(words, "any" if row[Attribute.OBJECT_ID] == ANY else "the")
