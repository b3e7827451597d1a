"""Floor plans: rooms tile the house, walls face inwards, doors connect, holes match openings."""

from collections import Counter

import numpy as np
import pytest
import trimesh
from generated import built, designed
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.polygons import is_inside_polygon, polygon_area
from home_mjx.schema.categories import ROOM_TYPES
from home_procgen.floor_plan.rooms import PlanWall, Rect, RoomPlan, outer_spans, outline, shared_span
from home_procgen.v1.openings import draw_plan
from home_procgen.v1.plan import WANTS

PLANS = 50
HOUSES = range(6)


@pytest.fixture(scope="module")
def plans():
    return [draw_plan(np.random.default_rng(seed)) for seed in range(PLANS)]


@pytest.fixture(scope="module")
def houses():
    return [built(seed) for seed in HOUSES]


def as_trimesh(mesh, group=None):
    faces = mesh.faces if group is None else mesh.faces[mesh.group == group]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


def test_three_to_eight_rooms_of_suncg_types(plans):
    counts = Counter(len(plan.rooms) for plan in plans)
    assert set(counts) == set(range(3, 9))
    types = Counter(room.type for plan in plans for room in plan.rooms)
    assert set(types) <= set(ROOM_TYPES)
    assert len(types) >= 10
    assert all("Living_Room" in [room.type for room in plan.rooms] for plan in plans)


def test_rooms_do_not_overlap_and_sizes_are_plausible(plans, rng):
    for plan in plans:
        low, high = np.min([r.polygon.min(0) for r in plan.rooms], 0), np.max([r.polygon.max(0) for r in plan.rooms], 0)
        points = rng.uniform(low, high, (400, 2))
        inside = np.stack([is_inside_polygon(room.polygon, points) for room in plan.rooms])
        assert inside.sum(0).max() == 1
        assert inside.any(0).mean() > 0.6  # else the house is not one block, less a corner at most
        for room in plan.rooms:
            assert room.area == pytest.approx(polygon_area(room.polygon))
            assert 0.7 * WANTS[room.type].low <= room.area <= 1.4 * WANTS[room.type].high + 9


def test_many_rooms_are_l_shaped(plans):
    corners = Counter(len(room.polygon) for plan in plans for room in plan.rooms)
    assert set(corners) == {4, 6}
    assert corners[6] >= PLANS // 4


def test_normals_point_into_the_room(plans):
    for room in (room for plan in plans for room in plan.rooms):
        middle = np.array([np.add(w.start, w.end) / 2 for w in room.walls])
        normal = np.array([w.normal for w in room.walls])
        assert is_inside_polygon(room.polygon, middle + 0.01 * normal).all()
        assert not is_inside_polygon(room.polygon, middle - 0.01 * normal).any()


def test_every_room_can_be_reached_and_one_door_leads_out(plans):
    for plan in plans:
        doors = [opening for opening in plan.openings if opening.is_door]
        inner = np.array([door.rooms for door in doors if len(door.rooms) == 2])
        graph = coo_array((np.ones(len(inner)), inner.T), shape=(len(plan.rooms),) * 2)
        assert connected_components(graph, directed=False)[0] == 1
        outer = [door for door in doors if len(door.rooms) == 1]
        assert len(outer) == 1
        assert outer[0].object.closed
        assert len(doors) >= len(plan.rooms)


def test_openings_lie_between_the_rooms_that_they_name(plans):
    """Half a metre to either side of every opening is in the rooms that it joins, or outside."""
    for plan in plans:
        for opening in plan.openings:
            found = set()
            for side in (-0.5, 0.5):
                point = np.array(opening.object.local_point(0.0, side))
                found |= {i for i, room in enumerate(plan.rooms) if is_inside_polygon(room.polygon, point)}
            assert found == set(opening.rooms)


def test_door_leaves_keep_clear_of_other_passages(plans):
    for plan in plans:
        doors = [opening for opening in plan.openings if opening.is_door]
        for door in doors:
            for other in doors:
                if door is not other:
                    low = np.maximum(door.object.box[0], other.passage[0])
                    high = np.minimum(door.object.box[1], other.passage[1])
                    assert (high - low).min() <= 0.02


def test_habitable_rooms_have_windows_where_an_outer_wall_allows(plans):
    lit = total = 0
    for plan in plans:
        for index, room in enumerate(plan.rooms):
            if room.type in ("Living_Room", "Bedroom", "Kitchen"):
                total += 1
                lit += any(not opening.is_door for opening in plan.openings_of(index))
    assert lit / total > 0.9


