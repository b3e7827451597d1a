"""Regions, portals and stairs: how the free spaces of rooms and levels hang together."""

from dataclasses import replace

import numpy as np
import pytest
from storeys import Stairs, Storey, metadata_of, stacked
from tiny_dataset import HOUSE_ID, ROOM_PARTS, edit_house, object_node, write_mesh, write_tiny_dataset

from home_mjx.datasets.outlines import RoomOutline
from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.boxes import concat_boxes, make_boxes
from home_mjx.geometry.geodesic import GridLink, distance_fields
from home_mjx.geometry.meshes import box_triangles, make_model
from home_mjx.scene_compile.collision.ramps import build_guards
from home_mjx.scene_compile.navigation.build import build_navigation
from home_mjx.scene_compile.navigation.free_space import NavigationOptions, find_free_space
from home_mjx.scene_compile.navigation.portals import find_portals, room_hops
from home_mjx.scene_compile.navigation.regions import label_regions
from home_mjx.scene_compile.objects.doorways import Doorway
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.scene_compile.objects.stairs import find_stairs
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.categories import COARSE
from home_mjx.schema.compiled import FIELD_UNIT, MAX_DEPTH_BELOW_FLOOR, HouseNavigation, PortalKind, RoomTable
from home_mjx.schema.house import ModelInfo, ObjectNode

UP = 2.8  # [m], of the upper floor
STEPS, RUN, WIDTH = 14, 0.25, 0.9  # of the stairs


def outline(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], float)


def rooms_of(*polygons: np.ndarray, level: tuple[int, ...] = ()) -> RoomTable:
    n = len(polygons)
    levels = np.array(level or [0] * n)
    return RoomTable(np.full(n, -1), levels, polygons, UP * levels.astype(float), UP * levels + 2.5, np.zeros(n, int))


def stairs_at(x: float, y: float, level: int = 0) -> PlacedObject:
    """A flight that rises along +x from (x, y), the middle of its first edge."""
    rise = UP / STEPS
    boxes = []
    for i in range(STEPS):
        half = np.array([RUN / 2, WIDTH / 2, rise * (i + 1) / 2])
        boxes.append(box_triangles(np.array([RUN * (i + 0.5), 0.0, half[2]]), half))
    model = make_model("stairs", np.concatenate(boxes))
    pose = np.c_[np.eye(3), [x, y, level * UP]]
    node = ObjectNode("0_9", 9, "levels[0].nodes[9]", None, "stairs", "stairs", np.eye(4))
    return PlacedObject(
        node, ModelInfo("stairs", "stairs", "stairs", "floor"), model, model, (), (), pose, 9, level, 0, 1
    )


ROOMS = rooms_of(outline(0, 0, 6, 4), outline(0, 0, 6, 4), level=(0, 1))


def two_storeys(climb: bool = True, stairs: PlacedObject | None = None) -> HouseNavigation:
    """A 6 x 4 m room on each level, joined by stairs along the middle."""
    stairs = stairs or stairs_at(1.0, 2.0)
    climbed = find_stairs([stairs], ROOMS, [0, 1], np.array([0, UP])) if climb else []
    sides = build_guards(climbed) if climbed else stairs.box
    below = find_free_space(ROOMS, sides, upstairs=climbed)
    above = find_free_space(ROOMS, sides, level=1, downstairs=climbed)
    return build_navigation("x", ROOMS, [below, above], stairs=climbed)


def test_the_category_exists():
    assert "stairs" in COARSE


def test_a_flight_is_the_slope_through_the_middles_of_the_treads():
    (found,) = find_stairs([stairs_at(1.0, 2.0)], ROOMS, [0, 1], np.array([0, UP]))
    (flight,), (top,) = found.slopes, found.top_tread
    np.testing.assert_allclose(flight.foot, [1.0 - RUN / 2, 2.0], atol=0.01)
    np.testing.assert_allclose([flight.run, np.ptp(top[:, 0])], [STEPS * RUN, RUN / 2], atol=0.01)
    np.testing.assert_allclose([flight.low, flight.high, flight.width, flight.yaw], [0, UP, WIDTH, 0], atol=0.01)
    assert found.room == (0, 1)
    middles = np.array([[1.0 + RUN * (i + 0.5), 2.0] for i in range(STEPS - 1)])
    np.testing.assert_allclose(flight.surface(middles), UP / STEPS * np.arange(1, STEPS), atol=0.01)


@pytest.mark.parametrize(("level", "floor"), [(0, 4.0), (1, UP), (0, 1.5)])
def test_stairs_that_end_at_no_floor_lead_nowhere(level, floor):
    assert find_stairs([stairs_at(1.0, 2.0, level)], ROOMS, [0, 1], np.array([0, floor])) == []


