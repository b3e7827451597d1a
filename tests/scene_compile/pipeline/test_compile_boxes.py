"""Boxes, slabs and outlines that stand for meshes."""

from itertools import pairwise

import numpy as np
import pytest
import trimesh
from cuboids import cuboid, turned
from hypothesis import given, settings
from hypothesis import strategies as st

from home_mjx.geometry import rectangle_cover
from home_mjx.geometry.box_fit import (
    cover_cells,
    fit_boxes,
    merge_boxes,
    narrowest_box,
    sample_surface,
    triangle_components,
)
from home_mjx.geometry.boxes import BoxSet, bounding_box, concat_boxes, footprint, footprint_distance, make_boxes
from home_mjx.geometry.polygons import polygon_area
from home_mjx.geometry.rectangle_cover import (
    cell_centers,
    cover_with_rectangles,
    is_in_triangles,
    merge_close_values,
    split_rectangles,
)
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.architecture.rooms import outline
from home_mjx.scene_compile.architecture.slabs import fit_slab, is_same_wall, wall_boxes
from home_mjx.scene_compile.collision.colliders import door_boxes, exposed_mask, select_passable_leaves

TABLE = np.concatenate(
    [cuboid((-0.7, -0.4, 0.7), (0.7, 0.4, 0.75))]
    + [cuboid((x - 0.03, y - 0.03, 0), (x + 0.03, y + 0.03, 0.7)) for x in (-0.65, 0.65) for y in (-0.35, 0.35)]
)


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_one_box_is_the_bounding_box(yaw):
    """HoME's representation, as an option."""
    boxes = fit_boxes(turned(TABLE, yaw, (3, 4, 0.05)), yaw, 1)
    assert len(boxes) == 1
    np.testing.assert_allclose(boxes.half[0], [0.7, 0.4, 0.375], atol=1e-6)
    np.testing.assert_allclose(boxes.center[0], [3, 4, 0.425], atol=1e-6)


def inside(boxes: BoxSet, points: np.ndarray, slack: float = 1e-6) -> np.ndarray:
    found = np.zeros(len(points), bool)
    for i in range(len(boxes)):
        local = (points - boxes.center[i]) @ yaw_matrix(boxes.yaw[i])
        found |= (abs(local) <= boxes.half[i] + slack).all(axis=1)
    return found


def volume(boxes: BoxSet) -> float:
    return float(8 * boxes.half.prod(axis=1).sum())


@pytest.mark.parametrize("yaw", [0.0, 0.4, -2.0])
def test_a_table_is_its_top_and_its_legs(yaw):
    boxes = fit_boxes(turned(TABLE, yaw, (3, 4, 0.05)), yaw, 8)
    assert len(boxes) == 5
    assert volume(boxes) < 2.0 * (1.4 * 0.8 * 0.05 + 4 * 0.06 * 0.06 * 0.7)
    under = np.array([[0.0, 0.0, 0.35], [0.4, 0.0, 0.6]]) @ yaw_matrix(yaw).T + [3, 4, 0.05]
    assert not inside(boxes, under).any()


@pytest.mark.parametrize("most", [1, 2, 5, 8])
@pytest.mark.parametrize("shape", ["table", "ball", "stairs"])
def test_boxes_hold_the_whole_surface(shape, most):
    ball = trimesh.creation.icosphere(3, 0.4)
    stairs = np.concatenate([cuboid((0, i, 0), (1, i + 1, i + 1)) for i in range(4)]) * 0.25
    triangles = {"table": TABLE, "ball": np.array(ball.triangles), "stairs": stairs}[shape]
    boxes = fit_boxes(triangles, 0.0, most)
    assert 1 <= len(boxes) <= most
    assert inside(boxes, sample_surface(triangles, 0.01), slack=0.015).all()
    assert inside(boxes, triangles.reshape(-1, 3), slack=1e-6).all()
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    assert volume(boxes) <= 1.0001 * (high - low).prod()


def test_a_closed_box_is_one_full_box():
    boxes = fit_boxes(cuboid((0, 0, 0), (0.8, 0.5, 2.0)), 0.0, 8)
    assert len(boxes) == 1
    np.testing.assert_allclose(boxes.half[0], [0.4, 0.25, 1.0])
    np.testing.assert_allclose(boxes.center[0], [0.4, 0.25, 1.0])


