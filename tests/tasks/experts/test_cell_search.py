"""Sweeps of rooms: the order of cells, and how soon agents have seen a home."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import homes_bank

import home_mjx
from home_mjx.tasks import add_expert
from home_mjx.tasks.experts.cell_search import STRIP_WIDTH, _nearest_cell, sweep_order

CELL = 0.1


@pytest.mark.parametrize("turned", [False, True])
def test_a_narrow_part_is_swept_from_end_to_end(turned):
    part = np.zeros((80, 60), bool)
    part[5:65, 10:35] = True
    order = np.asarray(sweep_order(jnp.asarray(part.T if turned else part), CELL))
    order = order.T if turned else order
    np.testing.assert_array_equal(order[part].reshape(60, 25), np.repeat(np.arange(60)[:, None], 25, axis=1))


def test_a_wide_part_is_swept_in_strips_to_and_fro():
    part = np.zeros((90, 90), bool)
    part[2:82, 4:74] = True  # 8 m long, 7 m wide
    order = np.asarray(sweep_order(jnp.asarray(part), CELL))[2:82, 4:74]
    strips = np.arange(70) * 3 // 70
    assert np.diff(np.flatnonzero(np.diff(strips, prepend=-1, append=3))).max() * CELL <= STRIP_WIDTH
    along = np.arange(80)
    for column, strip in enumerate(strips):
        np.testing.assert_array_equal(order[:, column], strip * 80 + (along if strip != 1 else 79 - along))


def test_the_order_of_nothing_is_finite():
    assert np.asarray(sweep_order(jnp.zeros((4, 5), bool), CELL)).shape == (4, 5)


def test_agents_beside_walkable_cells_are_in_the_part_of_the_nearest():
    """From the margin of a cabinet the agent was in no part, chose another room, and came back in the next step."""
    mask = np.zeros((7, 9), bool)
    mask[2:5, 3:6] = True
    assert np.argwhere(_nearest_cell(jnp.asarray(mask), jnp.array([0, 3, 7]))).tolist() == [[3, 5]]
    assert np.argwhere(_nearest_cell(jnp.asarray(mask), jnp.array([0, 4, 4]))).tolist() == [[4, 4]]
    assert not np.asarray(_nearest_cell(jnp.zeros_like(mask), jnp.array([0, 3, 7]))).any()


@pytest.mark.slow
def test_agents_see_homes_of_several_storeys_soon():
    """In 700 steps on average; agents that always went to the nearest uncovered tile needed 850."""
    bank = homes_bank(("one storey", "corner", "to and fro"))
    env = add_expert(home_mjx.make("Exploration-v0", bank, impl="kinematic", sensors=("state",)))
    num, core = 4 * bank.num_houses, env.core
    states = jax.jit(jax.vmap(core.reset, (None, 0, 0)))(
        env.params, jax.random.split(jax.random.key(0), num), jnp.arange(num) % bank.num_houses
    )
    step, steps = jax.jit(jax.vmap(core.step, (None, 0, 0))), np.zeros(num, int)
    for _ in range(1000):
        steps += ~np.asarray(states.done)
        states = step(env.params, states, states.obs["expert"])
    assert np.asarray(states.metrics["success"]).all()
    assert steps.mean() < 770
