"""Copies of a dataset that lack files: read, listed and compiled, never a crash; strictly they are refused."""

import json
import logging
import random
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from generated import generate_flats
from tiny_dataset import DEPTH, DOOR, HOUSE_ID, TABLE, WIDTH, edit_house, write_tiny_dataset

from home_mjx.cli import main
from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.job import compile_dataset
from home_mjx.houses.report import read_report
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house

STRICT, TOLERANT = ReadOptions(strict=True), ReadOptions(strict=False)
FOLDERS = ("object", "texture", "room", "metadata")


@pytest.fixture
def root(tmp_path) -> Path:
    """As if it were real: without the mark of a generated dataset."""
    root = write_tiny_dataset(tmp_path / "data")
    (root / "generated.json").unlink()
    return root


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def load(root: Path, options: ReadOptions = TOLERANT):
    return open_dataset(root).load_house(HOUSE_ID, options)


def kinds(house) -> dict[str, int]:
    return dict(Counter(item.kind for item in house.fallbacks))


def names(house) -> set[str]:
    return {item.name for item in house.fallbacks}


def test_a_whole_house_is_the_same_in_both_modes(root):
    """And its compiled arrays are, byte for byte."""
    dataset = open_dataset(root)
    first, second = (dataset.load_house(HOUSE_ID, options) for options in (STRICT, TOLERANT))
    assert first.fallbacks == second.fallbacks == ()
    ours, theirs = (compile_house(house, dataset.metadata) for house in (first, second))
    assert ours.models.keys() == theirs.models.keys()  # keys hold digests of their content
    assert ours.materials.texture == theirs.materials.texture
    assert dict(ours.report) == dict(theirs.report)
    np.testing.assert_array_equal(ours.colliders.pos, theirs.colliders.pos)
    np.testing.assert_array_equal(ours.materials.albedo, theirs.materials.albedo)


def test_generated_datasets_are_strict_and_others_tolerant_unless_asked(root):
    (root / "texture" / "wood_1.png").unlink()
    assert kinds(load(root, ReadOptions())) == {"texture": 1}
    (root / "generated.json").write_text("{}")
    with pytest.raises(DatasetError, match="texture `wood_1` is missing"):
        load(root, ReadOptions())
    assert kinds(load(root)) == {"texture": 1}


def test_lacking_textures_leave_the_materials_colour_and_kind(root):
    (root / "texture" / "wood_1.png").unlink()
    (root / "texture" / "s" / "123.jpg").unlink()
    house = load(root)
    assert names(house) == {"wood_1", "123"}
    slot = house.models[TABLE].materials[0]
    assert (slot.texture, slot.diffuse, slot.texture_name) == (None, (0.8, 0.6, 0.4), "wood_1")
    override = house.levels[0].objects[0].materials[0]
    assert (override.texture, override.texture_name) == (None, "123")
    compiled = compile_house(house, open_dataset(root).metadata)
    assert not any("wood_1" in path for path in compiled.materials.texture)
    assert "wood" in compiled.materials.kind  # by the texture's name, though there is no image


def test_lacking_models_are_replaced_by_ones_of_category_and_size(root):
    shutil.rmtree(root / "object" / TABLE)
    whole = write_tiny_dataset(root.parent / "whole")
    before = load(whole).models[TABLE].vertices
    house = load(root)
    (item,) = house.fallbacks
    assert (item.kind, item.name, item.replacement) == ("model", TABLE, "a generated dining_table")
    mesh = house.models[TABLE]
    assert len(mesh.faces) > 12
    np.testing.assert_allclose(mesh.vertices.min(0), before.min(0), atol=1e-6)
    np.testing.assert_allclose(mesh.vertices.max(0), before.max(0), atol=1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.3, np.pi / 4, np.pi / 2])
def test_without_its_row_a_models_size_follows_from_the_objects_box(root, turn):
    """A table of 1.2 x 0.75 x 0.8 m, stretched, turned and moved; at 45 degrees both edges are taken as equal."""
    shutil.rmtree(root / "object" / TABLE)
    shutil.rmtree(root / "metadata")
    linear = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]) * (1.0, 2.0, 0.5)
    corners = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (0, 0.75) for z in (-0.4, 0.4)]) @ linear.T + 1.5

    def change(document: dict) -> None:
        node = document["levels"][0]["nodes"][2]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = linear, 1.5
        node["transform"] = matrix.T.reshape(-1).tolist()
        node["bbox"] = {"min": corners.min(0).tolist(), "max": corners.max(0).tolist()}

    edit_house(root, change)
    house = load(root)
    assert names(house) == {TABLE, DOOR}  # a mesh of one, rows of both
    placed = house.models[TABLE].vertices @ linear.T + 1.5
    box = np.stack([placed.min(0), placed.max(0)])
    np.testing.assert_allclose(box, [corners.min(0), corners.max(0)], atol=2e-3)


