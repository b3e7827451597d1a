"""Generated datasets on disk: strict format, the same bytes each time, whole or not at all, read back unchanged."""

import csv
import hashlib
import json
import multiprocessing
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from generated import FLAT, flat, flat_id, write_flats
from PIL import Image
from processes import processes_of, wait_for

from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.seeds import GENERATED_MARKER, house_id, parse_house_id, sort_house_ids
from home_mjx.datasets.suncg.write import house as writer
from home_mjx.errors import ConfigError, DatasetError
from home_procgen import dataset_writer, generate
from home_procgen.model_library import building_models
from home_procgen.model_store import library

SEEDS = (3, 1, 4)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("generated") / "houses"
    assert write_flats(root, SEEDS) == tuple(flat_id(seed) for seed in SEEDS)
    return root


def digests(root: Path):
    return {p.relative_to(root): hashlib.md5(p.read_bytes()).hexdigest() for p in root.rglob("*") if p.is_file()}


def read_like_gaps(path: Path):
    """Vertices and used texture files of an OBJ, by the limits of GAPS's parser, on which SUNCG's tools stand."""
    vertices, counts, materials, used, library_path = [], {"v": 0, "vt": 0, "vn": 0}, {}, set(), None
    for line in path.read_bytes().split(b"\n"):
        assert len(line) < 1024
        words = line.decode("ascii").split()
        if not words:
            continue
        keyword, rest = words[0], words[1:]
        if keyword in counts:
            counts[keyword] += 1
            assert len(rest) == (2 if keyword == "vt" else 3)
            assert np.isfinite([float(word) for word in rest]).all()
            if keyword == "v":
                vertices.append([float(word) for word in rest])
        elif keyword == "mtllib":
            library_path = path.parent / rest[0]
            materials = read_mtl(library_path)
        elif keyword == "usemtl":
            assert rest[0] in materials
            used.add(rest[0])
        elif keyword == "f":
            assert used, "a face before the first usemtl"
            assert len(rest) in (3, 4)
            for corner in rest:
                for kind, index in zip(("v", "vt", "vn"), corner.split("/"), strict=True):
                    assert 1 <= int(index) <= counts[kind]
        else:
            assert keyword == "o"
    assert library_path is not None
    return np.array(vertices), [*materials]


def read_mtl(path: Path):
    names = []
    for words in (line.split() for line in path.read_text().splitlines()):
        if not words:
            continue
        if words[0] == "newmtl":
            names.append(words[1])
        elif words[0] == "map_Kd":
            assert len(words) == 2
            assert (path.parent / words[1]).resolve().is_file()
        else:
            assert words[0] in ("illum", "d", "Ns", "Kd", "Ks")
    assert names == [f"material_{i}" for i in range(len(names))]
    return names


def documents(root: Path):
    return [json.loads((root / "house" / flat_id(seed) / "house.json").read_text()) for seed in SEEDS]


def test_meshes_keep_to_the_limits_of_gaps(root):
    paths = list(root.glob("object/*/*.obj")) + list(root.glob("room/*/*.obj"))
    assert len(paths) > 100
    for path in paths:
        read_like_gaps(path)


def test_house_json_has_the_layout_of_suncg(root):
    for seed, house in zip(SEEDS, documents(root), strict=True):
        assert list(house) == ["version", "id", "up", "front", "scaleToMeters", "levels", "bbox"]
        assert house["id"] == flat_id(seed)
        assert [list(level) for level in house["levels"]] == [["id", "bbox", "nodes"]]
        nodes = house["levels"][0]["nodes"]
        assert [node["id"] for node in nodes] == [f"0_{i}" for i in range(len(nodes))]
        kinds = [node["type"] for node in nodes]
        assert kinds == sorted(kinds, key=["Room", "Object"].index)
        for node in nodes:
            order = ["id", "type", "valid", "modelId"]
            if node["type"] == "Room":
                order += ["nodeIndices", "roomTypes", "bbox"]
            else:
                order += ["state", "transform", "isMirrored", "bbox", "materials"]
            assert list(node) == [key for key in order if key in node]
            assert node["valid"] == 1
            assert type(node["valid"]) is int


