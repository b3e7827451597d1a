"""Habitat datasets as houses: a small one made here, and the counts of the shared samples."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh
from habitat_files import CONFIG, CUPBOARD, write, write_dataset

from home_mjx.datasets import ReadOptions, open_dataset
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.rotations import quat_matrix
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.house import House

SAMPLES = Path(__file__).parents[4] / "shared" / "data"
needs_sample = pytest.mark.skipif(not SAMPLES.is_dir(), reason="the shared samples are not here")


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def root(tmp_path) -> Path:
    return tmp_path / "data"


def read(path: Path | str, house_id: str | None = None, **options: bool) -> House:
    dataset = open_dataset(path)
    return dataset.load_house(house_id or dataset.house_ids[0], ReadOptions(**options))


def things(house: House) -> dict[str, object]:
    return {o.extra["name"]: o for level in house.levels for o in level.objects if o.model_id != "structure"}


def box_of(house: House, name: str) -> np.ndarray:
    node = things(house)[name]
    points = house.models[node.model_key].vertices @ node.transform[:3, :3].T + node.transform[:3, 3]
    return np.array([points.min(axis=0), points.max(axis=0)])


def test_a_scene_has_its_regions_objects_lights_and_joints(root):
    """The chair has no centre of mass stated, so the middle of its box is at its place; its class is a beanbag."""
    house = read(write_dataset(root))
    (level,) = house.levels
    assert [room.types for room in level.rooms] == [("Kitchen",), ("Living_Room",)]
    assert [room.shape.ceiling for room in level.rooms] == pytest.approx([2.6, 2.6])
    assert all(room.walls is not None and room.walls.part.max() == 3 for room in level.rooms)
    assert box_of(house, "chair_1") == pytest.approx(np.array([[1.75, 0, 0.8], [2.25, 0.9, 1.2]]), abs=1e-6)
    chair, cupboard = (things(house)[name] for name in ("chair_1", "cupboard"))
    assert (chair.model_id, chair.extra["category"]) == ("ottoman", "beanbag")
    lights = [light for node in level.objects for light in node.lights]
    assert [light.kind for light in lights] == ["point"]  # the negative one is not kept
    assert lights[0].power == pytest.approx(3.0 * 32)
    assert {"navmesh_instance", "lights.dark", "articulated_objects.paths..urdf[1]"} <= {
        problem.element for problem in house.problems
    }
    hinge, slide = cupboard.joints
    assert (hinge.kind, hinge.low, hinge.high, hinge.closed) == ("hinge", -0.5, 1.5, 0.0)
    assert hinge.axis == pytest.approx((0, -1, 0), abs=1e-6)  # z of the body, which lies on its back
    assert hinge.point == pytest.approx((-0.3, 0.5, 0.2), abs=1e-6)
    assert (hinge.faces.tolist(), slide.faces.tolist()) == (list(range(12, 24)), list(range(24, 36)))
    assert [joint.part.partition("_")[0] for joint in cupboard.joints] == ["door", "drawer"]
    assert (slide.kind, slide.high, slide.axis) == ("slide", 0.3, pytest.approx((0, 0, 1), abs=1e-6))
    assert [(fallback.kind, fallback.name) for fallback in house.fallbacks] == [("model", "none.glb")]
    with pytest.raises(MissingFileError, match="asset is missing"):
        read(root, strict=True)


def test_lights_whose_sum_overflows_have_finite_powers(root):
    write_dataset(root)
    lamp = {"type": "point", "position": [2, 2.3, 2], "intensity": 1e308}
    write(
        root / "configs" / "day.lighting_config.json", {"lights": {"a": lamp, "b": lamp}, "positive_intensity_scale": 9}
    )
    levels = read(root / CONFIG).levels
    powers = [light.power for level in levels for node in level.objects for light in node.lights]
    assert powers == pytest.approx([48, 48])


def test_a_scene_compiles_and_agents_walk_through_its_doorway(root):
    dataset = open_dataset(write_dataset(root))
    house = compile_house(dataset.load_house("flat_0"), dataset.metadata)
    assert set(np.unique(house.navigation.room[0][house.navigation.region[0] == 0])) == {0, 1}


def test_places_follow_origin_scale_frame_and_rotation(root):
    """Each place is computed here by hand: scale, then rotation w x y z, then translation."""
    turn = [0.5**0.5, 0, 0.5**0.5, 0]
    common = {"template_name": "chair_1", "rotation": turn, "non_uniform_scale": [2, 1, -1], "uniform_scale": 0.5}
    instances = [
        {**common, "translation": [2, 1, 2], "translation_origin": "asset_local"},
        {**common, "translation": [2, 1, 2]},
    ]
    house = read(write_dataset(root, object_instances=instances))
    nodes = [o for o in house.levels[0].objects if o.extra.get("name") == "chair_1"]
    corners = np.array([[1, 0, 0], [1.5, 0.9, 0.4]])
    for node, shift in zip(nodes, (np.zeros(3), corners.mean(axis=0)), strict=True):
        expected = (corners - shift) * [1, 0.5, -0.5] @ quat_matrix(np.array([turn]))[0].T + [2, 1, 2]
        found = corners @ node.transform[:3, :3].T + node.transform[:3, 3]
        assert found == pytest.approx(expected)
    config = root / "configs" / "chair_1.object_config.json"
    stated = {"up": [0, 0, 1], "front": [0, 1, 0], "COM": [1, 0, 0], "units_to_meters": 0.5}
    write(config, {**json.loads(config.read_text()), **stated})
    house = read(root)
    for node in (o for o in house.levels[0].objects if o.extra.get("name") == "chair_1"):
        is_local = node is next(o for o in house.levels[0].objects if o.extra.get("name") == "chair_1")
        oriented = np.stack([corners[:, 0], corners[:, 2], -corners[:, 1]], axis=1) * 0.5
        away = np.zeros(3) if is_local else np.array([1, 0, 0])
        expected = (oriented - away) * [1, 0.5, -0.5] @ quat_matrix(np.array([turn]))[0].T + [2, 1, 2]
        assert corners @ node.transform[:3, :3].T + node.transform[:3, 3] == pytest.approx(expected)


def test_missing_assets_are_stood_in_for_in_the_box_of_their_colliders_or_refused(root):
    config = write_dataset(root)
    (root / "objects" / "chair_1.glb").rename(root / "objects" / "collider.glb")
    template = {"render_asset": "../objects/chair_1.glb", "collision_asset": "../objects/collider.glb"}
    write(root / "configs" / "chair_1.object_config.json", template)
    house = read(config)
    assert box_of(house, "chair_1") == pytest.approx(np.array([[1.75, 0, 0.8], [2.25, 0.9, 1.2]]), abs=1e-6)
    assert things(house)["chair_1"].model_id == "chair"
    assert [fallback.name for fallback in house.fallbacks] == ["chair_1", "none.glb"]
    with pytest.raises(MissingFileError, match="asset is missing"):
        read(config, strict=True)
    (root / "stages" / "flat.glb").unlink()
    assert read(config).fallbacks[0].kind == "room mesh"


def test_names_match_by_part_and_ambiguous_ones_list_their_candidates(root):
    instance = {"template_name": "chair", "translation": [2, 0.45, 1]}
    path = write_dataset(root, object_instances=[instance])
    assert "chair" in things(read(path))
    write(root / "configs" / "chair_2.object_config.json", {"render_asset": "../objects/chair_1.glb"})
    with pytest.raises(DatasetError, match=r"2 templates .*object_instances\[0\].template_name.*`configs/chair_1`"):
        read(path)


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("configs/chair_1.object_config.json", {"render_asset": "../../secret.glb"}, "leads out of"),
        ("configs/chair_1.object_config.json", {"render_asset": "https://host/a.glb"}, "expected a relative path"),
        ("configs/chair_1.object_config.json", {"render_asset": "/etc/passwd"}, "expected a relative path"),
        ("urdf/cupboard/cupboard.urdf", "<robot><link name='a'/><link name='b'/></robot>", "one link that no joint"),
        ("urdf/cupboard/cupboard.urdf", "<!DOCTYPE a [<!ENTITY b 'c'>]><robot/>", "entities"),
        (
            "scenes/flat_0.scene_instance.json",
            {"object_instances": [{"template_name": "chair_1", "rotation": [0] * 4}]},
            "no length",
        ),
        ("scenes/flat_0.scene_instance.json", {"object_instances": 3}, "expected a list"),
        ("flat.semantic_config.json", {"region_annotations": [{"poly_loop": [[0, 0]]}]}, "expected 3 numbers"),
    ],
)
def test_broken_files_and_paths_out_of_the_dataset_are_refused_at_their_places(root, file, content, message):
    path = write_dataset(root)
    write(root / file, content)
    with pytest.raises(DatasetError, match=message) as caught:
        read(path)
    assert str(root / Path(file).parent) in str(caught.value)


def test_a_symbolic_link_out_of_the_dataset_is_refused(root, tmp_path):
    path = write_dataset(root)
    (root / "objects" / "chair_1.glb").rename(tmp_path / "chair_1.glb")
    (root / "objects" / "chair_1.glb").symlink_to(tmp_path / "chair_1.glb")
    with pytest.raises(DatasetError, match="leads out of"):
        read(path)
    assert "chair_1" in things(read(f"habitat:{path}?root={tmp_path}"))


def test_digests_change_with_every_file_of_a_house_and_with_no_other(root):
    path = write_dataset(root)
    digest = open_dataset(path).inputs().house("flat_0")
    write(root / "scenes" / "other.scene_instance.json", {})
    assert open_dataset(path).inputs().house("flat_0") == digest
    for name in ("objects/chair_1.glb", "urdf/cupboard/cupboard.urdf", "flat.semantic_config.json", CONFIG):
        file = root / name
        file.write_bytes(file.read_bytes() + b" ")
        changed = open_dataset(path).inputs().house("flat_0")
        assert changed != digest, name
        digest = changed


@needs_sample
def test_replica_cad_has_the_counts_of_its_readme():
    house = read(SAMPLES / "replicacad_sample", "apt_0")
    found = things(house)
    (level,) = house.levels
    nodes = [o for o in level.objects if o.model_id != "structure"]
    assert len(nodes) == 113 + 6 - 1  # the URDF of a door is absent
    assert Counter(o.extra.get("motion_type") for o in nodes)["STATIC"] == 11
    assert len({o.extra["category"] for o in nodes if o.extra["category"]}) == 38
    missing = [fallback for fallback in house.fallbacks if fallback.element.startswith("object_instances")]
    assert len(nodes) - 5 - len(missing) == 37  # instances whose file is here
    fridge = found["fridge"]
    assert [(j.kind, j.low, round(j.high, 6)) for j in fridge.joints] == [("hinge", 0, 2.3), ("hinge", 0, 2.5)]
    parts = sorted((SAMPLES / "replicacad_sample" / "urdf" / "fridge").glob("*.glb"))
    count = sum(len(mesh.faces) for part in parts for mesh in trimesh.load(part).geometry.values())
    assert len(house.models[fridge.model_key].faces) == count - 5  # 5 have no area
    assert np.ptp(box_of(house, "fridge")[:, 1]) == pytest.approx(1.9, abs=0.1)  # it stands
    assert [j.high for j in found["kitchen_counter"].joints] == pytest.approx([0.5 * 0.98] * 7)
    chair = found["objects/frl_apartment_chair_05"]
    points = house.models[chair.model_key].vertices
    assert (len(house.models[chair.model_key].faces), points[:, 1].min(), points[:, 1].max()) == (
        1008,
        pytest.approx(-0.571, abs=1e-3),
        pytest.approx(0.329, abs=1e-3),
    )
    other = read(SAMPLES / "replicacad_sample", "v3_sc0_staging_00")
    assert len(things(other)) >= 17


@needs_sample
def test_the_test_dataset_of_habitat_has_the_counts_of_its_readme():
    house = read(SAMPLES / "habitat_sample" / "dataset_0")
    found = things(house)
    sizes = [len(house.models[found[f"dataset_test_object{i}"].model_key].faces) for i in (1, 2)]
    assert sizes == [8736, 24]
    assert found["dataset_test_object1"].transform[:3, 3] == pytest.approx([0.1, 0.2, 0.3])
    expected = trimesh.load(SAMPLES / "habitat_sample" / "dataset_0" / "stages" / "dataset_test_stage.glb").bounds
    expected = expected + np.array([1.1, 2.2, 3.3])
    meshes = [m for room in house.levels[0].rooms for m in (room.floor, room.ceiling, room.walls) if m is not None]
    boxes = [box_of_node(house, o) for o in house.levels[0].objects if o.model_id == "structure"]
    points = np.concatenate([*boxes, *(mesh.vertices for mesh in meshes)])  # the override has scale 1, the file 2
    assert np.array([points.min(axis=0), points.max(axis=0)]) == pytest.approx(expected, abs=1e-5)
    room = read(f"habitat:{SAMPLES / 'habitat_sample' / 'scenes' / 'simple_room.glb'}")
    points = np.concatenate([box_of_node(room, o) for o in room.levels[0].objects])
    assert points[:, 1].max() <= 2.155  # z up becomes y up


def box_of_node(house: House, node) -> np.ndarray:
    points = house.models[node.model_key].vertices @ node.transform[:3, :3].T + node.transform[:3, 3]
    return np.array([points.min(axis=0), points.max(axis=0)])


def test_assets_may_be_obj_and_stl_files_and_urdf_shapes_have_their_colours(root):
    config = write_dataset(root)
    write(root / "objects" / "chair_1.mtl", "newmtl red\nKd 1 0 0\n")
    obj = "mtllib chair_1.mtl\nv 1 0 0\nv 1.5 0 0\nv 1 .9 .4\nusemtl red\nf 1 2 3\n"
    write(root / "objects" / "chair_1.obj", obj)
    write(root / "configs" / "chair_1.object_config.json", {"render_asset": "../objects/chair_1.obj"})
    trimesh.creation.box((0.1, 0.2, 0.3)).export(root / "urdf" / "cupboard" / "drawer.stl")
    text = CUPBOARD.replace('<link name="door"><visual>', '<link name="door"><visual><material name="oak"/>')
    text = text.replace("</robot>", '<material name="oak"><color rgba="0.5 0.25 0 1"/></material></robot>')
    write(root / "urdf" / "cupboard" / "cupboard.urdf", text.replace("none.glb", "drawer.stl"))
    house = read(config)
    assert house.fallbacks == ()
    assert np.ptp(box_of(house, "chair_1"), axis=0) == pytest.approx([0.5, 0.9, 0.4])
    chair, cupboard = (house.models[things(house)[name].model_key] for name in ("chair_1", "cupboard"))
    assert chair.materials[0].diffuse == (1, 0, 0)
    door, drawer = things(house)["cupboard"].joints
    colors = [{cupboard.materials[s].diffuse for s in cupboard.slot[joint.faces]} for joint in (door, drawer)]
    assert colors == [{(0.5, 0.25, 0)}, {(0.6, 0.6, 0.6)}]
    assert np.ptp(cupboard.vertices[np.unique(cupboard.faces[drawer.faces])], axis=0) == pytest.approx([0.1, 0.3, 0.2])
    (root / "urdf" / "cupboard" / "drawer.stl").write_bytes(
        bytes(80) + b"\x64\0\0\0"
    )  # of 100 triangles, none is there
    with pytest.raises(DatasetError, match="STL"):
        read(config)


def test_libraries_of_obj_files_count_in_digests_and_are_listed_if_missing(root):
    config = write_dataset(root)
    obj = "mtllib paint.mtl\nv 1 0 0\nv 1.5 0 0\nv 1 .9 .4\nusemtl red\nf 1 2 3\n"
    files = {"objects": "chair_1.OBJ", "urdf/cupboard": "drawer.obj"}
    for folder, name in files.items():
        write(root / folder / name, obj)
    write(root / "configs" / "chair_1.object_config.json", {"render_asset": "../objects/chair_1.OBJ"})
    write(root / "urdf" / "cupboard" / "cupboard.urdf", CUPBOARD.replace("none.glb", "drawer.obj"))
    found = {(f.kind, f.name, f.element) for f in read(config).fallbacks}
    assert found == {("material library", "paint.mtl", name) for name in files.values()}
    for folder in files:
        before = open_dataset(config).inputs().house("flat_0")
        write(root / folder / "paint.mtl", "newmtl red\nKd 1 0 0\n")
        assert open_dataset(config).inputs().house("flat_0") != before
    assert read(config).fallbacks == ()
