"""Windows of distances: against Dijkstra, and around what is slow."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from home_mjx.navigation.distance_fields import distance_field
from home_mjx.tasks.experts.local_planner import (
    HALF_WIDTH,
    MAX_DETOUR_RISE,
    RIDGE_COST_FACTOR,
    WIDTH,
    descend_window,
    nearest_walkable,
    window_distances,
)

CELL = 0.1

LEVEL = jnp.zeros(WIDTH * WIDTH)  # [m], height of the cells of one floor


def steps(free: np.ndarray, slow: np.ndarray) -> coo_matrix:
    """Ways out of each free cell to its free neighbours, without cutting corners [m]."""
    rows, columns, lengths = [], [], []
    number = np.arange(free.size).reshape(free.shape)
    for y, x in np.argwhere(free).tolist():
        for dy, dx in [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]:
            if not (0 <= y + dy < WIDTH and 0 <= x + dx < WIDTH):
                continue
            if free[y + dy, x + dx] and free[y + dy, x] and free[y, x + dx]:
                rows.append(number[y, x])
                columns.append(number[y + dy, x + dx])
                lengths.append(CELL * slow[y, x] * np.hypot(dy, dx))
    return coo_matrix((lengths, (rows, columns)), shape=(free.size, free.size)).tocsr()


@pytest.fixture
def room(rng):
    """A window with a few posts in it, and the distances of its cells to one of them."""
    free = rng.random((WIDTH, WIDTH)) < 0.9
    free[HALF_WIDTH, HALF_WIDTH] = free[3, 4] = True
    far = dijkstra(steps(free, np.ones(free.shape)).T, indices=3 * WIDTH + 4).reshape(free.shape)
    return np.isfinite(far), np.where(np.isfinite(far), far, np.inf).astype(np.float32)


def test_where_nothing_is_in_the_way_distances_are_as_known(room):
    free, far = room
    found = jax.jit(window_distances)(far.ravel(), np.full(far.size, CELL, np.float32), LEVEL)
    low = far <= far[HALF_WIDTH, HALF_WIDTH] + MAX_DETOUR_RISE
    np.testing.assert_allclose(np.asarray(found)[low], far[low], atol=1e-4)
    assert np.isinf(np.asarray(found)[~free]).all()


def test_what_is_slow_is_gone_round_on_the_way_to_an_end(room):
    free, far = room
    slow = slowed(far)
    found = np.asarray(jax.jit(window_distances)(far.ravel(), (CELL * slow).ravel(), LEVEL))
    expected = dijkstra(steps(free, over_ridges(far, slow)).T, indices=3 * WIDTH + 4).reshape(far.shape)
    # A way of more cells than rounds is not found.
    np.testing.assert_allclose(found[np.isfinite(found)], expected[np.isfinite(found)], atol=1e-4)
    assert np.isfinite(found)[free].mean() > 0.9
    assert (found[free] > far[free] + 0.05).any()
    path = np.asarray(descend_window(jnp.asarray(found), LEVEL, jnp.array([HALF_WIDTH, HALF_WIDTH]), 6)) + HALF_WIDTH
    assert (path[0] == HALF_WIDTH).all()
    assert (np.abs(np.diff(path, axis=0)).max(axis=1) <= 1).all()
    assert (np.diff(found[tuple(path.T)]) <= 0).all()


def test_without_an_end_ways_lead_to_the_edge_and_on_as_known(room):
    """Of what lies beyond the left edge."""
    free, _ = room
    sources = np.flatnonzero(free[:, 0]) * WIDTH
    far = dijkstra(steps(free, np.ones(free.shape)).T, indices=sources, min_only=True).reshape(free.shape) + 3
    free = np.isfinite(far)
    slow = slowed(far)
    found = np.asarray(jax.jit(window_distances)(far.ravel().astype(np.float32), (CELL * slow).ravel(), LEVEL))
    ways, known = steps(free, np.ones(free.shape)), far.ravel()
    around = np.array([known[ways[i].indices].min(initial=np.inf) for i in range(known.size)])
    ends = np.flatnonzero(free.ravel() & (known <= around))
    within = dijkstra(steps(free, over_ridges(far, slow)), indices=np.arange(far.size))[:, ends]
    expected = np.min(within + far.ravel()[ends], axis=1).reshape(far.shape)
    reached = np.isfinite(found)  # a way of more cells than rounds is not found
    np.testing.assert_allclose(found[reached], expected[reached], atol=1e-4)
    assert reached[free].mean() > 0.9


def over_ridges(far: np.ndarray, slow: np.ndarray) -> np.ndarray:
    """Cost factors, those of cells much farther from the end than the middle included."""
    far = far.astype(np.float32)
    return slow * np.where(far > far[HALF_WIDTH, HALF_WIDTH] + np.float32(MAX_DETOUR_RISE), RIDGE_COST_FACTOR, 1)


def slowed(far: np.ndarray) -> np.ndarray:
    """Something long that is slow."""
    slow = np.ones(far.shape, np.float32)
    slow[8:11, 2:20] = 16.0
    return slow


def test_who_stands_beside_the_cells_goes_back_into_the_room_that_it_is_in():
    """There are cells behind the wall that are nearer, and nearer to the end."""
    known, behind = np.full((WIDTH, WIDTH), np.inf, np.float32), np.zeros((WIDTH, WIDTH), bool)
    known[HALF_WIDTH + 7], known[HALF_WIDTH - 4] = 12.0, 4.0
    behind[: HALF_WIDTH - 2] = True

    def nearest(elsewhere):
        return nearest_walkable(jnp.asarray(known.ravel()), jnp.asarray(elsewhere.ravel())).tolist()

    assert nearest(behind) == [HALF_WIDTH + 7, HALF_WIDTH]
    assert nearest(np.zeros_like(behind)) == [HALF_WIDTH - 4, HALF_WIDTH]
    known[HALF_WIDTH + 7] = np.inf  # there is no other way
    assert nearest(behind) == [HALF_WIDTH - 4, HALF_WIDTH]


def test_paths_do_not_lead_from_a_floor_to_the_one_below():
    """The right half is 2.8 m lower, and the end is there; a ramp of cells joins them at the last row."""
    height = np.zeros((WIDTH, WIDTH), np.float32)
    height[:, HALF_WIDTH + 1 :] = -2.8
    far = np.where(height < 0, 1.0, 5.0 + 0.1 * np.arange(WIDTH)[::-1, None]).astype(np.float32)
    found = window_distances(jnp.asarray(far.ravel()), jnp.full(far.size, CELL), jnp.asarray(height.ravel()))
    begin = jnp.array([HALF_WIDTH, HALF_WIDTH])
    path = np.asarray(descend_window(found, jnp.asarray(height.ravel()), begin, 6)) + HALF_WIDTH
    assert (path[:, 1] <= HALF_WIDTH).all()
    assert path[-1, 0] == HALF_WIDTH + 6


@pytest.mark.parametrize("are_corners_passable", [False, True])
def test_paths_cut_corners_only_over_passable_cells(are_corners_passable: bool):
    """The end is beyond a gap between two cells that touch at a corner; the other way is along two edges."""
    free = np.zeros((WIDTH, WIDTH), bool)
    free[HALF_WIDTH:, : HALF_WIDTH + 1] = free[:HALF_WIDTH, HALF_WIDTH + 1 :] = free[0] = free[:, 0] = True
    passable = free.copy()
    passable[[HALF_WIDTH - 1, HALF_WIDTH], [HALF_WIDTH, HALF_WIDTH + 1]] |= are_corners_passable
    end = (HALF_WIDTH - 4, HALF_WIDTH + 4)
    source = jnp.zeros((WIDTH, WIDTH), bool).at[end].set(True)
    known = distance_field(jnp.asarray(free), source, CELL, passable=jnp.asarray(passable)).ravel()
    far = window_distances(known, jnp.full(known.size, CELL), LEVEL, jnp.asarray(passable.ravel()))
    begin = jnp.array([HALF_WIDTH, HALF_WIDTH])
    path = np.asarray(descend_window(far, LEVEL, begin, 4, jnp.asarray(passable.ravel())))
    assert path.tolist() == [[-k * are_corners_passable, k * (1 if are_corners_passable else -1)] for k in range(5)]


def test_a_way_past_a_leaf_is_not_left_for_an_exit_farther_from_the_end():
    """A detour beyond the window: the leaf drops out of sight, and the agent would come back for ever."""
    rows = np.arange(WIDTH)
    far = np.full((WIDTH, WIDTH), np.inf, np.float32)
    far[:, HALF_WIDTH - 1 : HALF_WIDTH + 2] = (3.0 + CELL * rows)[:, None]  # a corridor to the end, up
    far[-1, HALF_WIDTH + 2 :] = 5.75 - CELL * np.arange(WIDTH - HALF_WIDTH - 2)  # and another way to it, down
    slow = np.ones(far.shape)
    slow[2:5] = 16.0
    found = window_distances(jnp.asarray(far.ravel()), jnp.asarray((CELL * slow).ravel()), LEVEL)
    path = np.asarray(descend_window(found, LEVEL, jnp.array([HALF_WIDTH, HALF_WIDTH]), 6))
    assert (np.diff(path[:, 0]) == -1).all()


def test_an_exit_beside_a_leaf_costs_more_than_a_clear_one():
    """The rest of the leaf lies beyond the edge of the window, where it is not seen."""
    columns = np.arange(WIDTH)
    far = np.full((WIDTH, WIDTH), np.inf, np.float32)
    far[HALF_WIDTH - 1 : HALF_WIDTH + 2] = 3.0 + CELL * columns  # a corridor to the end, left
    far[HALF_WIDTH + 2 :, 18:21] = (4.8 - CELL * np.arange(HALF_WIDTH - 1))[:, None]  # and one down, 0.3 m longer
    slow = np.ones(far.shape)
    slow[:, 0] = 4.0
    found = window_distances(jnp.asarray(far.ravel()), jnp.asarray((CELL * slow).ravel()), LEVEL)
    path = np.asarray(descend_window(found, LEVEL, jnp.array([HALF_WIDTH, HALF_WIDTH]), 6))
    assert (np.diff(path[:4, 1]) == 1).all()


def test_a_corridor_with_a_leaf_ahead_is_left_in_one_direction():
    """Two ways to the end are nearly as long, a leaf is on one: who sees it does not turn round and come back."""
    length, leaf = 90, slice(24, 30)
    line = np.minimum(3.0 + CELL * np.arange(length), 4.1 + CELL * np.arange(length)[::-1])
    far, slow = (np.full((length + 2 * WIDTH, WIDTH), fill, np.float32) for fill in (np.inf, 1.0))
    aside = 0.05 * np.arange(7)  # ways are shorter on the side of the leaf
    far[WIDTH:-WIDTH, HALF_WIDTH - 3 : HALF_WIDTH + 4] = line[:, None] + aside
    slow[WIDTH + leaf.start : WIDTH + leaf.stop, : HALF_WIDTH + 2] = 4.0
    plan = jax.jit(lambda far, slow: descend_window(window_distances(far, slow, LEVEL), LEVEL, jnp.zeros(2, int), 1))
    for begin in range(40, 50):
        at, seen = np.array([WIDTH + begin, HALF_WIDTH]), set()
        while WIDTH + 4 < at[0] < WIDTH + length - 5 and tuple(at) not in seen:
            seen.add(tuple(at))
            window = slice(at[0] - HALF_WIDTH, at[0] + HALF_WIDTH + 1)
            around = [np.full((WIDTH, WIDTH), fill, np.float32) for fill in (np.inf, 1.0)]
            left = at[1] - HALF_WIDTH
            for target, source in zip(around, (far, slow), strict=True):
                part = source[window, max(left, 0) : WIDTH + min(left, 0)]
                target[:, max(-left, 0) : max(-left, 0) + part.shape[1]] = part
            at = at + np.asarray(plan(*(jnp.asarray(x.ravel() * f) for x, f in zip(around, (1, CELL), strict=True))))[1]
        assert tuple(at) not in seen, f"from {begin}"
