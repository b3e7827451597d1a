"""The writer against the reader, on the hand-written dataset and on the real house: what goes out comes back."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from tiny_dataset import HOUSE_ID, edit_house, write_tiny_dataset

from home_mjx.core.images import decode_image, encode_png
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.read.joints import read_joints
from home_mjx.datasets.suncg.read.metadata import read_metadata
from home_mjx.datasets.suncg.write import house as writer_module
from home_mjx.datasets.suncg.write.house import house_document, write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House, Joint, Light, Mesh, ModelInfo

IGNORED = {"path", "problems"}  # where something was read from


def assert_same(one, other, where=""):
    """Equal values, all the way down; arrays to the tenth of a millimetre."""
    assert type(one) is type(other), where
    if isinstance(one, Path):
        assert one.name == other.name, where
    elif isinstance(one, Mesh):
        assert_same_surface(one, other, where)
    elif dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            if field.name not in IGNORED:
                assert_same(getattr(one, field.name), getattr(other, field.name), f"{where}.{field.name}")
    elif isinstance(one, Mapping):
        assert list(one) == list(other), where
        for key in one:
            assert_same(one[key], other[key], f"{where}[{key}]")
    elif isinstance(one, tuple):
        assert len(one) == len(other), where
        for i, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{where}[{i}]")
    elif isinstance(one, np.ndarray | float):
        np.testing.assert_allclose(one, other, atol=1e-4, err_msg=where)
    else:
        assert one == other, where


def assert_same_surface(one: Mesh, other: Mesh, where: str):
    """The same triangles with the same looks, whatever the order of vertices and blocks in the file."""
    assert_same(one.materials, other.materials, where)
    assert len(one.faces) == len(other.faces), where
    rows = [
        np.concatenate(
            [
                m.vertices[m.faces].reshape(-1, 9),
                m.uv.reshape(-1, 6),
                m.slot[:, None],
                [[hash(m.groups[g]) % 1000 if g >= 0 else -1] for g in m.group],
            ],
            1,
        ).round(3)
        for m in (one, other)
    ]
    one_rows, other_rows = (r[np.lexsort(r.T[::-1])] for r in rows)
    np.testing.assert_allclose(one_rows, other_rows, atol=2e-3, err_msg=where)


def without_room_boxes(house: House) -> House:
    """For the hand-written dataset, whose room box leaves its members out."""
    rooms = tuple(dataclasses.replace(room, bbox=None) for room in house.levels[0].rooms)
    return dataclasses.replace(house, levels=(dataclasses.replace(house.levels[0], rooms=rooms),))


def copy_by_writing(source: Path, target: Path, house_id: str) -> tuple[House, House]:
    """Reads a house, writes it beside the same library, and reads it again."""
    for folder in ("object", "texture", "metadata"):
        (target / folder).symlink_to(source / folder)
    house = open_dataset(source).load_house(house_id)
    write_house(target, house)
    return house, open_dataset(target).load_house(house_id)


def test_round_trip_of_every_kind_of_node(tmp_path):
    source = write_tiny_dataset(tmp_path / "source")
    (tmp_path / "target").mkdir()
    house, again = copy_by_writing(source, tmp_path / "target", HOUSE_ID)
    assert_same(without_room_boxes(house), without_room_boxes(again))
    _, high = again.levels[0].rooms[0].bbox
    assert high[2] == pytest.approx(3.07)  # of the door, which reaches beyond the walls


def test_unknown_nodes_are_written_as_they_were(tmp_path):
    source = write_tiny_dataset(tmp_path / "source")
    camera = {"id": "0_5", "type": "Camera", "fov": 0.7, "target": [1, {"of": "what"}]}
    edit_house(source, lambda document: document["levels"][0]["nodes"].append(camera))
    (tmp_path / "target").mkdir()
    house, again = copy_by_writing(source, tmp_path / "target", HOUSE_ID)
    assert (
        [node.data for node in house.levels[0].unknown] == [node.data for node in again.levels[0].unknown] == [camera]
    )
    written = json.loads((tmp_path / "target" / "house" / HOUSE_ID / "house.json").read_text())
    assert written["levels"][0]["nodes"][5] == camera


@pytest.mark.real
def test_round_trip_of_the_real_house(suncg_root, tmp_path):
    house, again = copy_by_writing(suncg_root, tmp_path, open_dataset(suncg_root).house_ids[0])
    assert_same(dataclasses.replace(house, levels=()), dataclasses.replace(again, levels=()))
    for one, other in zip(house.levels[0].rooms, again.levels[0].rooms, strict=True):
        assert_same(dataclasses.replace(one, bbox=None), dataclasses.replace(other, bbox=None), one.id)
    assert_same(house.levels[0].objects, again.levels[0].objects)


@pytest.mark.real
def test_boxes_agree_with_those_that_suncg_stored(suncg_root, tmp_path):
    """Also for rooms, whose boxes SUNCG grew by their members."""
    house_id = open_dataset(suncg_root).house_ids[0]
    copy_by_writing(suncg_root, tmp_path, house_id)
    real, own = (json.loads((r / "house" / house_id / "house.json").read_text()) for r in (suncg_root, tmp_path))
    for one, other in zip(real["levels"][0]["nodes"], own["levels"][0]["nodes"], strict=True):
        for corner in ("min", "max"):
            np.testing.assert_allclose(one["bbox"][corner], other["bbox"][corner], atol=1e-3, err_msg=one["id"])
    np.testing.assert_allclose(real["bbox"]["max"], own["bbox"]["max"], atol=1e-3)


@pytest.mark.real
def test_json_has_the_keys_of_suncg_in_its_order(suncg_root, tmp_path):
    house_id = open_dataset(suncg_root).house_ids[0]
    copy_by_writing(suncg_root, tmp_path, house_id)
    real, own = (json.loads((r / "house" / house_id / "house.json").read_text()) for r in (suncg_root, tmp_path))
    assert list(real) == list(own)
    assert list(real["levels"][0]) == list(own["levels"][0])
    for one, other in zip(real["levels"][0]["nodes"], own["levels"][0]["nodes"], strict=True):
        assert list(one) == list(other), one["id"]
        assert [list(m) for m in one.get("materials", [])] == [list(m) for m in other.get("materials", [])]


def test_tables_come_back(tmp_path):
    source = open_dataset(write_tiny_dataset(tmp_path / "source"))
    mesh = source.load_model("9001")
    light = Light("spot", 40.0, (1.0, 1.0, 1.0), (0.0, 1.0, 0.5), (0.0, -1.0, 0.0), 1.57)
    info = ModelInfo("gen_lamp_1", "floor_lamp", "indoor_lamp", "lamp", front=(1.0, 0.0, 0.0))
    model = LibraryModel(info, mesh, ("n03367059", "floor_lamp.n.01"), {"gen_lamp_1_0": mesh}, (light,))
    write_library(tmp_path / "own", [model], {"wood_1": np.zeros((4, 4, 3), np.uint8)})
    read = read_metadata(tmp_path / "own" / "metadata")
    dims = tuple(np.ptp(mesh.vertices, axis=0).tolist())
    assert list(read.models)[5:] == ["gen_lamp_1", "gen_lamp_1_0"]  # after the five pseudo models
    assert_same(
        read.info("gen_lamp_1"), dataclasses.replace(info, dims=dims, low=tuple(mesh.vertices.min(axis=0).tolist()))
    )
    assert read.info("gen_lamp_1_0").fine == "floor_lamp"
    assert_same(read.lights["gen_lamp_1"], (light,))
    header, row = (tmp_path / "own" / "metadata" / "ModelCategoryMapping.csv").read_text().split("\n")[:6:5]
    assert header == (
        "index,model_id,fine_grained_class,coarse_grained_class,empty_struct_obj,nyuv2_40class,wnsynsetid,wnsynsetkey"
    )
    assert row == "4,Box,unknown,unknown,2,void,n08632096,unknown.n.01"


def test_joints_come_back_and_without_any_there_is_no_table_even_of_a_former_library(tmp_path):
    mesh = open_dataset(write_tiny_dataset(tmp_path / "source")).load_model("9001")
    joints = (
        Joint("x", "door_1", "hinge", (0.0, -0.707107, 0.707107), (0.1, 0.2, 0.3), -0.5, 1.570796, ((0, 3), (6, 6))),
        Joint("x", "drawer_1", "slide", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.4, ((4, 5),)),
    )
    model = LibraryModel(ModelInfo("x", "desk", "desk", "desk"), mesh, ("n03179701", "desk.n.01"), joints=joints)
    for name, each in (("with", model), ("without", dataclasses.replace(model, joints=()))):
        write_library(tmp_path / name, [each], {})
    assert read_joints(tmp_path / "with" / "metadata") == {"x": joints}
    assert not list((tmp_path / "without" / "metadata").glob("joints*"))
    write_library(tmp_path / "with", [dataclasses.replace(model, joints=())], {})
    former, new = (
        sorted(path.name for path in (tmp_path / name / "metadata").iterdir()) for name in ("with", "without")
    )
    assert former == new


def test_a_crash_leaves_nothing_behind(tmp_path, monkeypatch):
    source = write_tiny_dataset(tmp_path / "source")
    house = open_dataset(source).load_house(HOUSE_ID)
    target = tmp_path / "target"
    target.mkdir()

    def crash(path, content):
        raise KeyboardInterrupt if path.suffix == ".json" else OSError(28, "No space left on device")

    monkeypatch.setattr(writer_module, "_write_file", crash)
    with pytest.raises(DatasetError, match="No space left on device"):
        write_house(target, house)
    assert [p for p in target.rglob("*") if p.is_file() or p.name.startswith(".partial")] == []


def test_a_crash_after_the_rooms_shows_no_house(tmp_path, monkeypatch):
    source = write_tiny_dataset(tmp_path / "source")
    house = open_dataset(source).load_house(HOUSE_ID)
    target = tmp_path / "target"
    target.mkdir()
    write = writer_module._write_file

    def crash(path, content):
        if path.suffix == ".json":
            raise KeyboardInterrupt
        write(path, content)

    monkeypatch.setattr(writer_module, "_write_file", crash)
    with pytest.raises(KeyboardInterrupt):
        write_house(target, house)
    assert not (target / "house" / HOUSE_ID).exists()
    monkeypatch.undo()
    write_house(target, house)
    for folder in ("object", "texture", "metadata"):
        (target / folder).symlink_to(source / folder)
    assert_same(without_room_boxes(house), without_room_boxes(open_dataset(target).load_house(HOUSE_ID)))


def test_unwritable_root(tmp_path):
    house = open_dataset(write_tiny_dataset(tmp_path / "source")).load_house(HOUSE_ID)
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(DatasetError, match="cannot write"):
        write_house(blocked, house)


def test_unknown_fields_are_kept_and_written(tmp_path):
    source = write_tiny_dataset(tmp_path / "source")
    extra = {"maker": ["somebody", {"year": 2017}]}

    def add(document: dict):
        document.update(extra)
        document["levels"][0].update(extra)
        for node in document["levels"][0]["nodes"]:
            node.update(extra)

    edit_house(source, add)
    (tmp_path / "target").mkdir()
    for house in copy_by_writing(source, tmp_path / "target", HOUSE_ID):
        (level,) = house.levels
        things = [house, level, *level.rooms, *level.objects, *level.boxes, *level.grounds]
        assert len(things) > 4
        assert all(thing.extra == extra for thing in things)


def test_hidden_nodes_cameras_and_statistics_are_written_again(tmp_path):
    """So members, which are positions in the list, still name the same nodes."""
    source = write_tiny_dataset(tmp_path / "source")

    def change(document: dict) -> None:
        nodes = document["levels"][0]["nodes"]
        nodes[0] |= {"stats": {"floorArea": 12.0}, "nodeIndices": ["4", "5", "6"]}
        nodes[1:1] = [{}, {"id": "0_9", "type": "Object", "modelId": "nothing", "valid": 0}]
        document["camera"] = [{"name": "current"}]

    edit_house(source, change)
    (tmp_path / "target").mkdir()
    for house in copy_by_writing(source, tmp_path / "target", HOUSE_ID):
        (level,) = house.levels
        assert level.rooms[0].members == (4, 5, 6)
        assert [node.index for node in (*level.objects, *level.boxes)] == [4, 5, 6]
        assert [dict(node.data).get("modelId") for node in level.hidden] == [None, "nothing"]
        assert house.extra == {"camera": [{"name": "current"}]}
        assert level.rooms[0].extra == {"stats": {"floorArea": 12.0}}


def test_members_follow_nodes_that_were_left_out(tmp_path):
    house = open_dataset(write_tiny_dataset(tmp_path / "source")).load_house(HOUSE_ID)
    without = dataclasses.replace(house.levels[0], grounds=())  # the second node
    document = house_document(dataclasses.replace(house, levels=(without,)))
    assert document["levels"][0]["nodes"][0]["nodeIndices"] == [1, 2, 3]


def test_levels_and_rooms_without_content_are_written_without_boxes(tmp_path):
    source = write_tiny_dataset(tmp_path / "source")

    def empty(document: dict) -> None:
        hidden = {"hideFloor": 1, "hideCeiling": 1, "hideWalls": 1}
        room = {"id": "1_0", "type": "Room", "modelId": "fr_1rm_0", "nodeIndices": [], "roomTypes": [], **hidden}
        document["levels"] += [{"id": "1", "nodes": [room]}, {"id": "2", "nodes": []}]

    edit_house(source, empty)
    (tmp_path / "target").mkdir()
    house, again = copy_by_writing(source, tmp_path / "target", HOUSE_ID)
    assert_same(without_room_boxes(house), without_room_boxes(again))
    written = house_document(house)["levels"]
    assert ["bbox" in level for level in written] == [True, False, False]
    assert "bbox" not in written[1]["nodes"][0]


def test_hidden_grounds_stay_hidden_and_keep_their_box(tmp_path):
    source = write_tiny_dataset(tmp_path / "source")
    edit_house(source, lambda document: document["levels"][0]["nodes"][1].update(hideFloor=1))
    (tmp_path / "target").mkdir()
    house, again = copy_by_writing(source, tmp_path / "target", HOUSE_ID)
    assert again.levels[0].grounds[0].mesh is None
    assert [problem.rule for problem in again.problems if problem.rule == "missing-part"] == []
    np.testing.assert_allclose(again.levels[0].grounds[0].bbox, house.levels[0].grounds[0].bbox)


def test_only_a_file_that_was_broken_before_is_named(tmp_path: Path, monkeypatch, caplog):
    """Another process may create the same texture between two looks of this one: that is no broken file."""
    image, path = np.full((4, 4, 3), 9, np.uint8), tmp_path / "texture" / "oak.png"
    path.parent.mkdir()
    with monkeypatch.context() as patch:

        def lose_race(path: Path, content: np.ndarray) -> bool:
            path.write_bytes(encode_png(content))
            return False

        patch.setattr(writer_module, "_holds", lose_race)
        writer_module.write_textures(tmp_path, {"oak": image})
    assert caplog.text == ""
    path.write_bytes(b"no image")
    writer_module.write_textures(tmp_path, {"oak": image})
    assert f"broken file {path} is rewritten" in caplog.text
    assert np.array_equal(decode_image(path.read_bytes()), image)
