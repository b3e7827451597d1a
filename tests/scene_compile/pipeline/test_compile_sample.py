"""The real house, against what HoME measured in it, its own meshes and the dataset's tables."""

import csv
import re

import numpy as np
import pytest
from house_checks import (
    cell_points,
    crossed_partitions,
    mujoco_contacts,
    name_of,
    nearest,
    object_instances,
    obstacle_points,
    row_of,
    world_triangles,
)

from home_mjx.datasets.base import Dataset
from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.boxes import BoxSet, footprint_distance
from home_mjx.geometry.meshes import bounds, transform
from home_mjx.scene_compile.objects.masses import mass_range
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.categories import COARSE, FINE, NYU40
from home_mjx.schema.compiled import ARCHITECTURE, FIELD_UNREACHABLE, CompiledHouse, RayKind
from home_mjx.schema.house import House
from home_mjx.schema.semantic import Semantic

pytestmark = pytest.mark.real

# Instances after loading in HoME: middle of the model's own box (Z up, not recentred) [m], heading [deg], M = mirrored.
GOLDEN = {
    0: "81-0:(40.12,-41.78,0.497)90 83-0:(38.99,-40.507,0.483)0 87-0:(38.677,-41.53,0.524)89.95 "
    "144-0:(38.46,-41.47,1.45)-90 150-0:(39.76,-40.434,0.347)0 317-0:(38.61,-42.11,1.57)0 "
    "317-1:(38.61,-42.31,1.57)0 499-0:(38.49,-40.78,1.393)90",
    1: "67-0:(39.87,-38.07,0.523)0 67-1:(42.07,-38.06,0.523)-0.05 109-0:(40.96,-38.11,0.275)0 "
    "122-0:(38.139,-38.93,1.08)90.93 122-2:(43.17,-41.48,1.08)90.61M 122-4:(40.955,-40.767,1.08)90 "
    "174-0:(39.09,-37.96,0.331)0 174-1:(42.9,-37.98,0.331)0 209-0:(42.123,-37.491,1.55)-0.28 "
    "209-1:(39.828,-37.48,1.55)-0.28 352-0:(42.1,-42.263,0.524)180 352-1:(42.593,-41.49,0.524)-90 "
    "352-2:(42.14,-40.717,0.524)0 478-0:(43.28,-39.14,0.294)90 561-0:(40.59,-39.81,0.19)179.77 "
    "625-0:(39.86,-37.51,1.33)0 625-1:(42.03,-37.53,1.33)0 656-0:(42.11,-41.5,0.425)-90",
    2: "77-0:(45.043,-38.758,0.536)0 122-3:(45.914,-40.802,1.08)179.72 203-0:(47.42,-40.25,0.827)180 "
    "209-2:(44.979,-37.49,1.55)0.28 209-3:(47.141,-37.48,1.55)0.28 261-0:(47.13,-38.105,0.448)0 "
    "274-0:(43.7,-38.52,1.48)90 441-0:(47.4,-39.98,0.55)0 456-0:(44.17,-40.38,1.9)0 456-1:(45,-40.38,1.9)0 "
    "502-0:(48.51,-38.92,1.15)-90",
    3: "122-1:(45.537,-45.915,1.08)180 126-0:(44.71,-45.647,1.55)180 210-0:(47.349,-43.147,1.55)180",
    -1: "135-0:(34.19,-40.95,1.2)0 365-0:(38.19,-39.69,1.4)0 365-1:(38.19,-38.21,1.4)0",
}
PATTERN = re.compile(r"(\d+)-\d+:\(([-\d.,]+)\)([-\d.]+)(M?)")


@pytest.fixture(scope="module")
def dataset(suncg_root) -> Dataset:
    return open_dataset(suncg_root)


@pytest.fixture(scope="module")
def house(dataset) -> House:
    return dataset.load_house(dataset.house_ids[0])


@pytest.fixture(scope="module")
def compiled(house, dataset) -> CompiledHouse:
    return compile_house(house, dataset.metadata)


def golden() -> list[tuple]:
    return [
        (model, np.array(place.split(","), float), float(heading), bool(mirrored), room)
        for room, text in GOLDEN.items()
        for model, place, heading, mirrored in PATTERN.findall(text)
    ]


def test_counts(compiled):
    report = compiled.report
    counts = [report[n] for n in ("levels", "rooms", "objects", "architecture_parts", "triangles")]
    assert counts == [1, 4, 43, 12, 102_150]
    assert len(golden()) == 43


def test_ground_floor_is_around_the_origin(compiled):
    low, high = bounds(compiled.models[compiled.instances.model[ARCHITECTURE]].triangle)
    np.testing.assert_allclose((low + high)[:2], 0, atol=1e-5)
    np.testing.assert_allclose(compiled.rooms.floor, 0.05, atol=1e-6)


