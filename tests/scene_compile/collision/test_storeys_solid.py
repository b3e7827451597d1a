"""Floors, ramps and railings of houses of several storeys: rays and walks by brute force."""

from dataclasses import replace

import numpy as np
import pytest
from boxes_by_hand import Solids
from cuboids import cuboid
from matplotlib.path import Path
from storeys import FLOOR, UP, Stairs, Storey, metadata_of, stacked

from home_mjx.datasets.outlines import RoomOutline, WallOpening
from home_mjx.geometry.boxes import BoxSet
from home_mjx.scene_compile.collision.floors import FLOOR_THICKNESS, plan_floors
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.compiled import (
    FIELD_UNIT,
    FIELD_UNREACHABLE,
    MAX_DEPTH_BELOW_FLOOR,
    CompiledHouse,
    PortalKind,
    RoomTable,
)
from home_mjx.schema.house import House

MARGIN = 0.15  # [m], from the axis of an agent to what is beside it
STEP = 0.05  # [m], most that an agent steps up
LITTLE = np.array([0, 0, 0.2])  # [m], above a floor
FALL = 0.3  # [m]: nobody steps down farther
DOOR = WallOpening((8, 2.5), (8, 3.5))
GROUND = Storey(
    [
        RoomOutline("Living_Room", [(0, 0), (8, 0), (8, 6), (0, 6)]),
        RoomOutline("Bedroom", [(8, 0), (12, 0), (12, 6), (8, 6)]),
    ],
    [DOOR],
)
# An L and a smaller room; the wall along z = 4.5 is missing, and a door leads out of the wall at x = 12 into nothing.
UPPER = Storey(
    [
        RoomOutline("Hall", [(0, 0), (8, 0), (8, 6), (5, 6), (5, 4.5), (0, 4.5)]),
        RoomOutline("Bedroom", [(8, 0), (12, 0), (12, 4), (8, 4)]),
    ],
    [DOOR, WallOpening((0.06, 4.5), (4.94, 4.5), 0, 2.75), WallOpening((12, 1), (12, 2))],
)
SLANTED = Storey(
    [
        RoomOutline("Hall", [(0, 0), (8, 0.3), (8, 4.5), (6, 6), (0, 6)]),
        RoomOutline("Bedroom", [(8, 0.3), (12, 0), (11, 4), (8, 4.5)]),
    ],
    [DOOR],
)
HOUSES = {
    "along": stacked([GROUND, UPPER], [Stairs((2.0, 1.2))]),
    "back": stacked([GROUND, UPPER], [Stairs((6.5, 2.0), np.pi, steps=15, run=0.28, width=1.1)]),
    "across": stacked([GROUND, SLANTED], [Stairs((4.0, 5.0), np.pi / 2, run=0.22)]),
    "askew": stacked([GROUND, SLANTED], [Stairs((2.0, 4.0), 0.5, steps=12)]),
    "three": stacked([GROUND, UPPER, SLANTED], [Stairs((2.0, 1.2)), Stairs((6.0, 3.3), np.pi, level=1)]),
}


def compiled_of(house: House, **navigation) -> CompiledHouse:
    options = CompileOptions(navigation=NavigationOptions(**navigation))
    return compile_house(house, metadata_of(house), options)


# Walks through the other houses take half a minute each.
WALKED = [pytest.param(name, marks=() if name == "along" else pytest.mark.slow) for name in HOUSES]


@pytest.fixture(scope="module", params=HOUSES)
def house(request) -> CompiledHouse:
    return compiled_of(HOUSES[request.param])


def cells(house: CompiledHouse) -> np.ndarray:
    """Middle of each home cell, on the floor or ramp."""
    n = house.navigation
    return np.c_[n.origin + (n.cell_coords[:, :0:-1] + 0.5) * n.cell, n.height]


def test_a_ray_down_from_every_cell_meets_the_floor(house):
    points = cells(house)
    np.testing.assert_allclose(Solids(house).below(points + LITTLE), points[:, 2], atol=0.03)
    n = house.navigation
    floors = house.rooms.floor[n.room[tuple(n.cell_coords.T)]]
    on_ramp = abs(n.height - floors) > 1e-6
    assert 0 < on_ramp.mean() < 0.1
    assert (house.rooms.floor.max() - n.height[on_ramp]).min() < MAX_DEPTH_BELOW_FLOOR


def test_starts_and_goals_lie_on_the_floors_of_all_levels(house):
    n = house.navigation
    for points in (n.start, n.goal):
        np.testing.assert_allclose(Solids(house).below(points + LITTLE), points[:, 2], atol=1e-3)
        heights = FLOOR + UP * np.arange(len(n.level))
        assert set(np.unique(points[:, 2]).round(3).tolist()) == set(heights.round(3).tolist())


