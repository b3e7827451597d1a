"""Houses as GLB: read back by trimesh and by the package's own reader; the command."""

import json

import numpy as np
import pytest
import trimesh
from gltf_files import CUBE, GltfFile, two_rooms
from gltf_rules import find_faults, split
from PIL import Image

from home_mjx.cli import main
from home_mjx.core.color import decode_srgb
from home_mjx.datasets import open_dataset
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.gltf.export import export_gltf
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.categories import FINE
from home_mjx.schema.semantic import Semantic


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def house(tmp_path):
    """Two rooms with a chair, a table, and a picture with an image."""
    file: GltfFile = two_rooms()
    Image.new("RGB", (4, 4), (200, 30, 10)).save(tmp_path / "red.png")
    file.add("images", bufferView=file.view((tmp_path / "red.png").read_bytes()), mimeType="image/png")
    file.add("textures", source=0)
    shade = {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0}
    material = file.add("materials", name="oak", pbrMetallicRoughness=shade)
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    uv = file.accessor([[0, 0], [1, 0], [0, 1]])
    mesh = file.mesh(corners, material=material, attributes={"TEXCOORD_0": uv})
    file.node(name="picture", mesh=mesh, translation=[1, 1.2, 0.5], scale=[-1, 1, 1])
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    return compile_house(dataset.load_house("flat"), dataset.metadata)


def world(house) -> np.ndarray:
    """Return all triangles (t, 3, 3) with y up."""
    rows = zip(house.instances.model, house.instances.pose, strict=True)
    points = [house.models[m].triangle.astype(float) @ pose[:, :3].T + pose[:, 3] for m, pose in rows]
    found = np.concatenate(points)[..., [0, 2, 1]] * [1, 1, -1]
    return found[(found != np.roll(found, 1, axis=1)).any(axis=2).all(axis=1)]  # those with two equal corners are lines


def document(path) -> dict:
    data = path.read_bytes()
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def test_trimesh_reads_the_same_triangles(house, tmp_path):
    loaded = trimesh.load(export_gltf(house, tmp_path / "out.glb"), process=False)
    expected, found = world(house), loaded.to_geometry().triangles
    assert len(found) == len(expected)
    middle = [np.array(sorted(t.mean(axis=1).round(4).tolist())) for t in (expected, found)]
    assert np.allclose(middle[0], middle[1], atol=2e-4)
    assert np.allclose(loaded.bounds, [expected.min(axis=(0, 1)), expected.max(axis=(0, 1))], atol=1e-5)


def test_our_reader_finds_the_same_rooms_categories_materials_and_images(house, tmp_path):
    dataset = open_dataset(export_gltf(house, tmp_path / "again.glb"))
    again = compile_house(dataset.load_house("again"), dataset.metadata)
    assert np.allclose(again.rooms.ceiling, house.rooms.ceiling, atol=1e-5)
    for old, new in zip(house.rooms.polygon, again.rooms.polygon, strict=True):
        assert np.allclose(sorted(old.tolist()), sorted((new - again.offset[:2]).tolist()), atol=1e-5)
    for name in ("chair", "dining_table", "picture_frame"):
        boxes = [object_box(h, FINE.index(name)) for h in (house, again)]
        assert np.allclose(boxes[0], boxes[1] - again.offset, atol=1e-4)
    rows = [first_material(h, "picture_frame") for h in (house, again)]
    assert np.allclose(house.materials.albedo[rows[0]], again.materials.albedo[rows[1]], atol=1e-5)
    images = [np.asarray(Image.open(h.materials.texture[row])) for h, row in zip((house, again), rows, strict=True)]
    assert np.array_equal(*images)


def object_box(house, fine: int) -> np.ndarray:
    (row,) = np.flatnonzero(house.semantics[house.instances.semantic, Semantic.FINE] == fine)
    pose = house.instances.pose[row]
    points = house.models[house.instances.model[row]].triangle.astype(float) @ pose[:, :3].T + pose[:, 3]
    return np.array([points.min(axis=(0, 1)), points.max(axis=(0, 1))])


