"""The validator: silent about a house without faults, and each of its rules for exactly the fault that it names."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tiny_arch import edit_arch, write_tiny_v2
from tiny_dataset import (
    DEPTH,
    DOOR,
    HOUSE_ID,
    ROOM_PARTS,
    TABLE,
    edit_house,
    room_node,
    write_mesh,
    write_tiny_dataset,
)

from home_mjx.cli import main
from home_mjx.datasets.base import Dataset
from home_mjx.datasets.outlines import RoomOutline, outline_house
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.validate.finding import RULES
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.errors import DatasetError
from home_mjx.schema.house import BoxNode, Metadata, Problem

NODES = "levels[0].nodes"


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path / "data")


def findings(root):
    return validate_house(open_dataset(root), HOUSE_ID)


def rules(root):
    return {(finding.rule, finding.element) for finding in findings(root)}


def node(index, **changes):
    """A change of one node; None removes a field."""

    def change(document):
        data = document["levels"][0]["nodes"][index]
        data.update(changes)
        for key in [key for key, value in data.items() if value is None]:
            del data[key]

    return change


def box_only(document):
    """Leaves the box out of what the room and the level enclose."""
    document["levels"][0]["nodes"][4]["bbox"] = {"min": [-30, 0, 0], "max": [30, 1, 1]}
    document["levels"][0]["nodes"][4]["dimensions"] = [60, 1, 1]


def append(*nodes):
    return lambda document: document["levels"][0]["nodes"].extend(nodes)


def moved(document):
    """The table and its box, 50 m away."""
    table = document["levels"][0]["nodes"][2]
    table["transform"][12] += 50
    for corner in table["bbox"].values():
        corner[0] += 50


HOUSE_CHANGES = {
    "format-version": (lambda d: d.update(version="x"), "version"),
    "house-id": (lambda d: d.update(id="x"), "id"),
    "axes": (lambda d: d.update(up=[0, 0, 1]), "up"),
    "nothing-shown": (lambda d: d.update(levels=[]), "levels"),
    "no-room": (node(0, valid=0), "levels"),
    "unknown-field": (node(2, colour=1), f"{NODES}[2].colour"),
    "empty-level": (lambda d: d["levels"].append({"id": "1"}), "levels[1].nodes"),
    "empty-node": (append({}), f"{NODES}[5]"),
    "node-type": (append({"id": "0_5", "type": "Camera"}), f"{NODES}[5].type"),
    "missing-id": (node(2, id=None), f"{NODES}[2].id"),
    "duplicate-id": (node(3, id="0_2"), f"{NODES}[3].id"),
    "id-position": (node(3, id="0_9"), f"{NODES}[3].id"),
    "missing-transform": (node(2, transform=None), f"{NODES}[2].transform"),
    "flat-transform": (node(2, transform=[0] * 15 + [1]), f"{NODES}[2].transform"),
    "mirror-flag": (node(3, isMirrored=0), f"{NODES}[3].isMirrored"),
    "missing-mirror-flag": (node(3, isMirrored=None), f"{NODES}[3]"),
    "missing-variant": (node(2, state=1), f"{NODES}[2].state"),
    "flat-box": (node(4, dimensions=[1, 0, 1]), f"{NODES}[4].dimensions"),
    "backdrop": (box_only, f"{NODES}[4]"),
    "missing-bbox": (node(2, bbox=None), f"{NODES}[2].bbox"),
    "inverted-bbox": (node(2, bbox={"min": [9, 9, 9], "max": [0, 0, 0]}), f"{NODES}[2].bbox"),
    "bbox-mismatch": (
        lambda d: d["levels"][0]["nodes"][2]["bbox"]["min"].__setitem__(1, -0.5),
        f"{NODES}[2].bbox.min[1]",
    ),
    "room-bbox": (
        lambda d: d["levels"][0]["nodes"][0]["bbox"]["max"].__setitem__(1, 2.0),
        f"{NODES}[0].bbox.max[1]",
    ),
    "level-bbox": (lambda d: d["bbox"]["max"].__setitem__(0, 99), "bbox.max[0]"),
    "room-type": (node(0, roomTypes=["Cellar"]), f"{NODES}[0].roomTypes"),
    "member-index": (node(0, nodeIndices=[2, 3, 4, 9]), f"{NODES}[0].nodeIndices"),
    "repeated-member": (node(0, nodeIndices=[2, 3, 4, 2]), f"{NODES}[0].nodeIndices"),
    "text-member": (node(0, nodeIndices=["2", "3", "4"]), f"{NODES}[0].nodeIndices"),
    "shared-member": (append(room_node() | {"id": "0_5"}), f"{NODES}[5].nodeIndices"),
    "hidden-member": (node(2, valid=0), f"{NODES}[0].nodeIndices"),
    "member-type": (node(0, nodeIndices=[1, 2, 3, 4]), f"{NODES}[0].nodeIndices"),
    "room-overlap": (append(room_node() | {"id": "0_5", "nodeIndices": []}), f"{NODES}[5]"),
    "outside-rooms": (moved, f"{NODES}[2]"),
    "door-off-wall": (
        lambda d: d["levels"][0]["nodes"][3]["transform"].__setitem__(14, 1.5),
        f"{NODES}[3]",
    ),
    "extra-materials": (node(2, materials=[{}] * 3), f"{NODES}[2].materials"),
    "unreadable": (node(2, modelId="nothing"), f"{NODES}[2].modelId"),
}


def edit_text(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def save_as(kind):
    return lambda path: Image.new("RGB", (2, 2)).save(path, kind)


def in_one_group(path):
    """Every wall of the room in the group of the first."""
    lines = path.read_text().split("\n")
    first = next(line for line in lines if line.startswith("o "))
    path.write_text("\n".join(first if line.startswith("o ") else line for line in lines))


def upside_down(path):
    """The corners of every face in reverse."""
    lines = [line.split() for line in path.read_text().split("\n")]
    turned = [[line[0], *line[:0:-1]] if line[:1] == ["f"] else line for line in lines]
    path.write_text("\n".join(" ".join(line) for line in turned))


def joints_of(model, *faces):
    """Writes a table with a drawer of the model for each of these runs of faces."""
    rows = [f'{model},drawer_{k},slide,"0,0,1","0,0,0","0,0.4",{runs}' for k, runs in enumerate(faces, 1)]
    return lambda path: path.write_text("\n".join(["id,part,kind,axis,point,range,faces", *rows]))


FILE_CHANGES = {  # file, what is done to it, element
    "missing-part": (f"room/{HOUSE_ID}/fr_0rm_0c.obj", lambda path: path.unlink(), f"{NODES}[0].modelId"),
    "unknown-model": (
        "metadata/ModelCategoryMapping.csv",
        lambda path: edit_text(path, f"5,{TABLE},", "5,777,"),
        f"{NODES}[2].modelId",
    ),
    "broken-variant": (
        f"object/{DOOR}/{DOOR}.obj",  # it is shown closed
        lambda path: edit_text(path, "f  1/", "f  91/"),
        f"{NODES}[3].modelId",
    ),
    "unused-slot": (
        f"object/{TABLE}/{TABLE}.mtl",
        lambda path: path.write_text(path.read_text() + "newmtl spare\n"),
        "spare",
    ),
    "missing-slot": (f"object/{TABLE}/{TABLE}.obj", lambda path: edit_text(path, "usemtl material_0\n", ""), ""),
    "thick-wall": (f"room/{HOUSE_ID}/fr_0rm_0w.obj", in_one_group, "WallInside#0_0_0"),
    "floor-down": (f"room/{HOUSE_ID}/fr_0rm_0f.obj", upside_down, "Floor#0_0"),
    "joint-model": ("metadata/joints.csv", joints_of("nothing", "0-3"), "nothing"),
    "joint-faces": ("metadata/joints.csv", joints_of(TABLE, "0-3 90-91"), f"{TABLE} drawer_1"),
    "texture-broken": ("texture/wood_1.png", lambda path: path.write_bytes(path.read_bytes()[:40]), ""),
    "texture-type": ("texture/wood_1.png", save_as("JPEG"), ""),
}
ARCH_CHANGES = {
    "flat-wall": (lambda d: d["elements"][1].update(points=[[1, 0, 1]] * 2), "elements[1].points"),
    "element-type": (lambda d: d["elements"].append({"type": "Roof"}), "elements[7].type"),
}


def test_a_house_without_faults(root):
    assert findings(root) == ()


def test_a_v2_house_without_faults(tmp_path):
    assert findings(write_tiny_v2(tmp_path)) == ()


def test_every_rule_has_a_test_below():
    in_other_file = {
        "flat-model",
        "bridged-face",
        "bent-face",
        "unread-statement",
        "ambiguous-opacity",
        "clamped-value",
        "unreachable-storey",
    }
    tested = {*HOUSE_CHANGES, *FILE_CHANGES, *ARCH_CHANGES, *in_other_file, "tolerated"}
    assert tested == set(RULES)


@pytest.mark.parametrize("rule", HOUSE_CHANGES)
def test_faults_of_house_json(root, rule):
    change, element = HOUSE_CHANGES[rule]
    edit_house(root, change)
    assert (rule, element) in rules(root)


@pytest.mark.parametrize("rule", FILE_CHANGES)
def test_faults_of_other_files(root, rule):
    name, change, element = FILE_CHANGES[rule]
    change(root / name)
    assert (rule, element) in rules(root)


def test_all_walls_of_a_room_in_one_group_are_as_thick_as_the_room(root):
    in_one_group(root / "room" / HOUSE_ID / "fr_0rm_0w.obj")
    (found,) = [finding for finding in findings(root) if finding.rule == "thick-wall"]
    assert (found.severity, Path(found.file).name) == ("error", "fr_0rm_0w.obj")
    assert found.message.startswith(f"{DEPTH:.1f} m thick")  # the long walls face across it


def test_a_flat_floor_that_looks_down_is_reported_and_one_that_looks_up_is_not(root):
    folder = root / "room" / HOUSE_ID
    path = folder / "fr_0rm_0f.obj"
    write_mesh(folder, "fr_0rm_0f", ROOM_PARTS["f"], [("1 1 1", "")])
    lines = path.read_text().split("\n")
    faces = [line for line in lines if line.startswith("f")]
    top = [line for line in lines if line not in faces or line == faces[1]]
    path.write_text("\n".join(top))
    assert "floor-down" not in {finding.rule for finding in findings(root)}
    upside_down(path)
    assert "floor-down" in {finding.rule for finding in findings(root)}


def test_sound_joints_are_silent_and_faces_of_two_joints_are_not(root):
    path = root / "metadata" / "joints.csv"
    joints_of(TABLE, "0-3", "4-5 7-7")(path)
    assert findings(root) == ()
    joints_of(TABLE, "0-3 6-7", "3-4")(path)
    assert [str(finding) for finding in findings(root)] == [
        f"{path}: {TABLE} drawer_2: face 3 is of drawer_1 as well [joint-faces]"
    ]


def test_a_broken_table_of_joints_is_reported_with_its_line(root):
    path = root / "metadata" / "joints.csv"
    joints_of(TABLE, "0-3")(path)
    edit_text(path, '"0,0,1"', '"0,0,2"')
    assert [str(finding) for finding in findings(root)] == [f"{path}: line 2: axis `0,0,2` is 2 long [unreadable]"]


@pytest.mark.parametrize("rule", ARCH_CHANGES)
def test_faults_of_the_architecture(tmp_path, rule):
    root = write_tiny_v2(tmp_path)
    change, element = ARCH_CHANGES[rule]
    edit_arch(root, change)
    (found,) = [finding for finding in findings(root) if finding.rule == rule]
    assert (found.file.endswith(".arch.json"), found.element) == (True, element)


@pytest.mark.parametrize(
    ("rule", "others"),
    [
        ("bbox-mismatch", {"level-bbox"}),
        ("level-bbox", set()),
        ("missing-id", set()),
        ("mirror-flag", set()),
        ("missing-mirror-flag", set()),
        ("duplicate-id", {"id-position"}),
        ("room-type", set()),
        ("door-off-wall", {"bbox-mismatch"}),
        ("room-overlap", set()),
        ("unknown-field", set()),
    ],
)
def test_one_fault_is_not_reported_as_others(root, rule, others):
    edit_house(root, HOUSE_CHANGES[rule][0])
    assert {finding.rule for finding in findings(root)} - others == {rule}


def test_all_faults_are_reported_at_once_with_errors_first(root):
    for name in ("format-version", "mirror-flag", "missing-bbox", "room-type"):
        edit_house(root, HOUSE_CHANGES[name][0])
    for name in ("texture-broken", "missing-part"):
        FILE_CHANGES[name][1](root / FILE_CHANGES[name][0])
    found = findings(root)
    assert {"format-version", "mirror-flag", "missing-bbox", "room-type", "texture-broken", "missing-part"} <= {
        finding.rule for finding in found
    }
    severities = [finding.severity for finding in found]
    assert severities == sorted(severities)


def test_every_unreadable_node_is_reported(root):
    def change(document):
        document["scaleToMeters"] = "x"
        for index, field in ((0, "roomTypes"), (1, "modelId"), (2, "transform"), (3, "materials"), (4, "dimensions")):
            document["levels"][0]["nodes"][index][field] = 5

    edit_house(root, change)
    broken = {finding.element for finding in findings(root) if finding.rule == "unreadable"}
    assert broken == {
        "scaleToMeters",
        *(
            f"{NODES}[{i}].{key}"
            for i, key in enumerate(["roomTypes", "modelId", "transform", "materials", "dimensions"])
        ),
    }


def test_a_broken_model_is_reported_once(root):
    edit_house(root, lambda d: d["levels"][0]["nodes"].append(d["levels"][0]["nodes"][2] | {"id": "0_5"}))
    (root / "object" / TABLE / f"{TABLE}.obj").write_text("f 1 2 3")
    (found,) = [finding for finding in findings(root) if finding.rule == "unreadable"]
    assert found.file.endswith(f"{TABLE}.obj")


def test_a_missing_base_model_is_found_behind_its_variant(root):
    (root / "object" / DOOR / f"{DOOR}.obj").unlink()
    assert ("unreadable", f"{NODES}[3].modelId") in rules(root)


def test_a_house_that_is_no_json(root):
    (root / "house" / HOUSE_ID / "house.json").write_text("{")
    (found,) = findings(root)
    assert (found.rule, found.severity) == ("unreadable", "error")


@pytest.mark.parametrize("document", ["[]", "5", "null", '"x"', '{"levels": 5}', '{"levels": [5]}', "{}"])
def test_documents_of_other_shapes(root, document):
    (root / "house" / HOUSE_ID / "house.json").write_text(document)
    assert "error" in {finding.severity for finding in findings(root)}


def test_missing_metadata_is_reported(root):
    shutil.rmtree(root / "metadata")
    assert [(f.rule, f.file.endswith("Mapping.csv")) for f in findings(root)] == [("unreadable", True)]


def test_thin_overlaps_are_those_of_outsets(root):
    """Floors reach 2 cm beyond the wall lines, so neighbours always share a strip."""
    write_mesh(
        root / "room" / HOUSE_ID,
        "fr_0rm_5f",
        [("Floor#0_5", "material_0", (3.85, 0, 0), (8, 0.05, 3))],
        [("1 1 1", "")],
    )
    box = {"min": [3.85, 0, 0], "max": [8, 0.05, 3]}
    beside = {"id": "0_5", "type": "Room", "valid": 1, "modelId": "fr_0rm_5", "bbox": box}
    edit_house(root, append(beside | {"hideWalls": 1, "hideCeiling": 1}))
    assert not [finding for finding in findings(root) if finding.rule == "room-overlap"]


def test_unknown_house(root):
    with pytest.raises(DatasetError, match="unknown house"):
        validate_house(open_dataset(root), "nothing")


def test_command_line(root, capsys):
    assert main(["inspect", HOUSE_ID, "--dataset", str(root), "--validate"]) == 0
    assert capsys.readouterr().out == f"{HOUSE_ID}: 0 errors, 0 warnings\n"
    edit_house(root, node(2, bbox=None))
    assert main(["inspect", "--dataset", str(root), "--validate"]) == 0
    assert "warning: " in capsys.readouterr().out
    edit_house(root, node(3, isMirrored=0))
    assert main(["inspect", "--dataset", str(root), "--validate"]) == 1
    first, *_, last = capsys.readouterr().out.splitlines()
    assert first.startswith("error: ")
    assert first.endswith(f"{NODES}[3].isMirrored: isMirrored contradicts the transform, which is used [mirror-flag]")
    assert last.startswith(f"{HOUSE_ID}: 1 errors, ")


def test_command_line_validates_all_houses_of_a_root(root, capsys):
    for folder in ("house", "room"):
        shutil.copytree(root / folder / HOUSE_ID, root / folder / "other")
    assert main(["inspect", str(root), "--validate"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert f"{HOUSE_ID}: 0 errors, 0 warnings" in lines
    assert lines[-1].startswith("other: 1 errors")  # its id is not its folder's name


def test_command_line_with_json(root, capsys):
    edit_house(root, node(3, isMirrored=0))
    assert main(["inspect", "--dataset", str(root), "--validate", "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert (record["id"], record["errors"]) == (HOUSE_ID, 1)
    (found,) = record["findings"]
    assert (found["severity"], found["rule"], found["element"]) == ("error", "mirror-flag", f"{NODES}[3].isMirrored")


def test_unknown_house_on_the_command_line(root, capsys):
    assert main(["inspect", "nothing", "--dataset", str(root), "--validate"]) == 2
    assert "unknown house" in capsys.readouterr().err


@pytest.mark.real
def test_the_real_house(suncg_root):
    """Known oddities: one room drawn over another, a shower in no room."""
    dataset = open_dataset(suncg_root)
    found = validate_house(dataset, dataset.house_ids[0])
    assert [(f.severity, f.rule, f.element) for f in found] == [
        ("warning", "room-overlap", f"{NODES}[1]"),
        ("warning", "outside-rooms", f"{NODES}[35]"),
    ]


def test_houses_of_other_formats_are_checked_as_they_are_read(tmp_path):
    """A box outside, a flat one, a member that does not exist, an oddity of the reader, and a house that is broken."""

    class Boxes(Dataset):
        house_ids, metadata = ("box", "broken"), Metadata({})

        def load_house(self, house_id, options=None):
            if house_id == "broken":
                raise DatasetError("no house", file="boxes.txt", element="line 3")
            house = outline_house(house_id, [RoomOutline("Hall", [(0, 0), (4, 0), (4, 3), (0, 3)])])
            (level,), (room,) = house.levels, house.levels[0].rooms
            places = [np.eye(4), np.diag([1.0, 1.0, 0.0, 1.0])]
            places[0][:3, 3], places[1][:3, 3] = (9, 0.5, 1), (2, 0.5, 1)
            boxes = [BoxNode(f"0_{i}", i, f"boxes[{i}]", None, np.ones(3), place) for i, place in enumerate(places, 1)]
            level = replace(level, boxes=tuple(boxes), rooms=(replace(room, members=(7,)),))
            return replace(house, levels=(level,), problems=(Problem("lines", "too many"),))

        def inputs(self):
            raise NotImplementedError

    dataset = Boxes(tmp_path, "boxes:1")
    found = validate_house(dataset, "box")
    assert [(one.rule, one.element) for one in found] == [
        *[("member-index", "levels[0].nodes[0]"), ("flat-transform", "boxes[2]")],
        *[("tolerated", "lines"), ("outside-rooms", "boxes[1]")],
    ]
    (broken,) = validate_house(dataset, "broken")
    assert (broken.rule, broken.file, broken.element) == ("unreadable", "boxes.txt", "line 3")
