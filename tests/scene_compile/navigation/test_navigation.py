from dataclasses import replace

import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from home_mjx.geometry.boxes import empty_boxes, make_boxes
from home_mjx.geometry.geodesic import distance_fields
from home_mjx.geometry.polygons import find_smallest_room, is_inside_polygon, polygon_area
from home_mjx.scene_compile.navigation.build import build_navigation
from home_mjx.scene_compile.navigation.free_space import (
    NO_SPACE_HINTS,
    NavigationOptions,
    find_free_space,
    no_free_space_error,
)
from home_mjx.schema.compiled import FIELD_UNIT, RoomTable


def square(low: float, high: float) -> np.ndarray:
    return np.array([[low, low], [high, low], [high, high], [low, high]], float)


def rooms_of(*polygons: np.ndarray) -> RoomTable:
    n = len(polygons)
    return RoomTable(np.full(n, -1), np.zeros(n, int), polygons, np.zeros(n), np.full(n, 2.7), np.zeros(n, int))


def relaxed(free: np.ndarray, goal: tuple[int, int], cell: float) -> np.ndarray:
    """Distances by relaxing every edge until nothing changes."""
    distance = np.full(free.shape, np.inf)
    distance[goal] = 0
    ny, nx = free.shape
    while True:
        before = distance.copy()
        for y in range(ny):
            for x in range(nx):
                for dy in (-1, 0, 1):
                    for dx in (-1, 0, 1):
                        v, u = y + dy, x + dx
                        if not (0 <= v < ny and 0 <= u < nx) or not free[[y, v, y, v], [x, u, u, x]].all():
                            continue
                        distance[y, x] = min(distance[y, x], distance[v, u] + cell * np.hypot(dy, dx))
        if (distance == before).all():
            return distance


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_distances_are_those_of_relaxation(seed):
    rng = np.random.default_rng(seed)
    free = rng.random((7, 9)) < 0.7
    goals = np.argwhere(free[None])[:3]
    fields = distance_fields(free[None], goals, 0.1)
    assert fields.shape == (free.sum(), len(goals))
    for goal, field in zip(goals, fields.T, strict=True):
        np.testing.assert_allclose(field, relaxed(free, tuple(goal[1:]), 0.1)[free], rtol=1e-12)


def test_way_around_a_wall_has_its_closed_form():
    free = np.ones((3, 5), bool)
    free[:2, 2] = False
    field = np.full(free.shape, np.inf)
    field[free] = distance_fields(free[None], np.array([[0, 0, 0]]), 1.0)[:, 0]
    # Down the left side, straight below the wall since no corner is cut, and up again.
    assert field[0, 4] == pytest.approx(2 * np.sqrt(2) - np.sqrt(2) + 1 + 2 + np.sqrt(2) + 1)


def test_points_in_a_polygon_agree_with_matplotlib(rng):
    path = pytest.importorskip("matplotlib.path")
    polygon = np.array([[0, 0], [4, 0.2], [4.1, 3], [2, 2.9], [2.1, 1.5], [0.1, 1.4]])
    points = rng.uniform(-1, 5, (2000, 2))
    np.testing.assert_array_equal(is_inside_polygon(polygon, points), path.Path(polygon).contains_points(points))
    assert polygon_area(polygon) == pytest.approx(is_inside_polygon(polygon, points).mean() * 36, rel=0.1)


def test_smallest_of_nested_rooms_has_the_point():
    rooms = rooms_of(square(0, 4), square(1, 2))
    found = find_smallest_room(rooms, np.arange(2), np.array([[1.5, 1.5], [3.0, 3.0], [9.0, 9.0]]))
    assert found.tolist() == [1, 0, -1]


def test_free_cells_keep_their_distance_and_no_other_cell_does(rng):
    """Against the distance to densely sampled outlines."""
    boxes = make_boxes(np.c_[rng.uniform(0.5, 3.5, (6, 2)), np.full(6, 0.5)], (0.3, 0.15, 0.5), rng.uniform(-3, 3, 6))
    space = find_free_space(rooms_of(square(0, 4)), boxes)
    points = np.stack(np.meshgrid(space.x, space.y), axis=-1)
    t = np.linspace(-1, 1, 61)
    grid = np.stack(np.meshgrid(t, t), axis=-1).reshape(-1, 2)
    gap = np.full(points.shape[:2], np.inf)
    for i in range(len(boxes)):
        c, s = np.cos(boxes.yaw[i]), np.sin(boxes.yaw[i])
        samples = (grid * boxes.half[i, :2]) @ np.array([[c, s], [-s, c]]) + boxes.center[i, :2]
        away = points[:, :, None] - samples
        gap = np.minimum(gap, np.linalg.norm(away, axis=-1).min(axis=-1))
    assert (gap[space.free] >= 0.15).all()
    regions, _ = ndimage.label(gap >= 0.15 + 0.011)  # beyond the sampling error of the outlines
    sizes = np.bincount(regions[regions > 0])
    assert space.free[regions == sizes.argmax()].all()


