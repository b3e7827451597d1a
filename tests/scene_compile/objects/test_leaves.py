"""How far leaves turn: closed forms on plans, MuJoCo's distances in compiled houses."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from door_states import with_doors
from generated import generate_flats

from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, make_boxes, penetration_depth
from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.objects.doors import PlacedLeaf
from home_mjx.scene_compile.objects.leaves import CLEARANCE, find_blocking_leaves, find_motion_range, make_doors
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse, PortalKind
from home_mjx.schema.house import BoxNode

LENGTH, THICK = 0.8, 0.04  # [m]


def leaf(placed: float = 0.0, side: int = 1) -> PlacedLeaf:
    """Hinged at the origin, closed along +x, opening to `side`; it stands `placed` radians open."""
    shut = make_boxes((LENGTH / 2, 0, 1), (LENGTH / 2, THICK / 2, 1))
    probe = PlacedLeaf(5, np.zeros(2), 0.0, 0.0, shut)
    closed = -side * placed
    return PlacedLeaf(5, np.zeros(2), closed, closed + side * np.pi / 2, probe.box_at(side * placed))


def jambs(face: float = 0.0) -> BoxSet:
    """The wall to both sides of the doorway, its face at y = `face`, 0.3 m thick."""
    left = make_boxes((-1.003, face - 0.15, 1), (1, 0.15, 1))
    right = make_boxes((LENGTH + 1.003, face - 0.15, 1), (1, 0.15, 1))
    return concat_boxes([left, right])


@pytest.mark.parametrize("placed", [0.0, 0.4, 1.2])
@pytest.mark.parametrize("side", [1, -1])
def test_nothing_in_the_way_lets_a_leaf_turn_half_a_circle_to_one_side(placed, side):
    low, high = find_motion_range(leaf(placed, side), empty_boxes())
    closed = -side * placed
    assert closed == (low if side > 0 else high)
    assert high - low == pytest.approx(np.pi, abs=np.deg2rad(1.01))
    assert low <= 0 <= high


@pytest.mark.parametrize("gap", [0.2, 0.5, 0.7])
@pytest.mark.parametrize("placed", [0.0, 0.1])
def test_a_leaf_stops_a_centimetre_before_a_wall(gap, placed):
    """Its far corner is at height L sin q + t/2 cos q."""
    wall = make_boxes((0, gap + 1, 1), (3, 1, 1))
    low, high = find_motion_range(leaf(placed), concat_boxes([jambs(), wall]))
    q = np.linspace(0, np.pi / 2, 20_000)
    expected = q[np.argmax(LENGTH * np.sin(q) + THICK / 2 * np.cos(q) > gap - CLEARANCE)]
    assert high - low == pytest.approx(expected, abs=np.deg2rad(1.01))
    assert high - low <= expected + 1e-3
    assert low == -placed


def test_a_leaf_on_the_face_of_its_wall_opens_until_it_lies_along_it():
    low, high = find_motion_range(leaf(), jambs(face=0.0))
    assert (low, high) == (0.0, pytest.approx(np.pi, abs=np.deg2rad(1.01)))


def test_a_leaf_deep_in_its_wall_stops_at_the_corner_of_the_doorway():
    low, high = find_motion_range(leaf(), jambs(face=0.2))
    assert low == 0.0
    assert np.deg2rad(85) < high < np.deg2rad(120)


@pytest.mark.parametrize("bottom", [0.0, 2.5])
def test_only_boxes_at_its_height_stop_a_leaf(bottom):
    low, high = find_motion_range(leaf(), make_boxes((0, 0.5, bottom + 0.25), (0.1, 0.1, 0.25)))
    assert (high - low < np.pi / 2) == (bottom == 0.0)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("placed", [0.0, np.pi / 2])
def test_what_stands_behind_an_open_door_ends_its_range_though_it_could_move(side, placed):
    """A plant of a home, seed 4000700, held a leaf at 137 of 171 degrees."""
    plant = make_boxes((-0.55, side * 0.4, 0.5), (0.15, 0.15, 0.5))
    wall = jambs(face=0.0) if side > 0 else empty_boxes()
    low, high = find_motion_range(leaf(placed, side), wall, movable=plant)
    assert np.pi / 2 < high - low < np.deg2rad(140)
    reached = leaf(placed, side).box_at(high if side > 0 else low)
    assert -2 * CLEARANCE - 0.014 < penetration_depth(reached, plant).max() <= -CLEARANCE
    assert (make_doors([leaf(placed, side)], wall, movable=plant).low[0]) == low
    free = find_motion_range(leaf(placed, side), wall)
    assert free[1] - free[0] > np.deg2rad(175)


def test_what_could_move_does_not_keep_a_door_from_opening_wide():
    """It is pushed; nor does it end the range there, since it may stand a little nearer than a leaf as placed."""
    chair = make_boxes((0.5, 0.5, 0.5), (0.2, 0.2, 0.5))
    assert find_motion_range(leaf(), empty_boxes(), movable=chair) == find_motion_range(leaf(), empty_boxes())
    behind = make_boxes((-0.2, 0.5, 0.5), (0.195, 0.2, 0.5))  # at 90 degrees it is 5 mm away
    assert find_motion_range(leaf(), empty_boxes(), movable=behind) == (0.0, pytest.approx(np.pi / 2))
    wall = make_boxes((0, 1.4, 1), (3, 1, 1))
    assert find_motion_range(leaf(), wall, movable=behind) == find_motion_range(leaf(), wall)  # never wide open


def test_a_leaf_that_stands_free_can_turn_to_where_it_stands():
    """Something thin stands between closed and as placed."""
    low, high = find_motion_range(leaf(placed=1.5), make_boxes((0.5, 0.3, 1), (0.05, 0.05, 1)))
    assert low == -1.5
    assert high > 0.2


def test_a_leaf_that_stands_in_something_is_held_before_it():
    thing = make_boxes((0.0, 0.6, 1), (0.3, 0.1, 1))
    stands = leaf(placed=np.pi / 2)
    low, high = find_motion_range(stands, thing)
    assert low == -np.pi / 2
    assert high < np.deg2rad(-30)
    doors = make_doors([stands], thing)
    assert (doors.low[0], doors.high[0], doors.closed[0]) == (low, high, low)
    assert doors.fully_open[0] == high  # 90 degrees cannot be reached


def test_a_leaf_that_hardly_opens_is_in_the_way_as_far_open_as_it_can_be():
    wall = make_boxes((0, 1.3, 1), (3, 1, 1))
    shut = leaf()
    (_, high) = find_motion_range(shut, wall)
    assert high < np.deg2rad(30)
    boxes = find_blocking_leaves([shut, leaf(side=-1)], wall)  # the other one opens away from the wall
    assert len(boxes) == 1
    np.testing.assert_allclose(boxes.center, shut.box_at(high).center)


def sliding(placed: float = 0.7) -> PlacedLeaf:
    """A leaf that is shut between x = 0 and its length, and slides behind the wall to the right by up to 0.7 m."""
    box = make_boxes((LENGTH / 2 + placed, 0, 1), (LENGTH / 2, THICK / 2, 1))
    wide = -placed + 0.7
    return PlacedLeaf(5, box.center[0, :2], -placed, wide, box, np.array([1.0, 0.0]))


@pytest.mark.parametrize("placed", [0.0, 0.3, 0.7])
@pytest.mark.parametrize("face", [0.0, 0.15])
def test_a_leaf_slides_as_far_as_its_model_beside_and_into_the_wall(placed, face):
    low, high = find_motion_range(sliding(placed), jambs(face))
    assert (low, high) == pytest.approx((-placed, 0.7 - placed), abs=0.011)
    doors = make_doors([sliding(placed)], jambs(face))
    assert doors.is_sliding.tolist() == [True]
    np.testing.assert_allclose([doors.closed[0], doors.fully_open[0]], [low, high])
    np.testing.assert_allclose(doors.pivot, doors.pos[:, :2])


def drawer(yaw: float, overlap: float) -> tuple[PlacedLeaf, BoxSet]:
    """The front of a drawer of 0.4 m travel, beside a cabinet whose side it touches or overlaps."""
    ahead, across = np.array([np.cos(yaw), np.sin(yaw), 0]), np.array([-np.sin(yaw), np.cos(yaw), 0])
    middle = np.array([1.3, 0.4, 0.5])
    box = BoxSet(middle[None], np.array([[0.01, 0.2, 0.1]]), np.array([yaw]))
    beside = BoxSet(
        (middle + 0.5 * ahead + (0.5 - overlap) * across)[None], np.array([[0.6, 0.3, 0.4]]), np.array([yaw])
    )
    return PlacedLeaf(5, middle[:2], 0.0, 0.4, box, ahead[:2], is_front=True), beside


@pytest.mark.parametrize("overlap", [0.0, 0.004])
def test_a_drawer_opens_along_a_flush_side_at_any_yaw(overlap):
    """Depths beside it are equal all the way but for rounding."""
    for yaw in np.linspace(0, np.pi, 37):
        front, beside = drawer(yaw, overlap)
        low, high = find_motion_range(front, beside)
        assert (low, high) == pytest.approx((0, 0.4), abs=0.011), yaw


def test_a_leaf_that_slides_stops_a_centimetre_before_what_stands_in_its_way():
    thing = make_boxes((LENGTH + 0.5, 0.0, 0.4), (0.2, 0.2, 0.4))
    low, high = find_motion_range(sliding(0.0), thing)
    assert low == 0.0
    assert 0.3 - CLEARANCE - 0.011 <= high <= 0.3 - CLEARANCE + 1e-6
    (box,) = find_blocking_leaves([sliding(0.0)], thing).center  # it hardly opens, so it is in the way
    np.testing.assert_allclose(box, [LENGTH / 2 + high, 0, 1])
    assert len(find_blocking_leaves([sliding(0.0)], empty_boxes())) == 0


def _distances(house: CompiledHouse, row: int, angle: float, bodies: bool = False) -> np.ndarray:
    """MuJoCo's distance from a leaf at an angle to each static box; negative: depth."""
    doors, boxes = house.doors, house.bodies if bodies else house.colliders
    spec, kind = mujoco.MjSpec(), mujoco.mjtGeom.mjGEOM_BOX
    arm = doors.pos[row, :2] - doors.pivot[row]
    c, s = np.cos(angle), np.sin(angle)
    pos = [*(doors.pivot[row] + np.array([[c, -s], [s, c]]) @ arm), doors.pos[row, 2]]
    quat = np.zeros(4)
    mujoco.mju_mulQuat(quat, np.array([np.cos(angle / 2), 0, 0, np.sin(angle / 2)]), doors.quat[row])
    spec.worldbody.add_geom(type=kind, pos=pos, quat=quat, size=doors.size[row])
    near = np.linalg.norm(boxes.pos[:, :2] - doors.pivot[row], axis=1) < 2.5
    for p, q, size in zip(boxes.pos[near], boxes.quat[near], boxes.size[near], strict=True):
        spec.worldbody.add_geom(type=kind, pos=p, quat=q, size=size)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return np.array([mujoco.mj_geomDistance(model, data, 0, i, 1.0, None) for i in range(1, model.ngeom)])


