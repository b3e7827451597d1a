"""Balanced selection of rows: each question has each of its answers equally often, so that text alone predicts nothing.

In earlier datasets much can be answered without looking: Anand et al., "Blindfold Baselines for Embodied QA", 2018
(arXiv:1811.05013). A question is therefore kept only if it has at least two answers in the bank.
"""

from collections import Counter, defaultdict
from dataclasses import replace

import numpy as np

from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.build_bank import FeasibleRow

Block = list[FeasibleRow]  # rows of one question, one for each of its answers


def balance_rows(drawn: list[FeasibleRow], max_rows: int, random: np.random.Generator) -> list[FeasibleRow]:
    """Select rows of all houses such that each question occurs equally often with each answer that is kept.

    Each question keeps its most frequent answers, as many as keep most rows; with only one answer it is dropped.

    Args:
        drawn: Rows whose `group` is the kind and the text of their question.
        max_rows: Maximum number of rows per house.
        random: Random generator for the choice among the rows of a group, and of their wording.

    Returns:
        Rows of all kinds of questions, in equal numbers while a kind has rows left.

    Raises:
        ConfigError: No question has two answers, or none fits in the maximum number of rows.
    """
    turns: dict[str, list[Block]] = {}
    for (kind, _), rows in sorted(_group_rows(drawn).items()):
        turns.setdefault(kind, []).extend(_split_blocks(rows, random))
    waiting = {kind: [blocks[i] for i in random.permutation(len(blocks))] for kind, blocks in turns.items() if blocks}
    if not waiting:
        houses = len({row.house for row in drawn})
        hint = "Give more houses, see num_houses: a question must have different answers in them."
        raise ConfigError(f"no question has two answers in {houses} houses", hint=hint)
    kept: list[FeasibleRow] = []
    taken: Counter[int] = Counter()
    while waiting:
        for kind in list(waiting):
            block = waiting[kind].pop()
            need = Counter(row.house for row in block)
            if all(taken[house] + count <= max_rows for house, count in need.items()):
                taken += need
                kept += _unify_wording(block, random)
            if not waiting[kind]:
                del waiting[kind]
    if not kept:
        hint = "Give more rows per house or more houses: each question is kept with all its answers."
        raise ConfigError(f"no question with all its answers fits in {max_rows} rows per house", hint=hint)
    return kept


def _group_rows(drawn: list[FeasibleRow]) -> dict[tuple[str, str], list[FeasibleRow]]:
    """Return the rows by their `group`."""
    groups: dict = defaultdict(list)
    for row in drawn:
        groups[row.row.group].append(row)
    return groups


def _split_blocks(rows: list[FeasibleRow], random: np.random.Generator) -> list[Block]:
    """Return blocks of k rows of a question, one per answer of its k most frequent ones; [] if it has one answer.

    The k that keeps most rows is chosen, of several the smallest; further rows are dropped.
    """
    by_answer: dict[int, list[FeasibleRow]] = defaultdict(list)
    for i in random.permutation(len(rows)):
        by_answer[rows[i].row.answer].append(rows[i])
    answers = sorted(by_answer.values(), key=lambda own: (-len(own), own[0].row.answer))
    if len(answers) < 2:
        return []
    count = max(range(2, len(answers) + 1), key=lambda k: k * len(answers[k - 1]))
    return [[own[at] for own in answers[:count]] for at in range(len(answers[count - 1]))]


def _unify_wording(block: Block, random: np.random.Generator) -> Block:
    """Return a block's rows with one wording, drawn from those of its first row: it must not predict the answer."""
    texts = (block[0].row.tokens, *block[0].row.paraphrases)
    tokens = texts[int(random.integers(len(texts)))]
    return [replace(row, row=replace(row.row, tokens=tokens)) for row in block]
