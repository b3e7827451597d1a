"""Rows without an instruction are described."""

import numpy as np

from home_mjx.tasks import tokenize
from home_mjx.tasks.language.asked import asked
from home_mjx.tasks.rules.words import Kind, Word

NO_TOKENS = np.zeros(32, int)


def row(**words: int) -> np.ndarray:
    found = np.full((2, len(Word)), -1)
    for name, value in words.items():
        found[0, Word[name.upper()]] = value
    return found


def test_what_is_meant_is_said_unless_there_is_a_sentence():
    anything = asked("ObjectNav", NO_TOKENS, row(kind=Kind.OBJECT, coarse=11, color=1))
    assert anything.startswith("ObjectNav: any ")
    assert anything.endswith(" chair")
    one = asked("Fetch", NO_TOKENS, row(kind=Kind.OBJECT, coarse=11, object_id=3))
    assert one == "Fetch: the chair"
    assert asked("PiedPiper", NO_TOKENS, row(kind=Kind.AGENT, agent=2)) == "PiedPiper: agent 2"
    assert asked("Nothing", NO_TOKENS, row()) == "Nothing"
    words = np.array(tokenize("walk to the sofa"))
    assert asked("Any", np.pad(words, (0, 32 - len(words))), row(kind=Kind.PLACE)) == "walk to the sofa"
