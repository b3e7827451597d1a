"""Inputs that once broke the reader, each as small as it gets: found by fuzzing or by thinking like an attacker."""

import json
import os
import time
import tracemalloc

import numpy as np
import pytest
from tiny_arch import edit_arch, write_tiny_v2
from tiny_dataset import HOUSE_ID, TABLE, edit_house, write_tiny_dataset

from home_mjx.core import files
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.formats import json_value as place
from home_mjx.datasets.suncg.formats import obj_faces
from home_mjx.datasets.suncg.read import arch_json, house_json
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.errors import DatasetError, did_you_mean

NODES = "levels[0].nodes"


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path)


def load(root):
    return open_dataset(root).load_house(HOUSE_ID)


def refused(root):
    with pytest.raises(DatasetError) as caught:
        load(root)
    assert caught.value.hint
    str(caught.value).encode()  # can be printed
    assert len(str(caught.value)) < 2_000
    return caught.value


def change_node(root, index, **changes):
    edit_house(root, lambda document: document["levels"][0]["nodes"][index].update(changes))


def edit_table(root, old, new, kind="obj"):
    path = root / "object" / TABLE / f"{TABLE}.{kind}"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return path


@pytest.mark.parametrize("model_id", ["_0", "._0", ".._0", "s____0"])
def test_model_id_that_is_nothing_but_a_variant(root, model_id):
    """`_0` is the variant of a model without a name."""
    change_node(root, 2, modelId=model_id)
    assert refused(root).element == f"{NODES}[2].modelId"


@pytest.mark.parametrize("name", ["a" * 300, "é" * 150, "a" * 1_000_000])
def test_names_longer_than_the_file_system_takes(root, name):
    change_node(root, 2, modelId=name)
    error = refused(root)
    assert (error.element, "too long" in error.message) == (f"{NODES}[2].modelId", True)


def test_texture_names_longer_than_the_file_system_takes(root):
    change_node(root, 2, materials=[{"texture": "a" * 300}])
    assert refused(root).element == f"{NODES}[2].materials[0].texture"


@pytest.mark.parametrize("library", ["a\0b.mtl", "a" * 300 + ".mtl", "\x7f\x1b[31m.mtl"])
def test_material_libraries_with_odd_names(root, library):
    edit_table(root, f"{TABLE}.mtl", library)
    refused(root)


@pytest.mark.parametrize("field", ["modelId", "id", "type"])
def test_half_of_a_surrogate_pair_can_be_printed(root, field):
    path = root / "house" / HOUSE_ID / "house.json"
    document = json.loads(path.read_text())
    document["levels"][0]["nodes"][2] |= {field: "\ud800", "transform": 5}
    path.write_text(json.dumps(document))
    for finding in validate_house(open_dataset(root), HOUSE_ID):
        str(finding).encode()
    refused(root)


def test_lists_nested_as_deep_as_can_be_read(root):
    path = root / "house" / HOUSE_ID / "house.json"
    for depth in range(100, 3_000, 150):
        path.write_text(
            json.dumps({"version": "suncg", "id": HOUSE_ID})[:-1] + f', "levels": {"[" * depth}{"]" * depth}}}'
        )
        refused(root)
        validate_house(open_dataset(root), HOUSE_ID)


@pytest.mark.parametrize("number", [1e300, -1e7, 1e-300])
def test_numbers_whose_products_no_float_can_hold(root, number):
    change_node(root, 2, transform=[number] * 12 + [0, 0, 0, 1])
    if abs(number) > 1:
        assert refused(root).element == f"{NODES}[2].transform[0]"
    else:
        assert [problem.rule for problem in load(root).problems] == ["flat-transform"]


@pytest.mark.parametrize("number", ["1e300", "-1e7", "1e39"])
def test_vertices_and_texture_coordinates_beyond_float32(root, number):
    path = edit_table(root, "vt 0 0", f"vt {number} 0")
    error = refused(root)
    assert (error.file, error.element) == (str(path), "line 2")


def test_units_that_make_a_house_infinite(root):
    edit_house(root, lambda document: document.update(scaleToMeters=1e300))
    assert refused(root).element == "scaleToMeters"


def test_pipes_are_not_waited_for(root):
    path = root / "object" / TABLE / f"{TABLE}.mtl"
    path.unlink()
    os.mkfifo(path)
    assert "not a regular file" in refused(root).message


def test_links_in_a_circle(root):
    path = root / "object" / TABLE / f"{TABLE}.mtl"
    path.unlink()
    path.symlink_to(path)
    assert "cannot be read" in refused(root).message


@pytest.mark.parametrize("name", ["../../../../../../../etc/passwd", "/etc/passwd", "..\\..\\..\\x", "../../../x"])
@pytest.mark.parametrize("keyword", ["mtllib", "map_Kd"])
def test_paths_that_lead_out_of_the_dataset(root, name, keyword):
    kind = {"mtllib": "obj", "map_Kd": "mtl"}[keyword]
    path = root / "object" / TABLE / f"{TABLE}.{kind}"
    lines = path.read_text().split("\n")
    number = next(i for i, line in enumerate(lines) if line.startswith(keyword))
    lines[number] = f"{keyword} {name}"
    path.write_text("\n".join(lines))
    error = refused(root)
    assert (error.file, error.element) == (str(path), f"line {number + 1}")
    assert "leads out of the dataset" in error.message


def test_an_object_file_is_no_material_library(root):
    """It has none of the keywords, so the material is missing; it must not be read as its own library for ever."""
    edit_table(root, f"{TABLE}.mtl", f"{TABLE}.obj")
    assert "is not in the material library" in refused(root).message


