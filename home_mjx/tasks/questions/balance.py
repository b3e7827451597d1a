"""Rows of which each question has each of its answers as often, so that questions alone tell nothing.

In older sets of questions about houses much can be answered without looking: Anand et al., "Blindfold Baselines for
Embodied QA", 2018 (arXiv:1811.05013). So a question is kept only if it has at least two answers in the bank.
"""

from collections import Counter, defaultdict
from dataclasses import replace

import numpy as np
from jaxtyping import Int

from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.build import Drawn
from home_mjx.tasks.rules.task_bank import TaskBank

Block = list[Drawn]  # one question with each of its answers, once


def balanced(drawn: list[Drawn], most: int, random: np.random.Generator) -> list[Drawn]:
    """Rows chosen such that each text is the instruction of as many rows with each of its answers.

    Args:
        drawn: Rows with a `group`: the kind of the question and the question.
        most: Rows per house.
        random: Draws which rows of a group are kept, and in what words they ask.

    Returns:
        Of each kind of question as many as there are of the others, as long as there are.

    Raises:
        ConfigError: No question has two answers, or none has room.
    """
    turns: dict[str, list[Block]] = {}
    for (kind, _), rows in sorted(_grouped(drawn).items()):
        turns.setdefault(kind, []).extend(_blocks(rows, random))
    waiting = {kind: [blocks[i] for i in random.permutation(len(blocks))] for kind, blocks in turns.items() if blocks}
    if not waiting:
        houses = len({row.house for row in drawn})
        hint = "Give more houses, see num_houses: only questions that have different answers in them are asked."
        raise ConfigError(f"no question has two answers in {houses} houses", hint=hint)
    kept: list[Drawn] = []
    taken: Counter[int] = Counter()
    while waiting:
        for kind in list(waiting):
            block = waiting[kind].pop()
            need = Counter(row.house for row in block)
            if all(taken[house] + count <= most for house, count in need.items()):
                taken += need
                kept += _worded(block, random)
            if not waiting[kind]:
                del waiting[kind]
    if not kept:
        hint = "Give more rows per house or more houses: a question comes with each of its answers."
        raise ConfigError(f"no question with all its answers has room in {most} rows per house", hint=hint)
    return kept


def _grouped(drawn: list[Drawn]) -> dict[tuple[str, str], list[Drawn]]:
    groups: dict = defaultdict(list)
    for row in drawn:
        groups[row.row.group].append(row)
    return groups


def _blocks(rows: list[Drawn], random: np.random.Generator) -> list[Block]:
    """Blocks of one question: of as many of its answers, the most frequent, as give the most rows."""
    by_answer: dict[int, list[Drawn]] = defaultdict(list)
    for i in random.permutation(len(rows)):
        by_answer[rows[i].row.answer].append(rows[i])
    answers = sorted(by_answer.values(), key=lambda own: (-len(own), own[0].row.answer))
    if len(answers) < 2:
        return []
    count = max(range(2, len(answers) + 1), key=lambda k: k * len(answers[k - 1]))
    return [[own[at] for own in answers[:count]] for at in range(len(answers[count - 1]))]


def _worded(block: Block, random: np.random.Generator) -> Block:
    """The rows of a block ask in the same words, so that words tell nothing either."""
    texts = (block[0].row.tokens, *block[0].row.wordings)
    tokens = texts[int(random.integers(len(texts)))]
    return [replace(row, row=replace(row.row, tokens=tokens)) for row in block]


def chance(tasks: TaskBank) -> float:
    """How often an agent is right that knows only what each question's answers are, and draws one of them."""
    texts, answers = _asked(tasks)
    own: dict[bytes, set[int]] = defaultdict(set)
    for text, answer in zip(texts, answers.tolist(), strict=True):
        own[text].add(answer)
    return float(np.mean([1 / len(own[text]) for text in texts]))


def prior_accuracy(learned: TaskBank, tasks: TaskBank) -> float:
    """How often the best agent is right that reads questions but looks at nothing.

    To each text it gives the answer that was the most frequent one where it has learned; to a text that it has not met
    the most frequent of all answers.

    Args:
        learned: Where it has learned.
        tasks: Where it is judged; maybe the same.

    Raises:
        ConfigError: One of them asks nothing.

    Example:
        >>> prior_accuracy(env.params.tasks, held_out.params.tasks)  # doctest: +SKIP
        0.38
    """
    counts: dict[bytes, Counter[int]] = defaultdict(Counter)
    for text, answer in zip(*_asked(learned), strict=True):
        counts[text][int(answer)] += 1
    overall = sum(counts.values(), Counter()).most_common(1)[0][0]
    texts, answers = _asked(tasks)
    guess = [counts[text].most_common(1)[0][0] if text in counts else overall for text in texts]
    return float(np.mean(np.array(guess) == answers))


def _asked(tasks: TaskBank) -> tuple[list[bytes], Int[np.ndarray, " t"]]:
    """Texts and answers of the rows that ask."""
    tokens, answers = (np.asarray(tasks.rows.columns[name]) for name in ("tokens", "answer"))
    if not (answers >= 0).any():
        raise ConfigError("no row asks a question", hint="Give rows of HouseQA or VQA.")
    return [row.tobytes() for row in tokens[answers >= 0]], answers[answers >= 0]
