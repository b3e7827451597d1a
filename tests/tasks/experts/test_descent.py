"""Ways down: whole steps end where they should, straight ways keep away from leaves of doors."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial.distance import cdist

import home_mjx
from home_mjx.navigation.grid import cell_at_feet, cell_position, stored_distance
from home_mjx.tasks.experts.door_avoidance import (
    NUM_IMPATIENT_STEPS,
    PATIENCE_PERIOD,
    cell_cost_factors,
    leaf_distances,
)
from home_mjx.tasks.experts.field_descent import END_TOLERANCE, _next_cell, descend_field, step_aside
from home_mjx.tasks.rules.cell_graph import BRUSH_COST_FACTOR, MIN_LEAF_CLEARANCE, PUSH_COST_FACTOR, CellGraph

STEP = 0.25


@jax.jit
def is_near_leaf(snapshot, place):
    """Whether feet at each place would be within `MIN_LEAF_CLEARANCE` of a leaf."""
    return leaf_distances(snapshot, place) < jnp.float32(snapshot.bank.spec.agent_radius + MIN_LEAF_CLEARANCE)


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make("RoomNav-v0", generated_bank, sensors=("state",), num_tasks=2, impl="kinematic")


@pytest.fixture(scope="module")
def snapshot(env):
    state = jax.jit(lambda key: env.core.reset(env.params, key, None, 0, observe=False))(jax.random.key(0))
    return env.core.snapshot(env.params, state)


@pytest.fixture(scope="module")
def graph(generated_bank):
    return CellGraph(jax.tree.map(np.asarray, generated_bank), 0)


def test_leaves_of_doors_are_where_fields_of_rows_have_them(snapshot, graph):
    """Doors are open here: the device and the host name the same cells."""
    place = jnp.asarray(graph.place, jnp.float32)
    found = np.asarray(is_near_leaf(snapshot, place))
    assert found.any()
    near = (
        np.abs(
            np.asarray(jax.jit(leaf_distances)(snapshot, place)) - snapshot.bank.spec.agent_radius - MIN_LEAF_CLEARANCE
        )
        < 1e-4
    )
    near |= graph.cut_off  # there nothing begins, whether or not a leaf is beside it
    np.testing.assert_array_equal(found[~near], graph.at_leaf[~near])
    cells = np.asarray(jax.jit(jax.vmap(lambda p: cell_at_feet(snapshot.bank, snapshot.house, p)))(place))
    assert not cells[:, 0].any()  # the house has one storey
    slow = np.asarray(jax.jit(cell_cost_factors)(snapshot, jnp.int32(0)))[tuple(cells[:, 1:].T)]
    np.testing.assert_array_equal(slow[~near] >= BRUSH_COST_FACTOR, graph.at_leaf[~near])


def test_after_a_collision_agents_aim_where_a_step_ends(snapshot):
    """In a passage of .3 m one that aimed .1 m ahead and walked .25 m slid from side to side."""
    ahead = np.arange(1, 7) * 0.1
    place = snapshot.feet[0] + jnp.asarray(ahead[:, None] * [1.0, 0.0, 0.0], jnp.float32)
    chosen = [int(_next_cell(snapshot, jnp.int32(0), place, jnp.asarray(ahead <= most))) for most in (1.0, 0.15, 0.0)]
    assert abs(ahead[chosen[0]] - STEP) <= 0.051
    assert chosen[1:] == [0, 0]


def test_agents_brush_leaves_after_some_steps_but_do_not_push_them(snapshot):
    """Who turned round at a leaf, and comes back for it, walks past it in the end, and does not shut it for good."""
    last = snapshot.replace(step=jnp.int32(PATIENCE_PERIOD - NUM_IMPATIENT_STEPS - 1))
    before, after = (jax.jit(cell_cost_factors)(last.replace(step=last.step + k), jnp.int32(0)) for k in (0, 1))
    assert (before == BRUSH_COST_FACTOR).any()
    assert (before == PUSH_COST_FACTOR).any()
    np.testing.assert_array_equal(after, jnp.where(before == PUSH_COST_FACTOR, before, 1))


def test_what_open_leaves_cut_off_is_what_a_flood_from_the_rest_does_not_reach(snapshot, graph):
    """The house has one storey. Corners are not cut, so that a flood over four neighbours will do."""
    place = jnp.asarray(graph.place, jnp.float32)
    cells = np.asarray(jax.jit(jax.vmap(lambda p: cell_at_feet(snapshot.bank, snapshot.house, p)))(place))
    assert (cells[:, 0] == 0).all()
    clear = np.asarray(jax.jit(leaf_distances)(snapshot, place)) >= snapshot.bank.spec.agent_radius
    free = np.zeros(cells[:, 1:].max(axis=0) + 1, bool)
    free[tuple(cells[clear, 1:].T)] = True
    label, count = ndimage.label(free)
    most = 1 + np.argmax(ndimage.sum_labels(free, label, range(1, count + 1)))
    np.testing.assert_array_equal(graph.cut_off, label[tuple(cells[:, 1:].T)] != most)


def stands_at(snapshot, pos):
    """The same with the agent at another place, in touch with nothing."""
    pose = snapshot.pose.replace(pos=pos[None])
    return snapshot.replace(pose=pose, in_contact=jnp.zeros(1, bool))


def test_two_steps_lead_to_any_place_that_is_near(snapshot, graph, rng):
    """From places all around the middle of a room: each step is one of 0.25 m, in the direction that is asked for."""
    around = cdist(graph.place[:, :2], graph.place[~graph.at_leaf, :2]) < 2 * STEP + 0.1
    clear = graph.place[np.argmax(around.sum(axis=1))]
    agent = jnp.int32(0)
    aim = jax.jit(jax.vmap(lambda pos, end: step_aside(stands_at(snapshot, pos), agent, end, STEP), (0, None)))
    angle, away = rng.uniform(0, 2 * np.pi, 64), rng.uniform(0.02, 2 * STEP, 64)
    end = clear[:2].astype(np.float32)
    pos = np.c_[end + np.c_[np.cos(angle), np.sin(angle)] * away[:, None], np.full(64, clear[2])].astype(np.float32)
    for _ in range(2):
        gone = np.linalg.norm(pos[:, :2] - end, axis=1) < END_TOLERANCE * STEP
        way = np.asarray(aim(pos, end)) - pos[:, :2]
        way = way / np.linalg.norm(way, axis=1, keepdims=True)
        pos[:, :2] += np.where(gone, 0.0, STEP)[:, None] * way
    assert np.mean(np.linalg.norm(pos[:, :2] - end, axis=1) < END_TOLERANCE * STEP) > 0.95


def test_straight_ways_keep_away_from_leaves(env, snapshot, graph):
    """Where the cell beside a place is off all leaves, so is every point of the way on which an expert sets out."""
    tasks, bank = env.params.tasks, snapshot.bank
    first = int(bank.navigation.first_cell[0])
    cells = jnp.asarray(first + np.flatnonzero(~graph.at_leaf))
    column = jnp.int32(tasks.rows.columns["field"][np.flatnonzero(np.asarray(tasks.rows.house) == 0)[0], 0])

    def aimed(cell):
        pos = cell_position(bank, snapshot.house, cell)
        far = lambda _, cell: stored_distance(tasks.field, cell, column)  # noqa: E731
        return pos, descend_field(stands_at(snapshot, pos), jnp.int32(0), far)[0]

    pos, aim = (np.asarray(x) for x in jax.jit(jax.vmap(aimed))(cells))
    part = np.linspace(0, 1, 9)[1:, None]
    way = pos[:, None] + part * np.concatenate([aim - pos[:, :2], np.zeros((len(aim), 1))], axis=1)[:, None]
    beside = np.asarray(is_near_leaf(snapshot, jnp.asarray(way.reshape(-1, 3), jnp.float32)))
    ends = np.asarray(is_near_leaf(snapshot, jnp.asarray(np.c_[aim, pos[:, 2]], jnp.float32)))
    # A way that must go past a leaf may be cut short there, too: few are.
    assert beside.reshape(way.shape[:2])[~ends].any(axis=1).mean() < 0.02
    assert ends.mean() < 0.2