def test_agents_that_climb_reach_both_storeys_over_the_stairs():
    n = two_storeys(climb=True)
    assert n.region_area.shape == (1,)
    levels = n.cell_coords[:, 0]
    assert set(levels.tolist()) == {0, 1}
    assert set(np.unique(n.goal[:, 2]).tolist()) == {0.0, UP}
    share = np.mean(n.start[:, 2] > 0)
    assert share == pytest.approx((levels == 1).mean(), abs=0.1)  # in proportion to the area
    goal = int(np.flatnonzero(n.goal[:, 2] == 0)[0])
    field = n.field[:, goal] * FIELD_UNIT
    far = n.goal[goal, :2] - ((n.cell_coords[:, :0:-1] + 0.5) * n.cell + n.origin)
    away = np.linalg.norm(far, axis=1)
    assert (field[levels == 1] >= np.hypot(away, UP)[levels == 1] - 0.01).all()
    assert (field[levels == 1] > field[levels == 0].min() + UP).all()


def test_agents_that_do_not_climb_stay_on_the_ground_floor():
    n = two_storeys(climb=False)
    assert len(n.region_area) == 2
    assert set(n.cell_coords[:, 0].tolist()) == {0}
    assert (n.start[:, 2] == 0).all()
    assert (n.region[1] >= 0).any()


def test_the_slope_is_in_one_grid_below_and_in_the_other_above():
    """They share the cells at the height from which on a point counts as on the upper level."""
    n = two_storeys()
    row = int((2.0 - n.origin[1]) / n.cell)
    x = n.origin[0] + (np.arange(n.region.shape[2]) + 0.5) * n.cell
    z = UP * (x - 1.0 + RUN / 2) / (STEPS * RUN)
    on = (z > 0) & (z < UP)
    margin = 2 * n.cell * UP / (STEPS * RUN)
    for level, side in ((0, 1), (1, -1)):
        free = n.region[level, row] == 0
        assert free[on & (side * (UP - MAX_DEPTH_BELOW_FLOOR - z) > 0)].all()
        assert not free[on & (side * (UP - MAX_DEPTH_BELOW_FLOOR - z) < -margin)].any()


def test_stairs_are_portals():
    n = two_storeys()
    assert n.portals.kind.tolist() == [PortalKind.STAIRS]
    assert n.portals.room.tolist() == [[0, 1]]
    np.testing.assert_allclose(n.portals.width, WIDTH - 2 * 0.15, atol=1e-6)
    assert n.room_hops.tolist() == [[0, 1], [1, 0]]


def test_stairs_outside_of_rooms_join_nothing():
    n = two_storeys(stairs=stairs_at(8.0, 2.0))
    assert len(n.region_area) == 2
    assert len(n.portals.width) == 0
    assert n.room_hops.tolist() == [[0, -1], [-1, 0]]


def test_height_is_a_part_of_the_way():
    """Along a slope of 3 in 4, by hand."""
    free, height = np.ones((1, 1, 4), bool), 0.75 * np.arange(4.0)[None, None]
    field = distance_fields(free, np.array([[0, 0, 0]]), 1.0, (), height)[:, 0]
    np.testing.assert_allclose(field, [0, 1.25, 2.5, 3.75])


def test_floors_too_far_apart_are_not_joined():
    """Of three rows, the middle one rises by a wall of 2.6 m in the middle of the grid; by hand."""
    free, height = np.ones((1, 3, 6), bool), np.zeros((1, 3, 6))
    height[0, :, 3:] = 2.6
    region, area = label_regions(free, (), 0.1, height)
    np.testing.assert_array_equal(region[0], [[0, 0, 0, 1, 1, 1]] * 3)
    np.testing.assert_allclose(area, [0.09, 0.09])
    field = distance_fields(free, np.array([[0, 0, 0]]), 0.1, (), height)[:, 0].reshape(3, 6)
    assert np.isinf(field[:, 3:]).all()
    rooms = rooms_of(outline(0, 0, 0.3, 0.3), outline(0.3, 0, 0.6, 0.3))
    centres = np.arange(6) * 0.1 + 0.05, np.arange(3) * 0.1 + 0.05
    room = np.where(height > 0, 1, 0)
    assert len(find_portals(rooms, room, free, height, centres, [[]]).width) == 0
    assert len(find_portals(rooms, room, free, 0 * height, centres, [[]]).width) == 1
    plain = find_free_space(rooms, concat_boxes([]), options=NavigationOptions(agent_radius=0.0, margin=0.0))
    assert plain.free.sum() == 18
    assert replace(plain, height=height[0]).free.sum() == 9


