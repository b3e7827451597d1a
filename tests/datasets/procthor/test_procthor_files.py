"""Files of ProcTHOR: names, lines, digests, errors, and the shared sample."""

import gzip
import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from thor_houses import database, small_house, thing, write_house

from home_mjx.datasets import ReadOptions, open_dataset, split_of, validate_house
from home_mjx.datasets.procthor.dataset import ProcthorDataset
from home_mjx.datasets.procthor.parse import parse_house
from home_mjx.datasets.procthor.shell import room_polygon
from home_mjx.datasets.suncg.formats.json_value import read_json
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownIdError
from home_mjx.geometry.polygons import polygon_area
from home_mjx.houses import HouseSet
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house

SAMPLE = Path(__file__).parents[4] / "shared" / "data" / "procthor_sample"
needs_sample = pytest.mark.skipif(not SAMPLE.is_dir(), reason=f"{SAMPLE} does not exist")


def write_lines(folder: Path, names: list[str], packed: bool) -> Path:
    lines = []
    for name in names:
        house = small_house()
        house["rooms"][0]["roomType"] = name
        lines.append(json.dumps(house) + "\n")
    path = folder / ("train.jsonl.gz" if packed else "train.jsonl")
    data = "".join(lines).encode()
    path.write_bytes(gzip.compress(data) if packed else data)
    return path


@pytest.mark.parametrize("packed", [False, True])
def test_lines_are_houses_with_the_number_of_their_line(tmp_path, packed):
    path = write_lines(tmp_path, ["Bedroom", "Bathroom", "Kitchen", "LivingRoom"], packed)
    dataset = open_dataset(f"procthor:{path}?first=1&count=2")
    assert dataset.house_ids == ("train_00001", "train_00002")
    assert dataset.load_house("train_00002").levels[0].rooms[0].types == ("Kitchen",)
    assert open_dataset(path).house_ids == tuple(f"train_{i:05d}" for i in range(4))
    assert open_dataset(f"procthor:{tmp_path}?split=train&first=3").house_ids == ("train_00003",)
    again = pickle.loads(pickle.dumps(dataset))
    assert again == dataset
    assert again.house_ids == dataset.house_ids
    with pytest.raises(UnknownIdError):
        dataset.load_house("train_00000")


def test_official_splits_are_the_files(tmp_path):
    """All houses of train.jsonl are in `train`; by the hash of the id, some would be in others."""
    path = write_lines(tmp_path, ["Bedroom"] * 30, False)
    ids = open_dataset(path).house_ids
    assert {split_of(name) for name in ids} != {"train"}
    assert HouseSet(str(path), split="train").house_ids == ids
    with pytest.raises(ConfigError, match="split `val`"):
        _ = HouseSet(str(path), split="val").house_ids


def test_lines_without_text_are_no_houses(tmp_path):
    path = write_lines(tmp_path, ["Bedroom", "Kitchen"], False)
    path.write_text(path.read_text().replace("\n", "\n\n"))
    assert open_dataset(f"procthor:{path}?first=1&count=1").house_ids == ("train_00002",)


def test_a_digest_changes_with_its_house_and_the_database_alone(tmp_path):
    path = write_lines(tmp_path, ["Bedroom", "Bathroom"], False)
    first = [ProcthorDataset(str(path)).inputs().house(name) for name in ("train_00000", "train_00001")]
    write_lines(tmp_path, ["Bedroom", "Kitchen"], False)
    after = [ProcthorDataset(str(path)).inputs().house(name) for name in ("train_00000", "train_00001")]
    assert (after[0] == first[0], after[1] == first[1]) == (True, False)
    (tmp_path / "asset-database.json").write_text(json.dumps(database()))
    assert ProcthorDataset(str(path)).inputs().house("train_00000") != first[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("houses.json?frist=1", "unknown option"),
        ("houses.json?first=-1", "whole number"),
        ("houses.json?count=0", "whole number"),
        ("", "no path"),
        ("?first=1", "no path"),
    ],
)
def test_wrong_names_are_refused(text, message):
    with pytest.raises(ConfigError, match=message):
        ProcthorDataset(text)


def test_missing_files_and_splits_are_refused(tmp_path):
    with pytest.raises(MissingFileError, match="no file or folder"):
        ProcthorDataset(str(tmp_path / "none.json"))
    path = write_lines(tmp_path, ["Bedroom"], False)
    with pytest.raises(ConfigError, match="split `val`"):
        ProcthorDataset(f"{tmp_path}?split=val")
    with pytest.raises(MissingFileError, match="number 1 or more"):
        _ = ProcthorDataset(f"{path}?first=1").house_ids