def test_broken_models_and_libraries_count_as_missing(root):
    (root / "object" / TABLE / f"{TABLE}.obj").write_text("v 0 0\n")
    (root / "object" / DOOR / f"{DOOR}.mtl").write_text("Kd red\n")
    house = load(root)
    assert kinds(house) == {"model": 1, "material library": 1}
    (model,) = (item for item in house.fallbacks if item.kind == "model")
    assert "expected 3 numbers" in model.reason or "no faces" in model.reason
    assert [m.name for m in house.models[f"{DOOR}_0"].materials] == ["material_0", "material_1"]
    with pytest.raises(DatasetError):
        load(root, STRICT)


def test_a_lacking_door_has_a_leaf_on_hinges(root):
    """Both states are made, so the leaf is found; outer doors are shut. SUNCG's door 122 is known without a row."""
    shutil.rmtree(root / "object" / DOOR)
    shutil.rmtree(root / "metadata")

    def change(document: dict) -> None:
        document["levels"][0]["nodes"][3] |= {"modelId": "122"}

    edit_house(root, change)
    house = load(root)
    assert {*house.models} - {TABLE} == {"122_0"}
    (door,) = (o for o in house.levels[0].objects if o.model_id == "122")
    assert [joint.kind for joint in door.joints] == ["hinge"]
    compiled = compile_house(house, open_dataset(root).metadata_for(TOLERANT))
    assert compiled.report["shut_leaves"] == 1


@pytest.mark.parametrize("parts", ["f", "c", "w", "fc", "fw", "cw", "fcw"])
def test_lacking_meshes_of_rooms_are_made_from_what_is_left(root, parts):
    for part in parts:
        (root / "room" / HOUSE_ID / f"fr_0rm_0{part}.obj").unlink()
    house = load(root)
    assert names(house) == {f"fr_0rm_0{part}" for part in parts}
    room = house.levels[0].rooms[0]
    floor, ceiling, walls = (mesh.vertices for mesh in (room.floor, room.ceiling, room.walls))
    np.testing.assert_allclose(floor[:, [0, 2]].min(0), 0, atol=0.08)
    np.testing.assert_allclose(floor[:, [0, 2]].max(0), (WIDTH, DEPTH), atol=0.08)
    assert floor[:, 1].max() == pytest.approx(0.05, abs=0.01)
    assert ceiling[:, 1].min() == pytest.approx(2.69, abs=0.05)
    np.testing.assert_allclose(walls[:, [0, 2]].max(0) - walls[:, [0, 2]].min(0), (WIDTH, DEPTH), atol=0.2)
    compiled = compile_house(house, open_dataset(root).metadata)
    assert compiled.report["rooms"] == 1
    if "w" in parts:  # the closed door of the tiny house stands in a hole of the new wall
        heights = walls[abs(walls[:, 2] - DEPTH) < 0.1][:, 1]
        assert ((heights > 2.0) & (heights < 2.2)).any()


def test_a_lacking_ground_and_a_room_without_anything(root):
    shutil.rmtree(root / "room")
    edit_house(root, lambda document: document["levels"][0]["nodes"][0].pop("bbox"))
    house = load(root)
    assert names(house) == {"fr_0gd_1f"}
    assert {p.rule for p in house.problems} == {"missing-bbox", "missing-part"}
    np.testing.assert_allclose(house.levels[0].grounds[0].mesh.vertices.max(0), (6, 0.04, -0.5), atol=0.03)