def first_material(house, name: str) -> int:
    (row,) = np.flatnonzero(house.semantics[house.instances.semantic, Semantic.FINE] == FINE.index(name))
    return int(house.instances.material[row])


def test_nodes_have_rooms_categories_cameras_and_lights(house, tmp_path):
    root = document(export_gltf(house, tmp_path / "out.glb"))
    nodes = {node["name"]: node for node in root["nodes"]}
    assert [name for name in nodes if name.startswith("room")] == ["room0", "room1"]
    inside = {root["nodes"][i]["name"] for r in ("room0", "room1") for i in nodes[r]["children"]}
    chair = next(name for name in nodes if name.startswith("chair_"))
    assert chair in inside
    assert nodes[chair]["extras"]["category"] == "chair"
    assert len(root["cameras"]) == 2
    lights = root["extensions"]["KHR_lights_punctual"]["lights"]
    lamps = np.flatnonzero(~house.lights.daylight)
    assert len(lights) == len(lamps)
    total = 683 * house.lights.intensity[lamps]
    assert np.allclose([np.array(x["color"]) * x["intensity"] for x in lights], total, rtol=1e-6)
    picture = next(m for m in root["materials"] if "baseColorTexture" in m["pbrMetallicRoughness"])
    row = first_material(house, "picture_frame")
    linear = decode_srgb(house.materials.albedo[row, :3])
    assert np.allclose(picture["pbrMetallicRoughness"]["baseColorFactor"][:3], linear)
    (node,) = [node for name, node in nodes.items() if name.startswith("picture_frame_")]
    assert np.linalg.det(np.array(node["matrix"]).reshape(4, 4)[:3, :3]) < 0  # mirrored


def test_files_keep_the_rules_of_the_specification(house, tmp_path):
    """The Khronos validator finds no error, warning, information or hint in such files; it needs Node.js."""
    root, chunk = split(export_gltf(house, tmp_path / "out.glb").read_bytes())
    assert find_faults(root, chunk) == []
    root["accessors"][0]["max"][0] += 1
    root["nodes"][-1]["children"].append(0)
    root["bufferViews"][0].pop("target")
    found = " ".join(find_faults(root, chunk))
    assert all(text in found for text in ("bounds do not fit", "parents", "targets"))


def test_normals_without_length_become_those_of_their_triangles(tmp_path):
    file = two_rooms()
    normal = file.accessor([[0, 0, 0]] * 3)
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    file.node(name="picture", mesh=file.mesh(corners, attributes={"NORMAL": normal}), translation=[1, 1.2, 0.5])
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    flat = compile_house(dataset.load_house("flat"), dataset.metadata)
    assert find_faults(*split(export_gltf(flat, tmp_path / "out.glb").read_bytes())) == []


