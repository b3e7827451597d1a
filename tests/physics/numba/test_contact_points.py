"""Contact points of pairs of shapes: C MuJoCo has the same ones."""

import numpy as np
import pytest
from c_oracle import contacts_of, floats, ordered, place, two_geoms
from mujoco import mj_forward
from numba import njit

from home_mjx.physics.numba.box_box import MAX_PAIR_POINTS, box_box
from home_mjx.physics.numba.capsule import capsule_box, capsule_capsule

RADIUS, LENGTH = 0.1, 0.7
CASES = 1500
UPRIGHT = np.array([1.0, 0, 0, 0])


@njit
def _at(array):
    return floats(array.ctypes.data)


@njit
def _box_box(pos1, rot1, half1, pos2, rot2, half2, points, normal):
    first, second = (_at(pos1), _at(rot1), _at(half1)), (_at(pos2), _at(rot2), _at(half2))
    return box_box(first[0], first[1], first[2], second[0], second[1], second[2], _at(points), _at(normal))


@njit
def _capsule_box(pos, box, rot, half, points, normals):
    return capsule_box(_at(pos), RADIUS, LENGTH, _at(box), _at(rot), _at(half), _at(points), _at(normals))


@njit
def _capsules(pos1, pos2, length2, points, normals):
    return capsule_capsule(_at(pos1), RADIUS, LENGTH, _at(pos2), RADIUS, length2, _at(points), _at(normals))


def turned(rng, kind: str) -> np.ndarray:
    """A rotation: any, one that is nearly none (faces nearly parallel), or about the vertical (exactly parallel)."""
    quat = {"any": rng.normal(size=4), "slight": UPRIGHT + 0.05 * rng.normal(size=4), "yaw": UPRIGHT.copy()}[kind]
    if kind == "yaw":
        quat[3] = rng.normal()
    return quat / np.linalg.norm(quat)


@pytest.mark.parametrize("kind", ["any", "slight", "yaw"])
def test_boxes(kind):
    rng, seen = np.random.default_rng(1), 0
    model, data = two_geoms('type="box" size="1 1 1"', 'type="box" size="1 1 1"')
    points, normal = np.zeros((MAX_PAIR_POINTS, 4)), np.zeros(3)
    for _ in range(CASES):
        half = rng.uniform(0.05, 1, (2, 3))
        for geom in range(2):
            place(model, data, geom, rng.uniform(-0.9, 0.9, 3), turned(rng, kind), half[geom])
        mj_forward(model, data)
        (pos1, pos2), (rot1, rot2) = data.geom_xpos.copy(), data.geom_xmat.copy()
        count = _box_box(pos1, rot1, half[0], pos2, rot2, half[1], points, normal)
        rows = np.c_[points[:count], np.tile(normal, (count, 1))]
        assert count == data.ncon
        np.testing.assert_allclose(ordered(rows), contacts_of(data), atol=1e-7)
        seen += count > 0
    assert seen > CASES // 4


@pytest.mark.parametrize("kind", ["any", "slight", "yaw"])
def test_a_capsule_and_a_box(kind):
    rng, seen = np.random.default_rng(2), 0
    model, data = two_geoms(f'type="capsule" size="{RADIUS} {LENGTH}"', 'type="box" size="1 1 1"')
    points, normals = np.zeros((2, 4)), np.zeros((2, 3))
    place(model, data, 0, np.zeros(3), UPRIGHT, None)
    for _ in range(CASES):
        half = rng.uniform(0.02, 0.8, 3)
        place(model, data, 1, rng.uniform(-0.8, 0.8, 3), turned(rng, kind), half)
        mj_forward(model, data)
        count = _capsule_box(np.zeros(3), data.geom_xpos[1].copy(), data.geom_xmat[1].copy(), half, points, normals)
        rows, truth = ordered(np.c_[points[:count], normals[:count]]), contacts_of(data)
        assert rows.shape == truth.shape
        np.testing.assert_allclose(rows, truth, atol=1e-7)
        seen += count > 0
    assert seen > CASES // 6


def test_two_capsules():
    rng, seen = np.random.default_rng(3), 0
    model, data = two_geoms(f'type="capsule" size="{RADIUS} {LENGTH}"', f'type="capsule" size="{RADIUS} 0.5"')
    points, normals = np.zeros((2, 4)), np.zeros((2, 3))
    place(model, data, 0, np.zeros(3), UPRIGHT, None)
    for _ in range(CASES):
        place(model, data, 1, rng.uniform(-0.25, 0.25, 3) * [1, 1, 6], UPRIGHT, None)
        mj_forward(model, data)
        count = _capsules(np.zeros(3), data.geom_xpos[1].copy(), 0.5, points, normals)
        assert count == data.ncon
        np.testing.assert_allclose(ordered(np.c_[points[:count], normals[:count]]), contacts_of(data), atol=1e-7)
        seen += count > 0
    assert seen > CASES // 4
