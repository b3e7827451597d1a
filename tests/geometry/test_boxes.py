"""Boxes against MuJoCo's geometry."""

import mujoco
import numpy as np
import pytest

from home_mjx.geometry.boxes import footprint, make_boxes, penetration_depth, rotate_boxes


def test_overlap_is_the_depth_of_mujoco_and_no_more_than_its_distance(rng):
    """Boxes as high as a tower: none is less deep upwards than in the plan."""
    met = 0
    for _ in range(200):
        center, half = np.c_[rng.uniform(-1, 1, (2, 2)), [0, 0]], np.c_[rng.uniform(0.05, 0.8, (2, 2)), [20, 20]]
        boxes = make_boxes(center, half, rng.uniform(-np.pi, np.pi, 2))
        ((depth,),) = penetration_depth(boxes[:1], boxes[1:])
        contacts, distance = _mujoco(boxes)
        assert (depth > 0) == bool(contacts)
        assert depth == pytest.approx(-min(contacts), abs=1e-6) if contacts else -depth <= distance + 1e-6
        np.testing.assert_allclose(penetration_depth(boxes[1:], boxes[:1]), depth, atol=1e-12)
        met += bool(contacts)
    assert 50 < met < 150


def _mujoco(boxes) -> tuple[list[float], float]:
    """Distances of the contacts of two boxes, and the distance between them."""
    spec = mujoco.MjSpec()
    for pos, half, yaw in zip(boxes.center, boxes.half, boxes.yaw, strict=True):
        body = spec.worldbody.add_body(pos=pos, quat=[np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)])
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return [contact.dist for contact in data.contact], mujoco.mj_geomDistance(model, data, 0, 1, 10.0, None)


def test_turned_boxes_keep_their_place_on_the_circle():
    boxes = rotate_boxes(make_boxes((2.0, 1.0, 0.5), (1.0, 0.1, 0.5)), np.pi / 2, np.array([1.0, 1.0]))
    np.testing.assert_allclose(boxes.center, [[1.0, 2.0, 0.5]], atol=1e-12)
    corners = footprint(boxes, 0)
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[0.9, 1.0], [1.1, 3.0]], atol=1e-12)
