"""Kinds of instructions by their words: how many parts, in which order, and by what objects are described."""

from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Bool, Int

from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.vocabulary import detokenize, to_word
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS

PART_VERBS = ("go", "walk", "find", "bring", "put", "enter", "turn", "switch")  # each begins a part of an instruction
ORDER_WORDS = ("then", "before", "after")
DESCRIBED = {
    "a colour": Semantic.COLOR,
    "a size": Semantic.SIZE,
    "a material": Semantic.MATERIAL,
    "a room": Semantic.ROOM_TYPE,
}
Words = list[str]


def instruction_kinds(tokens: Int[np.ndarray, "t n"]) -> dict[str, Bool[np.ndarray, " t"]]:
    """Return the masks of instructions of each kind that occurs; an instruction is of several kinds.

    Kinds are `all`, the number of parts, the word of their order, the attributes that describe objects (or the category
    alone, as `a name`), and the number of such attributes.

    Args:
        tokens: Rows of tokens, 0 after the end of each.

    Example:
        >>> said = ["find the red chair", "go to the lamp then find the bed in the bedroom"]
        >>> rows = [(*tokenize(text), *[0] * 12)[:12] for text in said]  # doctest: +SKIP
        >>> instruction_kinds(np.array(rows))["a room"].tolist()  # doctest: +SKIP
        [False, True]
    """
    said = [detokenize(row).split() for row in tokens]
    found = {name: np.array([test(words) for words in said], bool) for name, test in _tests().items()}
    return {name: mask for name, mask in found.items() if mask.any()}


def _tests() -> dict[str, Callable[[Words], bool]]:
    """Return the test of each kind on the words of an instruction, in the order of tables."""
    names = {kind: {to_word(name) for name in vocabularies()[column]} for kind, column in DESCRIBED.items()}

    def num_attributes(words: Words) -> int:
        """Count the attributes in an instruction."""
        return sum(word in known for known in names.values() for word in words)

    tests: dict[str, Callable[[Words], bool]] = {"all": lambda words: True}
    for count in (1, 2, 3):
        tests[f"{count} part{'s' * (count > 1)}"] = lambda words, count=count: _num_parts(words) == count
    for order in ORDER_WORDS:
        tests[f"`{order}`"] = lambda words, order=order: order in words
    tests["a name"] = lambda words: not num_attributes(words)
    for kind, known in names.items():
        tests[kind] = lambda words, known=known: any(word in known for word in words)
    for count in (1, 2, 3, 4):
        tests[f"{count} attribute{'s' * (count > 1)}"] = lambda words, count=count: num_attributes(words) == count
    return tests


def _num_parts(words: Words) -> int:
    """Count the verbs that begin a part."""
    return sum(word in PART_VERBS for word in words)


def failures_by_kind(results: Mapping[str, np.ndarray], tokens: Int[np.ndarray, "t n"]) -> dict[str, dict[str, float]]:
    """Return episodes, success, and how the others ended, of each kind of instruction.

    `wrong` is the fraction that a mistake ended, such as a wrong `stop`; `late` that ran out of time. Of the latter,
    `begun` is the fraction of all episodes in which a part was done, but not the last.

    Args:
        results: Metrics of each episode, with `stage`; episode i is of row i, cyclically.
        tokens: Instructions of the rows.

    Example:
        >>> failures_by_kind(evaluate(env, *policy), env.params.tasks.rows.columns["tokens"])  # doctest: +SKIP
        {'all': {'episodes': 100.0, 'success': 0.26, 'wrong': 0.4, 'late': 0.34, 'begun': 0.11}, ...}
    """
    stage = np.asarray(results["stage"])
    of_row = instruction_kinds(np.asarray(tokens))
    row = np.arange(len(stage)) % len(tokens)
    ends = {
        "success": stage == SUCCESS,
        "wrong": stage == FAILURE,
        "late": (stage != SUCCESS) & (stage != FAILURE),
        "begun": stage > 0,
    }
    found = {}
    for kind, mask in of_row.items():
        own = mask[row]
        if own.any():
            found[kind] = {"episodes": float(own.sum())} | {name: float(end[own].mean()) for name, end in ends.items()}
    return found