@pytest.mark.parametrize(("low", "high", "blocks"), [(0.0, 0.02, False), (0.0, 0.1, True), (1.7, 2.0, False)])
def test_only_what_is_at_an_agents_height_blocks(low, high, blocks):
    box = make_boxes((2, 2, (low + high) / 2), (0.5, 0.5, (high - low) / 2))
    space = find_free_space(rooms_of(square(0, 4)), box)
    assert space.free[20, 20] != blocks


def test_floor_of_a_lower_room_does_not_block_a_higher_one():
    """As where a room's floor mesh is missing, and its height is taken from its walls."""
    left, right = square(0, 2), square(0, 1) + np.array([2.0, 0])
    rooms = replace(rooms_of(left, right), floor=np.array([0.0, -0.2]))
    slab = make_boxes((1, 1, -0.1), (1, 1, 0.1))  # the left room's own floor
    space = find_free_space(rooms, slab)
    assert space.free[10, 5]


def test_passages_join_rooms_that_leave_a_gap():
    left, right = square(0, 2), square(0, 2) + np.array([2.3, 0])
    apart = find_free_space(rooms_of(left, right), empty_boxes())
    door = np.array([[1.9, 0.5], [2.4, 0.5], [2.4, 1.5], [1.9, 1.5]])
    joined = find_free_space(rooms_of(left, right), empty_boxes(), [door])
    assert len(np.unique(apart.room[apart.free])) == 1
    assert np.unique(joined.room[joined.free]).tolist() == [0, 1]


def test_starts_and_goals_are_free_spread_and_repeatable():
    house = shoebox(furniture=[Furniture((1.0, 1.0), (1.0, 1.0, 1.0))])
    n = house.navigation
    for points in (n.start, n.goal):
        column, row = ((points[:, :2] - n.origin) / n.cell).astype(int).T
        assert n.home_mask[0, row, column].all()
        assert (points[:, 2] == 0).all()
    halves = np.mean(n.start[:, 0] > 0)
    assert 0.3 < halves < 0.7
    assert len(n.goal) == 32
    gaps = np.linalg.norm(n.goal[:, None] - n.goal[None], axis=-1) + 9 * np.eye(len(n.goal))
    assert gaps[:8, :8].min() > 0.8
    assert gaps.min() > 0.3
    for g, goal in enumerate(n.goal):
        column, row = ((goal[:2] - n.origin) / n.cell).astype(int)
        assert n.distance(g)[0, row, column] == 0
    np.testing.assert_array_equal(n.start, shoebox(furniture=[Furniture((1.0, 1.0), (1.0, 1.0, 1.0))]).navigation.start)


def test_goals_visit_all_rooms():
    rooms = rooms_of(square(0, 3), square(0, 3) + np.array([3.0, 0]))
    n = build_navigation("x", rooms, [find_free_space(rooms, empty_boxes())], NavigationOptions(num_goals=4))
    assert sorted((n.goal[:, 0] > 3).tolist()) == [False, False, True, True]


def test_field_is_never_shorter_than_the_straight_way():
    n = two_rooms().navigation
    points = (n.cell_coords[:, :0:-1] + 0.5) * n.cell + n.origin
    straight = np.linalg.norm(points[:, None] - n.goal[None, :, :2], axis=-1)
    field = n.field * FIELD_UNIT
    assert (field >= straight - FIELD_UNIT).all()
    assert (field <= 1.09 * straight + FIELD_UNIT).all()  # octile distance in a convex room


def test_navigation_names_the_agent_that_it_is_for():
    rooms = rooms_of(square(0, 3))
    n = build_navigation(
        "x", rooms, [find_free_space(rooms, empty_boxes())], NavigationOptions(agent_radius=0.25, agent_height=1)
    )
    assert (n.agent_radius, n.agent_height) == (0.25, 1.0)
    assert isinstance(n.agent_height, float)


def test_an_error_tells_which_of_floor_walls_and_furniture_took_the_space():
    rooms, options = rooms_of(square(0, 3)), NavigationOptions(agent_radius=0.1, margin=0.05)
    wall = make_boxes((0.45, 1.5, 1), (0.5, 2, 1))  # up to x = 0.95 m, and 0.15 m for the agent: 11 of 30 columns
    error = no_free_space_error(find_free_space(rooms, wall, options=options), options)
    assert "of 9.0 m² of floor, walls take 3.3 m², furniture and doors 5.7 m²" in error.message
    assert error.hint == NO_SPACE_HINTS["furniture"]
    block = find_free_space(rooms, make_boxes((1.5, 1.5, 1), (2, 2, 1)), options=options)
    assert "walls take 9.0 m², furniture and doors 0.0 m²" in no_free_space_error(block, options).message
    assert no_free_space_error(block, options).hint == NO_SPACE_HINTS["walls"]
    outside = replace(block, room=np.full_like(block.room, -1), standable=np.zeros_like(block.standable))
    assert no_free_space_error(outside, options).hint == NO_SPACE_HINTS["floor"]