def check_ranges(house: CompiledHouse) -> None:
    """Within its range a leaf keeps a centimetre from all that it keeps it from when it is closed; beyond, not.

    Where it is opened farther than wide it keeps as far from what can move.
    """
    doors = house.doors
    for row in range(len(doors.instance)):
        low, high, closed = (float(v[row]) for v in (doors.low, doors.high, doors.closed))
        assert closed in (low, high)
        assert low <= doors.fully_open[row] <= high
        apart = _distances(house, row, closed) > CLEARANCE * 1.5
        for angle in np.linspace(low, high, 8):
            assert _distances(house, row, angle)[apart].min() > CLEARANCE * 0.9
        if high - low < np.deg2rad(178):
            free_end, way = (high, 1) if closed == low else (low, -1)
            now, beyond = (_distances(house, row, free_end + way * np.deg2rad(a)) for a in (0.0, 3.0))
            held = _distances(house, row, free_end + way * np.deg2rad(3.0), bodies=True).min(initial=1.0) < CLEARANCE
            assert beyond[apart].min() < CLEARANCE or (beyond < now - 1e-3)[~apart].any() or held
        end = high if closed == low else low
        if end != doors.fully_open[row]:
            for angle in np.linspace(doors.fully_open[row], end, 8)[1:]:
                assert _distances(house, row, angle, bodies=True).min(initial=1.0) > CLEARANCE * 0.9


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = tmp_path_factory.mktemp("generated")
    generate_flats(root, range(2))
    return open_dataset(root)


