"""Slots hold the nearest static boxes, cut to the owner's surroundings."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from home_mjx.physics.mjx.contact_slots import MAX_SLOT_DISTANCE, OrientedBoxes, fill_slots, separation


def _random_boxes(rng, count, spread, upright=False):
    quat = rng.normal(size=(count, 4)) * ([1, 0, 0, 1] if upright else 1)
    quat /= np.linalg.norm(quat, axis=1, keepdims=True)
    pos, half = rng.uniform(-spread, spread, (count, 3)), rng.uniform(0.05, 0.8, (count, 3))
    return OrientedBoxes(*(jnp.asarray(x, jnp.float32) for x in (pos, quat, half)))


def _corners(pos, quat, half):
    signs = np.stack(np.meshgrid(*[[-1, 1]] * 3), -1).reshape(-1, 3)
    return Rotation.from_quat(quat, scalar_first=True).apply(signs * half) + pos


def _gaps(a, b):
    """Gaps of two boxes along their six face axes, by projecting all corners."""
    first, second = (_corners(*(np.asarray(x, float) for x in (box.pos, box.quat, box.half))) for box in (a, b))
    turns = [Rotation.from_quat(np.asarray(box.quat, float), scalar_first=True).as_matrix() for box in (a, b)]
    for axis in np.concatenate([t.T for t in turns]):
        u, v = first @ axis, second @ axis
        yield max(u.min() - v.max(), v.min() - u.max())


def _distance(a, b):
    """Distance of two boxes, by minimising over points of both."""
    (pa, ra, ha), (pb, rb, hb) = (
        (np.asarray(x.pos, float), Rotation.from_quat(np.asarray(x.quat, float), scalar_first=True), np.asarray(x.half))
        for x in (a, b)
    )

    def apart(z):
        return np.sum((pa + ra.apply(z[:3]) - pb - rb.apply(z[3:])) ** 2)

    bounds = [(-h, h) for h in (*ha.astype(float), *hb.astype(float))]
    return np.sqrt(minimize(apart, np.zeros(6), bounds=bounds, tol=1e-12).fun)


def _row(boxes, i):
    return jax.tree.map(lambda x: x[i], boxes)


@pytest.fixture
def strict():
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        yield


def test_separation_is_the_largest_gap_along_the_face_axes(rng, strict):
    owners, static = _random_boxes(rng, 8, 1.0), _random_boxes(rng, 32, 2.0)
    got = jax.vmap(lambda owner: separation(owner, static))(owners)
    want = [[max(_gaps(_row(owners, i), _row(static, j))) for j in range(32)] for i in range(8)]
    assert_allclose(got, want, atol=1e-5)


def test_separation_never_exceeds_the_distance(rng):
    owner, static = _random_boxes(rng, 1, 0.5), _random_boxes(rng, 24, 2.5)
    got = separation(_row(owner, 0), static)
    distance = np.array([_distance(_row(owner, 0), _row(static, j)) for j in range(24)])
    assert (np.asarray(got) <= distance + 1e-4).all()
    assert (distance > 0.1).sum() > 10


def test_slots_hold_the_nearest_boxes_and_park_the_others(rng, strict):
    owner, static = _row(_random_boxes(rng, 1, 0.3), 0), _random_boxes(rng, 40, 2.0)
    gap = np.asarray(separation(owner, static))
    slots, _, _ = fill_slots(owner, static, 6)
    nearest = np.argsort(gap)[:6]
    near = gap[nearest] < MAX_SLOT_DISTANCE
    assert near.any()
    assert_allclose(np.asarray(slots.quat)[near], np.asarray(static.quat)[nearest][near])
    assert (np.asarray(slots.pos)[~near, 2] < -100).all()


def test_cut_boxes_keep_what_is_near_the_owner(rng, strict):
    owner, static = _row(_random_boxes(rng, 1, 0.3), 0), _random_boxes(rng, 40, 1.0)
    radius = np.linalg.norm(owner.half) + MAX_SLOT_DISTANCE
    (slots, _, _), order = fill_slots(owner, static, 40), np.argsort(np.asarray(separation(owner, static)))
    points = np.asarray(owner.pos) + rng.normal(size=(500, 3)) * radius / 3
    points = points[np.linalg.norm(points - np.asarray(owner.pos), axis=1) < radius]

    def inside(boxes, i):
        turn = Rotation.from_quat(np.asarray(boxes.quat[i]), scalar_first=True)
        local = turn.inv().apply(points - np.asarray(boxes.pos[i]))
        return (np.abs(local) <= np.asarray(boxes.half[i]) + 1e-5).all(axis=1)

    count = 0
    for slot, source in enumerate(order):
        if slots.pos[slot, 2] > -100:
            assert (inside(slots, slot) == inside(static, int(source))).all()
            assert (np.asarray(slots.half[slot]) <= np.asarray(static.half[int(source)]) + 1e-6).all()
            count += 1
    assert count > 5


def test_box_just_out_of_reach_is_parked():
    owner = OrientedBoxes(jnp.zeros(3), jnp.array([1.0, 0, 0, 0]), jnp.full(3, 0.5))
    x = jnp.array([0.5 + 0.1 + MAX_SLOT_DISTANCE - 1e-3, 0.5 + 0.1 + MAX_SLOT_DISTANCE + 1e-3])
    static = OrientedBoxes(
        jnp.stack([x, jnp.zeros(2), jnp.zeros(2)], -1), jnp.tile(owner.quat[None], (2, 1)), jnp.full((2, 3), 0.1)
    )
    slots, _, _ = fill_slots(owner, static, 2)
    assert_allclose(slots.pos[0], static.pos[0])
    assert slots.pos[1, 2] < -100
