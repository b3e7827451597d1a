"""Terms of rewards: their sum is the reward, for every task that splits it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, two_rooms

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.env.actions import action_names


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled(
        [two_rooms(furniture=(Furniture((1.0, 1.0), mass=5.0), Furniture((-1.0, 1.0), category="chair")))]
    )


@pytest.mark.parametrize(
    ("task", "names"),
    [
        ("PointNav-v0", {"progress", "steps", "contacts", "success"}),
        ("ObjectNav-v0", {"progress", "transitions", "steps", "contacts", "questions", "mistakes"}),
        ("Exploration-v0", {"area", "steps", "contacts"}),
    ],
)
def test_terms_add_up_to_the_reward(bank, task: str, names: set[str]):
    env = home_mjx.make(task, bank, sensors=("state",), impl="kinematic")
    action = jnp.array([1.0, 0.0, 0.3, 0.0])
    if env.config.discrete is not None:
        action = action_names(env.config).index("move_forward")
    step, split = jax.jit(env.core.step), jax.jit(env.core.reward_terms)
    state, seen = jax.jit(env.core.reset)(env.params, jax.random.key(1)), []
    for _ in range(12):
        after = step(env.params, state, action)
        terms = split(env.params, state, after)
        assert set(terms) == names
        assert float(sum(terms.values())) == pytest.approx(float(after.reward), abs=1e-6)
        seen.append([float(x) for x in terms.values()])
        state = after
    assert np.ptp(seen, axis=0).max() > 0  # walking makes a difference
