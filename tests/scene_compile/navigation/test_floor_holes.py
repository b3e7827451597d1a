"""Floors with holes: nobody stands, walks or begins above them, and railings stand around them."""

from dataclasses import replace

import numpy as np
import pytest
from storeys import Stairs, Storey, metadata_of, stacked

from home_mjx.datasets.outlines import RoomOutline
from home_mjx.geometry.boxes import empty_boxes
from home_mjx.geometry.polygons import find_smallest_room, polygon_area
from home_mjx.scene_compile.collision.barriers import find_barriers
from home_mjx.scene_compile.navigation.free_space import find_free_space
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import RoomTable

SIZE = 8.0  # [m], edge of the rooms
PLAIN = Storey([RoomOutline("Living_Room", [(0, 0), (SIZE, 0), (SIZE, SIZE), (0, SIZE)])])
HOLES = {  # (x0, z0, x1, z1) [m]
    "atrium": (3.0, 3.0, 5.0, 5.0),
    "stairwell": (0.9, 0.4, 4.5, 1.6),
    "long stairwell": (0.8, 0.4, 4.65, 1.6),  # beyond the last tread, too
}
STAIRS = Stairs((1.0, 1.0))


def with_hole(mesh, hole):
    """The floor's upper side without a rectangle, as rectangles that share no corners with their neighbours."""
    y, (x0, z0, x1, z1) = mesh.vertices[:, 1].max(), hole
    sides = [(0, 0, SIZE, z0), (0, z0, x0, z1), (x1, z0, SIZE, z1), (0, z1, SIZE, SIZE)]
    corners = [[(a, y, b), (a, y, d), (c, y, d), (c, y, b)] for a, b, c, d in sides]
    faces = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * i for i in range(len(sides))]).astype(np.int32)
    zeros = np.zeros(len(faces), np.int32)
    return replace(
        mesh,
        vertices=np.array(corners, float).reshape(-1, 3),
        faces=faces,
        uv=np.zeros((len(faces), 3, 2)),
        slot=zeros,
        group=zeros - 1,
        normal=None,
        part=None,
    )


@pytest.fixture(scope="module", params=HOLES)
def galleries(request):
    """Two storeys joined by stairs; the upper floor has a hole above the lower room."""
    house = stacked([PLAIN, PLAIN], [STAIRS])
    lower, upper = house.levels
    floor = with_hole(upper.rooms[0].floor, HOLES[request.param])
    levels = (
        replace(lower, rooms=(replace(lower.rooms[0], ceiling=None),)),
        replace(upper, rooms=(replace(upper.rooms[0], floor=floor),)),
    )
    return request.param, compile_house(replace(house, levels=levels), metadata_of(house))


def in_hole(name, points, inset=0.0):
    """Mask of points (x, y) of the world, whose origin is the middle of the room."""
    x0, z0, x1, z1 = np.array(HOLES[name]) - SIZE / 2
    x, y = points[..., 0], -points[..., 1]
    return (x > x0 + inset) & (x < x1 - inset) & (y > z0 + inset) & (y < z1 - inset)


def test_the_area_of_a_gallery(galleries):
    name, house = galleries
    x0, z0, x1, z1 = HOLES[name]
    areas = [polygon_area(polygon) for polygon in house.rooms.polygon]
    assert areas[1] == pytest.approx(SIZE**2 - (x1 - x0) * (z1 - z0), abs=0.01)


def test_agents_do_not_walk_above_a_hole(galleries):
    name, house = galleries
    grid = house.navigation
    rows, columns = np.indices(grid.region.shape[1:])
    middle = grid.origin + (np.stack([columns, rows], axis=-1) + 0.5) * grid.cell
    hole = in_hole(name, middle)
    walked = grid.region >= 0
    assert walked[1][~hole].sum() * grid.cell**2 > 20
    if name == "atrium":
        assert not walked[1][hole].any()
        assert walked[0][hole].all()
    else:  # stairs rise in the hole, up to the middle of it on the lower grid
        assert walked[1][hole].sum() * grid.cell**2 < 3
    assert len(np.unique(grid.region[walked])) == 1  # stairs join the levels


def test_agents_begin_on_floors(galleries):
    name, house = galleries
    for points in (house.navigation.start, house.navigation.goal):
        above = points[points[:, 2] > house.rooms.floor[1] - 0.05]
        assert len(above)
        assert not in_hole(name, above, 0.0 if name == "atrium" else 0.2).any()


def test_a_hole_has_no_floor_and_a_railing(galleries):
    name, house = galleries
    floor = house.rooms.floor[1]
    x0, z0, x1, z1 = np.array(HOLES[name]) - SIZE / 2
    middle = np.array([(x0 + x1) / 2, -(z0 + z1) / 2])
    if name == "atrium":
        assert not solid(house, [*middle, floor - 0.05])
    sides = {"-x": [x0, middle[1]], "-z": [middle[0], -z0], "+z": [middle[0], -z1], "+x": [x1, middle[1]]}
    closed = [side for side, point in sides.items() if solid(house, [*point, floor + 0.6], reach=0.12)]
    # Stairs end at the last side.
    assert closed == ["-x", "-z", "+z", *(["+x"] if name == "atrium" else [])]
    assert solid(house, [x1 + 0.5, middle[1], floor - 0.05])


RING = np.array([(0, 0), (6, 0), (6, 3), (4, 3), (4, 2), (2, 2), (2, 4), (4, 4), (4, 3), (6, 3), (6, 6), (0, 6)], float)
INNER = np.array([(2, 2), (4, 2), (4, 4), (2, 4)], float)


@pytest.mark.parametrize("is_nested", [False, True])
def test_a_hole_without_a_room_is_closed_on_the_ground_floor(is_nested):
    polygons = (RING, INNER) if is_nested else (RING,)
    n = len(polygons)
    zeros = np.zeros(n, int)
    rooms = RoomTable(zeros - 1, zeros, polygons, np.zeros(n), np.full(n, 2.7), zeros)
    barriers = find_barriers(rooms, 0, empty_boxes(), [], 4.0)
    inner = (abs(barriers.center[:, :2] - 3) < 1.5).all(axis=1)
    assert inner.any() == (not is_nested)
    found = find_smallest_room(rooms, np.arange(n), np.array([[3.0, 3.3], [5.0, 3.3]]))
    assert found.tolist() == [1 if is_nested else -1, 0]
    space = find_free_space(rooms, barriers)
    middle = (abs(space.x - 3) < 0.9)[None, :] & (abs(space.y - 3) < 0.9)[:, None]
    assert space.free[middle].all() == space.free[middle].any() == is_nested


def solid(house, point, reach=0.0):
    """Whether a point of the world is in a static box, or horizontally within `reach` of one."""
    boxes = house.colliders
    yaw = 2 * np.arctan2(boxes.quat[:, 3], boxes.quat[:, 0])
    x, y, z = (np.array(point) - boxes.pos).T
    local = np.stack([x * np.cos(yaw) + y * np.sin(yaw), y * np.cos(yaw) - x * np.sin(yaw), z], axis=1)
    upright = np.hypot(boxes.quat[:, 1], boxes.quat[:, 2]) < 1e-6
    return bool((upright & (abs(local) <= boxes.size + np.array([reach, reach, 0])).all(axis=1)).any())
