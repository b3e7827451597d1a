"""Whole environments: accelerations of the fused step are those of C MuJoCo, converged."""

import numpy as np
import pytest
from c_oracle import Boxes, Oracle
from heaps import AGENTS, BODIES, heap

from home_mjx.physics import PhysicsSetup


@pytest.mark.parametrize("trays", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_a_heap_accelerates_as_in_c(seed, trays):
    rng, contacts = np.random.default_rng(seed), 0
    for _ in range(10):
        oracle, qpos, qvel, action = heap(rng, trays=trays)
        truth, count = oracle.accelerations(qpos, qvel, action)
        _, _, found, own_count, lost = oracle.fused(qpos, qvel, action)
        assert own_count == count
        assert lost.tolist() == [0, 0]
        np.testing.assert_allclose(found, truth, atol=1e-9 * np.abs(truth).max())
        contacts += count
    assert contacts > 300


@pytest.mark.slow
def test_a_thousand_heaps_accelerate_as_in_c():
    rng = np.random.default_rng(100)
    for _ in range(1000):
        oracle, qpos, qvel, action = heap(rng)
        truth, count = oracle.accelerations(qpos, qvel, action)
        _, _, found, own_count, _ = oracle.fused(qpos, qvel, action)
        assert own_count == count
        np.testing.assert_allclose(found, truth, atol=1e-8 * np.abs(truth).max())


def test_free_flight_is_exact():
    """Linear motion and spin without contact: momentum is kept, and the fall is g t."""
    rng = np.random.default_rng(7)
    oracle, qpos, qvel, action = heap(rng)
    bodies = qpos[4 * AGENTS : 4 * AGENTS + 7 * BODIES].reshape(-1, 7)
    bodies[:, :3] = 50.0 * np.arange(1, BODIES + 1)[:, None] + 100
    before = qvel[4 * AGENTS : 4 * AGENTS + 6 * BODIES].reshape(-1, 6).copy()
    _, after, _, _, _ = oracle.fused(qpos, qvel, action, substeps=20)
    after = after[4 * AGENTS : 4 * AGENTS + 6 * BODIES].reshape(-1, 6)
    np.testing.assert_allclose(after[:, :2], before[:, :2], rtol=1e-12)
    np.testing.assert_allclose(after[:, 2], before[:, 2] - 9.81 * 20 * oracle.config.timing.sim_dt, rtol=1e-12)


def test_bodies_that_just_touch_the_floor_take_few_steps():
    """At rest, with corners on the floor to the last bit: what is left to gain is rounding, and it is left."""
    half = np.full((4, 3), 0.25)
    rows = np.arange(1, 5)[:, None]
    bodies = Boxes(np.c_[rows, rows, np.full(4, 0.25)], np.tile([1.0, 0, 0, 0], (4, 1)), half)
    far = Boxes(np.full((1, 3), -50.0), np.array([[1.0, 0, 0, 0]]), np.full((1, 3), 0.1))
    oracle = Oracle(PhysicsSetup(), far, bodies, np.full(4, 10.0))
    qpos = np.r_[0, 0, 0.8, 0, np.c_[bodies.pos, bodies.quat].ravel()]
    oracle.fused(qpos, np.zeros(28), np.zeros((1, 3)), substeps=1)
    for height in (0.0, -1e-12, -1e-9, -1e-6, -1e-3):
        lower = qpos.copy()
        lower[4:].reshape(-1, 7)[:, 2] += height
        truth, _ = oracle.accelerations(lower, np.zeros(28), np.zeros((1, 3)))
        found = oracle.fused(lower, np.zeros(28), np.zeros((1, 3)))[2]
        np.testing.assert_allclose(found, truth, atol=1e-7)
        assert oracle.newton_steps <= 4 * 5