def test_ramps_rise_without_a_step(house):
    """Along the middle and near both sides, from half a metre before to half a metre beyond."""
    solids, ramps = Solids(house), house.ramps
    assert len(ramps.up) == len(house.navigation.level) - 1
    for i, (up, slope) in enumerate(zip(ramps.up, ramps.slope, strict=True)):
        left, half = np.array([-up[1], up[0]]), ramps.size[i, 0] * np.cos(slope)
        top = ramps.pos[i, :2] + ramps.size[i, 2] * -np.sin(slope) * up
        along = np.arange(-half - 0.5, half + 0.5, 0.01)
        rise = 2 * ramps.size[i, 0] * np.sin(slope)
        assert rise == pytest.approx(UP, abs=1e-6)
        for across in (-ramps.size[i, 1] + MARGIN, 0.0, ramps.size[i, 1] - MARGIN):
            plan = top + along[:, None] * up + across * left
            expected = FLOOR + UP * i + np.clip((along + half) / (2 * half), 0, 1) * rise
            height = solids.below(np.c_[plan, expected + 0.3])
            np.testing.assert_allclose(height, expected, atol=0.02)
            assert (np.diff(height) >= -1e-9).all()
            assert np.diff(height).max() < STEP
            assert not solids.blocked(np.c_[plan, expected], 0.2, 1.6, 0.05).any()


def test_ramps_are_colliders_and_point_uphill(house):
    ramps, boxes = house.ramps, house.colliders
    for name in ("pos", "quat", "size", "object_id"):
        np.testing.assert_array_equal(getattr(boxes, name)[ramps.collider], getattr(ramps, name))
    axis = Solids(house).turn[ramps.collider, :, 0]
    np.testing.assert_allclose(axis[:, :2], np.cos(ramps.slope)[:, None] * ramps.up, atol=1e-9)
    np.testing.assert_allclose(axis[:, 2], np.sin(ramps.slope), atol=1e-9)


@pytest.mark.parametrize("name", WALKED)
def test_nobody_can_step_down_or_out(name):
    """A walk over a fine grid from the starts, by an agent that squeezes through gaps of 13 cm."""
    house = compiled_of(HOUSES[name])
    grid, solids = 0.05, Solids(house)
    front = {(*np.round(p[:2] / grid).astype(int).tolist(), round(p[2], 1)): p[2] for p in house.navigation.start}
    seen, steps = set(front), np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
    while front:
        at = np.array([key[:2] for key in front])
        height = np.array(list(front.values()))
        place = (at[:, None] + steps).reshape(-1, 2)
        old = np.repeat(height, 4)
        known = [{(x, y, round(z + d, 1)) for d in (-0.1, 0, 0.1)} & seen for (x, y), z in zip(place, old, strict=True)]
        fresh = np.array([not keys for keys in known])
        place, old = place[fresh], old[fresh]
        ahead = np.c_[place * grid, old]
        new = solids.below(ahead + STEP * np.array([0, 0, 1]))
        free = ~solids.blocked(np.c_[ahead[:, :2], np.maximum(old, new)], 0.15, 1.5, 0.065)
        assert (old - new)[free].max(initial=0) < FALL
        assert (outside(house.rooms.polygon, ahead[free, :2]) < 0.2).all()
        front = {}
        for (x, y), z in zip(place[free].tolist(), new[free].tolist(), strict=True):
            if (x, y, round(z, 1)) not in seen:
                seen.add((x, y, round(z, 1)))
                front[x, y, round(z, 1)] = z
    levels = house.navigation.floor
    assert {round(z, 1) for _, _, z in seen} >= {round(float(z), 1) for z in levels}


def test_a_way_over_the_stairs_is_as_long_as_the_ramp(house):
    n, ramps = house.navigation, house.ramps
    points = cells(house)
    for i, (up, slope) in enumerate(zip(ramps.up, ramps.slope, strict=True)):
        half = ramps.size[i, 0] * np.cos(slope)
        ends = [np.array([*(ramps.pos[i, :2] + s * (half + 0.3) * up), FLOOR + UP * (i + (s > 0))]) for s in (-1, 1)]
        foot, head = (int(np.linalg.norm(points - end, axis=1).argmin()) for end in ends)
        for goal in np.flatnonzero(n.goal[:, 2] > FLOOR + UP * (i + 0.5)).tolist():
            way = (int(n.field[foot, goal]) - int(n.field[head, goal])) * FIELD_UNIT
            # eight directions are up to 8 % longer than the straight way
            assert 2 * ramps.size[i, 0] - 0.3 < way < 1.09 * (2 * ramps.size[i, 0] + 1.2)


def test_distances_are_continuous_over_the_stairs(house):
    """Neighbouring places, in whichever grid, differ by no more than the way between them."""
    n, points = house.navigation, cells(house)
    assert (n.field < FIELD_UNREACHABLE).all()
    ramp = np.flatnonzero(abs(points[:, 2] - house.rooms.floor[n.room[tuple(n.cell_coords.T)]]) > 1e-6)
    for row in ramp.tolist():
        away = np.linalg.norm(points - points[row], axis=1)
        near = (away < 1.5 * n.cell) & (abs(points[:, 2] - points[row, 2]) < 0.2)
        gap = abs(n.field[near].astype(int) - n.field[row].astype(int)).max(axis=1) * FIELD_UNIT
        assert (gap <= 1.5 * away[near] + 2 * n.cell).all()