def test_a_box_open_below_is_full():
    shell = cuboid((0, 0, 0), (1, 1, 1)).reshape(6, 2, 3, 3)[[0, 1, 2, 3, 5]].reshape(-1, 3, 3)
    boxes = fit_boxes(shell, 0.0, 8)
    assert inside(boxes, np.array([[0.5, 0.5, 0.1], [0.5, 0.5, 0.5]])).all()


@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_cells_are_covered_exactly_and_merging_keeps_them(seed):
    occupied = np.random.default_rng(seed).random((4, 5, 3)) < 0.4
    boxes = cover_cells(occupied)
    painted = np.zeros(occupied.shape, int)
    for low, high in boxes:
        painted[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] += 1
    np.testing.assert_array_equal(painted, occupied.astype(int))
    merged = merge_boxes(boxes, 3, 0.0) if len(boxes) else boxes
    assert len(merged) <= 3
    for low, high in merged:
        painted[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = 0
    assert not painted.any()


def test_components_are_those_of_trimesh():
    mesh = trimesh.Trimesh(TABLE.reshape(-1, 3), np.arange(TABLE.size // 3).reshape(-1, 3), process=True)
    assert triangle_components(TABLE).max() + 1 == mesh.body_count == 5


@settings(max_examples=20)
@given(st.floats(-3.1, 3.1), st.floats(0.3, 2.0), st.floats(0.02, 0.25))
def test_narrowest_box_finds_a_turned_box(yaw, length, width):
    corners = turned(cuboid((-length, -width, 0), (length, width, 2)), yaw, (1, 2, 0)).reshape(-1, 3)
    box = narrowest_box(corners)
    assert sorted(box.half[0, :2]) == pytest.approx(sorted((length, width)))
    assert inside(box, corners).all()


def door(open_by: float) -> np.ndarray:
    """A frame with a sill, and a leaf of 0.7 m that hangs on its left side."""
    frame = [
        cuboid((-0.45, -0.05, 0), (-0.4, 0.05, 2.1)),
        cuboid((0.4, -0.05, 0), (0.45, 0.05, 2.1)),
        cuboid((-0.45, -0.05, 2.05), (0.45, 0.05, 2.1)),
        cuboid((-0.4, -0.05, 0), (0.4, 0.05, 0.03)),
    ]
    leaf = turned(cuboid((0, -0.02, 0.05), (0.78, 0.02, 2.0)), -open_by, (-0.39, 0, 0))
    return np.concatenate([*frame, leaf])


def test_an_open_door_lets_one_pass_beside_its_leaf():
    frame, leaves = door_boxes(door(np.deg2rad(50)), 0.04, 8)
    assert len(leaves) == 1
    np.testing.assert_allclose(np.sort(leaves[0].half[0]), [0.02, 0.39, 0.975], atol=1e-9)
    way = np.array([[0.2, 0.0, 0.1], [0.2, 0.0, 1.5], [0.3, -0.1, 1.0]])
    assert not inside(frame, way).any()
    assert not inside(leaves[0], way).any()
    assert inside(frame, np.array([[-0.42, 0.0, 1.0], [0.42, 0.0, 1.0], [0.0, 0.0, 2.08]])).all()


def test_a_closed_door_closes_the_way():
    frame, leaves = door_boxes(door(0.0), 0.04, 8)
    assert leaves == ()
    assert inside(frame, np.array([[0.0, 0.0, 1.0], [-0.3, 0.0, 0.3], [0.3, 0.0, 1.8]])).all()


def test_a_leaf_that_cuts_off_a_room_is_left_out():
    far, near = make_boxes((5, 5, 1), (0.4, 0.02, 1)), make_boxes((0, 0, 1), (0.4, 0.02, 1))

    def free_area(boxes: BoxSet) -> float:
        return 10.0 if (boxes.center[:, 0] < 1).any() else 30.0

    assert select_passable_leaves([near, far], free_area) == [far]


def test_only_boxes_inside_others_are_hidden():
    """What lies on another box can be touched from above."""
    table = make_boxes((0, 0, 0.4), (0.5, 0.5, 0.4))
    drawer, vase = make_boxes((0.1, 0, 0.6), (0.1, 0.1, 0.2), 0.5), make_boxes((0.1, 0, 0.9), (0.1, 0.1, 0.2))
    shelf, chair = make_boxes((0, 0, 1.0), (0.6, 0.2, 0.1)), make_boxes((0, 0.45, 0.2), (0.1, 0.1, 0.2))
    joined = concat_boxes([table, drawer, vase, shelf, chair])
    assert exposed_mask(joined).tolist() == [True, False, True, True, True]


def test_of_equal_boxes_one_stays():
    assert exposed_mask(make_boxes(np.zeros((3, 3)), 1.0)).sum() == 1


def wall(length: float, holes, yaw: float = 0.0, shift=(0, 0, 0), thickness: float = 0.1) -> np.ndarray:
    """A wall from x = 0 along x, with holes (x0, z0, x1, z1) through it, as triangles of its solid cells."""
    u = np.unique([0, length, *(h[0] for h in holes), *(h[2] for h in holes)])
    v = np.unique([0, 2.7, *(h[1] for h in holes), *(h[3] for h in holes)])
    cells = []
    for x0, x1 in pairwise(u):
        for z0, z1 in pairwise(v):
            middle = (x0 + x1) / 2, (z0 + z1) / 2
            if not any(h[0] < middle[0] < h[2] and h[1] < middle[1] < h[3] for h in holes):
                cells.append(cuboid((x0, -thickness / 2, z0), (x1, thickness / 2, z1)))
    return turned(np.concatenate(cells), yaw, shift)


HOLES = [(1.0, 0.0, 1.8, 2.1), (3.0, 0.9, 4.4, 2.2)]


@pytest.mark.parametrize("yaw", [0.0, 0.05, np.pi / 2, 2.0])
def test_wall_boxes_fill_the_wall_around_its_openings(yaw, rng):
    slab = fit_slab(wall(6.0, HOLES, yaw, (1, 2, 0)))
    assert abs(np.sin(slab.yaw - yaw)) < 1e-6
    boxes = wall_boxes([slab], 1.5)
    assert (2 * boxes.half[:, 0] <= 1.5 + 1e-9).all()
    points = np.c_[rng.uniform(0, 6, 4000), np.zeros(4000), rng.uniform(0, 2.7, 4000)]
    open_ = np.zeros(4000, bool)
    for x0, z0, x1, z1 in HOLES:
        open_ |= (points[:, 0] > x0) & (points[:, 0] < x1) & (points[:, 2] > z0) & (points[:, 2] < z1)
    np.testing.assert_array_equal(inside(boxes, turned(points, yaw, (1, 2, 0))), ~open_)
    assert volume(boxes) == pytest.approx(0.1 * (6 * 2.7 - 0.8 * 2.1 - 1.4 * 1.3), rel=1e-6)


def test_copies_of_one_wall_are_one_and_neighbours_are_not():
    own = fit_slab(wall(5.0, []))
    copy = fit_slab(wall(3.0, [], np.pi, (4.0, 0.05, 0)))
    askew = fit_slab(wall(5.0, [], 0.006, (0, 0.02, 0)))
    further = fit_slab(wall(4.0, [], 0.0, (4.96, 0, 0)))
    beside = fit_slab(wall(5.0, [], 0.0, (0, 0.5, 0)))
    across = fit_slab(wall(5.0, [], np.pi / 2))
    above = fit_slab(wall(5.0, [], 0.0, (0, 0, 2.7)))
    assert [is_same_wall(own, s) for s in (own, copy, askew)] == [True] * 3
    assert [is_same_wall(own, s) for s in (further, beside, across, above)] == [False] * 4
    boxes = wall_boxes([own, copy, askew], 10.0)
    assert len(boxes) == 1
    assert inside(boxes, np.concatenate([s.to_world(np.stack([s.low, s.high])) for s in (own, copy, askew)])).all()


@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_rectangles_tile_the_solid_cells(seed):
    rng = np.random.default_rng(seed)
    solid = rng.random((5, 6)) < 0.6
    u, v = np.cumsum(rng.uniform(0.1, 1, 7)), np.cumsum(rng.uniform(0.1, 1, 6))
    pieces = split_rectangles(cover_with_rectangles(u, v, solid), 0.5)
    assert (pieces[:, 2] - pieces[:, 0] <= 0.5 + 1e-9).all() if len(pieces) else not solid.any()
    centers = cell_centers(u, v)
    points = centers[..., None, :]
    hits = ((points > pieces[:, :2]) & (points < pieces[:, 2:])).all(axis=-1).sum(axis=-1)
    areas = np.outer(np.diff(v), np.diff(u))
    assert (hits[~solid] == 0).all()
    assert (pieces[:, 2:] - pieces[:, :2]).prod(axis=1).sum() == pytest.approx(areas[solid].sum())


def test_points_in_triangles_of_either_winding():
    triangles = np.array([[[0, 0], [1, 0], [0, 1]], [[3, 0], [3, 1], [4, 0]], [[5, 5], [6, 6], [7, 7]]], float)
    points = np.array([[0.2, 0.2], [0.8, 0.8], [3.2, 0.2], [6.5, 6.5]])
    assert is_in_triangles(triangles, points).tolist() == [True, False, True, False]
    assert not is_in_triangles(triangles[:0], points).any()


def test_points_in_many_triangles_are_those_of_barycentric_coordinates(monkeypatch):
    """More pairs than are compared at once; points whose coordinates are nearly 0 may be on either side."""
    monkeypatch.setattr(rectangle_cover, "MAX_PAIRS", 1_000)
    random = np.random.default_rng(0)
    triangles = random.normal(size=(300, 1, 2)) + random.normal(scale=0.1, size=(300, 3, 2))
    points = np.round(random.normal(size=(20, 30, 2)), 2)
    matrix = np.concatenate([triangles.transpose(0, 2, 1), np.ones((300, 1, 3))], axis=1)
    weights = np.linalg.solve(matrix[:, None, None], np.concatenate([points, np.ones((20, 30, 1))], -1)[..., None])
    least = weights[..., 0].min(axis=-1).max(axis=0)
    clear = abs(least) > 1e-9
    assert 0.05 < (least > 0).mean() < 0.95
    assert (is_in_triangles(triangles, points) == (least > 0))[clear].all()


def test_cluster_keeps_the_ends():
    np.testing.assert_allclose(merge_close_values(np.array([0.0, 0.02, 1.0, 1.01, 3.0, 2.99]), 0.03), [0, 1.005, 3])


def test_no_values_merge_into_none():
    assert merge_close_values(np.zeros(0), 0.03).shape == (0,)


def test_outline_of_an_l_shaped_slab():
    corners = np.array([[0, 0], [4, 0], [4, 1], [2, 1], [2, 3], [0, 3]], float)
    pieces = [((0, 0, 0), (2, 1, 0.05)), ((2, 0, 0), (4, 1, 0.05)), ((0, 1, 0), (2, 3, 0.05))]
    slab = np.concatenate([cuboid(*piece) for piece in pieces])
    polygon = outline(slab)
    assert polygon_area(polygon) == pytest.approx(8.0)
    gaps = np.linalg.norm(corners[:, None] - polygon[None], axis=-1).min(axis=1)
    np.testing.assert_allclose(gaps, 0, atol=1e-9)


def test_outline_of_what_is_no_proper_slab_is_its_box():
    ceiling = np.array([[[0, 0, 1], [0, 2, 1], [3, 0, 1.0]]])  # faces down: there is no upper side
    assert polygon_area(outline(ceiling)) == pytest.approx(6.0)
    torn = np.concatenate([cuboid((0, 0, 0), (4, 1, 0.05)), cuboid((0, 1.1, 0), (2, 3, 0.05))])
    assert polygon_area(outline(torn)) == pytest.approx(12.0)
    joined = np.concatenate([cuboid((0, 0, 0), (4, 1, 0.05)), cuboid((0, 1, 0), (2, 3, 0.05))])  # share one corner
    assert polygon_area(outline(joined)) == pytest.approx(8.0)


def test_footprints_agree_with_distances(rng):
    boxes = make_boxes(rng.normal(size=(5, 3)), rng.uniform(0.1, 1, (5, 3)), rng.uniform(-3, 3, 5))
    for i in range(5):
        corners = footprint(boxes, i)
        assert footprint_distance(boxes[[i]], corners[None]).max() < 1e-9
        out = boxes.center[i, :2] + 2 * (corners - boxes.center[i, :2])
        expected = np.hypot(*boxes.half[i, :2])
        np.testing.assert_allclose(footprint_distance(boxes[[i]], out[None])[0], expected)
        grown = bounding_box(np.c_[corners, np.zeros(4)], boxes.yaw[i])
        np.testing.assert_allclose(grown.half[0, :2], boxes.half[i, :2])
