"""Baselines of question answering that observe nothing but the question.

In earlier datasets much can be answered without looking: Anand et al., "Blindfold Baselines for Embodied QA", 2018
(arXiv:1811.05013).
"""

from collections import Counter, defaultdict

import numpy as np
from jaxtyping import Int

from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.task_bank import TaskBank


def chance_accuracy(tasks: TaskBank) -> float:
    """Return the accuracy of guessing uniformly among the distinct answers that each question has in `tasks`.

    It is averaged over rows; those without a question do not count. `ConfigError` if none has one.
    """
    texts, answers = _questions_and_answers(tasks)
    own: dict[bytes, set[int]] = defaultdict(set)
    for text, answer in zip(texts, answers.tolist(), strict=True):
        own[text].add(answer)
    return float(np.mean([1 / len(own[text]) for text in texts]))


def prior_accuracy(train_tasks: TaskBank, test_tasks: TaskBank) -> float:
    """Return the accuracy on `test_tasks` of the best agent that reads questions but observes nothing else.

    It gives each question its most frequent answer in `train_tasks`, and an unseen question the most frequent answer of
    all; of equally frequent ones the first. Rows without a question do not count.

    Raises:
        ConfigError: One of them has no questions.

    Example:
        >>> prior_accuracy(env.params.tasks, held_out.params.tasks)  # doctest: +SKIP
        0.38
    """
    counts: dict[bytes, Counter[int]] = defaultdict(Counter)
    for text, answer in zip(*_questions_and_answers(train_tasks), strict=True):
        counts[text][int(answer)] += 1
    overall = sum(counts.values(), Counter()).most_common(1)[0][0]
    texts, answers = _questions_and_answers(test_tasks)
    guess = [counts[text].most_common(1)[0][0] if text in counts else overall for text in texts]
    return float(np.mean(np.array(guess) == answers))


def _questions_and_answers(tasks: TaskBank) -> tuple[list[bytes], Int[np.ndarray, " t"]]:
    """Return the texts (tokens as bytes) and answers (tokens) of rows with a question; `ConfigError` without any."""
    tokens, answers = (np.asarray(tasks.rows.columns[name]) for name in ("tokens", "answer"))
    if not (answers >= 0).any():
        raise ConfigError("no row asks a question", hint="Give rows of HouseQA or VQA.")
    return [row.tobytes() for row in tokens[answers >= 0]], answers[answers >= 0]