@pytest.fixture(scope="module")
def houses(dataset) -> list[CompiledHouse]:
    return HouseSet(dataset).load()


def test_leaves_of_generated_houses_turn_as_far_as_there_is_room(houses):
    for house in houses:
        check_ranges(house)
        assert ((house.doors.low <= 0) & (house.doors.high >= 0)).all()


@pytest.mark.real
def test_leaves_of_the_real_house_turn_as_far_as_there_is_room(suncg_root):
    dataset = open_dataset(suncg_root)
    check_ranges(compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata))


def test_every_door_between_rooms_names_its_leaf(houses):
    for house in houses:
        doors, portals = house.doors, house.navigation.portals
        inner = (portals.kind == PortalKind.DOOR) & (portals.room >= 0).all(axis=1)
        assert sorted(portals.leaf[inner, 0].tolist()) == list(range(len(doors.instance)))
        assert (portals.leaf[inner, 1] == -1).all()
        assert (portals.leaf[~inner] == -1).all()
        for pos, row in zip(portals.pos[inner], portals.leaf[inner, 0], strict=True):
            assert np.linalg.norm(doors.pivot[row] - pos[:2]) < 0.7  # half of a door that is 0.9 m wide, and some


def test_shut_doors_between_rooms_can_be_pushed_open(dataset):
    house = dataset.load_house(dataset.house_ids[0])
    shut = compile_house(with_doors(dataset, house, closed=True), dataset.metadata)
    np.testing.assert_array_equal(shut.doors.closed, 0)
    assert (shut.navigation.room_hops >= 0).all()
    check_ranges(shut)