def test_agents_that_do_not_climb_stay_below():
    house = compiled_of(HOUSES["along"], use_stairs=False)
    assert len(house.ramps.up) == 0
    assert set(house.navigation.cell_coords[:, 0].tolist()) == {0}
    assert (house.navigation.portals.kind != PortalKind.STAIRS).all()
    # The stairs are in the way, and the floor above them is whole.
    inside = np.array([[-2.5, 1.8, FLOOR + 0.1], [-1.2, 1.8, FLOOR + 0.5]])
    assert Solids(house).blocked(inside, 0.0, 0.1, 0.01).all()
    assert Solids(house).below(np.array([[-2.5, 1.8, FLOOR + UP + 0.1]])) == pytest.approx(FLOOR + UP, abs=1e-3)


def test_stairs_that_turn_without_a_landing_have_no_ramp():
    """Two flights at right angles, the second beside the last tread of the first."""
    rise = UP / 14
    first = [cuboid((0.25 * i, -0.45, 0), (0.25 * (i + 1), 0.45, rise * (i + 1))) for i in range(7)]
    second = [cuboid((1.75, -0.45 + 0.25 * i, 0), (2.65, -0.45 + 0.25 * (i + 1), rise * (i + 8))) for i in range(7)]
    house = HOUSES["along"]
    (key,) = house.models
    triangles = np.concatenate(first + second)[..., [0, 2, 1]] * [1, 1, -1]
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    flat = np.zeros(len(faces), np.int32)
    mesh = replace(
        house.models[key],
        vertices=triangles.reshape(-1, 3),
        faces=faces,
        uv=np.zeros((*faces.shape, 2)),
        slot=flat,
        group=flat,
    )
    compiled = compiled_of(replace(house, models={key: mesh}))
    assert compiled.report["stairs"] == 1
    assert len(compiled.ramps.up) == 0
    assert set(compiled.navigation.cell_coords[:, 0].tolist()) == {0}


def rooms_of(polygons: list, floors: list) -> RoomTable:
    count = len(polygons)
    arrays = tuple(np.array(p, float) for p in polygons)
    return RoomTable(
        np.full(count, -1),
        np.zeros(count, int),
        arrays,
        np.array(floors, float),
        np.array(floors) + 2.5,
        np.zeros(count, int),
    )


@pytest.mark.parametrize("yaw", [0.0, 0.3, -0.7])
def test_floors_of_rectilinear_rooms_are_exact_and_few(yaw, rng):
    """Three rooms in an L with a nook; the smaller of two that overlap is higher."""
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    plans = [
        [[0, 0], [6, 0], [6, 3], [4, 3], [4, 5], [0, 5]],
        [[6, 0], [9, 0], [9, 4], [6, 4]],
        [[1, 1], [2, 1], [2, 2], [1, 2]],
    ]
    polygons = [np.array(p, float) @ turn.T for p in plans]
    boxes = plan_floors(rooms_of(polygons, [3.0, 3.0, 3.4]), 0, [], [], 1).boxes()
    points = rng.uniform(-1, 10, (20_000, 2)) @ turn.T
    inner, outer = ([outside([p], points) <= -s for p in polygons] for s in (0.001, -0.001))
    found = heights(boxes, points)
    assert (found[inner[2]] == 3.4).all()
    assert (found[(inner[0] | inner[1]) & ~outer[2]] == 3.0).all()
    assert np.isinf(found[~(outer[0] | outer[1])]).all()
    np.testing.assert_allclose(boxes.bottom, 3.0 - FLOOR_THICKNESS)
    assert len(boxes) <= 8


def test_floors_of_slanted_rooms_cover_them(rng):
    corners = np.array([[0, 0], [7, 0.4], [9, 3], [6, 6], [0, 5]], float)
    boxes = plan_floors(rooms_of([corners], [3.0]), 0, [], [], 1).boxes()
    points = rng.uniform(-1, 10, (20_000, 2))
    found, away = heights(boxes, points), outside([corners], points)
    assert (found[away < -0.1] == 3.0).all()
    assert np.isinf(found[away > 0.1]).all()
    assert len(boxes) < 80


def outside(polygons, points: np.ndarray) -> np.ndarray:
    """Distance of each point from the nearest of some polygons; in one, less than 0 by the way to its edge [m]."""
    found = np.full(len(points), np.inf)
    for corners in polygons:
        way = np.roll(corners, -1, axis=0) - corners
        along = np.einsum("pcx,cx->pc", points[:, None] - corners, way) / (way**2).sum(axis=1)
        nearest = corners + np.clip(along, 0, 1)[..., None] * way
        away = np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)
        found = np.minimum(found, np.where(Path(corners).contains_points(points), -away, away))
    return found


def heights(boxes: BoxSet, points: np.ndarray) -> np.ndarray:
    """Of the highest box at each point; -inf where there is none."""
    found = np.full(len(points), -np.inf)
    for center, half, yaw in zip(boxes.center, boxes.half, boxes.yaw, strict=True):
        local = (points - center[:2]) @ np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        inside = (abs(local) <= half[:2]).all(axis=1)
        found[inside] = np.maximum(found[inside], center[2] + half[2])
    return found.round(9)