def test_a_diagonal_step_passes_no_corner_on_another_floor():
    free, height = np.ones((1, 2, 2), bool), np.array([[[0.0, 2.6], [0.0, 0.0]]])
    field = distance_fields(free, np.array([[0, 0, 0]]), 1.0, (), height)[:, 0]
    np.testing.assert_allclose(field, [0, np.inf, 1, 2])


@pytest.mark.parametrize("foot", [(2.6, 3.0), (2.0, 3.6)])
def test_a_flight_with_an_offset_above_another_is_not_joined_to_it(foot):
    """No way between heights is shorter than the slope of the stairs."""
    storey = Storey([RoomOutline("Living_Room", [(0, 0), (9, 0), (9, 8), (0, 8)])])
    house = stacked([storey] * 3, [Stairs((2.0, 3.0)), Stairs(foot, level=1)])
    n = compile_house(house, metadata_of(house)).navigation
    field = n.field[: n.home_mask.sum()] * FIELD_UNIT
    rise = abs(n.height[:, None] - n.goal[:, 2])
    assert rise.max() > UP - 0.2
    assert (field >= rise * np.hypot(STEPS * RUN, UP) / UP - 0.1).all()


def test_a_link_shortens_the_way():
    """Two rows without a common neighbour, joined at one end; by hand."""
    free = np.ones((2, 1, 4), bool)
    link = GridLink((0, 0, 3), (1, 0, 0), 10.0)
    field = distance_fields(free, np.array([[0, 0, 0]]), 1.0, [link])[:, 0]
    np.testing.assert_allclose(field, [0, 1, 2, 3, 13, 14, 15, 16])
    assert np.isinf(distance_fields(free, np.array([[0, 0, 0]]), 1.0)[4:]).all()


def test_the_home_region_has_floor():
    """The foot of stairs is all that is free below: agents begin above."""
    standable = np.zeros((2, 1, 8), bool)
    standable[0, 0, :3] = standable[1, 0, :2] = standable[1, 0, 3:] = True
    on_ramp = np.zeros_like(standable)
    on_ramp[0] = True
    region, area = label_regions(standable, (), 1.0, on_ramp=on_ramp)
    assert (region[1, 0, 3:] == 0).all()
    np.testing.assert_allclose(area, [5, 3, 2])


def test_regions_are_those_of_a_flood_fill(rng):
    standable = rng.random((2, 20, 30)) < 0.6
    region, area = label_regions(standable, (), 0.1)
    assert ((region >= 0) == standable).all()
    seen = np.full(standable.shape, -1)
    for start in np.argwhere(standable).tolist():
        if seen[tuple(start)] < 0:
            stack, number = [tuple(start)], int(region[tuple(start)])
            while stack:
                at = stack.pop()
                if seen[at] < 0:
                    seen[at] = number
                    assert region[at] == number
                    level, y, x = at
                    near = [(level, y + 1, x), (level, y - 1, x), (level, y, x + 1), (level, y, x - 1)]
                    stack += [n for n in near if 0 <= n[1] < 20 and 0 <= n[2] < 30 and standable[n]]
    sizes = [(region == i).sum() for i in range(len(area))]
    np.testing.assert_allclose(area, np.array(sizes) * 0.01)
    assert sizes[0] == max((region[0] == i).sum() for i in range(len(area)))
    assert sizes[1:] == sorted(sizes[1:], reverse=True)
    starts = [np.argwhere(region == i)[0].tolist() for i in range(len(area))]
    assert len({tuple(s) for s in starts}) == len(area)


def three_rooms(door: bool) -> HouseNavigation:
    """Rooms 0 and 1 share an open border of 2 m; a wall with a doorway 0.8 m wide leads from 1 to 2."""
    rooms = rooms_of(outline(0, 0, 3, 2), outline(3, 0, 6, 2), outline(6, 0, 9, 2))
    wall = [make_boxes((6, 0.3, 1), (0.05, 0.3, 1)), make_boxes((6, 1.7, 1), (0.05, 0.3, 1))]
    wall += [] if door else [make_boxes((6, 1, 1), (0.05, 1, 1))]
    doorway = Doorway(np.array([[6.15, 0.6], [6.15, 1.4], [5.85, 1.4], [5.85, 0.6]]), 0, (1, 2), (3, -1))
    outside = Doorway(np.array([[9.15, 0.6], [9.15, 1.4], [8.85, 1.4], [8.85, 0.6]]), 0, (2, -1))
    return build_navigation("x", rooms, [find_free_space(rooms, concat_boxes(wall))], doorways=[[doorway, outside]])