@pytest.mark.parametrize("model", sorted({g[0] for g in golden()}))
def test_poses_are_those_that_home_had(compiled, model):
    objects = [parts for parts in object_instances(compiled) if name_of(compiled, parts[0]) == model]
    expected = [g for g in golden() if g[0] == model]
    assert len(objects) == len(expected)
    for _, center, heading, mirrored, room in expected:
        box = bounds(np.array([compiled.models[compiled.instances.model[i]].box for i in objects[0]], float))
        middles = [transform(compiled.instances.pose[parts[0]], box.mean(axis=0)) for parts in objects]
        gaps = np.linalg.norm(np.array(middles) - compiled.offset - center, axis=1)
        i = objects.pop(int(gaps.argmin()))[0]
        pose = compiled.instances.pose[i, :, :3]
        assert gaps.min() < 1e-3
        assert (np.linalg.det(pose) < 0) == mirrored
        turn = np.rad2deg(np.arctan2(pose[1, 0], pose[0, 0])) - heading
        if not mirrored:
            assert abs((turn + 180) % 360 - 180) < 0.01
        assert row_of(compiled, i)[Semantic.ROOM] == room


def test_boxes_are_those_of_the_file(compiled, house):
    for node in house.levels[0].objects:
        parts = np.flatnonzero(compiled.instances.object_id == node.index)
        if len(parts) > 1 and not np.isin(parts[1], compiled.doors.instance):
            continue  # an outer door: open in the file, shut here
        low, high = bounds(np.concatenate([world_triangles(compiled, i) for i in parts])) - compiled.offset
        expected = node.bbox
        np.testing.assert_allclose([low[0], low[2], -high[1]], expected[0], atol=1e-4)
        np.testing.assert_allclose([high[0], high[2], -low[1]], expected[1], atol=1e-4)


def test_categories_are_those_of_the_table(compiled, suncg_root):
    with (suncg_root / "metadata" / "ModelCategoryMapping.csv").open() as file:
        table = {row["model_id"]: row for row in csv.DictReader(file)}
    for i in range(1, len(compiled.instances.model)):
        row, expected = row_of(compiled, i), table[name_of(compiled, i)]
        names = FINE[row[Semantic.FINE]], COARSE[row[Semantic.COARSE]], NYU40[row[Semantic.NYU40]]
        columns = ("fine_grained_class", "coarse_grained_class", "nyuv2_40class")
        assert names == tuple(expected[c] for c in columns)
        assert row[Semantic.OBJECT_ID] == compiled.instances.object_id[i]
        assert row[Semantic.MOVABLE] == compiled.instances.body[i]


@pytest.mark.parametrize(
    ("start", "end", "count"),
    [
        ((1.0, 2.0), (1.0, -1.0), 1),  # bedroom to the room south of it: two copies of one wall
        ((-1.0, 3.0), (1.0, 3.0), 1),  # room 1 to the bedroom; room 0's copy coincides
        ((-3.0, 3.0), (-3.0, 0.5), 1),  # room 1 to the bathroom that it is cut out of
        ((1.0, -2.0), (-2.0, -2.0), 1),  # out of the house
        ((1.0, 3.0), (1.0, -6.0), 2),  # through the southern room and out
        ((1.0, 1.5), (3.0, 3.0), 0),  # within the bedroom
    ],
)
def test_a_segment_crosses_each_physical_wall_once(compiled, start, end, count):
    found = crossed_partitions(compiled, np.array([*start, 2.4]), np.array([*end, 2.4]))
    assert len(found) == count


def test_walls_of_two_rooms_share_their_partition_and_others_do_not(compiled):
    model = compiled.models[compiled.instances.model[ARCHITECTURE]]
    rows = compiled.semantics[: int(model.part.max()) + 1]
    walls = rows[rows[:, Semantic.FINE] == FINE.index("wall")]
    rooms = {p: set(walls[walls[:, Semantic.PARTITION] == p, Semantic.ROOM].tolist()) for p in walls[:, 6].tolist()}
    assert {2, 3} in rooms.values()
    assert {1} in rooms.values()  # around the bathroom that lies in room 0's outline
    assert {3} in rooms.values()
    flat = rows[rows[:, Semantic.FINE] != FINE.index("wall")]
    assert not set(flat[:, Semantic.PARTITION].tolist()) & set(rooms)


def test_all_rooms_are_connected(compiled):
    navigation = compiled.navigation
    assert set(navigation.room[navigation.home_mask].tolist()) == {0, 1, 2, 3}
    assert (navigation.field < FIELD_UNREACHABLE).all()
    assert len(navigation.field) == navigation.home_mask.sum()


