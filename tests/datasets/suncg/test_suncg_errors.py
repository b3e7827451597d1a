"""Every way in which a dataset can be broken: one typed error that names file, element and what to do."""

import json
import pickle

import pytest
from tiny_dataset import DOOR, HOUSE_ID, TABLE, edit_house, write_tiny_dataset

from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import DatasetError, UnknownIdError
from home_mjx.schema.house import House

NODES = "levels[0].nodes"


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path / "data")


def refused(action, *args):
    with pytest.raises(DatasetError) as caught:
        action(*args)
    assert caught.value.hint
    return caught.value


def load(root):
    return open_dataset(root).load_house(HOUSE_ID)


def house_json(root):
    return root / "house" / HOUSE_ID / "house.json"


def test_root_not_given(monkeypatch):
    monkeypatch.delenv("SUNCG_DATA_DIR", raising=False)
    error = refused(open_dataset)
    assert error.message == "no dataset root was specified"
    assert "set SUNCG_DATA_DIR" in (error.hint or "")
    assert "house/, room/, object/, texture/ and metadata/" in (error.hint or "")


def test_root_from_the_environment(monkeypatch, root):
    monkeypatch.setenv("SUNCG_DATA_DIR", str(root))
    assert open_dataset().house_ids == (HOUSE_ID,)


def test_root_from_the_environment_that_is_wrong(monkeypatch, tmp_path):
    monkeypatch.setenv("SUNCG_DATA_DIR", str(tmp_path / "nowhere"))
    error = refused(open_dataset)
    assert (error.message, error.file) == ("dataset root is not a folder", str(tmp_path / "nowhere"))
    assert "SUNCG_DATA_DIR" in (error.hint or "")


def test_root_in_the_home_folder(monkeypatch, root):
    monkeypatch.setenv("HOME", str(root.parent))
    assert open_dataset("~/data").root == root


def test_root_without_houses(tmp_path):
    error = refused(open_dataset, tmp_path)
    assert (error.message, error.file) == ("folder contains no house/<id>/house.json", str(tmp_path))


@pytest.mark.parametrize("inside", ["house", f"house/{HOUSE_ID}", "object"])
def test_root_too_deep(root, inside):
    error = refused(open_dataset, root / inside)
    assert (error.hint or "").startswith(f"Did you mean {root}?")


def test_house_ids_are_sorted_and_need_a_house_json(root):
    for name in ("b" * 32, "a" * 32):
        (root / "house" / name).mkdir()
        (root / "house" / name / "house.json").write_text("{}")
    (root / "house" / ("c" * 32)).mkdir()
    assert open_dataset(root).house_ids == (HOUSE_ID, "a" * 32, "b" * 32)


def test_unknown_house(root):
    error = refused(open_dataset(root).load_house, HOUSE_ID[:-1] + "2")
    assert error.file == str(root / "house")
    assert error.hint == f"Did you mean `{HOUSE_ID}`? Known: {HOUSE_ID}"


@pytest.mark.parametrize("name", ["../house/" + HOUSE_ID, "", "."])
def test_house_outside_its_folder(root, name):
    assert refused(open_dataset(root).load_house, name).message == f"unknown house `{name}`"


def test_hint_stays_short_with_many_houses(root):
    for i in range(50):
        (root / "house" / f"h{i:02}").mkdir()
        (root / "house" / f"h{i:02}" / "house.json").write_text("{}")
    hint = refused(open_dataset(root).load_house, "zzz").hint or ""
    assert hint.endswith("h18, … (51 in all)")


def test_errors_survive_worker_processes(root):
    error = refused(open_dataset(root).load_house, "zzz")
    copy = pickle.loads(pickle.dumps(error))
    assert (type(copy), str(copy)) == (UnknownIdError, str(error))


