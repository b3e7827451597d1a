"""Nobody leaves: floods of the free space between the boxes of compiled houses, and of plans with known gaps."""

from dataclasses import replace

import numpy as np
import pytest
from door_states import with_doors
from flood import farthest_from_rooms, outside_rooms, reached, rows
from generated import generate_flats

from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, make_boxes
from home_mjx.geometry.rotations import plane_matrix
from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.collision.barriers import MAX_HALF_THICKNESS, build_fence, find_barriers
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse, RoomTable
from home_mjx.schema.house import House

WALL = 0.3  # [m]: an agent that stands in an outer doorway is no farther from its room
SQUARE = np.array([[-2, -2], [2, -2], [2, 2], [-2, 2]], float)
NUM_FENCE = 4


def rooms_of(*polygons: np.ndarray) -> RoomTable:
    n = len(polygons)
    return RoomTable(np.full(n, -1), np.zeros(n, int), polygons, np.zeros(n), np.full(n, 2.7), np.zeros(n, int))


def wall(start, end, thickness: float = 0.1, low: float = 0.0, high: float = 2.7) -> BoxSet:
    way = np.subtract(end, start)
    middle = [*(np.add(start, end) / 2), (low + high) / 2]
    half = [np.hypot(*way) / 2 + thickness / 2, thickness / 2, (high - low) / 2]
    return make_boxes(middle, half, float(np.arctan2(way[1], way[0])))


def walls(polygon: np.ndarray, missing: int | None = None) -> list[BoxSet]:
    return [
        wall(a, b) for i, (a, b) in enumerate(zip(polygon, np.roll(polygon, -1, axis=0), strict=True)) if i != missing
    ]


def farthest(boxes: BoxSet, polygons) -> float:
    """How far from rooms an agent can get that starts in the middle of the first one."""
    colliders = boxes.colliders(np.full(len(boxes), -1, np.int32))
    points = reached(colliders, 0.0, polygons, polygons[0].mean(axis=0, keepdims=True))
    return float(outside_rooms(polygons, points).max())


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 4])
def test_a_closed_room_needs_no_barrier(yaw):
    polygon = SQUARE @ plane_matrix(yaw).T
    assert len(find_barriers(rooms_of(polygon), 0, concat_boxes(walls(polygon)), [], 1.5)) == 0


@pytest.mark.parametrize("yaw", [0.0, 0.3, np.pi / 4])
def test_a_missing_wall_is_closed_by_thin_boxes_outside_of_the_room(yaw):
    polygon = SQUARE @ plane_matrix(yaw).T
    static = concat_boxes(walls(polygon, missing=1))
    assert farthest(static, [polygon]) > 2
    barriers = find_barriers(rooms_of(polygon), 0, static, [], 1.5)
    assert farthest(concat_boxes([static, barriers]), [polygon]) < 0.15
    assert 3 <= len(barriers) <= 4
    assert (2 * barriers.half[:, :2].max(axis=1) <= 1.5 + 1e-9).all()
    assert (barriers.half[:, :2].min(axis=1) <= MAX_HALF_THICKNESS + 1e-9).all()
    np.testing.assert_allclose([barriers.bottom, barriers.top], [[0.0] * len(barriers), [2.7] * len(barriers)])
    inner = (barriers.center[:, :2] @ plane_matrix(yaw))[:, 0]  # the missing wall is at x = 2
    assert ((inner > 2.0) & (inner < 2.2)).all()


@pytest.mark.parametrize(
    ("low", "high", "is_gap"), [(0.0, 0.9, False), (0.0, 0.3, True), (1.0, 2.7, False), (1.6, 2.7, True)]
)
def test_what_is_too_low_or_too_high_keeps_nobody_in(low, high, is_gap):
    static = concat_boxes([*walls(SQUARE, missing=1), wall(SQUARE[1], SQUARE[2], low=low, high=high)])
    assert (len(find_barriers(rooms_of(SQUARE), 0, static, [], 1.5)) > 0) == is_gap


@pytest.mark.parametrize("width", [0.05, 0.2, 0.9])
def test_gaps_that_an_agent_fits_through_are_closed(width):
    right = [wall((2, -2), (2, -0.5 - 0.05)), wall((2, -0.5 + width + 0.05), (2, 2))]
    static = concat_boxes([*walls(SQUARE, missing=1), *right])
    barriers = find_barriers(rooms_of(SQUARE), 0, static, [], 1.5)
    assert (len(barriers) > 0) == (width > 0.1)
    assert farthest(concat_boxes([static, barriers]), [SQUARE]) < WALL


def test_ways_between_rooms_stay_open():
    """Two rooms 0.3 m apart, with an opening of 1 m through both of their walls."""
    east = SQUARE + np.array([4.3, 0])
    between = [wall((x, a), (x, b)) for x in (2, 2.3) for a, b in ((-2, -0.55), (0.55, 2))]
    static = concat_boxes(
        [*walls(SQUARE, 1), *walls(east, 3), *between, wall((2, -2), (2.3, -2)), wall((2, 2), (2.3, 2))]
    )
    assert len(find_barriers(rooms_of(SQUARE, east), 0, static, [], 1.5)) == 0
    points = reached(static.colliders(np.full(len(static), -1)), 0.0, [SQUARE, east], np.zeros((1, 2)))
    assert points[:, 0].max() > 6