def test_boxes_are_those_of_the_geometry(root):
    for house in documents(root):
        level = house["levels"][0]
        boxes = {}
        for node in level["nodes"]:
            if node["type"] == "Object":
                vertices, _ = read_like_gaps(root / "object" / node["modelId"] / f"{node['modelId']}.obj")
                matrix = np.reshape(node["transform"], (4, 4)).T
                points = vertices @ matrix[:3, :3].T + matrix[:3, 3]
                boxes[node["id"]] = np.array([points.min(0), points.max(0)])
        for node in level["nodes"]:
            if node["type"] == "Room":
                own = [
                    read_like_gaps(root / "room" / house["id"] / f"{node['modelId']}{part}.obj")[0] for part in "cfw"
                ]
                boxes[node["id"]] = union([np.array([p.min(0), p.max(0)]) for p in own])
                members = [boxes[level["nodes"][i]["id"]] for i in node["nodeIndices"]]
                boxes[node["id"]] = union([boxes[node["id"]], *members])
            np.testing.assert_allclose([node["bbox"]["min"], node["bbox"]["max"]], boxes[node["id"]], atol=1e-3)
        for box in (level["bbox"], house["bbox"]):
            np.testing.assert_allclose([box["min"], box["max"]], union(list(boxes.values())), atol=1e-3)


def union(boxes):
    return np.array([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)])


def test_materials_of_objects_fill_all_slots(root):
    for house in documents(root):
        for node in house["levels"][0]["nodes"]:
            if node["type"] == "Object":
                slots = read_mtl(root / "object" / node["modelId"] / f"{node['modelId']}.mtl")
                assert len(node["materials"]) == len(slots)
                for material in node["materials"]:
                    assert "texture" not in material or (root / "texture" / f"{material['texture']}.png").is_file()
                    assert len(material["diffuse"]) == 7


def test_tables_list_every_model(root):
    with (root / "metadata" / "ModelCategoryMapping.csv").open() as file:
        categories = list(csv.DictReader(file))
    assert [row["index"] for row in categories] == [str(i) for i in range(len(categories))]
    assert [row["model_id"] for row in categories[:5]] == ["Empty", "Wall", "Ceiling", "Floor", "Box"]
    ids = [row["model_id"] for row in categories[5:]]
    assert set(ids) == {*library(), *building_models()}
    assert len(ids) == len(set(ids))
    assert all(all(row.values()) for row in categories)  # GAPS cannot read empty cells
    with (root / "metadata" / "models.csv").open() as file:
        sizes = {row["id"]: row for row in csv.DictReader(file)}
    written = {path.stem: path for path in root.glob("object/*/*.obj")}  # models that a flat has
    assert 50 < len(written) < len(sizes)
    assert set(sizes) > set(written)
    for name, path in written.items():
        row, (vertices, materials) = sizes[name], read_like_gaps(path)
        np.testing.assert_allclose(np.fromstring(row["minPoint"], sep=","), vertices.min(0), atol=1e-5)
        np.testing.assert_allclose(
            np.fromstring(row["aligned.dims"], sep=",") / 100, np.ptp(vertices, axis=0), atol=1e-5
        )
        assert int(row["nmaterials"]) == len(materials)
    assert sizes["home_door_1_0"]["variantIds"] == "home_door_1,home_door_1_0"
    assert sizes["home_door_1_0"]["index"] == sizes["home_door_1"]["index"]


def test_textures_are_images(root):
    for path in (root / "texture").iterdir():
        with Image.open(path) as image:
            assert image.size in ((256, 256), (512, 512))
            assert image.mode in ("P", "RGB")


def test_the_first_houses_stay_the_first_when_others_are_added(tmp_path):
    write_flats(tmp_path, range(2))
    before = open_dataset(tmp_path).house_ids
    write_flats(tmp_path, [7, 2])
    assert before == (flat_id(0), flat_id(1))
    assert open_dataset(tmp_path).house_ids == (*before, flat_id(2), flat_id(7))


def test_houses_come_by_variant_and_seed_and_others_after_them():
    far, near, home = house_id(2**63 - 1, 0x400), house_id(9, 0x400), house_id(1, 0x500)
    assert sort_house_ids([home, far, "0" * 32, near]) == (near, far, home, "0" * 32)
    assert parse_house_id(far) == (0x400, 2**63 - 1)
    for other in ("0" * 32, "", near[:-1], near + "0", near.replace("6f", "6F"), f"{near[:-2]}+9", f"{near[:-2]} 9"):
        assert parse_house_id(other) is None
    assert parse_house_id(house_id(-9, 0x400)) is None  # a sign takes the place of a digit