def test_nothing_of_the_meshes_is_in_free_space(compiled):
    gaps = nearest(obstacle_points(compiled, ("curtain", "door")), cell_points(compiled)[compiled.navigation.home_mask])
    assert gaps.min() > 0.15 - 0.01


def test_space_that_the_meshes_leave_is_free(compiled):
    """Boxes are larger than what they stand for, but little: a cell that is not free has something near."""
    navigation = compiled.navigation
    points = cell_points(compiled)
    bodies = BoxSet(compiled.bodies.pos, compiled.bodies.size, 2 * np.arctan2(*compiled.bodies.quat[:, [3, 0]].T))
    near_body = footprint_distance(bodies, points[None]).min(axis=0) < 0.16
    blocked = (navigation.room >= 0) & ~navigation.home_mask & ~near_body
    gaps = nearest(obstacle_points(compiled, ("curtain",)), points[blocked])
    assert np.mean(gaps < 0.15 + 0.1) > 0.96


def test_bodies_stand_free_on_the_floor(compiled):
    bodies, floor = compiled.bodies, compiled.rooms.floor.min()
    np.testing.assert_allclose(bodies.pos[:, 2] - bodies.size[:, 2], floor, atol=1e-9)
    assert len(bodies.mass) == 10
    assert (np.diff(bodies.mass) >= 0).all()


def test_no_body_touches_a_wall_or_another_body_in_mujoco(compiled):
    assert mujoco_contacts(compiled) == []


def test_body_frames_agree_with_poses(compiled):
    for slot, i in enumerate(compiled.bodies.instance):
        w, _, _, z = compiled.bodies.quat[slot]
        turn = np.array([[w * w - z * z, -2 * w * z, 0], [2 * w * z, w * w - z * z, 0], [0, 0, 1]])
        inner = compiled.bodies.from_model[slot]
        world = np.c_[turn @ inner[:, :3], turn @ inner[:, 3] + compiled.bodies.pos[slot]]
        np.testing.assert_allclose(world, compiled.instances.pose[i], atol=1e-9)
        assert compiled.instances.body[i] == slot


def test_what_hangs_or_is_built_in_stays(compiled):
    moving = {name_of(compiled, i) for i in compiled.bodies.instance}
    assert not moving & {"317", "456", "274", "209", "122", "135", "365", "625", "144", "499", "502"}
    assert moving <= {"67", "77", "109", "174", "261", "352", "441", "478", "561", "656"}


def test_masses_are_within_what_such_furniture_weighs(compiled):
    for slot, i in enumerate(compiled.bodies.instance):
        row = row_of(compiled, i)
        low, high = mass_range(FINE[row[Semantic.FINE]], COARSE[row[Semantic.COARSE]])
        assert low <= compiled.bodies.mass[slot] <= high


def test_glass_passes_light_but_stops_sound(compiled):
    window = next(i for i in range(len(compiled.instances.model)) if name_of(compiled, i) == "210")
    rows = compiled.materials.mask[compiled.instances.material[window] :][:2]
    assert sorted(rows.tolist()) == [int(RayKind.CAMERA | RayKind.SOUND), int(RayKind.ALL)]


def test_planes_face_their_rooms_and_none_reflects_twice(compiled):
    planes = compiled.planes
    lit = planes.center + 0.3 * planes.normal
    wall = abs(planes.normal[:, 2]) < 0.5
    low, high = compiled.rooms.floor.min(), compiled.rooms.ceiling.max()
    assert ((lit[:, 2] > low) & (lit[:, 2] < high)).all()
    for i in np.flatnonzero(wall):
        same = wall & (planes.normal @ planes.normal[i] > 0.999)
        same &= abs((planes.center - planes.center[i]) @ planes.normal[i]) < 0.03
        along = planes.axis_u[i] / np.linalg.norm(planes.axis_u[i])
        middle, half = planes.center[same] @ along, abs(planes.axis_u[same] @ along)
        order = np.argsort(middle)
        ends = (middle + half)[order][:-1]
        assert ((middle - half)[order][1:] > ends - 0.2).all()


def test_floor_planes_tile_the_plan(compiled):
    """Every free point is on exactly one floor plane and below exactly one ceiling plane."""
    n, planes = compiled.navigation, compiled.planes
    points = np.c_[cell_points(compiled)[n.home_mask], np.zeros(n.home_mask.sum())]
    for up in (1, -1):
        on = []
        for i in np.flatnonzero(planes.normal[:, 2] * up > 0.5):
            away = points - planes.center[i]
            sides = [abs(away @ axis[:3]) <= axis @ axis for axis in (planes.axis_u[i], planes.axis_v[i])]
            on.append(np.all(sides, axis=0))
        assert np.mean(np.sum(on, axis=0) == 1) > 0.99