def test_a_room_with_nothing_around_it_is_fenced_in():
    barriers = find_barriers(rooms_of(SQUARE), 0, empty_boxes(), [], 1.5)
    assert farthest(barriers, [SQUARE]) < 0.15
    assert 12 <= len(barriers) <= 32


def test_a_level_without_outlines_has_no_barrier():
    assert len(find_barriers(rooms_of(np.zeros((0, 2))), 0, empty_boxes(), [], 1.5)) == 0


def test_the_fence_goes_around_every_room():
    rooms = rooms_of(SQUARE, SQUARE + np.array([9, 3]))
    boxes = build_fence(rooms)
    assert len(boxes) == NUM_FENCE
    points = reached(boxes.colliders(np.full(NUM_FENCE, -1, np.int32)), 0.0, rooms.polygon, np.zeros((1, 2)))
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [[-3.9, -3.9], [12.9, 6.9]], atol=0.06)
    assert boxes.bottom.max() <= 0
    assert boxes.top.min() >= 2.7


def without_barriers(house: CompiledHouse):
    last = NUM_FENCE + house.report["barriers"]
    return rows(house.colliders, np.arange(len(house.colliders.pos)) < len(house.colliders.pos) - last)


def check_enclosed(house: CompiledHouse) -> None:
    """Not even the fence is needed."""
    kept = np.arange(len(house.colliders.pos)) < len(house.colliders.pos) - NUM_FENCE
    assert farthest_from_rooms(house, rows(house.colliders, kept)) < WALL
    assert set(house.navigation.room[house.navigation.home_mask].tolist()) == set(range(house.report["rooms"]))


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = tmp_path_factory.mktemp("generated")
    generate_flats(root, range(2))
    return open_dataset(root)


@pytest.fixture(scope="module", params=range(2))
def house(dataset, request) -> House:
    return dataset.load_house(dataset.house_ids[request.param])


def test_nobody_leaves_generated_houses(dataset):
    for house in HouseSet(dataset).load():
        check_enclosed(house)
        assert house.report["barriers"] == 0
        assert house.report["shut_leaves"] in (1, 2)  # of the entrance


def test_cells_in_doorways_to_the_outdoors_have_no_room(dataset):
    """An agent could stand there, cut off from the rooms by the shut door."""
    for house in HouseSet(dataset).load():
        row, column = np.nonzero(house.navigation.room[0] >= 0)
        points = house.navigation.origin + (np.stack([column, row], axis=-1) + 0.5) * house.navigation.cell
        assert outside_rooms(house.rooms.polygon, points).max() < 1e-6


@pytest.mark.slow
def test_nobody_leaves_more_generated_houses(tmp_path):
    generate_flats(tmp_path / "houses", range(100, 124))
    more = open_dataset(tmp_path / "houses")
    for house_id in more.house_ids:
        check_enclosed(compile_house(more.load_house(house_id), more.metadata))


@pytest.mark.real
def test_nobody_leaves_the_real_house(suncg_root):
    """Its outer doors stand open in the file: agents walked out through them."""
    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    check_enclosed(house)
    assert house.report["shut_leaves"] == 2


def entrance(house: House):
    """The closed door: all others of a generated house stand open."""
    (door,) = [o for o in house.levels[0].objects if o.model_key != o.model_id]
    return door


def with_objects(house: House, objects) -> House:
    return replace(house, levels=(replace(house.levels[0], objects=tuple(objects)),))


def test_an_open_entrance_is_shut(house, dataset):
    door = entrance(house)
    opened = with_doors(dataset, house, closed=False, chosen=lambda o: o is door)
    compiled = compile_house(opened, dataset.metadata)
    check_enclosed(compiled)
    assert (compiled.report["shut_leaves"], compiled.report["barriers"]) == (1, 0)
    assert not np.isin(np.flatnonzero(compiled.instances.object_id == door.index), compiled.doors.instance).any()


def test_an_open_entrance_of_unknown_hinge_is_closed_by_a_barrier(house, dataset):
    door = entrance(house)
    opened = with_doors(dataset, house, closed=False, chosen=lambda o: o is door)
    rigid = with_objects(opened, [replace(o, joints=()) for o in opened.levels[0].objects])
    compiled = compile_house(rigid, dataset.metadata)
    check_enclosed(compiled)
    assert len(compiled.doors.instance) == compiled.report["shut_leaves"] == 0
    assert compiled.report["barriers"] >= 1
    assert farthest_from_rooms(compiled, without_barriers(compiled)) > 1


def test_a_hole_where_the_entrance_was_is_closed_by_a_barrier(house, dataset):
    door = entrance(house)
    holed = with_objects(house, [o for o in house.levels[0].objects if o is not door])
    compiled = compile_house(holed, dataset.metadata)
    check_enclosed(compiled)
    assert 1 <= compiled.report["barriers"] <= 2
    assert farthest_from_rooms(compiled, without_barriers(compiled)) > 1
