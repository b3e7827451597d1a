"""Tasks that are held out by their words: nothing of them is left in training, and the choice never changes."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.tasks import TaskBank
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.language import mask_new_combinations, mask_words, tokenize
from home_mjx.tasks.language.splits import COMBINED_ATTRIBUTES
from home_mjx.tasks.rules.declaration import columns_of
from home_mjx.tasks.rules.enums import ANY, NUM_DESCRIPTORS, Attribute
from home_mjx.tasks.rules.task_bank import RowStart


def tasks_of(descriptors, texts):
    rows = len(descriptors)
    columns = {
        "descriptor": jnp.asarray(descriptors),
        "tokens": jnp.asarray([columns_of(RowStart)["tokens"].pack(tokenize(t)) for t in texts]),
    }
    zero = jnp.zeros(rows, jnp.int32)
    episodes = Episodes(house=zero, start=jnp.zeros((rows, 3)), yaw=jnp.zeros(rows), columns=columns)
    return TaskBank(rows=episodes, field=jnp.zeros((1, 1), jnp.uint16), names=("Any",))


@pytest.fixture(scope="module")
def tasks():
    """Every pair of ten kinds and eight colours, or the kind alone, in changing houses."""
    pairs = [(kind, color) for kind in range(10) for color in range(ANY, 8)]
    descriptor = np.full((2 * len(pairs), NUM_DESCRIPTORS, len(Attribute)), ANY, np.int16)
    for row, (kind, color) in enumerate(pairs * 2):
        descriptor[row, row % NUM_DESCRIPTORS, [Attribute.COARSE, Attribute.COLOR]] = kind, color
        descriptor[row, row % NUM_DESCRIPTORS, Attribute.OBJECT_ID] = row  # tells nothing to an agent
    return tasks_of(descriptor, ["find the red chair" if row % 3 else "find the bed" for row in range(len(descriptor))])


def said(tasks):
    words = np.asarray(tasks.rows.columns["descriptor"])[..., COMBINED_ATTRIBUTES]
    return [{tuple(d) for d in row.tolist() if sum(w != ANY for w in d) >= 2} for row in words]


def test_no_held_out_combination_is_left_in_training(tasks):
    held_out = mask_new_combinations(tasks)
    train, test = (set().union(*said(tasks.where(mask))) for mask in (~held_out, held_out))
    assert not train & test
    assert train | test == set().union(*said(tasks))
    assert 0.08 < len(test) / (len(test) + len(train)) < 0.35  # 80 combinations, a fifth of which are wanted


def test_words_that_stand_alone_are_never_held_out(tasks):
    held_out = mask_new_combinations(tasks, fraction=1.0)
    assert held_out.tolist() == [bool(row) for row in said(tasks)]
    assert not mask_new_combinations(tasks, fraction=0.0).any()


def test_the_choice_follows_from_words_and_seed_alone(tasks):
    held_out = mask_new_combinations(tasks)
    order = np.random.default_rng(0).permutation(len(tasks))
    assert mask_new_combinations(tasks.pick(jnp.asarray(order))).tolist() == held_out[order].tolist()
    assert mask_new_combinations(tasks, seed=1).tolist() != held_out.tolist()
    # A change of these would let agents be tested with what earlier ones were trained with.
    assert np.flatnonzero(held_out)[:4].tolist() == [1, 5, 29, 32]


def test_rows_that_mention_a_word(tasks):
    assert mask_words(tasks, ("red", "sofa")).tolist() == [bool(row % 3) for row in range(len(tasks))]
    assert not mask_words(tasks, ("sofa",)).any()
    with pytest.raises(ConfigError, match=r"unknown word `chiar`"):
        mask_words(tasks, ("chiar",))


@pytest.mark.parametrize("options", [{"fraction": 1.5}, {"fraction": float("nan")}])
def test_refuses_options(tasks, options):
    with pytest.raises(ConfigError, match="fraction"):
        mask_new_combinations(tasks, **options)