def test_a_material_library_that_is_named_a_thousand_times_is_read_once(root, reads):
    edit_table(root, f"mtllib {TABLE}.mtl\n", f"mtllib {TABLE}.mtl\nmtllib ./{TABLE}.mtl\n" * 500)
    assert len(load(root).models[TABLE].materials) == 2
    assert reads.count(f"{TABLE}.mtl") == 1


def repeat_node(root, index, count=100):
    """Adds nodes that show what another one shows."""

    def change(document):
        nodes = document["levels"][0]["nodes"]
        nodes += [nodes[index] | {"id": f"0_{number}", "nodeIndices": []} for number in range(5, 5 + count)]
        nodes += [nodes[index]] * count

    edit_house(root, change)


@pytest.fixture
def reads(monkeypatch):
    """Names of the files that are read."""
    names = []
    original = files.read_bytes
    monkeypatch.setattr(files, "read_bytes", lambda path, *rest: names.append(path.name) or original(path, *rest))
    return names


def test_a_mesh_that_many_rooms_show_is_read_once(root, reads):
    repeat_node(root, 0)
    assert len(load(root).levels[0].rooms) == 101
    assert reads.count("fr_0rm_0w.obj") == 1


@pytest.mark.parametrize(("index", "name"), [(0, f"room/{HOUSE_ID}/fr_0rm_0w.obj"), (2, f"object/{TABLE}/{TABLE}.obj")])
def test_a_broken_mesh_that_many_nodes_show_is_read_once(root, reads, index, name):
    repeat_node(root, index)
    (root / name).write_text("f 1 2 3")
    found = [finding for finding in validate_house(open_dataset(root), HOUSE_ID) if finding.rule == "unreadable"]
    assert [finding.file for finding in found] == [str(root / name)]
    assert reads.count(name.rpartition("/")[2]) == 1


@pytest.mark.parametrize("change", [lambda doc: doc.update(elements=5), lambda doc: doc["elements"][3].update(id=5)])
def test_a_broken_architecture_is_read_once(tmp_path, reads, change):
    root = write_tiny_v2(tmp_path)
    edit_arch(root, change)
    repeat_node(root, 0)
    found = [finding for finding in validate_house(open_dataset(root), HOUSE_ID) if finding.rule == "unreadable"]
    assert len(found) == 1
    assert reads.count(f"{HOUSE_ID}.arch.json") == 1


def test_walls_that_many_nodes_show_are_built_once(tmp_path, monkeypatch):
    root = write_tiny_v2(tmp_path)
    edit_house(root, lambda document: document["levels"][0]["nodes"].extend([document["levels"][0]["nodes"][0]] * 50))
    built = []
    original = arch_json.wall_pieces
    monkeypatch.setattr(arch_json, "wall_pieces", lambda *args: built.append(args) or original(*args))
    load(root)
    assert len(built) == 4


def test_a_hint_about_names_of_a_megabyte_takes_no_hours():
    start = time.process_time()
    hint = did_you_mean("ab" * 500_000, ["ba" * 500_000, "ab" * 499_999])
    assert time.process_time() - start < 1
    assert hint.startswith("Known: ")


def test_messages_are_short_whatever_the_file_says(root):
    edit_table(root, "newmtl material_0", "newmtl " + "x" * 1_000_000 + "\nnewmtl " + "x" * 1_000_000, kind="mtl")
    assert "is defined twice" in refused(root).message


def test_members_beyond_the_level_are_one_problem(root):
    change_node(root, 0, nodeIndices=list(range(5, 50_000)))
    (problem,) = load(root).problems
    assert problem.message == "index 5 is out of range: the level has 5 nodes, and 49994 more"


@pytest.mark.parametrize(
    ("module", "limit", "value"),
    [
        (files, "MAX_BYTES", 100),
        (files, "MAX_LINES", 10),
        (place, "MAX_JSON_BYTES", 100),
        (place, "MAX_ENTRIES", 4),
        (house_json, "MAX_NODES", 4),
        (house_json, "MAX_LEVELS", 0),
        (obj_faces, "MAX_CORNERS", 40),
    ],
)
def test_every_bound_is_a_typed_error(root, monkeypatch, module, limit, value):
    monkeypatch.setattr(module, limit, value)
    assert "at most" in refused(root).message


def test_more_materials_than_any_model_has(root):
    change_node(root, 2, materials=[{}] * 1_001)
    assert refused(root).message == "expected at most 1000 materials, got 1001"


def test_a_rectangle_that_a_wall_cannot_be(tmp_path):
    """A hole as large as the wall leaves a mesh without faces, which nothing could be made of."""
    root = write_tiny_v2(tmp_path)
    hole = {"id": "x", "box": {"min": [-9, -9], "max": [99, 99]}}
    edit_arch(root, lambda document: [wall.update(holes=[hole]) for wall in document["elements"][:4]])
    house = load(root)
    assert house.levels[0].rooms[0].walls is None
    assert [problem.rule for problem in house.problems] == ["missing-part"]


def test_holes_of_a_wall_stay_few_cells(tmp_path, rng):
    """Cells go with the square of the number of holes."""
    root = write_tiny_v2(tmp_path)
    corners = np.sort(rng.uniform(0, 3, (50, 2)), axis=1)
    holes = [{"box": {"min": [a, 0.01 * i], "max": [b, 0.01 * i + 0.005]}} for i, (a, b) in enumerate(corners.tolist())]
    edit_arch(root, lambda document: document["elements"][0].update(holes=holes))
    tracemalloc.start()
    load(root)
    assert tracemalloc.get_traced_memory()[1] < 64 << 20
    tracemalloc.stop()
