"""Outlines of floors with holes, and of floors whose rectangles share no corners."""

import numpy as np
import pytest

from home_mjx.geometry.polygons import (
    MIN_HOLE_RADIUS,
    boundary_edges,
    is_inside_polygon,
    outline,
    polygon_area,
)
from home_mjx.geometry.slabs import simplify, triangulate

# Rectangles (x0, y0, x1, y1) without gaps; some have corners on sides of others.
FLOORS = {
    "plain": [(0, 0, 6, 6)],
    "L": [(0, 0, 6, 2), (0, 2, 2, 6)],
    "U": [(0, 0, 6, 1.5), (0, 1.5, 1.5, 6), (4.5, 1.5, 6, 6)],
    "ring": [(0, 0, 6, 2), (0, 2, 2, 4), (4, 2, 6, 4), (0, 4, 6, 6)],
    "ring of equal squares": [(x, y, x + 2, y + 2) for x in (0, 2, 4) for y in (0, 2, 4) if (x, y) != (2, 2)],
    "two holes in a row": [(0, 0, 8, 1), (0, 1, 1, 3), (3, 1, 5, 3), (7, 1, 8, 3), (0, 3, 8, 4)],
    "two holes, one above the other": [(0, 0, 1, 8), (1, 0, 3, 1), (1, 3, 3, 5), (1, 7, 3, 8), (3, 0, 4, 8)],
}
# Lengths of all sides of their holes [m].
HOLES = {"ring": 8, "ring of equal squares": 8, "two holes in a row": 16, "two holes, one above the other": 16}


def floor_of(rectangles, yaw=0.0):
    corners = np.array([[[(a, b), (c, b), (c, d)], [(a, b), (c, d), (a, d)]] for a, b, c, d in rectangles], float)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    plan = corners.reshape(-1, 3, 2) @ turn.T
    return np.concatenate([plan, np.zeros((len(plan), 3, 1))], axis=2), turn


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 4, 2.0])
@pytest.mark.parametrize("name", FLOORS)
def test_an_outline_contains_the_points_of_its_floor_only(name, yaw):
    slab, turn = floor_of(FLOORS[name], yaw)
    found = outline(slab, with_holes=True)
    assert polygon_area(found) == pytest.approx(sum((c - a) * (d - b) for a, b, c, d in FLOORS[name]), abs=5e-3)
    points = np.random.default_rng(0).uniform(-1, 9, (2000, 2))
    edges = np.array([[a, b, c, d] for a, b, c, d in FLOORS[name]])
    x, y = points.T[..., None]
    depth = np.minimum(np.minimum(x - edges[:, 0], edges[:, 2] - x), np.minimum(y - edges[:, 1], edges[:, 3] - y))
    sure = (abs(depth) > 0.01).all(axis=1)
    expected = (depth > 0).any(axis=1)
    assert (is_inside_polygon(found, points @ turn.T) == expected)[sure].all()


@pytest.mark.parametrize("yaw", [0.0, 0.3])
@pytest.mark.parametrize("name", HOLES)
def test_bridges_are_no_edges(name, yaw):
    slab, _ = floor_of(FLOORS[name], yaw)
    found = outline(slab, with_holes=True)
    plain = outline(slab)
    length = np.linalg.norm(plain - np.roll(plain, 1, axis=0), axis=1).sum() + HOLES[name]
    start, end = boundary_edges(found).swapaxes(0, 1)
    assert np.linalg.norm(end - start, axis=1).sum() == pytest.approx(length, abs=2e-3)


@pytest.mark.parametrize("yaw", [0.0, 0.3])
@pytest.mark.parametrize("name", FLOORS)
def test_an_outline_with_holes_can_be_cut_into_triangles(name, yaw):
    found = simplify(outline(floor_of(FLOORS[name], yaw)[0], with_holes=True))
    assert sum(polygon_area(found[t]) for t in triangulate(found)) == pytest.approx(polygon_area(found))


@pytest.mark.parametrize(("width", "count"), [(1.8 * MIN_HOLE_RADIUS, 0), (2.4 * MIN_HOLE_RADIUS, 1)])
def test_agents_stand_across_narrow_holes(width, count):
    stop = 2 + width
    slab, _ = floor_of([(0, 0, 6, 2), (0, 2, 2, 4), (stop, 2, 6, 4), (0, 4, 6, 6)])
    assert polygon_area(outline(slab, with_holes=True)) == pytest.approx(36 - 2 * width * count)


def test_the_outer_edge_of_a_ring():
    assert polygon_area(outline(floor_of(FLOORS["ring"])[0])) == pytest.approx(36)
