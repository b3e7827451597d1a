"""Kinds of instructions by their words, and how episodes of each end."""

import numpy as np

from home_mjx.tasks.language.instruction_kinds import failures_by_kind, instruction_kinds
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS

SAID = (
    "find the chair",
    "go to the red sofa",
    "walk to the large blue bed in the bedroom",
    "before you go to the sofa find the wood table",
    "find the chair and then walk to the bed in the kitchen",
)
KINDS = {  # by reading them
    "all": "11111",
    "1 part": "11100",
    "2 parts": "00011",
    "`then`": "00001",
    "`before`": "00010",
    "a name": "10000",
    "a colour": "01100",
    "a size": "00100",
    "a material": "00010",
    "a room": "00101",
    "1 attribute": "01011",
    "3 attributes": "00100",
}


def rows_of(said: tuple[str, ...]) -> np.ndarray:
    tokens = np.zeros((len(said), 16), np.int16)
    for row, text in zip(tokens, said, strict=True):
        numbers = tokenize(text)
        row[: len(numbers)] = numbers
    return tokens


def test_kinds_of_five_instructions():
    found = instruction_kinds(rows_of(SAID))
    assert {kind: "".join(map(str, mask.astype(int))) for kind, mask in found.items()} == KINDS
    assert list(found) == list(KINDS)


def test_ends_of_seven_episodes_of_five_rows():
    """Rows 0 and 1 are played twice. Stage 1 at the end: one part is done, and time was out."""
    stage = np.array([SUCCESS, FAILURE, 0, 1, SUCCESS, FAILURE, SUCCESS], np.float32)
    found = failures_by_kind({"stage": stage, "success": stage == SUCCESS}, rows_of(SAID))
    assert found["all"] == {"episodes": 7, "success": 3 / 7, "wrong": 2 / 7, "late": 2 / 7, "begun": 1 / 7}
    assert found["a name"] == {"episodes": 2, "success": 0.5, "wrong": 0.5, "late": 0, "begun": 0}
    assert found["2 parts"] == {"episodes": 2, "success": 0.5, "wrong": 0, "late": 0.5, "begun": 0.5}
    few = failures_by_kind({"stage": stage[:1], "success": stage[:1] == SUCCESS}, rows_of(SAID))
    assert set(few) == {"all", "1 part", "a name"}, "kinds that no episode has are left out"