def test_what_stands_in_is_told_once_counted_and_listed(root, caplog, capsys):
    (root / "texture" / "wood_1.png").unlink()
    shutil.rmtree(root / "object" / TABLE)
    with caplog.at_level(logging.WARNING):
        compiled = HouseCache(open_dataset(root)).load(HOUSE_ID)
        HouseCache(open_dataset(root)).load(HOUSE_ID)  # from the cache
    (line,) = [record.getMessage() for record in caplog.records if "fallbacks" in record.getMessage()]
    assert "lacks 1 texture, 1 model" in line
    assert compiled.report["fallbacks"] == 2
    assert main(["inspect", HOUSE_ID, "--dataset", str(root)]) == 0
    listed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("fallback: ")]
    assert len(listed) == 2
    assert main(["inspect", HOUSE_ID, "--dataset", str(root), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["fallbacks"]) == 2
    summary = compile_dataset(root)
    assert (summary.failed, summary.incomplete) == (0, 1)
    assert len(read_report(summary.report)[0]["fallbacks"]) == 2
    assert main(["inspect", HOUSE_ID, "--dataset", str(root), "--strict"]) != 0
    assert "has no OBJ file" in capsys.readouterr().err


def test_houses_are_compiled_anew_when_files_arrive(root):
    """Textures, models, libraries and meshes of rooms, one after the other; then it is as if they had been there."""
    whole = HouseCache(open_dataset(root)).load(HOUSE_ID)
    files = [
        root / "texture" / "wallp_0.jpg",
        root / "object" / TABLE / f"{TABLE}.obj",
        root / "object" / DOOR / f"{DOOR}.mtl",
        root / "room" / HOUSE_ID / "fr_0rm_0w.obj",
    ]
    contents = [path.read_bytes() for path in files]
    for path in files:
        path.unlink()
    for left, (path, data) in zip((4, 3, 2, 1), zip(files, contents, strict=True), strict=True):
        assert HouseCache(open_dataset(root)).load(HOUSE_ID).report["fallbacks"] == left
        path.write_bytes(data)
    again = HouseCache(open_dataset(root))
    house = again.load(HOUSE_ID)
    assert house.report == whole.report
    assert house.models.keys() == whole.models.keys()


def test_the_option_is_part_of_the_caches_key(root):
    dataset = open_dataset(root)
    entries = [HouseCache(dataset, CompileOptions(read=read)).entry_path(HOUSE_ID) for read in (STRICT, TOLERANT)]
    assert entries[0] != entries[1]
    assert HouseCache(dataset).entry_path(HOUSE_ID) == entries[1]


def partial_copy(source: Path, target: Path, house_id: str, seed: int) -> Path:
    """A copy of one house from which files are removed at random: from one to all, every third time tables too."""
    draw = random.Random(seed)
    for folder in FOLDERS:
        within = (folder, house_id) if folder == "room" else (folder,)
        shutil.copytree(source.joinpath(*within), target.joinpath(*within))
    shutil.copytree(source / "house" / house_id, target / "house" / house_id)
    tables = seed % 3 == 0
    files = sorted(p for f in FOLDERS if f != "metadata" or tables for p in (target / f).rglob("*") if p.is_file())
    count = len(files) if seed == 0 else max(1, int(len(files) * draw.random() ** 2))
    for path in draw.sample(files, count):
        path.unlink()
    return target


def check_partial(source: Path, target: Path, house_id: str, seed: int) -> None:
    """It is read, what is lacking is listed, and it compiles to as many rooms and objects as the whole house."""
    dataset = open_dataset(partial_copy(source, target, house_id, seed))
    house, whole = dataset.load_house(house_id), open_dataset(source).load_house(house_id)
    compiled = compile_house(house, dataset.metadata_for(TOLERANT))
    assert compiled.report["rooms"] == sum(len(level.rooms) for level in whole.levels)
    assert compiled.report["objects"] == sum(len(level.objects) + len(level.boxes) for level in whole.levels)
    lacking = {item.name for item in house.fallbacks}
    for key, mesh in whole.models.items():
        there = (target / mesh.path.relative_to(source)).is_file()
        assert there or key in lacking or any(key in p.message for p in house.problems)
    for level in whole.levels:
        meshes = [mesh for room in level.rooms for mesh in (room.floor, room.ceiling, room.walls) if mesh is not None]
        assert all((target / m.path.relative_to(source)).is_file() or m.path.stem in lacking for m in meshes)
    shutil.rmtree(target)


@pytest.fixture(scope="module")
def as_if_real(tmp_path_factory) -> tuple[Path, str]:
    """A generated house, written as if it were real."""
    root = tmp_path_factory.mktemp("generated")
    (house_id,) = generate_flats(root, [5])
    (root / "generated.json").unlink()
    return root, house_id


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(s, marks=pytest.mark.slow) for s in range(2, 8))])
def test_random_subsets_of_a_generated_house(as_if_real, tmp_path, seed):
    check_partial(as_if_real[0], tmp_path / "partial", as_if_real[1], seed)


@pytest.mark.real
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(s, marks=pytest.mark.slow) for s in range(2, 6))])
def test_random_subsets_of_the_real_house(suncg_root, tmp_path, seed):
    check_partial(suncg_root, tmp_path / "partial", open_dataset(suncg_root).house_ids[0], seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 200))
def test_many_subsets_of_a_generated_house(as_if_real, tmp_path, seed):
    check_partial(as_if_real[0], tmp_path / "partial", as_if_real[1], seed)


@pytest.mark.slow
@pytest.mark.real
@pytest.mark.parametrize("seed", range(100, 300))
def test_many_subsets_of_the_real_house(suncg_root, tmp_path, seed):
    check_partial(suncg_root, tmp_path / "partial", open_dataset(suncg_root).house_ids[0], seed)


def test_a_lacking_metadata_row_names_its_first_user(root):
    shutil.rmtree(root / "metadata")

    def repeat(document: dict) -> None:
        nodes = document["levels"][0]["nodes"]
        table = next(node for node in nodes if node.get("modelId") == TABLE)
        nodes.append(table | {"id": f"0_{len(nodes)}"})

    edit_house(root, repeat)
    house = load(root)
    first, *others = [item.path for item in house.levels[0].objects if item.model_id == TABLE]
    assert others
    assert [row.element for row in house.fallbacks if (row.kind, row.name) == ("metadata row", TABLE)] == [first]
