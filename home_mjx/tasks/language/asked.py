"""Text of a row's goal, for display."""

import numpy as np
from jaxtyping import Int

from home_mjx.tasks.language.phrases import COLUMN, name, phrase
from home_mjx.tasks.language.vocabulary import detokenize
from home_mjx.tasks.rules.words import ANY, Kind, Word


def asked(task: str, tokens: Int[np.ndarray, " n"], descriptors: Int[np.ndarray, "d words"]) -> str:
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
    parts = [_phrase(row) for row in descriptors if row[Word.KIND] != Kind.NOTHING]
    return detokenize(tokens) or (f"{task}: {', '.join(parts)}" if parts else task)


def _phrase(row: np.ndarray) -> str:
    if row[Word.KIND] == Kind.PLACE:
        return "a place"
    if row[Word.KIND] == Kind.AGENT:
        return f"agent {row[Word.AGENT]}"
    words = {word: int(row[word]) for word in COLUMN if row[word] != ANY}
    if row[Word.KIND] == Kind.ROOM:
        return f"the {name(Word.ROOM_TYPE, words[Word.ROOM_TYPE])}" if Word.ROOM_TYPE in words else "a room"
    return phrase(words, "any" if row[Word.OBJECT_ID] == ANY else "the")