def test_the_command_writes_a_house_and_refuses_other_names(tmp_path, capsys):
    path = two_rooms().write(tmp_path / "flat.glb")
    assert main(["export", "flat", str(tmp_path / "out.glb"), "--dataset", str(path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "out.glb")
    assert document(tmp_path / "out.glb")["asset"]["version"] == "2.0"
    assert main(["export", "flat", str(tmp_path / "out.obj"), "--dataset", str(path)]) == 2
    assert "`.glb`" in capsys.readouterr().err


def test_files_of_other_formats_are_refused(house, tmp_path):
    with pytest.raises(ConfigError, match="GLB"):
        export_gltf(house, tmp_path / "out.gltf")


def leaf_room(tmp_path) -> tuple[GltfFile, dict]:
    """The two rooms, a mirrored cupboard whose door turns by a quarter, and a copy twice as large that slides."""
    file = two_rooms()
    closed = {"axis": [0, 1, 0], "point": [6, 0, 0.42], "range": [-2.0, 0.0], "closed": 0, "open": -np.pi / 2}
    slide = {"type": "slide", "axis": [1, 0, 0], "point": [2, 0.5, 0.42], "range": [0, 0.4], "closed": 0.1}
    body = file.mesh(np.array([-0.5, 0, 0]) + CUBE * [1, 1, 0.4])
    leaf = file.mesh(np.array([-0.5, 0, 0.4]) + CUBE * [1, 1, 0.02])
    for owner, joint, place in ((30, {"type": "hinge", **closed}, [6.5, 0, 0]), (31, slide, [2, 0, 0])):
        scale = [-1, 1, 1] if owner == 30 else [-2, 2, 2]
        name, extras = f"wardrobe_{owner}", {"object_id": owner, "category": "wardrobe_cabinet", "model": "w"}
        file.node(name=name, mesh=body, translation=place, scale=scale, extras=extras)
        file.node(name=name, mesh=leaf, translation=place, scale=scale, extras={**extras, "joint": joint})
    return file, {"hinge": closed, "slide": slide}


def test_joints_of_exported_files_are_read_back_in_frames_of_their_models(tmp_path):
    """Parts at the ends of their ranges are where the joint moves them, also in a mirrored, scaled model."""
    file, stated = leaf_room(tmp_path)
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    house = dataset.load_house("flat")
    found = {o.joints[0].kind: o for o in house.levels[0].objects if o.joints}
    assert [o.model_id for o in found.values()] == ["wardrobe_cabinet"] * 2
    for kind, item in found.items():
        (joint,), mesh = item.joints, house.models[item.model_key]
        value = joint.open
        moved = joint.move(mesh, value).vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
        shown = mesh.vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
        part = np.unique(mesh.faces[joint.faces])
        point = np.array(stated[kind]["point"])
        if kind == "hinge":  # by -90 degrees about +y: x becomes z
            away = shown[part] - point
            expected = point + np.stack([-away[:, 2], away[:, 1], away[:, 0]], axis=1)
        else:
            expected = shown[part] + [0.4, 0, 0]
            assert joint.closed * 2 == pytest.approx(0.1)  # the model is half as large as its copy
        assert np.allclose(moved[part], expected, atol=1e-6)
        assert np.ptp(shown[part][:, 2]) == pytest.approx(0.02 * item.transform[1, 1], abs=1e-6)  # the leaf alone


@pytest.mark.parametrize(
    "joint", [None, 3, {"type": "ball"}, {"type": "hinge", "axis": [0, 0, 0]}, {"type": "hinge", "axis": ["x", 1, 2]}]
)
def test_entries_of_other_programs_are_no_joints(tmp_path, joint):
    file = two_rooms()
    file.json["nodes"][-1]["extras"] = {"object_id": 3, "category": "chair", "model": "c", "joint": joint}
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    assert not any(o.joints for o in dataset.load_house("flat").levels[0].objects)


def test_object_ids_of_other_programs_join_nothing(tmp_path):
    file = two_rooms()
    for number in (1, 2):
        low = np.array([1.0 + number, 0, 2])
        file.box(f"Stool.00{number}", low, low + 0.4)
        file.json["nodes"][-1]["extras"] = {"object_id": 0}
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    found = [o.model_id for o in dataset.load_house("flat").levels[0].objects]
    assert found.count("stool") == 2


def test_leaves_of_an_exported_house_are_leaves_of_the_house_that_is_read(tmp_path):
    """Fronts of furniture open in both houses: same hinges, ranges and boxes."""
    options = CompileOptions(articulation=ArticulationOptions(4))
    dataset = open_dataset(leaf_room(tmp_path)[0].write(tmp_path / "flat.glb"))
    first = compile_house(dataset.load_house("flat"), dataset.metadata, options)
    dataset = open_dataset(export_gltf(first, tmp_path / "again.glb"))
    second = compile_house(dataset.load_house("again"), dataset.metadata, options)
    assert (len(first.doors.instance), first.doors.is_front.tolist()) == (1, second.doors.is_front.tolist())
    for name in ("closed", "fully_open", "low", "high", "size"):
        assert np.allclose(getattr(first.doors, name), getattr(second.doors, name), atol=1e-5), name
    assert np.allclose(first.doors.pos, second.doors.pos - second.offset, atol=1e-5)
    assert np.allclose(first.doors.pivot, second.doors.pivot - second.offset[:2], atol=1e-5)