def test_portals_are_doors_and_openings():
    portals = three_rooms(door=True).portals
    found = dict(zip(map(tuple, portals.room.tolist()), range(3), strict=True))
    opening, door, outside = found[0, 1], found[1, 2], found[-1, 2]
    assert [portals.kind[i] for i in (opening, door, outside)] == [PortalKind.OPENING, PortalKind.DOOR, PortalKind.DOOR]
    np.testing.assert_allclose(portals.pos[door], [6, 1, 0], atol=0.06)
    np.testing.assert_allclose(portals.pos[opening], [3, 1, 0], atol=0.06)
    assert portals.width[opening] == pytest.approx(2.0, abs=0.11)
    assert portals.width[door] == pytest.approx(0.8 - 2 * 0.15, abs=0.11)
    assert portals.width[outside] == 0
    assert [portals.leaf[i].tolist() for i in (opening, door, outside)] == [[-1, -1], [3, -1], [-1, -1]]


def test_hops_count_portals():
    assert three_rooms(door=True).room_hops.tolist() == [[0, 1, 2], [1, 0, 1], [2, 1, 0]]
    shut = three_rooms(door=False)
    assert shut.room_hops.tolist() == [[0, 1, -1], [1, 0, -1], [-1, -1, 0]]
    assert shut.portals.width[shut.portals.kind == PortalKind.DOOR].tolist() == [0, 0]
    closed = replace(three_rooms(door=True).portals, width=np.zeros(3))
    assert room_hops(closed, 3).tolist() == [[0, -1, -1], [-1, 0, -1], [-1, -1, 0]]


def test_rooms_of_the_real_house_lead_to_each_other(suncg_root):
    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    n = house.navigation
    assert (n.room_hops >= 0).all()
    doors = n.portals.kind == PortalKind.DOOR
    passed = n.portals.room[doors & (n.portals.width > 0)]
    assert (passed >= 0).all()
    assert n.region_area[0] == pytest.approx(n.home_mask.sum() * n.cell**2)
    assert (n.portals.room[doors] == -1).any()  # the entrance


def add_storey(root) -> None:
    """A second level over the tiny house's room, and a flight of stairs in place of its furniture."""
    rise, run = UP / STEPS, 0.18
    steps = [("", "material_0", (run * i, 0, 0), (run * (i + 1), rise * (i + 1), 0.9)) for i in range(STEPS)]
    write_mesh(root / "object" / "9003", "9003", steps, [("0.5 0.5 0.5", "")])
    for part, cuboids in ROOM_PARTS.items():
        raised = [
            (g.replace("0_0", "1_0"), m, (a, b + UP, c), (d, e + UP, f)) for g, m, (a, b, c), (d, e, f) in cuboids
        ]
        write_mesh(root / "room" / HOUSE_ID, f"fr_1rm_0{part}", raised, [("1 1 1", "")])
    table = root / "metadata" / "ModelCategoryMapping.csv"
    table.write_text(table.read_text() + "\n7,9003,stairs,stairs,1,floor,n04314914,stairs.n.01\n")

    def change(house: dict) -> None:
        nodes = house["levels"][0]["nodes"]
        flight = object_node("0_2", "9003", np.eye(3), (0.7, 0.05, 1.0), steps)
        house["levels"][0]["nodes"] = [dict(nodes[0], nodeIndices=[2]), nodes[1], flight]
        room = dict(nodes[0], id="1_0", modelId="fr_1rm_0", nodeIndices=[])
        house["levels"].append({"id": "1", "valid": 1, "nodes": [room]})

    edit_house(root, change)


@pytest.mark.parametrize("climb", [False, True])
def test_a_house_of_two_levels_is_compiled(tmp_path, climb):
    root = write_tiny_dataset(tmp_path / "data")
    add_storey(root)
    dataset = open_dataset(root)
    options = CompileOptions(navigation=NavigationOptions(use_stairs=climb))
    n = compile_house(dataset.load_house(HOUSE_ID), dataset.metadata, options).navigation
    assert n.level.tolist() == [0, 1]
    np.testing.assert_allclose(n.floor, [0.05, UP + 0.05], atol=1e-6)
    assert set(n.cell_coords[:, 0].tolist()) == ({0, 1} if climb else {0})
    assert (n.portals.kind == PortalKind.STAIRS).sum() == int(climb)
    assert n.room_hops.tolist() == ([[0, 1], [1, 0]] if climb else [[0, -1], [-1, 0]])
    assert (n.room[1] == 1).any()
    assert set(np.unique(n.start[:, 2]).round(2).tolist()) == ({0.05, 2.85} if climb else {0.05})
