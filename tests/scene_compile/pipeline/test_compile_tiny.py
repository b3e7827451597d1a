"""A house small enough to know every number of its compiled form."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from house_checks import mujoco_contacts, name_of, row_of, world_triangles
from tiny_dataset import DEPTH, DOOR, DOOR_AT, HOUSE_ID, TABLE, TABLE_AT, WIDTH, edit_house, write_tiny_dataset

from home_mjx.core.array_store import flatten
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.scene_compile.collision.colliders import _fit_shape
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions, compile_house
from home_mjx.schema.categories import FINE, ROOM_TYPES
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, RayKind
from home_mjx.schema.semantic import Semantic

SHIFT = np.array([-WIDTH / 2, DEPTH / 2, 0.0])  # world = (x, -z, y) + SHIFT


def compile_tiny(root, options=DEFAULT_OPTIONS) -> CompiledHouse:
    dataset = open_dataset(root)
    return compile_house(dataset.load_house(HOUSE_ID), dataset.metadata, options)


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory) -> CompiledHouse:
    return compile_tiny(write_tiny_dataset(tmp_path_factory.mktemp("tiny")))


def instance(compiled: CompiledHouse, name: str) -> int:
    return next(i for i in range(len(compiled.instances.model)) if name_of(compiled, i) == name)


def slot_rows(compiled: CompiledHouse, i: int) -> np.ndarray:
    slots = compiled.models[compiled.instances.model[i]].slot
    return compiled.instances.material[i] + np.arange(slots.max() + 1)


def test_offset_centres_the_room(compiled):
    np.testing.assert_allclose(compiled.offset, SHIFT)
    polygon = compiled.rooms.polygon[0]
    np.testing.assert_allclose(polygon.min(axis=0), [-WIDTH / 2, -DEPTH / 2], atol=1e-4)
    np.testing.assert_allclose(polygon.max(axis=0), [WIDTH / 2, DEPTH / 2], atol=1e-4)
    np.testing.assert_allclose([compiled.rooms.floor[0], compiled.rooms.ceiling[0]], [0.05, 2.69])
    assert ROOM_TYPES[compiled.rooms.type[0]] == "Living_Room"


def test_turned_and_mirrored_objects_lie_where_the_file_says(compiled):
    table = world_triangles(compiled, instance(compiled, TABLE))
    x, y, z = np.array([TABLE_AT[0], -TABLE_AT[2], TABLE_AT[1]]) + SHIFT
    np.testing.assert_allclose(table.min(axis=(0, 1)), [x - 0.4, y - 0.6, z], atol=1e-6)
    np.testing.assert_allclose(table.max(axis=(0, 1)), [x + 0.4, y + 0.6, z + 0.75], atol=1e-6)
    door = instance(compiled, f"{DOOR}_0")
    assert np.linalg.det(compiled.instances.pose[door, :, :3]) == pytest.approx(-1)
    np.testing.assert_allclose(compiled.instances.pose[door, :, 3], [DOOR_AT[0] - 2, -DOOR_AT[2] + 1.5, DOOR_AT[1]])


def test_a_box_node_is_a_scaled_cube(compiled):
    box = instance(compiled, "box")
    triangles = world_triangles(compiled, box)
    np.testing.assert_allclose(np.ptp(triangles.reshape(-1, 3), axis=0), [0.5, 0.5, 1.0], atol=1e-6)
    assert len(slot_rows(compiled, box)) == 6
    assert FINE[row_of(compiled, box)[Semantic.FINE]] == "unknown"


def test_object_ids_are_node_indices(compiled):
    assert compiled.instances.object_id.tolist() == [-1, 2, 3, 4]


def test_overrides_by_position_replace_only_what_they_name(compiled):
    row, metal = slot_rows(compiled, instance(compiled, TABLE))
    table = compiled.materials
    np.testing.assert_allclose(table.albedo[row], [1.0, 128 / 255, 0.0, 1.0], atol=1e-6)
    assert table.texture[row].endswith("123.jpg")
    np.testing.assert_allclose(table.albedo[metal], [0.2, 0.2, 0.2, 0.5])
    assert table.texture[metal] == ""
    assert (table.kind[metal], table.mask[metal]) == ("glass", int(RayKind.CAMERA | RayKind.SOUND))
    frame, leaf = slot_rows(compiled, instance(compiled, f"{DOOR}_0"))
    np.testing.assert_allclose(table.albedo[frame, :3], 0.5)  # the override has a name and nothing else
    assert table.kind[leaf] == "wood"


def test_sound_rows_are_energy_fractions(compiled):
    table = compiled.materials
    for name in ("absorption", "scattering", "transmission"):
        assert ((getattr(table, name) >= 0) & (getattr(table, name) <= 1)).all()
    assert (table.transmission <= table.absorption).all()


def test_parts_are_floor_ceiling_walls_and_ground(compiled):
    model = compiled.models[compiled.instances.model[ARCHITECTURE]]
    rows = compiled.semantics[: model.part.max() + 1]
    assert [FINE[r] for r in rows[:, Semantic.FINE]] == ["floor", "ceiling", "wall", "wall", "wall", "wall", "floor"]
    assert len(set(rows[:, Semantic.PARTITION].tolist())) == 7
    assert rows[:, Semantic.ROOM].tolist() == [0] * 6 + [-1]
    assert compiled.report["architecture_parts"] == 3 + 1


def test_planes_are_the_six_sides_of_the_room(compiled):
    planes = compiled.planes
    normals = {tuple(np.round(n).astype(int).tolist()) for n in planes.normal}
    assert len(planes.normal) == len(normals) == 6
    inner = np.array([WIDTH - 0.1, DEPTH - 0.1, 2.64]) / 2
    middle = np.array([0, 0, (0.05 + 2.69) / 2])
    for center, normal in zip(planes.center, planes.normal, strict=True):
        axis = int(abs(normal).argmax())
        away = {0: inner[0], 1: inner[1], 2: inner[2]}[axis]
        assert (center - middle) @ normal == pytest.approx(-away, abs=1e-6)


def test_the_table_can_be_pushed_but_not_what_is_built_in(compiled):
    assert [name_of(compiled, i) for i in compiled.bodies.instance] == [TABLE]
    assert row_of(compiled, instance(compiled, TABLE))[Semantic.MOVABLE] == 0
    assert 15 <= compiled.bodies.mass[0] <= 60
    assert mujoco_contacts(compiled) == []


def test_without_bodies_everything_is_solid(root):
    still = compile_tiny(root, CompileOptions(movables=MovableOptions(max_bodies=0)))
    assert len(still.bodies.mass) == 0
    moving = compile_tiny(root)
    assert len(still.colliders.pos) > len(moving.colliders.pos)


def test_a_table_that_stands_in_a_wall_stays(root):
    def into_wall(house):
        house["levels"][0]["nodes"][2]["transform"][12] = 0.2

    edit_house(root, into_wall)
    compiled = compile_tiny(root)
    assert compiled.report["movable_but_stuck"] == 1
    assert len(compiled.bodies.mass) == 0


def test_a_table_a_little_in_the_wall_is_drawn_in(root):
    def near_wall(house):
        house["levels"][0]["nodes"][2]["transform"][12] = 0.05 + 0.4 - 0.02

    edit_house(root, near_wall)
    compiled = compile_tiny(root)
    assert len(compiled.bodies.mass) == 1
    assert compiled.bodies.size[0, 1] == pytest.approx(0.4 - 0.0105, abs=1e-6)
    assert mujoco_contacts(compiled) == []
    pose = compiled.instances.pose[instance(compiled, TABLE)]
    assert pose[0, 3] == pytest.approx(0.43 - 2.0)


def test_a_second_storey_is_seen_but_not_felt(root):
    def add_storey(house):
        table = {**house["levels"][0]["nodes"][2], "id": "1_0"}
        table["transform"] = [*table["transform"][:13], table["transform"][13] + 2.7, *table["transform"][14:]]
        house["levels"].append({"id": "1", "nodes": [table]})

    edit_house(root, add_storey)
    compiled, before = compile_tiny(root), compile_tiny(write_tiny_dataset(root / "plain"))
    assert compiled.report["levels"] == 2
    assert compiled.instances.object_id.tolist() == [-1, 2, 3, 4, 5]
    assert row_of(compiled, 4)[Semantic.LEVEL] == 1
    assert row_of(compiled, 4)[Semantic.ROOM] == -1
    np.testing.assert_array_equal(compiled.colliders.pos, before.colliders.pos)
    np.testing.assert_array_equal(compiled.navigation.home_mask, before.navigation.home_mask)


def test_a_hidden_floor_is_stood_in_for_by_the_ceiling(root):
    edit_house(root, lambda house: house["levels"][0]["nodes"][0].update(hideFloor=1))
    compiled = compile_tiny(root)
    np.testing.assert_allclose(np.ptp(compiled.rooms.polygon[0], axis=0), [WIDTH, DEPTH], atol=1e-4)
    assert compiled.rooms.floor[0] == pytest.approx(0.0)
    assert compiled.navigation.home_mask.any()


def test_a_house_without_rooms_is_refused(root):
    edit_house(root, lambda house: house["levels"][0]["nodes"][0].update(valid=0))
    with pytest.raises(DatasetError, match="no room"):
        compile_tiny(root)


def test_a_house_full_of_things_is_refused(root):
    def fill(house):
        house["levels"][0]["nodes"][4]["dimensions"] = [20.0, 3.0, 20.0]

    edit_house(root, fill)
    with pytest.raises(DatasetError, match="no place"):
        compile_tiny(root)


def test_a_house_is_the_same_whatever_was_compiled_before(tmp_path):
    """Another house has the same models, turned and scaled by a little more: boxes are kept for equal shapes."""
    root, other = write_tiny_dataset(tmp_path), HOUSE_ID[:-1] + "2"
    for kind in ("house", "room"):
        shutil.copytree(root / kind / HOUSE_ID, root / kind / other)

    def turn(house):
        house.update(id=other)
        for node in house["levels"][0]["nodes"]:
            if node["type"] == "Object":
                matrix = np.array(node["transform"]).reshape(4, 4)
                c, s = np.cos(3e-7), np.sin(3e-7)
                matrix[:3, :3] = matrix[:3, :3] @ [[c, 0, s], [0, 1, 0], [-s, 0, c]] * (1 + 3e-7)
                node["transform"] = matrix.ravel().tolist()

    edit_house(root, turn, other)
    dataset, found = open_dataset(root), []
    for order in ((HOUSE_ID, other), (other, HOUSE_ID)):
        _fit_shape.cache_clear()
        houses = {house: compile_house(dataset.load_house(house), dataset.metadata) for house in order}
        found.append({house: flatten(houses[house], frozenset(("models",)))[0] for house in houses})
    for house in (HOUSE_ID, other):
        one, two = (each[house] for each in found)
        assert {name for name in one if one[name].tobytes() != two[name].tobytes()} == set()


def test_a_room_without_meshes_has_neither_a_light_nor_a_camera(root):
    dataset = open_dataset(root)
    house = dataset.load_house(HOUSE_ID)
    level = house.levels[0]
    last = max(node.index for node in (*level.rooms, *level.objects, *level.boxes))
    bare = replace(level.rooms[0], floor=None, ceiling=None, walls=None, index=last + 1, members=())
    house = replace(house, levels=(replace(level, rooms=(*level.rooms, bare)), *house.levels[1:]))
    compiled = compile_house(house, dataset.metadata)
    assert compiled.rooms.polygon[1].shape == (0, 2)
    assert 1 not in compiled.lights.room
    xml, _ = to_mjcf(compiled)
    assert 'name="room0"' in xml
    assert 'name="room1"' not in xml
