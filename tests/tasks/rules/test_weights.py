"""Rows of a task bank are drawn as often as their weights say."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from counted_jit import CountedJit
from scipy import stats

from home_mjx.errors import ConfigError
from home_mjx.tasks import Episodes, TaskBank

NUM = 50_000


def bank_of(count: int) -> TaskBank:
    zeros = jnp.zeros(count)
    rows = Episodes(house=zeros.astype(jnp.int32), start=jnp.zeros((count, 3)), yaw=zeros, columns={"length": zeros})
    return TaskBank(rows=rows, field=jnp.zeros((1, 1), jnp.uint16))


@jax.jit
def drawn(tasks: TaskBank):
    return jax.vmap(tasks.draw)(jax.random.split(jax.random.key(3), NUM))


@pytest.mark.parametrize(
    "weights", [(1, 2, 3, 4), (0.001, 0, 0.003, 0.1), (0, 0, 5, 0), (1e-20, 3e-20, 0, 0), (1e29, 2e29, 0, 1e29)]
)
def test_rows_are_drawn_by_weight_and_those_of_weight_0_never(weights):
    numbers = np.bincount(drawn(bank_of(4).with_weights(weights)), minlength=4)
    share = np.array(weights) / sum(weights)
    assert (numbers[share == 0] == 0).all()
    some = share > 0
    if some.sum() > 1:
        assert stats.chisquare(numbers[some], share[some] * NUM).pvalue > 0.01


def test_many_rows_of_weight_0_are_never_drawn():
    """Where sums of floating-point numbers would round: 200,000 rows, of which every third has a weight."""
    count = 200_001
    weights = np.where(np.arange(count) % 3 == 0, np.random.default_rng(0).random(count) + 0.1, 0.0)
    numbers = np.asarray(drawn(bank_of(count).with_weights(weights)))
    assert (numbers % 3 == 0).all()
    thirds = np.bincount(numbers * 3 // count, minlength=3)
    expected = np.array([weights[np.arange(count) * 3 // count == i].sum() for i in range(3)])
    assert stats.chisquare(thirds, expected / expected.sum() * NUM).pvalue > 0.01


def test_weights_change_without_another_program():
    tasks = bank_of(5)
    program = CountedJit(lambda tasks, key: tasks.draw(key))
    for only in range(5):
        weighted = tasks.with_weights(jnp.arange(5) == only)
        assert int(program(weighted, jax.random.key(0))) == only
    assert program.traces == 1


@pytest.mark.parametrize(("index", "row"), [(-1, 0), (-9, 0), (2, 2), (4, 3), (9, 3)])
def test_a_row_out_of_range_is_the_nearest_inside_jit(index, row):
    """JAX itself would count negative ones from the end."""
    tasks = bank_of(4).with_weights([1, 2, 3, 4])
    tasks = tasks.replace(rows=tasks.rows.replace(house=jnp.arange(4)))
    one = jax.jit(tasks.pick)(index)
    assert (int(one.rows.house), float(one.weights)) == (row, row + 1)
    assert int(jax.jit(tasks.rows.pick)(index).house) == row


def test_weights_go_with_their_rows():
    tasks = bank_of(4).with_weights([1, 0, 2, 3]).where(np.array([False, True, True, True]))
    assert tasks.weights.tolist() == [0, 2, 3]
    assert bank_of(4).pick(jnp.array([1])).weights is None


def test_weights_can_be_made_inside_a_program():
    @jax.jit
    def program(limit, tasks):
        own = tasks.with_weights(jnp.arange(len(tasks)) < limit)
        return jnp.max(jax.vmap(own.draw)(jax.random.split(jax.random.key(1), 500)))

    assert [int(program(limit, bank_of(9))) for limit in (1, 4, 9)] == [0, 3, 8]


@pytest.mark.parametrize(
    ("weights", "said"),
    [
        ((0, 0, 0, 0), "weights of all 4 tasks are 0"),
        ((1, -1, 0, 0), "weight of task 1 must be 0 or a positive number"),
        ((1, float("nan"), 0, 0), "task 1"),
        ((1, 1, 1), "expected 4 weights"),
        (1.0, "expected 4 weights"),
        ((1e-45, 0, 0, 0), "weights of all 4 tasks are 0"),
    ],
)
def test_weights_that_cannot_be_drawn_by_are_refused(weights, said):
    with pytest.raises(ConfigError, match=said):
        bank_of(4).with_weights(weights)