def test_a_jammed_door_is_no_way(dataset):
    """A post of 10 cm at the free edge of a shut leaf: one could walk past it if the leaf were wide open."""
    house = dataset.load_house(dataset.house_ids[0])
    free = compile_house(house, dataset.metadata)
    doors, row = free.doors, 0
    along = _turn(doors.closed[row]) @ (doors.pos[row, :2] - doors.pivot[row])
    along /= np.linalg.norm(along)
    towards = _turn(doors.closed[row] / 2) @ (doors.pos[row, :2] - doors.pivot[row])
    across = np.array([-along[1], along[0]])
    across *= np.sign(across @ towards)
    x, y, z = np.array([*(doors.pivot[row] + 0.72 * along + 0.15 * across), 1.0]) - free.offset
    pose = np.eye(4)
    pose[:3, 3] = x, z, -y
    post = BoxNode("0_999", 999, "levels[0].nodes[999]", None, np.array([0.1, 2.0, 0.1]), pose)
    level = replace(house.levels[0], boxes=(*house.levels[0].boxes, post))
    posted = replace(house, levels=(level,))
    shut = with_doors(dataset, posted, closed=True, chosen=lambda o: o.index == _owner(free, row))
    jammed = compile_house(shut, dataset.metadata)
    assert 0 < jammed.doors.high[row] - jammed.doors.low[row] < np.deg2rad(30)
    (portal,) = np.flatnonzero(jammed.navigation.portals.leaf[:, 0] == row)
    assert jammed.navigation.portals.width[portal] == 0
    (portal,) = np.flatnonzero(free.navigation.portals.leaf[:, 0] == row)
    assert free.navigation.portals.width[portal] > 0


def _turn(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _owner(house: CompiledHouse, row: int) -> int:
    return int(house.instances.object_id[house.doors.instance[row]])


def test_leaves_that_turn_are_no_static_boxes(houses):
    for house in houses:
        doors = house.doors
        assert np.linalg.norm(house.colliders.pos[:, None] - doors.pos, axis=-1).min() > 0.1
        assert not set(house.instances.body[doors.instance].tolist()) - {-1}
