"""Hollows behind fronts: closed surfaces with the right insides, and boxes that are free there."""

import numpy as np
import pytest

from home_mjx.geometry.boxes import make_boxes
from home_mjx.geometry.meshes import box_triangles, make_model
from home_mjx.scene_compile.objects.compartments import BOARD, carve_boxes, cut_pockets

SIZE, DOOR = np.array([1.0, 0.6, 1.8]), np.array([0.497, 0.02, 1.79])
AS_IS = np.eye(3)
NUM_SHELVES = 5  # compartments behind each door: 1.754 m by at most 0.4 m


def block(middle, size, turn=AS_IS):
    return box_triangles(np.array(middle), np.array(size) / 2) @ turn.T


def wardrobe(turn=AS_IS, inset=0.0):
    """A closed body with two doors before its side -y, or another one if turned, and a foot."""
    pieces = block((0, 0, 0.95), SIZE, turn), block((0, 0, 0.02), (0.04, 0.04, 0.04))
    body = make_model("wardrobe/frame", np.concatenate(pieces))
    doors = [block((x, -0.31 + inset, 0.95), DOOR, turn) for x in (-0.2485, 0.2485)]
    return body, [make_model("wardrobe/leaf", triangles) for triangles in doors]


def volume(triangles):
    """By the divergence theorem, of a closed surface."""
    a, b, c = triangles.astype(float).transpose(1, 0, 2)
    return np.einsum("ti,ti->", a, np.cross(b, c)) / 6


def winding_numbers(triangles, points):
    """How often a closed surface is around each point (Van Oosterom & Strackee, 1983): 1 inside, 0 outside."""
    a, b, c = (triangles.astype(float)[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    above = np.einsum("pti,pti->pt", a, np.cross(b, c))
    dots = [np.einsum("pti,pti->pt", *pair) for pair in ((a, b), (b, c), (c, a))]
    return np.arctan2(above, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum(axis=1) / (2 * np.pi)


def is_within(points, boxes):
    return ((points[:, None] > boxes[None, :, 0]) & (points[:, None] < boxes[None, :, 1])).all(axis=-1)


@pytest.mark.parametrize("quarter", range(4))
def test_a_body_is_hollow_behind_its_doors_and_solid_elsewhere(quarter):
    turn = np.round(np.array([[np.cos(q := quarter * np.pi / 2), -np.sin(q), 0], [np.sin(q), np.cos(q), 0], [0, 0, 1]]))
    body, doors = wardrobe(turn)
    hollow, pockets = cut_pockets(body, doors)
    boxes = np.stack([pocket.box for pocket in pockets])
    assert len(pockets) == 2 * NUM_SHELVES
    removed = np.ptp(boxes, axis=1).prod(axis=1)
    assert volume(hollow.triangle) == pytest.approx(volume(body.triangle) - removed.sum(), abs=1e-6)
    rng = np.random.default_rng(0)
    points = (rng.uniform(-0.55, 0.55, (400, 3)) * [1, 0.6, 1.8] + [0, 0, 0.95]) @ turn.T
    low, high = body.box[0].astype(float), body.box[1].astype(float)
    low[2] = 0.05
    inside = is_within(points, np.stack([low, high])[None])[:, 0]
    expected = inside & ~is_within(points, boxes).any(axis=1)
    clear = (np.abs(points[:, None, None] - boxes).min(axis=(1, 2, 3)) > 1e-3) & (points[:, 2] > 0.06)
    np.testing.assert_allclose(winding_numbers(hollow.triangle, points)[clear], expected[clear], atol=1e-3)


def test_shelves_and_walls_are_as_thick_as_a_board_and_doors_cover_what_is_open():
    body, doors = wardrobe()
    boxes = np.stack([pocket.box for pocket in cut_pockets(body, doors)[1]])
    left = boxes[boxes[:, 0, 0] < -0.1]
    np.testing.assert_allclose(np.diff(left[:, :, 2].ravel())[1::2], BOARD, atol=1e-6)
    np.testing.assert_allclose(left[:, 1, 1], 0.3 - BOARD, atol=1e-6)
    np.testing.assert_allclose(left[:, 0, 1], -0.3, atol=1e-6)
    assert (left[:, 0, 0] >= doors[0].box[0, 0] + BOARD - 1e-6).all()
    assert (left[:, 1, 0] <= doors[0].box[1, 0] - BOARD + 1e-6).all()
    assert (np.ptp(boxes[:, :, 2], axis=1) <= 0.4).all()


def test_texture_goes_on_where_the_face_was():
    body, doors = wardrobe()
    uv = body.triangle[..., [0, 2]] * [2.0, 3.0] + [0.1, 0.2]
    body = make_model("wardrobe/frame", body.triangle, uv)
    hollow, _ = cut_pockets(body, doors)
    rim = (np.abs(hollow.triangle[..., 1] + 0.3) < 1e-6).all(axis=1)
    assert rim.sum() > 10
    np.testing.assert_allclose(hollow.uv[rim], hollow.triangle[rim][..., [0, 2]] * [2.0, 3.0] + [0.1, 0.2], atol=1e-5)


@pytest.mark.parametrize("inset", [0.2, -0.1])
def test_nothing_is_cut_where_no_face_is_behind_a_door(inset):
    """Within the body, and far before it."""
    body, doors = wardrobe(inset=inset)
    assert cut_pockets(body, doors) == (body, ())


def test_a_face_that_is_no_rectangle_stays():
    body, doors = wardrobe()
    flat = (np.abs(body.triangle[..., 1] + 0.3) < 1e-6).all(axis=1)
    kept = np.delete(body.triangle, np.flatnonzero(flat)[0], axis=0)
    assert cut_pockets(make_model("wardrobe/frame", kept), doors)[1] == ()


def test_carved_boxes_are_disjoint_and_just_what_is_left():
    rng = np.random.default_rng(1)
    boxes = make_boxes([[0, 0, 1.0], [2.0, 0, 0.5]], [[0.5, 0.3, 1.0], [0.2, 0.2, 0.5]])
    cutters = np.sort(rng.uniform([-0.8, -0.5, 0], [0.8, 0.5, 2.0], (6, 2, 3)), axis=1)
    rest = carve_boxes(boxes, cutters)
    points = rng.uniform([-0.6, -0.4, 0], [2.3, 0.4, 2.1], (4000, 3))
    before, after = (np.stack([b.center - b.half, b.center + b.half], axis=1) for b in (boxes, rest))
    expected = is_within(points, before).any(axis=1) & ~is_within(points, cutters).any(axis=1)
    edge = np.abs(points[:, None, None] - cutters).min(axis=(1, 2, 3)) > 2e-3  # thin rests are left out
    counts = is_within(points, after).sum(axis=1)
    np.testing.assert_array_equal(counts[edge], expected[edge])