def test_files_of_other_formats_are_not_recognised(tmp_path):
    path = tmp_path / "notes.json"
    path.write_text('{"notes": []}')
    with pytest.raises(DatasetError, match="nor a file of a known format"):
        open_dataset(path)
    write_house(tmp_path)
    assert open_dataset(tmp_path).house_ids == ("house",)  # of the folder, the database and the notes are no houses


def change(house: dict, path: str, value: object) -> None:
    """Set the value at a path such as `rooms.0.id`, or delete the key if the value is `...`."""
    *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    for key in parents:
        house = house[key]
    if value is ...:
        del house[last]
    else:
        house[last] = value


@pytest.mark.parametrize(
    ("path", "value", "element", "message"),
    [
        ("metadata.schema", "2.0.0", "metadata.schema", "schema `2.0.0` is unknown"),
        ("rooms", [], "rooms", "house shows nothing"),
        ("rooms", ..., None, "expected a house of ProcTHOR"),
        ("rooms.1.floorPolygon", ..., "rooms[1].floorPolygon", "lacks `floorPolygon`"),
        ("rooms.1.floorPolygon.2.x", float("nan"), "rooms[1].floorPolygon[2].x", "finite"),
        ("rooms.1.floorPolygon.2", {"x": 4, "y": 0, "z": 2}, "rooms[1].floorPolygon", "crosses itself|no area"),
        ("rooms.0.roomType", 7, "rooms[0].roomType", "expected a string"),
        ("walls.0.polygon", [], "walls[0].polygon", "expected 4 corners"),
        ("walls.0.polygon.3.y", 1e9, "walls[0].polygon[3].y", "within 1000 m"),
        ("doors.0.wall0", "wall|9", "doors[0].wall0", "there is no wall"),
        ("doors.0.holePolygon", ..., "doors[0]", "lacks `holePolygon`"),
        ("doors.0.holePolygon.1.x", 0.5, "doors[0]", "narrower"),
        ("objects.0.position", ..., "objects[0].position", "expected an object"),
        ("objects.0.children.0.position.y", "high", "objects[0].children[0].position.y", "expected a number"),
        ("objects.0.children", [{}] * 5000, "objects[0].children", "at most 4000"),
        ("objects.0.assetId", ..., "objects[0].assetId", "expected a string"),
    ],
)
def test_broken_houses_are_refused_with_their_element(tmp_path, path, value, element, message):
    house = small_house()
    if path == "rooms.1.floorPolygon.2":  # all corners on one line
        house["rooms"][1]["floorPolygon"] = house["rooms"][1]["floorPolygon"][:3]
        house["rooms"][1]["floorPolygon"][2] = value
        house["rooms"][1]["floorPolygon"][0] = {"x": 4, "y": 0, "z": 0}
    else:
        change(house, path, value)
    file = write_house(tmp_path, house)
    with pytest.raises(DatasetError, match=message) as caught:
        ProcthorDataset(str(file)).load_house("house")
    assert caught.value.file == str(file)
    assert caught.value.element == element


def test_a_broken_line_is_named(tmp_path):
    path = tmp_path / "val.jsonl"
    path.write_text(json.dumps(small_house()) + '\n{"rooms": [,\n')
    dataset = ProcthorDataset(str(path))
    assert len(dataset.load_house("val_00000").levels[0].rooms) == 2
    with pytest.raises(DatasetError, match="not valid JSON") as caught:
        dataset.load_house("val_00001")
    assert caught.value.element == "line 2, column 12"


def test_cut_gzip_is_an_error_of_the_file(tmp_path):
    path = write_lines(tmp_path, ["Bedroom"] * 3, True)
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(DatasetError, match="not valid gzip"):
        _ = ProcthorDataset(str(path)).house_ids


def test_unknown_models_are_shown_as_boxes_and_refused_if_strict(tmp_path):
    house = small_house()
    house["objects"].append(thing("Gizmo_1", "3", (6.0, 0.3, 1.0)))
    dataset = ProcthorDataset(str(write_house(tmp_path, house)))
    read = dataset.load_house("house")
    assert read.fallbacks[-1].name == "unknown (1)"
    assert [problem.element for problem in read.problems] == ["objects[4]"]
    with pytest.raises(DatasetError, match="kind of `Gizmo_1` is unknown") as caught:
        dataset.load_house("house", ReadOptions(strict=True))
    assert caught.value.element == "objects[4]"