def test_truncated_json(root):
    path = house_json(root)
    text = json.dumps(json.loads(path.read_text()), indent=1)
    path.write_text(text[: len(text) // 2])
    error = refused(load, root)
    lines = text[: len(text) // 2].count("\n") + 1
    assert error.file == str(path)
    assert (error.element or "").startswith("line ")
    assert lines - 1 <= int((error.element or "").split()[1].rstrip(",")) <= lines
    assert "column" in (error.element or "")
    assert "truncated" in (error.hint or "")


@pytest.mark.parametrize("text", ["", "{", '{"a": 1,}', "[" * 100_000, '{"a": ' + "9" * 5_000 + "}"])
def test_invalid_json(root, text):
    house_json(root).write_text(text)
    error = refused(load, root)
    assert error.file == str(house_json(root))
    assert error.message.startswith("not valid JSON")
    assert error.hint


def test_json_that_is_not_utf8(root):
    path = house_json(root)
    path.write_bytes(path.read_bytes().replace(b'"version"', b'"versi\xf6n"'))
    error = refused(load, root)
    assert (error.file, error.element) == (str(path), "line 1")
    assert "is not UTF-8" in error.message


def test_json_with_a_byte_order_mark(root):
    path = house_json(root)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load(root).problems == ()


def test_house_json_that_is_a_folder(root):
    house_json(root).unlink()
    house_json(root).mkdir()
    error = refused(load, root)
    assert error.file == str(house_json(root))
    assert error.message == "file cannot be read: it is not a regular file"


@pytest.mark.parametrize(
    ("change", "element", "message"),
    [
        (lambda doc: doc.pop("levels"), "levels", "expected a list, got `nothing`"),
        (lambda doc: doc.update(levels=None), "levels", "expected a list, got `null`"),
        (lambda doc: doc.update(levels={}), "levels", "expected a list, got `{}`"),
        (lambda doc: doc.update(levels=[]), "levels", "house has no visible node"),
        (lambda doc: doc.update(levels=[7]), "levels[0]", "expected an object, got `7`"),
        (lambda doc: doc.update(scaleToMeters="1"), "scaleToMeters", "expected a number"),
        (lambda doc: doc.update(scaleToMeters=0), "scaleToMeters", "expected metres per unit above 0"),
        (lambda doc: doc.update(scaleToMeters=-1), "scaleToMeters", "expected metres per unit above 0"),
        (lambda doc: doc.update(scaleToMeters=float("nan")), "scaleToMeters", "expected a finite number, got `NaN`"),
        (lambda doc: doc.update(version=1), "version", "expected a string, got `1`"),
        (lambda doc: doc.update(up=[0, 1]), "up", "expected 3 numbers, got 2"),
        (lambda doc: doc["levels"][0].update(nodes="x"), NODES, "expected a list"),
        (lambda doc: doc["levels"][0].update(valid=2), "levels[0].valid", "expected 0 or 1, got `2`"),
        (lambda doc: doc["levels"][0].update(id=[]), "levels[0].id", "expected an integer, got `[]`"),
    ],
)
def test_broken_house(root, change, element, message):
    path = edit_house(root, change)
    error = refused(load, root)
    assert (error.file, error.element) == (str(path), element)
    assert message in error.message


BIG = 10**400


@pytest.mark.parametrize(
    ("index", "field", "value", "element", "message"),
    [
        (2, "type", 5, "type", "expected a string, got `5`"),
        (2, "id", 1.5, "id", "expected an integer, got `1.5`"),
        (2, "valid", "yes", "valid", 'expected 0 or 1, got `"yes"`'),
        (2, "modelId", None, "modelId", "expected a string, got `null`"),
        (2, "modelId", 9001, "modelId", "expected a string, got `9001`"),
        (2, "modelId", "../9001", "modelId", "`../9001` is not a plain name"),
        (2, "modelId", "..", "modelId", "`..` is not a plain name"),
        (2, "modelId", "a\\b", "modelId", "is not a plain name"),
        (2, "modelId", "a\0b", "modelId", "is not a plain name"),
        (2, "modelId", "", "modelId", "`` is not a plain name"),
        (0, "modelId", "../x/fr_0rm_0", "modelId", "is not a plain name"),
        (1, "modelId", "/etc/passwd", "modelId", "is not a plain name"),
        (2, "transform", 1, "transform", "expected a list, got `1`"),
        (2, "transform", [1, 2, 3], "transform", "expected 16 numbers, got 3"),
        (2, "transform", ["a"] * 16, "transform[0]", 'expected a number, got `"a"`'),
        (2, "transform", [True] * 16, "transform[0]", "expected a number, got `true`"),
        (2, "transform", [0.0, float("nan"), *[0.0] * 14], "transform[1]", "expected a finite number, got `NaN`"),
        (2, "transform", [float("inf"), *[0.0] * 15], "transform[0]", "expected a finite number, got `Infinity`"),
        (2, "transform", [BIG, *[0.0] * 15], "transform[0]", "expected a finite number"),
        (2, "transform", [1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "transform", "expected an affine transform"),
        (2, "bbox", [0, 1], "bbox", "expected an object, got `[0, 1]`"),
        (2, "bbox", {"min": [0, 0, 0]}, "bbox.max", "expected a list, got `nothing`"),
        (2, "state", "open", "state", "expected an integer"),
        (2, "state", -1, "state", "expected a state of at least 0, got -1"),
        (2, "isMirrored", 3, "isMirrored", "expected 0 or 1"),
        (2, "materials", {}, "materials", "expected a list"),
        (2, "materials", [5], "materials[0]", "expected an object, got `5`"),
        (2, "materials", [{"name": 5}], "materials[0].name", "expected a string"),
        (2, "materials", [{"diffuse": "red"}], "materials[0].diffuse", "expected a colour such as `#a3b0ff`"),
        (2, "materials", [{"diffuse": "#ff00"}], "materials[0].diffuse", "expected a colour"),
        (2, "materials", [{"texture": 5}], "materials[0].texture", "expected a string"),
        (2, "materials", [{}, {"texture": "w_9"}], "materials[1].texture", "texture `w_9` is missing"),
        (2, "materials", [{"texture": "../../x"}], "materials[0].texture", "leads out of the dataset"),
        (2, "materials", [{"texture": "/etc/x"}], "materials[0].texture", "leads out of the dataset"),
        (4, "dimensions", None, "dimensions", "expected a list, got `null`"),
        (4, "dimensions", [1, 1], "dimensions", "expected 3 numbers, got 2"),
        (4, "materials", [{"texture": "w_9"}], "materials[0].texture", "texture `w_9` is missing"),
        (0, "nodeIndices", [2, "x3"], "nodeIndices[1]", "expected an integer"),
        (0, "nodeIndices", [BIG], "nodeIndices[0]", "expected an integer"),
        (0, "roomTypes", "Kitchen", "roomTypes", "expected a list"),
        (0, "roomTypes", [1], "roomTypes[0]", "expected a string"),
        (0, "hideFloor", 7, "hideFloor", "expected 0 or 1"),
    ],
)
def test_broken_nodes(root, index, field, value, element, message):
    path = edit_house(root, lambda doc: doc["levels"][0]["nodes"][index].update({field: value}))
    error = refused(load, root)
    assert (error.file, error.element) == (str(path), f"{NODES}[{index}].{element}")
    assert message in error.message


def test_node_that_is_no_object(root):
    edit_house(root, lambda doc: doc["levels"][0]["nodes"].append([1]))
    assert refused(load, root).element == f"{NODES}[5]"


def test_material_index_out_of_range(root):
    def change(doc):
        doc["materials"] = [{"name": "x"}]
        del doc["levels"][0]["nodes"][2]["materials"]
        doc["levels"][0]["nodes"][2]["materialIndices"] = [0, 1]

    edit_house(root, change)
    error = refused(load, root)
    assert error.element == f"{NODES}[2].materialIndices[1]"
    assert error.message == "expected an index into the house's 1 materials, got 1"


def test_missing_object_mesh(root):
    path = root / "object" / TABLE / f"{TABLE}.obj"
    path.unlink()
    error = refused(load, root)
    assert (error.file, error.element) == (str(house_json(root)), f"{NODES}[2].modelId")
    assert error.message == f"model `{TABLE}` has no OBJ file"
    assert str(path) in (error.hint or "")


def test_missing_texture_says_what_to_do(root):
    (root / "texture" / "s" / "123.jpg").unlink()
    error = refused(load, root)
    assert (error.file, error.element) == (str(house_json(root)), f"{NODES}[2].materials[0].texture")
    assert error.hint == f"Put 123.png or 123.jpg into {root / 'texture'} or name another texture."


def test_missing_texture_of_a_model(root):
    (root / "texture" / "wood_1.png").unlink()
    error = refused(load, root)
    assert (error.file, error.element) == (str(root / "object" / TABLE / f"{TABLE}.mtl"), "line 3")
    assert error.message == "texture `wood_1` is missing"


def test_missing_room_folder(root):
    (root / "room" / HOUSE_ID).rename(root / "room" / "other")
    error = refused(load, root)
    assert (error.file, error.element) == (str(house_json(root)), f"{NODES}[0]")
    assert "download_suncg.py -v v1 -t room" in (error.hint or "")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("v 0.6 0.7 0.4", "v 0.6 nan 0.4", "expected finite numbers"),
        ("f  1/1", "f  99/1", "face refers to `v` 99"),
        ("usemtl material_1", "usemtl material_7", "material `material_7` is not in the material library"),
        ("mtllib 9001.mtl", "mtllib ../../../x.mtl", "leads out of the dataset"),
    ],
)
def test_broken_object_mesh(root, old, new, message):
    path = root / "object" / TABLE / f"{TABLE}.obj"
    text = path.read_text()
    line = text[: text.index(old)].count("\n") + 1
    path.write_text(text.replace(old, new, 1))
    error = refused(load, root)
    assert (error.file, error.element) == (str(path), f"line {line}")
    assert message in error.message
    assert error.hint


def test_broken_room_mesh(root):
    path = root / "room" / HOUSE_ID / "fr_0rm_0w.obj"
    path.write_text("")
    error = refused(load, root)
    assert (error.file, error.message) == (str(path), "mesh has no faces")


@pytest.mark.parametrize("key", ["nothing", "../x", "", "a/b"])
def test_unknown_model(root, key):
    assert refused(open_dataset(root).load_model, key).file == str(root / "object")


def test_a_model_that_failed_is_read_again(root):
    path = root / "object" / TABLE / f"{TABLE}.obj"
    text = path.read_text()
    dataset = open_dataset(root)
    path.write_text("")
    refused(dataset.load_house, HOUSE_ID)
    path.write_text(text)
    assert TABLE in dataset.load_house(HOUSE_ID).models


def mutations(data, rng, count):
    """Truncated, changed and repeated bytes."""
    for _ in range(count):
        at, length = rng.integers(len(data)), int(rng.integers(1, 12))
        other = bytes(rng.choice(list(b'0123456789-./ \n"{}[],:efnvu\xff'), length).tolist())
        yield [data[:at], data[:at] + other + data[at + length :], data[:at] + data[max(at - length, 0) :]][
            int(rng.integers(3))
        ]


def load_or_locate(root):
    """None if the dataset loads, else the place of its error."""
    dataset = open_dataset(root)
    try:
        assert isinstance(dataset.load_house(HOUSE_ID), House)
        assert dataset.metadata.models
    except DatasetError as error:
        return error.file, error.element
    return None


@pytest.mark.parametrize(
    "name",
    [f"house/{HOUSE_ID}/house.json", f"object/{TABLE}/{TABLE}.obj", f"object/{DOOR}/{DOOR}.mtl",
     "metadata/models.csv", "metadata/ModelCategoryMapping.csv", "metadata/suncgModelLights.json"],
)  # fmt: skip
def test_damaged_files_load_or_raise_a_located_error(root, rng, name):
    """Some still load, some do not; nothing else is ever raised."""
    path = root / name
    outcomes = set()
    for data in mutations(path.read_bytes(), rng, 60):
        path.write_bytes(data)
        outcomes.add(load_or_locate(root))
    assert len(outcomes) > 2
    assert None in outcomes
    assert all(place is None or place[0] for place in outcomes)
