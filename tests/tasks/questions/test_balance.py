"""Balance: questions alone tell nothing, whatever was asked before."""

import itertools

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.tasks import TaskBank
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.metrics import chance_accuracy, prior_accuracy
from home_mjx.tasks.questions.balance import balance_rows
from home_mjx.tasks.rules.build_bank import FeasibleRow, TaskRow
from home_mjx.tasks.rules.declaration import columns_of
from home_mjx.tasks.rules.task_bank import RowStart

HOUSES = 12


def offered(random, questions=20, kinds=3):
    """Every question in most of the houses; one of its answers is far more frequent than the others."""
    for number, house in itertools.product(range(questions), range(HOUSES)):
        if random.random() < 0.8:
            answer = 100 + (0 if random.random() < 0.8 else int(random.integers(1, 4)))
            words = (1 + number, 1), (1 + number, 2), (1 + number, 3)
            group = f"kind {number % kinds}", f"question {number}"
            row = TaskRow([], [], tokens=words[0], paraphrases=words[1:], answer=answer, group=group)
            yield FeasibleRow(row, house, 0, {})


def bank_of(rows):
    tokens = jnp.asarray([columns_of(RowStart)["tokens"].pack(row.row.tokens) for row in rows])
    columns = {"tokens": tokens, "answer": jnp.asarray([row.row.answer for row in rows])}
    zero = jnp.zeros(len(rows), jnp.int32)
    episodes = Episodes(house=zero, start=jnp.zeros((len(rows), 3)), yaw=jnp.zeros(len(rows)), columns=columns)
    return TaskBank(rows=episodes, field=jnp.zeros((1, 1), jnp.uint16), names=("Any",))


@pytest.fixture(scope="module")
def drawn():
    return list(offered(np.random.default_rng(0)))


def test_offered_questions_leak_and_chosen_ones_do_not(drawn):
    kept = bank_of(balance_rows(drawn, 100, np.random.default_rng(1)))
    assert 0.25 <= chance_accuracy(kept) <= 0.5
    assert prior_accuracy(bank_of(drawn), bank_of(drawn)) > chance_accuracy(kept) + 0.1
    assert prior_accuracy(kept, kept) == pytest.approx(chance_accuracy(kept), abs=1e-12)


def test_what_was_learned_elsewhere_does_not_help(drawn):
    """Not even where it was not balanced."""
    kept = bank_of(balance_rows(drawn, 100, np.random.default_rng(1)))
    for seed in range(5):
        others = list(offered(np.random.default_rng(10 + seed)))
        held_out = bank_of(balance_rows(others, 100, np.random.default_rng(seed)))
        for learned in (kept, bank_of(drawn)):
            assert prior_accuracy(learned, held_out) <= chance_accuracy(held_out) + 1e-12


def test_each_text_has_its_answers_as_often_in_different_houses(drawn):
    kept = balance_rows(drawn, 100, np.random.default_rng(1))
    texts = {}
    for row in kept:
        texts.setdefault(tuple(row.row.tokens), []).append((row.row.answer, row.house))
    for rows in texts.values():
        answers, counts = np.unique([answer for answer, _ in rows], return_counts=True)
        assert len(answers) >= 2
        assert len(set(counts.tolist())) == 1
    assert {tokens[1] for tokens in texts} == {1, 2, 3}  # all wordings are used
    assert len({(row.row.group, row.house) for row in kept}) == len(kept)  # a question is asked once per house


def test_questions_whose_answers_have_no_room_are_refused():
    """One house, of which one row is kept, cannot have both answers: an empty list was an IndexError later."""
    drawn = [
        FeasibleRow(TaskRow([], [], tokens=(1,), answer=answer, group=("a", "b")), 0, 0, {}) for answer in (100, 101)
    ]
    with pytest.raises(ConfigError, match=r"1 rows per house.*more houses"):
        balance_rows(drawn, 1, np.random.default_rng(0))


def test_no_house_has_too_many_and_kinds_take_turns(drawn):
    kept = balance_rows(drawn, 5, np.random.default_rng(1))
    assert np.bincount([row.house for row in kept]).max() <= 5
    kinds = np.unique([row.row.group[0] for row in kept], return_counts=True)[1]
    assert len(kinds) == 3
    assert kinds.max() <= 2.5 * kinds.min()
    assert prior_accuracy(bank_of(kept), bank_of(kept)) == pytest.approx(chance_accuracy(bank_of(kept)))


def test_the_same_seed_keeps_the_same(drawn):
    first, again, other = (balance_rows(drawn, 5, np.random.default_rng(seed)) for seed in (1, 1, 2))
    key = [(row.house, row.row.group, row.row.tokens) for row in first]
    assert key == [(row.house, row.row.group, row.row.tokens) for row in again]
    assert key != [(row.house, row.row.group, row.row.tokens) for row in other]


def test_questions_with_one_answer_are_refused(drawn):
    same = [row for row in drawn if row.row.answer == 100]
    with pytest.raises(ConfigError, match="no question has two answers"):
        balance_rows(same, 5, np.random.default_rng(0))
    with pytest.raises(ConfigError, match="asks"):
        chance_accuracy(bank_of([FeasibleRow(TaskRow([], [], tokens=(1,)), 0, 0, {})]))
