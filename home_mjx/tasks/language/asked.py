"""Text of a row's goal, for display."""

import numpy as np
from jaxtyping import Int

from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN, attribute_text, noun_phrase
from home_mjx.tasks.language.vocabulary import detokenize
from home_mjx.tasks.rules.words import ANY, Attribute, TargetKind


def describe_goal(task: str, tokens: Int[np.ndarray, " n"], descriptors: Int[np.ndarray, "d words"]) -> str:
    """Return the instruction of a row; without one, a phrase for its descriptors.

    Args:
        task: Name of the task.
        tokens: Tokens of the instruction.
        descriptors: Descriptors of the row's program.

    Example:
        >>> row = np.full((1, len(Word)), ANY)
        >>> row[0, [Word.KIND, Word.ROOM_TYPE]] = Kind.ROOM, 1
        >>> asked("RoomNav", np.zeros(32, int), row)
        'RoomNav: the kitchen'
    """
    parts = [_describe_target(row) for row in descriptors if row[Attribute.KIND] != TargetKind.NOTHING]
    return detokenize(tokens) or (f"{task}: {', '.join(parts)}" if parts else task)


def _describe_target(row: np.ndarray) -> str:
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
