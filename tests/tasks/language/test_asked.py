"""Rows without an instruction are described."""

import numpy as np

from home_mjx.tasks.language import tokenize
from home_mjx.tasks.language.phrases import describe_goal
from home_mjx.tasks.rules.enums import Attribute, TargetKind

NO_TOKENS = np.zeros(32, int)


def row(**words: int) -> np.ndarray:
    found = np.full((2, len(Attribute)), -1)
    for name, value in words.items():
        found[0, Attribute[name.upper()]] = value
    return found


def test_what_is_meant_is_said_unless_there_is_a_sentence():
    anything = describe_goal("ObjectNav", NO_TOKENS, row(kind=TargetKind.OBJECT, coarse=11, color=1))
    assert anything.startswith("ObjectNav: any ")
    assert anything.endswith(" chair")
    one = describe_goal("Fetch", NO_TOKENS, row(kind=TargetKind.OBJECT, coarse=11, object_id=3))
    assert one == "Fetch: the chair"
    assert describe_goal("PiedPiper", NO_TOKENS, row(kind=TargetKind.AGENT, agent=2)) == "PiedPiper: agent 2"
    assert describe_goal("Nothing", NO_TOKENS, row()) == "Nothing"
    words = np.array(tokenize("walk to the sofa"))
    assert describe_goal("Any", np.pad(words, (0, 32 - len(words))), row(kind=TargetKind.PLACE)) == "walk to the sofa"