def test_the_reader_gets_back_what_was_made(root):
    opened = open_dataset(root)
    assert set(opened.house_ids) == {flat_id(seed) for seed in SEEDS}
    for seed in SEEDS:
        made, read = flat(seed), opened.load_house(flat_id(seed))
        assert read.problems == ()
        for one, other in zip(made.levels[0].rooms, read.levels[0].rooms, strict=True):
            assert (one.id, one.types, one.members) == (other.id, other.types, other.members)
            for a, b in zip(
                (one.floor, one.ceiling, one.walls), (other.floor, other.ceiling, other.walls), strict=True
            ):
                assert a.groups == b.groups
                assert [m.texture and m.texture.name for m in a.materials] == [
                    m.texture and m.texture.name for m in b.materials
                ]
                np.testing.assert_allclose(surface(a), surface(b), atol=1e-5)
        for one, other in zip(made.levels[0].objects, read.levels[0].objects, strict=True):
            assert (one.model_key, one.is_mirrored) == (other.model_key, other.is_mirrored)
            np.testing.assert_allclose(one.transform, other.transform, atol=1e-8)
            assert [m.name for m in one.materials] == [m.name for m in other.materials]
            np.testing.assert_allclose(
                [m.diffuse for m in one.materials], [m.diffuse for m in other.materials], atol=1 / 500
            )
            info = opened.metadata.info(one.model_key)
            assert info.fine == library()[one.model_id].fine
        lit = {node.model_id for node in made.levels[0].objects if library()[node.model_id].lights}
        assert lit
        assert lit <= set(opened.metadata.lights)


def surface(mesh):
    """Triangles with their UVs, group and slot, in an order of their own."""
    rows = np.concatenate(
        [mesh.group[:, None], mesh.slot[:, None], mesh.vertices[mesh.faces].reshape(-1, 9), mesh.uv.reshape(-1, 6)], 1
    )
    return rows[np.lexsort(rows.round(4).T[::-1])]


def test_same_seed_same_bytes_in_any_order_and_subset(root, tmp_path):
    write_flats(tmp_path / "again", [4])
    write_flats(tmp_path / "again", [7, 1])
    write_flats(tmp_path / "again", [4, 3])
    one, other = digests(root), digests(tmp_path / "again")
    assert len(one) > 300
    assert {path: other[path] for path in one} == one


def test_worker_processes_write_the_same_bytes(root, tmp_path, monkeypatch):
    monkeypatch.setattr(dataset_writer, "MIN_POOL_HOUSES", 2)
    ids = write_flats(tmp_path / "pool", SEEDS)
    assert ids == tuple(flat_id(seed) for seed in SEEDS)
    assert digests(tmp_path / "pool") == digests(root)
    assert multiprocessing.active_children() == []


def test_what_is_there_is_kept(root):
    before = {path: path.stat().st_mtime_ns for path in root.rglob("*")}
    assert write_flats(root, [1, 1]) == (flat_id(1), flat_id(1))
    assert {path: path.stat().st_mtime_ns for path in root.rglob("*")} == before


def test_a_crash_can_be_resumed(root, tmp_path, monkeypatch):
    """Whatever file the crash comes at: nothing unfinished is seen, and the next call completes the dataset."""
    write = writer._write_file
    monkeypatch.setattr(generate, "build_home", lambda seed, variant: flat(seed))
    expected = digests(root)
    for stop in (100, 200, 237, 250):  # among models, textures, tables, rooms
        target, left = tmp_path / str(stop), stop

        def crash(path, content):
            nonlocal left
            if left == 0:
                raise KeyboardInterrupt
            left -= 1
            write(path, content)

        monkeypatch.setattr(writer, "_write_file", crash)
        with pytest.raises(KeyboardInterrupt):
            write_flats(target, SEEDS)
        done = digests(target)
        assert {path: expected.get(path) for path in done} == done
        monkeypatch.setattr(writer, "_write_file", write)
        write_flats(target, SEEDS)
        assert digests(target) == expected


@pytest.mark.parametrize("seed", [-1, 2**63, 1.5, "1", True, None])
def test_bad_seed(tmp_path, seed):
    with pytest.raises(ConfigError, match="seed must be an integer"):
        dataset_writer._check_seed(seed)
    assert list(tmp_path.iterdir()) == []


def test_numpy_seeds_are_seeds():
    assert dataset_writer._check_seed(np.int64(5)) == 5


def test_root_with_something_else_in_it(tmp_path):
    (tmp_path / "house").mkdir()
    with pytest.raises(DatasetError, match="not generated here"):
        write_flats(tmp_path, [0])
    assert [path.name for path in tmp_path.iterdir()] == ["house"]


