"""Houses that can be read but are too large to be compiled: a typed error with file and element, soon."""

import json
import re
import time
import tracemalloc

import numpy as np
import pytest
from tiny_arch import arch_path, write_tiny_v2
from tiny_dataset import DEPTH, HOUSE_ID, WIDTH, edit_house, write_tiny_dataset

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.houses.house_cache import HouseCache
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.pipeline import limits
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house

HOUSE_JSON = f"house/{HOUSE_ID}/house.json"
NODES = "levels[0].nodes"


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path)


def compiled(root, options=CompileOptions()):  # noqa: B008 - frozen
    dataset = open_dataset(root)
    return compile_house(dataset.load_house(HOUSE_ID), dataset.metadata, options)


def repeat(root, index, count):
    def change(document):
        nodes = document["levels"][0]["nodes"]
        nodes += [dict(nodes[index], id=f"0_{i}") for i in range(len(nodes), len(nodes) + count)]

    edit_house(root, change)


def widen(root, factor):
    """Makes the room longer and wider, as one wrong unit would."""
    for path in (root / "room" / HOUSE_ID).glob("fr_0rm_*.obj"):
        lines = path.read_text().split("\n")
        for i, line in enumerate(lines):
            if line.startswith("v "):
                x, y, z = (float(word) for word in line.split()[1:])
                lines[i] = f"v {x * factor:g} {y:g} {z * factor:g}"
        path.write_text("\n".join(lines))


@pytest.mark.parametrize(
    ("limit", "value", "index", "what", "element"),
    [
        ("MAX_ROOMS", 3, 0, "3 rooms", f"{NODES}[7]"),
        ("MAX_OBJECTS", 5, 2, "5 objects", f"{NODES}[8]"),
        ("MAX_TRIANGLES", 100, 2, "100 triangles", f"{NODES}[7]"),
    ],
)
def test_too_many_of_something(root, monkeypatch, limit, value, index, what, element):
    monkeypatch.setattr(limits, limit, value)
    compiled(root)
    repeat(root, index, 8)
    with pytest.raises(DatasetError, match=f"at most {what}") as caught:
        compiled(root)
    assert (caught.value.file, caught.value.element) == (str(root / HOUSE_JSON), element)
    assert caught.value.hint


@pytest.mark.parametrize("factor", [100, 1e5])
def test_rooms_of_kilometres_cost_no_memory(root, factor):
    """Found by the fuzzer: their navigation grid would have had billions of cells."""
    widen(root, factor)
    dataset = open_dataset(root)
    house = dataset.load_house(HOUSE_ID)
    tracemalloc.start()
    with pytest.raises(DatasetError, match="can be navigated") as caught:
        compile_house(house, dataset.metadata)
    assert tracemalloc.get_traced_memory()[1] < 16 << 20
    tracemalloc.stop()
    assert (caught.value.file, caught.value.element) == (str(root / HOUSE_JSON), f"{NODES}[0]")


def test_walls_of_kilometres_are_refused(tmp_path):
    """Found by the fuzzer: 278,788 pieces of a wall were compared with one another."""
    root = write_tiny_v2(tmp_path)
    path = arch_path(root)
    document = json.loads(path.read_text())
    wall = next(element for element in document["elements"] if element["type"] == "Wall")
    wall["points"][1][0] += 5e5
    path.write_text(json.dumps(document))
    with pytest.raises(DatasetError, match="walls are") as caught:
        compiled(root)
    assert caught.value.file
    assert caught.value.element.startswith("levels[0]")


def test_large_houses_are_compiled_with_larger_cells(root):
    widen(root, 100)
    options = CompileOptions(navigation=NavigationOptions(cell=2.0))
    assert compiled(root, options).navigation.region_area[0] > 10_000


def test_a_house_without_a_free_place_names_its_file(root):
    def block(document):
        transform = document["levels"][0]["nodes"][2]["transform"]
        for i in (0, 5, 10):
            transform[i] = 100.0

    edit_house(root, block)
    with pytest.raises(DatasetError, match="no place") as caught:
        compiled(root)
    assert caught.value.file == str(root / HOUSE_JSON)
    assert "furniture" in caught.value.hint


def test_walls_in_one_mesh_group_take_the_whole_room(root):
    """A user's own house: the validator had nothing against it, and the error did not say why."""
    path = root / "room" / HOUSE_ID / "fr_0rm_0w.obj"
    path.write_text(re.sub("^o .*$", "o WallInside#0_0_0", path.read_text(), flags=re.MULTILINE))
    with pytest.raises(DatasetError, match="no place") as caught:
        compiled(root)
    area = WIDTH * DEPTH
    assert f"of {area:.1f} m² of floor, walls take {area:.1f} m², furniture and doors 0.0 m²" in caught.value.message
    assert "mesh group of its own" in caught.value.hint


def test_things_in_a_heap_take_seconds(root):
    """Found by the fuzzer: whether one stands on another was asked of all pairs."""
    compiled(root)  # compiles the compiler
    repeat(root, 2, 400)
    begin = time.process_time()
    house = compiled(root)
    assert house.report["objects"] == 403
    assert time.process_time() - begin < 20


def test_a_wall_without_length_mirrors_nothing(root):
    """Found by the fuzzer: its direction was 0 / 0."""
    path = root / "room" / HOUSE_ID / "fr_0rm_0w.obj"
    before = len(compiled(root).planes.center)
    lines = path.read_text().split("\n")
    first = [i for i, line in enumerate(lines) if line.startswith("v ")][:8]
    for i in first:
        lines[i] = "v 4.0 0.0 0.05"
    path.write_text("\n".join(lines))
    planes = compiled(root).planes
    assert len(planes.center) == before - 1
    assert np.isfinite(planes.axis_u).all()


def test_what_is_read_is_an_option_of_compiling(root, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    path = root / "metadata" / "ModelCategoryMapping.csv"
    path.write_text(path.read_text().replace("dining_table,table", "person,person"))
    dataset = open_dataset(root)
    kinds = {
        people: HouseCache(dataset, CompileOptions(read=ReadOptions(people=people))).load(HOUSE_ID).instances.object_id
        for people in (True, False, True)
    }
    np.testing.assert_array_equal(sorted(set(kinds[True].tolist()) - set(kinds[False].tolist())), [2])