def test_old_files_without_a_schema_are_read_and_told(tmp_path):
    house = small_house()
    del house["metadata"]
    house["rooms"][0]["floorMaterial"] = "DarkWoodFloors"
    door = house["doors"][0]
    low, high = door.pop("holePolygon")
    door["boundingBox"] = {"min": low, "max": high}
    read = ProcthorDataset(str(write_house(tmp_path, house))).load_house("house")
    assert "before 1.0.0" in read.problems[0].message
    assert read.version == "procthor@old"


def test_metadata_of_a_running_scene_is_no_house(tmp_path):
    path = tmp_path / "FloorPlan1.json"
    path.write_text(json.dumps({"Mug|1": {"objectType": "Mug"}}))
    with pytest.raises(DatasetError, match=r"running scene"):
        ProcthorDataset(str(path)).load_house("FloorPlan1")


@needs_sample
@pytest.mark.parametrize(
    ("name", "areas", "walls", "openings", "things", "lights", "bounds"),
    [
        ("house_0", [25.33, 12.67, 29.56, 16.89], (32, 10, 4), (3, 2), (22, 52), 4, (12.329, 2.754, 10.274)),
        ("house_6", [51.72, 30.17, 38.79, 34.48], (40, 12, 0), (4, 4), (37, 102), 4, (12.456, 2.544, 14.532)),
        ("house_12", [42.63, 17.75, 35.52, 28.41], (38, 12, 0), (4, 3), (31, 89), 4, (11.308, 5.022, 13.193)),
        ("klbr_house_8", [17.75, 17.75, 17.75], (28, 10, 0), (3, 5), (24, 54), 3, (10.533, 2.983, 8.427)),
    ],
)
def test_counts_of_the_sample(name, areas, walls, openings, things, lights, bounds):
    """As its README states them; the sun is no point light."""
    house = parse_house(read_json(SAMPLE / "houses" / f"{name}.json"))
    polygons = [room_polygon(room) for room in house.rooms]
    assert [polygon_area(polygon) for polygon in polygons] == pytest.approx(areas, abs=0.01)
    exterior, empty = (sum(getattr(w, field) for w in house.walls) for field in ("is_exterior", "is_empty"))
    assert (len(house.walls), exterior, empty) == walls
    kinds = [opening.kind for opening in house.openings]
    assert (kinds.count("door"), kinds.count("window")) == openings

    def count(found) -> int:
        return len(found) + sum(count(item.children) for item in found)

    assert (len(house.objects), count(house.objects)) == things
    assert len(house.lights) == lights
    every = np.concatenate(polygons)
    assert (np.ptp(every[:, 0]), house.height, np.ptp(every[:, 1])) == pytest.approx(bounds, abs=1e-3)


@needs_sample
def test_every_room_of_the_sample_is_reached_by_an_agent_of_a_fifth_of_a_metre():
    dataset = open_dataset(SAMPLE / "houses")
    options = CompileOptions(navigation=NavigationOptions(agent_radius=0.2, margin=0.0))
    for house_id in dataset.house_ids:
        house = compile_house(dataset.load_house(house_id), dataset.metadata, options)
        reached = set(np.unique(house.navigation.room[house.navigation.home_mask]).tolist()) - {-1}
        assert reached == set(range(len(house.rooms.type))), house_id
        assert house.report["objects_outside"] == 0


@needs_sample
def test_the_sample_has_no_faults():
    dataset = open_dataset(SAMPLE / "houses")
    assert [finding for name in dataset.house_ids for finding in validate_house(dataset, name)] == []


@needs_sample
def test_an_empty_house_is_refused():
    with pytest.raises(DatasetError, match="house shows nothing"):
        ProcthorDataset(str(SAMPLE / "holodeck" / "empty_house.json")).load_house("empty_house")


@needs_sample
def test_every_model_of_the_sample_keeps_a_fine_category():
    dataset = open_dataset(SAMPLE / "houses")
    nodes = [item for name in dataset.house_ids for item in dataset.load_house(name).levels[0].objects]
    fine = [node.model_id for node in nodes if "category" in node.extra]
    assert len(fine) == 52 + 102 + 89 + 54
    assert fine.count("unknown") == 0


def test_rooms_without_a_type_are_rooms_of_no_type(tmp_path):
    house = small_house()
    for room in house["rooms"]:
        room.pop("roomType")
    dataset = open_dataset(f"procthor:{write_house(tmp_path, house)}")
    assert [room.types for room in dataset.load_house("house").levels[0].rooms] == [(), ()]
