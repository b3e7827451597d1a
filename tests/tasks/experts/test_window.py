"""Windows of distances: against Dijkstra, and around what is slow."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from home_mjx.tasks.experts.window import HALF, WIDTH, descend_window, window_distances

CELL = 0.1


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
    free[HALF, HALF] = free[3, 4] = True
    far = dijkstra(steps(free, np.ones(free.shape)).T, indices=3 * WIDTH + 4).reshape(free.shape)
    return np.isfinite(far), np.where(np.isfinite(far), far, np.inf).astype(np.float32)


def test_where_nothing_is_in_the_way_distances_are_as_known(room):
    free, far = room
    found = jax.jit(window_distances)(far.ravel(), np.full(far.size, CELL, np.float32))
    np.testing.assert_allclose(np.asarray(found)[free], far[free], atol=1e-4)
    assert np.isinf(np.asarray(found)[~free]).all()


def test_what_is_slow_is_gone_round(room):
    """Distances are those of the best of: a way within the window to its end, or to its edge and on as known."""
    free, far = room
    slow = np.ones(far.shape, np.float32)
    slow[6:9, 2:16] = 16.0
    found = np.asarray(jax.jit(window_distances)(far.ravel(), (CELL * slow).ravel()))
    ends = np.zeros(far.shape, bool)
    ends[[0, -1]] = ends[:, [0, -1]] = ends[3, 4] = True
    within = dijkstra(steps(free, slow), indices=np.arange(far.size))[:, np.flatnonzero(ends & free)]
    expected = np.min(within + far[ends & free], axis=1).reshape(far.shape)
    np.testing.assert_allclose(found[free], expected[free], atol=1e-4)
    assert (found[free] > far[free] + 0.05).any()
    path = np.asarray(descend_window(jnp.asarray(found), 6))[:, 1:] + HALF
    assert (path[0] == HALF).all()
    assert (np.abs(np.diff(path, axis=0)).max(axis=1) <= 1).all()
    assert (np.diff(found[tuple(path.T)]) <= 0).all()