def test_architecture_is_watertight_and_of_the_right_volume(houses):
    for room in (room for house in houses for room in house.levels[0].rooms):
        for slab in (room.floor, room.ceiling):
            mesh = as_trimesh(slab)
            assert mesh.is_watertight
            assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(0.05)
        for group in range(len(room.walls.groups)):
            prism = as_trimesh(room.walls, group)
            assert prism.is_watertight
            assert prism.is_winding_consistent
            assert prism.volume > 0


def test_floors_are_the_rooms_grown_by_two_centimetres(houses):
    for seed, house in zip(HOUSES, houses, strict=True):
        plan = designed(seed).plan
        for planned, room in zip(plan.rooms, house.levels[0].rooms, strict=True):
            perimeter = sum(wall.length for wall in planned.walls)
            area = planned.area + 0.02 * perimeter + 4 * 0.02**2  # convex corners are four more than reflex ones
            assert as_trimesh(room.floor).volume == pytest.approx(0.05 * area, rel=1e-6)
            assert room.floor.vertices[:, 1].max() == pytest.approx(0.05)


def test_every_prism_has_exactly_the_holes_of_its_openings(houses):
    """Each opening makes one handle in two prisms of every room that it touches."""
    for seed, house in zip(HOUSES, houses, strict=True):
        openings = designed(seed).plan.openings
        genus = sum(
            1 - as_trimesh(room.walls, group).euler_number // 2
            for room in house.levels[0].rooms
            for group in range(len(room.walls.groups))
        )
        assert genus == sum(2 * len(opening.rooms) for opening in openings)


def test_holes_are_the_openings_boxes_less_two_centimetres(houses):
    """Rays through a wall a centimetre inside the edge of its hole pass, a centimetre outside they hit both prisms."""
    for seed, house in zip(HOUSES, houses, strict=True):
        walls = trimesh.util.concatenate([as_trimesh(room.walls) for room in house.levels[0].rooms])
        for opening in designed(seed).plan.openings:
            low, high = opening.object.box
            along, across = (0, 2) if opening.object.quarter % 2 == 0 else (2, 0)
            for inset, passes in ((0.03, True), (0.01, False)):
                ends = [(low[along] + inset, (low[1] + high[1]) / 2), (high[along] - inset, (low[1] + high[1]) / 2)]
                ends += [((low[along] + high[along]) / 2, y) for y in (low[1] + inset, high[1] - inset)]
                origin = np.zeros((4, 3))
                origin[:, along], origin[:, 1] = np.array(ends).T
                origin[:, across] = opening.object.position[across] - 0.3
                direction = np.zeros((4, 3))
                direction[:, across] = 1.0
                hits, rays = walls.ray.intersects_location(origin, direction)[:2]
                near = np.abs(hits[:, across] - opening.object.position[across]) < 0.1
                assert set(rays[near]) == (set() if passes else {0, 1, 2, 3})


def test_wall_prisms_have_suncg_thickness(houses):
    """Inner prism: from the centre-line 0.05 m inwards; the outer one overlaps it by a nineteenth of 0.1 m."""
    room = houses[0].levels[0].rooms[0]
    wall = designed(HOUSES[0]).plan.rooms[0].walls[0]
    for group, expected in ((0, (0.0, 0.05)), (1, (0.1 / 19 - 0.05, 0.1 / 19))):
        used = np.unique(room.walls.faces[room.walls.group == group])
        offset = (room.walls.vertices[used][:, [0, 2]] - wall.start) @ wall.normal
        along = (room.walls.vertices[used][:, [0, 2]] - wall.start) @ wall.direction
        np.testing.assert_allclose((offset.min(), offset.max()), expected, atol=1e-6)
        np.testing.assert_allclose((along.min(), along.max()), (-0.04, wall.length + 0.04), atol=1e-6)


def test_outline_of_an_l():
    polygon = outline([Rect(0.0, 0.0, 4.0, 5.0), Rect(4.0, 0.0, 6.0, 2.0)])
    assert polygon.tolist() == [[0, 0], [6, 0], [6, 2], [4, 2], [4, 5], [0, 5]]


def test_spans_of_walls():
    one = RoomPlan("Room", (Rect(0.0, 0.0, 4.0, 3.0),))
    two = RoomPlan("Room", (Rect(1.0, 3.0, 2.5, 5.0),))
    bottom = next(wall for wall in one.walls if wall.line == 3.0 and wall.axis == 0)
    assert outer_spans(bottom, two.walls) == [(0.0, 1.0), (2.5, 4.0)]
    assert [span for wall in two.walls if (span := shared_span(bottom, wall))] == [(1.0, 2.5)]
    assert outer_spans(PlanWall((0.0, 0.0), (4.0, 0.0)), two.walls) == [(0.0, 4.0)]
