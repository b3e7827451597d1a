"""Distance fields on the device against SciPy's Dijkstra on the host."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry import geodesic as host
from home_mjx.navigation.distance_fields import (
    BACK,
    FORTH,
    KERNEL,
    _grid_moves,
    _sweep_in_jax,
    _sweep_natively,
    distance_field,
    goal_fields,
)


def on_device(free: np.ndarray, sources: np.ndarray, cell: float = 0.1) -> np.ndarray:
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(jax.jit(jax.vmap(distance_field, (None, 0, None)), static_argnums=2)(free, sources, cell))


def single(free: np.ndarray, goals: np.ndarray) -> np.ndarray:
    sources = np.zeros((len(goals), *free.shape), bool)
    sources[np.arange(len(goals)), goals[:, 0], goals[:, 1]] = True
    return sources


@pytest.mark.parametrize("share", [0.55, 0.7, 0.95])
def test_random_mazes(rng, share):
    free = rng.random((40, 50)) < share
    goals = rng.permutation(np.argwhere(free))[:8]
    found = on_device(free, single(free, goals))
    wanted = host.distance_fields(free[None], np.c_[np.zeros(8, int), goals], 0.1).T
    np.testing.assert_allclose(found[:, free], wanted, rtol=1e-5)
    assert np.isinf(found[:, ~free]).all()


def test_a_spiral_takes_as_many_rounds_as_it_needs():
    free = np.ones((41, 50), bool)
    for turn in range(0, 20, 2):
        free[turn + 1, turn : 49 - turn] = False
        free[turn + 1 : 40 - turn, 48 - turn] = False
        free[39 - turn, turn + 1 : 49 - turn] = False
        free[turn + 3 : 40 - turn, turn + 1] = False
    goal = np.argwhere(free)[:1]
    found = on_device(free, single(free, goal))
    wanted = host.distance_fields(free[None], np.c_[[0], goal], 0.1).T
    np.testing.assert_allclose(found[:, free], wanted, rtol=1e-4)


def test_the_nearest_of_several_sources_counts(rng):
    free = rng.random((40, 50)) < 0.8
    goals = rng.permutation(np.argwhere(free))[:5]
    together = on_device(free, single(free, goals).any(axis=0)[None])[0]
    np.testing.assert_allclose(together, on_device(free, single(free, goals)).min(axis=0), rtol=1e-6)


def relaxed(free: np.ndarray, source: np.ndarray, slow: np.ndarray) -> np.ndarray:
    """By edges that are relaxed one after the other until nothing changes (Bellman and Ford), in cells."""
    far, moves = np.where(source & free, 0.0, np.inf), [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if y or x]
    cells, before = np.argwhere(free).tolist(), None
    inside = lambda y, x: 0 <= y < free.shape[0] and 0 <= x < free.shape[1] and free[y, x]  # noqa: E731
    while before is None or (before != far).any():
        before = far.copy()
        for y, x in cells:
            for dy, dx in moves:
                if inside(y + dy, x + dx) and inside(y + dy, x) and inside(y, x + dx):
                    far[y, x] = min(far[y, x], far[y + dy, x + dx] + slow[y, x] * np.hypot(dy, dx))
    return far


def test_ways_are_led_around_what_is_slow(rng):
    free, slow = rng.random((16, 20)) < 0.85, rng.choice([1.0, 4.0, 16.0], (16, 20))
    source = single(free, rng.permutation(np.argwhere(free))[:1])[0]
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        found = np.asarray(jax.jit(distance_field, static_argnums=2)(free, source, 1.0, slow.astype(np.float32)))
    np.testing.assert_allclose(found, relaxed(free, source, slow), rtol=1e-5)


def plan_distances(free: np.ndarray, height: np.ndarray, goals: np.ndarray, cell: float) -> np.ndarray:
    """Distances in plan over the cells that `grid_edges` joins, by Dijkstra."""
    sources, targets, _ = host.grid_edges(free[None], height[None], cell)
    place = np.argwhere(free) * cell
    graph = csr_matrix((np.linalg.norm(place[sources] - place[targets], axis=1), (sources, targets)), (len(place),) * 2)
    number = np.cumsum(free).reshape(free.shape) - 1
    return dijkstra(graph, directed=False, indices=number[tuple(goals.T)])


@pytest.mark.parametrize("cell", [0.1, 0.3])
def test_cells_are_joined_only_if_agents_can_walk_between_their_heights(rng, cell):
    free, height = (
        rng.random((40, 50)) < 0.9,
        np.float32(rng.choice([0.0, 0.2, 0.4, 0.7], (40, 50), p=[0.6, 0.2, 0.1, 0.1])),
    )
    goals = rng.permutation(np.argwhere(free))[:8]
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        field = functools.partial(distance_field, cell=cell, height=jnp.asarray(height))
        found = np.asarray(jax.jit(jax.vmap(field, (None, 0)))(free, single(free, goals)))
    wanted = plan_distances(free, height, goals, cell)
    np.testing.assert_allclose(found[:, free], wanted, rtol=1e-5)
    level = on_device(free, single(free, goals), cell)[:, free]
    assert (wanted > level + 0.1).mean() > 0.05


def test_fields_do_not_leave_a_gallery_across_its_edge():
    """A gallery, and beside it a ramp of 3 m from its height down to a hall: they meet only at the top of the ramp."""
    free, height = np.ones((12, 40), bool), np.full((12, 40), 2.8, np.float32)
    height[5:] = np.clip(np.linspace(2.8, -0.9, 40), 0, None)
    goal = single(free, np.array([[11, 39]]))[0]
    field = np.asarray(distance_field(jnp.asarray(free), jnp.asarray(goal), 0.1, 1.0, jnp.asarray(height)))
    assert 6.5 < field[0, 35] < 8.0


def test_sources_that_are_not_free_lead_nowhere():
    free = np.ones((40, 50), bool)
    free[3, 4] = False
    assert np.isinf(on_device(free, single(free, np.array([[3, 4]])))).all()


def test_fields_of_a_house_agree_with_the_stored_ones():
    house = shoebox(furniture=[Furniture((0.0, 0.5), size=(3.0, 0.3, 1.0))])
    n, bank = house.navigation, HouseBank.from_compiled([house])
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        fields = np.asarray(jax.jit(goal_fields)(bank, jnp.int32(0), jnp.int32(0), bank.navigation.goal[0, :4]))
    ny, nx = n.region.shape[1:]
    for g in range(4):
        stored, found = n.distance(g)[0][n.home_mask[0]], fields[g, :ny, :nx][n.home_mask[0]]
        # Sources reach to the neighbours of the goal's cell: at most one diagonal step nearer.
        assert (stored - found).min() > -0.01
        assert (stored - found).max() < 0.1 * 2**0.5 + 0.01


def test_diagonal_steps_pass_cells_that_lack_only_the_margin(rng):
    free = rng.random((40, 50)) < 0.6
    passable = free | (rng.random((40, 50)) < 0.5)
    goals = rng.permutation(np.argwhere(free))[:8]
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        field = functools.partial(distance_field, cell=0.1, passable=jnp.asarray(passable))
        found = np.asarray(jax.jit(jax.vmap(field, (None, 0)))(free, single(free, goals)))
    wanted = host.distance_fields(free[None], np.c_[np.zeros(8, int), goals], 0.1, passable=passable[None]).T
    np.testing.assert_allclose(found[:, free], wanted, rtol=1e-5)
    cut = host.distance_fields(free[None], np.c_[np.zeros(8, int), goals], 0.1).T
    assert (wanted < cut - 0.1).mean() > 0.1


def test_a_diagonal_gap_is_a_step_only_where_both_corners_are_passable():
    free = np.array([[1, 0], [0, 1]], bool)
    for passable, way in (([[1, 1], [1, 1]], 2**0.5), ([[1, 1], [0, 1]], np.inf), ([[1, 0], [0, 1]], np.inf)):
        passable = np.array(passable, bool)
        on_host = host.distance_fields(free[None], np.array([[0, 0, 0]]), 1.0, passable=passable[None])[:, 0]
        source = jnp.asarray(single(free, np.array([[0, 0]]))[0])
        on_device = distance_field(jnp.asarray(free), source, 1.0, passable=jnp.asarray(passable))
        np.testing.assert_allclose([on_host[1], on_device[1, 1]], way, rtol=1e-6)


def test_diagonals_are_clear_unless_cells_are_coarse():
    assert host.has_clear_diagonals(0.1, 0.1)
    assert not host.has_clear_diagonals(0.3, 0.1)


def test_the_kernel_sweeps_as_jax_does(rng):
    """Grids with heights, narrow cells and slow ones; most of them wind."""
    assert KERNEL.find_problem("cpu") is None
    count, rows, columns = 24, 37, 53
    free = rng.random((count, rows, columns)) < 0.7
    source = rng.random(free.shape) < 0.004
    slow = rng.choice([1.0, 1.5, 4.0], free.shape).astype(np.float32)
    height = np.cumsum(rng.choice([0.0, 0.01, 0.2], free.shape, p=[0.5, 0.45, 0.05]), axis=1).astype(np.float32)
    passable = free | (rng.random(free.shape) < 0.3)
    grids = tuple(map(jnp.asarray, (free, source, slow, height, passable)))

    def fields(sweep):
        def one(free, source, slow, height, passable):
            start = jnp.where(free & source, jnp.float32(0), jnp.inf)
            moves = (_grid_moves(free[way], passable[way], height[way], 0.1) for way in (FORTH, BACK))
            return sweep(start, jnp.float32(0.1) * slow, *moves)

        return np.asarray(jax.jit(jax.vmap(one))(*grids))

    by_kernel, by_jax = fields(_sweep_natively), fields(_sweep_in_jax)
    np.testing.assert_allclose(by_kernel, by_jax, rtol=2e-6)
    assert np.isfinite(by_jax).sum() > 1000
    assert (np.isinf(by_jax) & free).sum() > 1000
    whole = jax.vmap(
        lambda free, source, slow, height, passable: distance_field(free, source, 0.1, slow, height, passable)
    )
    np.testing.assert_array_equal(whole(*grids), by_kernel)


def test_a_field_has_the_gradient_of_its_steps():
    """In forward mode, in which the sweeps in JAX have one; it is the length of the steps on the shortest path."""
    free, source = jnp.ones((1, 5), bool), jnp.zeros((1, 5), bool).at[0, 0].set(True)
    slope = jax.jacfwd(lambda factor: distance_field(free, source, 0.5, factor)[0, 4])(jnp.ones((1, 5)))
    np.testing.assert_allclose(slope, [[0.0, 0.5, 0.5, 0.5, 0.5]])