def test_root_of_another_version(tmp_path):
    (tmp_path / GENERATED_MARKER).write_text('{"generator": "home_mjx", "version": 0}')
    with pytest.raises(DatasetError, match="generator version 0"):
        write_flats(tmp_path, [0])


@pytest.mark.parametrize("broken", ["", "[", "null"])
def test_broken_marker(tmp_path, broken):
    (tmp_path / GENERATED_MARKER).write_text(broken)
    with pytest.raises(DatasetError):
        write_flats(tmp_path, [0])


def test_two_processes_may_mark_the_same_new_folder(tmp_path):
    (tmp_path / f".{GENERATED_MARKER}.1").write_text("")  # the other one is between writing its marker and renaming it
    dataset_writer.claim_root(tmp_path, FLAT)
    assert json.loads((tmp_path / GENERATED_MARKER).read_text())["generator"] == "home_mjx"


CUT = (
    "house/{}/house.json",
    "house/{}/sha256.json",
    "room/{}/*.obj",
    "object/home_door_1/*.obj",
    "texture/*.png",
    "metadata/*",
)


@pytest.fixture(scope="module")
def copied(root, tmp_path_factory):
    return shutil.copytree(root, tmp_path_factory.mktemp("copied") / "houses")


@pytest.mark.parametrize("name", CUT)
def test_a_file_that_was_cut_is_written_anew(root, copied, name, monkeypatch):
    """Half a door's OBJ is an OBJ of half a door."""
    monkeypatch.setattr(generate, "build_home", lambda seed, variant: flat(seed))
    path = min(copied.glob(name.format(flat_id(3))))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert digests(copied) != digests(root)
    write_flats(copied, SEEDS)
    assert digests(copied) == digests(root)


def test_a_house_of_a_former_version_is_kept(root, copied):
    (copied / "house" / flat_id(1) / "sha256.json").unlink()
    before = (copied / "house" / flat_id(1) / "house.json").stat().st_mtime_ns
    write_flats(copied, SEEDS)
    assert (copied / "house" / flat_id(1) / "house.json").stat().st_mtime_ns == before


def test_what_killed_writers_left_is_swept(copied):
    leftovers = [copied / f"{writer.PARTIAL_PREFIX}old", copied / f".{GENERATED_MARKER}.77"]
    leftovers[0].mkdir()
    leftovers[1].write_text("{")
    young = copied / f"{writer.PARTIAL_PREFIX}young"
    young.mkdir()
    for path in leftovers:
        os.utime(path, times=(0, 0))
    write_flats(copied, [3])
    assert [path.exists() for path in (*leftovers, young)] == [False, False, True]


def test_a_broken_marker_in_the_cache_says_what_to_remove(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    (tmp_path / "generated-v5").mkdir()
    (tmp_path / "generated-v5" / GENERATED_MARKER).write_text('{"gener')
    with pytest.raises(DatasetError, match=r"broken generated.json.*Remove that folder: it is made again"):
        dataset_writer.claim_root(tmp_path / "generated-v5", FLAT)


def test_a_folder_of_the_cache_without_its_marker_may_be_removed(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    (tmp_path / "generated-v5" / "house").mkdir(parents=True)
    with pytest.raises(DatasetError, match=r"generated-v5.*Remove that folder: it is made again"):
        dataset_writer.claim_root(tmp_path / "generated-v5", FLAT)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder in which nobody can make another")
def test_a_folder_that_cannot_be_made_is_told_of():
    with pytest.raises(DatasetError, match=r"cannot be used.*Choose another folder"):
        dataset_writer.claim_root(Path("/proc/nowhere/houses"), FLAT)


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="looks for orphans in /proc")
def test_worker_processes_leave_with_a_killed_parent(tmp_path):
    command = [
        sys.executable,
        "-m",
        "home_mjx.cli",
        "generate",
        str(tmp_path / "killed"),
        "--seeds",
        "0:400",
        "--preset",
        "flat",
    ]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, env={**os.environ, "MARK": str(tmp_path)})
    wait_for(lambda: list(tmp_path.glob("killed/house/*")))
    assert len(processes_of(tmp_path)) > 1
    process.kill()
    process.wait()
    wait_for(lambda: not processes_of(tmp_path))


def test_root_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("x")
    for root in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(DatasetError, match="cannot be used"):
            write_flats(root, [0])
