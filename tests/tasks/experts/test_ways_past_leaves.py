"""The expert of PointNav takes the long way round where a leaf of an open door fills the short one."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.houses import load_bank
from home_mjx.navigation.grid import cell_at_feet
from home_mjx.tasks import add_expert, sample_episodes
from home_mjx.tasks.experts.cell_search import distances_past_leaves
from home_mjx.tasks.experts.door_avoidance import is_shut
from home_mjx.tasks.rules.cell_graph import CellGraph

NUM_DRAWN, NUM_PLAYED, NUM_STEPS = 2000, 6, 250
MIN_DETOUR, MAX_DETOUR = 0.5, 6.0  # [m], extra length of the way past leaves: with a push it is longer


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def detours(bank):
    """Episodes whose shortest path pushes a leaf, and whose path past leaves is longer and pushes none."""
    drawn = sample_episodes(bank, NUM_DRAWN, min_length=3.0)
    house, start, goal = (np.asarray(x) for x in (drawn.house, drawn.start, drawn.columns["goal"]))
    extra = np.zeros(NUM_DRAWN)
    for h in range(bank.num_houses):
        own = np.flatnonzero(house == h)
        graphs = CellGraph(bank, h), CellGraph(bank, h, brush_cost_factor=1.0)
        ends = [graphs[0].nearest_cell(np.asarray(place)) for place in bank.navigation.goal[h]]
        at = np.array([int(graphs[0].nearest_cell(feet)[0][0]) for feet in start[own]])
        past, short = (graph.compute_distances(ends)[at, goal[own]] for graph in graphs)
        extra[own] = np.where(graphs[0].cut_off[at], 0.0, past - short)
    rows = np.flatnonzero((extra > MIN_DETOUR) & (extra < MAX_DETOUR))
    return drawn.pick(jnp.asarray(rows[np.argsort(-extra[rows], kind="stable")][:NUM_PLAYED]))


@pytest.fixture(scope="module")
def env(bank, detours):
    env = home_mjx.make(
        "PointNav-v0", bank, impl="kinematic", actions="discrete", stop=True, sensors=("state",),
        episode_length=NUM_STEPS,
    )  # fmt: skip
    return add_expert(env.with_tasks(detours))


def test_distances_are_those_of_fields_of_rows(env, bank):
    """Doors are open here, and the house has one level: the device and the host find the same ways past leaves."""
    core, params = env.core, env.params
    snapshot = core.snapshot(params, jax.jit(core.reset)(params, jax.random.key(0), None, jnp.int32(0)))
    graph = CellGraph(bank, int(snapshot.house))
    place = jnp.asarray(graph.place, jnp.float32)
    goal = jnp.int32(0)

    @jax.jit
    def distances(snapshot):
        cells = jax.vmap(lambda feet: cell_at_feet(snapshot.bank, snapshot.house, feet))(place)
        numbers = snapshot.bank.navigation.cell[snapshot.house][cells[:, 0], cells[:, 1], cells[:, 2]]
        return distances_past_leaves(snapshot, jnp.int32(0), goal)(cells, numbers)

    expected = graph.compute_distances([graph.nearest_cell(np.asarray(bank.navigation.goal[int(snapshot.house), 0]))])
    apart = np.abs(np.asarray(distances(snapshot)) - expected[:, 0])
    assert np.median(apart) < 0.05
    assert np.quantile(apart, 0.99) < 1.0  # `CellGraph` weighs a step by its slower end, `distance_field` by one end


def test_agents_arrive_and_push_no_leaf_shut(env, detours):
    core, params, count = env.core, env.params, len(detours.house)
    assert count == NUM_PLAYED
    state = jax.jit(jax.vmap(core.reset, (None, 0, None, 0)))(
        params, jax.random.split(jax.random.key(0), count), None, jnp.arange(count)
    )

    def advance(state, _):
        shut = jax.vmap(lambda one: is_shut(core.snapshot(params, one)).any())(state)
        after = jax.vmap(core.step, (None, 0, 0))(params, state, state.obs["expert"])
        return after, (shut, after.done, after.metrics["success"])

    _, (shut, done, success) = jax.jit(lambda state: jax.lax.scan(advance, state, None, NUM_STEPS))(state)
    end = np.argmax(done, axis=0)
    np.testing.assert_array_equal(np.asarray(success)[end, np.arange(count)], 1.0)
    assert not any(np.asarray(shut)[: last + 1, row].any() for row, last in enumerate(end))
