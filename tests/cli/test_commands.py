"""The subcommands do what they say, on generated houses."""

import json
import wave
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from generated import generate_flats
from PIL import Image

from home_mjx.audio_jax.parameters.room_survey import SURVEY_CONFIG
from home_mjx.bank.bank import HouseBank
from home_mjx.cli import main
from home_mjx.cli.commands.render import CUT_WALL_GREY, STOREY_MARGIN
from home_mjx.cli.viewpoint import EYE_HEIGHT, _lowest_ceiling, longest_free_direction
from home_mjx.houses import bakes, house_cache, load_bank
from home_mjx.houses.house_set import HouseSet
from home_mjx.raycast_render.shaders import base
from home_mjx.schema.compiled import RoomTable
from home_mjx.viewer.pictures.pictures import colour_ids
from home_mjx.viewer.pictures.storey_maps import reduce_rays

RECORD = ["case", "value", "unit", "num_envs", "device", "versions", "compile_seconds", "peer", "peer_value", "ratio"]


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("houses")
    generate_flats(root, range(2))
    return root


def test_generate_writes_what_inspect_counts(tmp_path: Path, capsys: pytest.CaptureFixture):
    assert main(["generate", str(tmp_path / "new"), "--seeds", "5:7", "--preset", "flat"]) == 0
    written = sorted(path.parent.name for path in (tmp_path / "new").glob("house/*/house.json"))
    assert len(written) == 2
    capsys.readouterr()
    assert main(["inspect", written[1], "--dataset", str(tmp_path / "new"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    house = json.loads((tmp_path / "new" / "house" / written[1] / "house.json").read_text())
    nodes = [node["type"] for level in house["levels"] for node in level["nodes"]]
    assert found["id"] == written[1]
    assert found["counts"]["rooms"] == nodes.count("Room") >= 3
    assert found["counts"]["objects"] == nodes.count("Object") + nodes.count("Box") >= 12
    assert found["problems"] == []


def test_inspect_counts_of_the_real_house(suncg_root: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", "--dataset", str(suncg_root), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    counts = found["counts"]
    assert len(found["stuck"]) == counts["movable_but_stuck"] > 0
    assert found["bytes"]["house"] > found["bytes"]["fields"] > 100_000
    assert main(["inspect", "--dataset", str(suncg_root)]) == 0
    listed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("stuck: ")]
    assert [int(line.split()[2]) for line in listed] == found["stuck"]
    wanted = {"levels": 1, "rooms": 4, "objects": 43, "architecture parts": 12, "triangles": 102_150}
    assert {name.replace("_", " "): counts[name] for name in counts if name.replace("_", " ") in wanted} == wanted


def test_inspect_prints_a_table(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", "--dataset", str(houses)]) == 0
    rows = [line.rsplit(maxsplit=1) for line in capsys.readouterr().out.splitlines()[2:]]
    assert [name for name, _ in rows if name in ("rooms", "objects")] == ["rooms", "objects"]


def test_inspect_tells_bytes_per_house_and_per_model(houses: Path, capsys: pytest.CaptureFixture):

    assert main(["inspect", str(houses), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    bank = load_bank(houses)
    assert found["counts"]["houses"] == bank.num_houses == 2
    geometry = bank.geometry
    stored = sum(getattr(geometry, name).nbytes for name in ("triangle", "triangle_uv", "node_box"))
    assert 0.5 * stored < found["counts"]["bytes_of_models"] < 1.5 * stored
    assert main(["inspect", "--dataset", str(houses), "--json"]) == 0
    one = json.loads(capsys.readouterr().out)["bytes"]
    assert one["house"] > 100_000
    assert all(found["bytes"]["models"][key] == size for key, size in one["models"].items())


def test_semantics_of_a_root_asks_for_a_house(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", str(houses), "--semantics"]) == 2
    assert f"Pass one of its houses: HOUSE --dataset {houses}" in capsys.readouterr().err


def test_a_folder_named_as_a_house_is_not_a_dataset(
    houses: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    house = sorted(path.name for path in (houses / "house").iterdir())[1]
    (tmp_path / house).mkdir()
    monkeypatch.chdir(tmp_path)
    assert main(["inspect", house, "--dataset", str(houses), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["id"] == house


def test_unknown_house_is_one_message(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", "nowhere", "--dataset", str(houses)]) == 2
    assert "unknown house `nowhere`" in capsys.readouterr().err


def test_compiled_mjcf_opens_in_mujoco(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    import mujoco

    house = sorted(path.name for path in (houses / "house").iterdir())[0]
    assert main(["compile", house, "--dataset", str(houses), "--mjcf", str(tmp_path)]) == 0
    path = Path(capsys.readouterr().out.splitlines()[0])
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 10)
    assert np.isfinite(data.qpos).all()
    assert model.nmesh > 0


COMMANDS = {
    "inspect": ["--json"],
    "compile": ["--mjcf", "OUT"],
    "render": ["--size", "4", "4", "--out", "OUT"],
    "listen": ["--out", "OUT"],
}


@dataclass(frozen=True)
class Area:
    """Record of the bake below."""

    floors: np.ndarray


class FloorAreas:
    """A bake that counts its records."""

    name, version, options, record, unused = "floor_areas", 1, None, Area, frozenset()
    made: ClassVar[list[str]] = []

    def bake_house(self, bank, index, house):
        self.made.append(house.id)
        return Area(np.ones(1, np.float32))

    def stack(self, records, houses, bank):
        return np.stack([record.floors for record in records])


def test_compile_bakes_every_house_that_did_not_fail_last(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(bakes, "_REGISTRY", {**bakes._REGISTRY, "floor_areas": FloorAreas})
    ids, report = HouseSet(houses).house_ids, tmp_path / "report.jsonl"
    report.write_text(json.dumps({"id": ids[0], "status": "failed"}) + "\n")
    assert main(["compile", str(houses), "--resume", "--report", str(report), "--bakes", "floor_areas"]) == 0
    assert FloorAreas.made == list(ids)
    assert "floor_areas of 2 houses baked" in capsys.readouterr().out


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_take_a_compiled_house_from_the_cache(
    command: str, houses: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (house, _) = HouseSet(houses, num_houses=2).house_ids
    HouseSet(houses, ids=(house,)).load()
    monkeypatch.setattr(house_cache, "compile_house", lambda *_: pytest.fail("compiled"))
    options = [str(tmp_path) if word == "OUT" else word for word in COMMANDS[command]]
    assert main([command, house, "--dataset", str(houses), *options]) == 0


def test_the_old_name_of_the_dataset_works_but_is_not_shown(houses: Path, capsys: pytest.CaptureFixture):
    shown = []
    for option in ("--dataset", "--suncg"):
        assert main(["inspect", option, str(houses), "--json"]) == 0
        shown.append(capsys.readouterr().out)
    assert shown[0] == shown[1]
    assert main(["inspect", "--sunc", str(houses)]) == 2
    assert "--suncg" not in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["inspect", "--help"])
    text = capsys.readouterr().out
    assert "--dataset ROOT" in text
    assert "suncg" not in text


def test_render_writes_pictures(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    assert main(["render", "--dataset", str(houses), "--size", "32", "24", "--out", str(tmp_path)]) == 0
    images = {line.rsplit("/")[-1]: np.asarray(Image.open(line)) for line in capsys.readouterr().out.splitlines()}
    assert {image.shape for image in images.values()} == {(24, 32, 3)}
    assert images["rgb.png"].std() > 5
    assert len(np.unique(images["depth.png"].reshape(-1, 3), axis=0)) > 20
    assert len(np.unique(images["instance.png"].reshape(-1, 3), axis=0)) >= 2


SHADER_FILE = """
from dataclasses import dataclass
import jax.numpy as jnp
from home_mjx.raycast_render import Shader, Vec, register_shader

@register_shader
@dataclass(frozen=True)
class White(Shader):
    name = "white_of_a_user"

    def radiance(self, scene, rays):
        return Vec(*[jnp.ones_like(rays.hit.t)] * 3)
"""


def test_render_takes_a_shader_of_a_users_file(houses: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    monkeypatch.setattr(base, "_REGISTRY", dict(base._REGISTRY))
    (tmp_path / "user_shader_file.py").write_text(SHADER_FILE)
    monkeypatch.syspath_prepend(tmp_path)
    options = ["render", "--dataset", str(houses), "--size", "8", "6", "--out", str(tmp_path), "--shader"]
    assert main([*options, "white_of_a_use"]) == 2
    assert "unknown shader `white_of_a_use`" in capsys.readouterr().err
    assert main([*options, "white_of_a_user", "--import", "user_shader_file"]) == 0
    assert (np.asarray(Image.open(tmp_path / "rgb.png")) == 255).all()


@pytest.mark.parametrize(("pitch", "colour"), [("-90", [127, 127, 255]), ("90", [127, 127, 0])])
def test_pitch_turns_the_view_down_to_the_floor_and_up_to_the_ceiling(
    pitch: str, colour: list[int], houses: Path, tmp_path: Path
):
    options = ["--pitch", pitch, "--size", "9", "9", "--fovy", "10", "--out", str(tmp_path)]
    assert main(["render", "--dataset", str(houses), *options]) == 0
    normals = np.asarray(Image.open(tmp_path / "normal.png")).reshape(-1, 3)
    np.testing.assert_allclose(np.median(normals, axis=0), colour, atol=1)


def test_top_shows_every_room_where_the_navigation_grid_has_it(houses: Path, tmp_path: Path):
    width, height = 160, 120
    size = ["--size", str(width), str(height)]
    assert main(["render", "--dataset", str(houses), "--top", *size, "--out", str(tmp_path)]) == 0
    (house,) = HouseSet(houses, num_houses=1).load()
    corners = np.concatenate(house.rooms.polygon)
    low, high = corners.min(0), corners.max(0)
    fovy = max(high[1] - low[1], (high[0] - low[0]) * height / width) + 2 * STOREY_MARGIN
    rows, columns = np.nonzero(house.navigation.region[0] >= 0)
    points = house.navigation.origin + (np.stack([columns, rows], -1) + 0.5) * house.navigation.cell
    x, y = ((points - (low + high) / 2) * height / fovy).T
    seen = np.asarray(Image.open(tmp_path / "room.png"))[(height / 2 - y).astype(int), (width / 2 + x).astype(int)]
    wanted = colour_ids(house.navigation.room[0][rows, columns][None].astype(int))[0]
    assert (seen == wanted).all(-1).mean() > 0.97  # a door's leaf may hang over the next room


def test_cut_walls_are_dark_in_the_plan(houses: Path, tmp_path: Path):
    assert main(["render", "--dataset", str(houses), "--top", "--size", "320", "240", "--out", str(tmp_path)]) == 0
    dark = (np.asarray(Image.open(tmp_path / "rgb.png")) == CUT_WALL_GREY).all(-1)
    assert dark.any(axis=0).sum() > 0.9 * np.ptp(np.flatnonzero(dark.any(axis=0)))  # outer walls run all around
    assert 0.01 < dark.mean() < 0.15


@pytest.mark.parametrize("options", [["--at", "0", "0"], ["--pitch", "0"], ["--lens", "cube"]])
def test_a_plan_leaves_no_choice_of_the_camera(options: list[str], houses: Path, tmp_path: Path, capsys):
    assert main(["render", "--dataset", str(houses), "--out", str(tmp_path), "--top", *options]) == 2
    assert f"{options[0]} cannot be combined with --top" in capsys.readouterr().err


def test_a_storey_that_is_not_there_is_refused(houses: Path, tmp_path: Path, capsys):
    assert main(["render", "--dataset", str(houses), "--out", str(tmp_path), "--top", "1"]) == 2
    assert "--top 1: the house has 1 storey. Pass 0 to 0" in capsys.readouterr().err


def test_a_terrace_does_not_lower_the_camera_of_a_plan():
    """What is outdoors ends where its floor is."""
    floor, ceiling = np.array([0.05, 0.05, 2.85]), np.array([2.69, 0.05, 5.5])
    rooms = RoomTable(np.zeros(3, int), np.zeros(3, int), (np.zeros((3, 2)),) * 3, floor, ceiling, np.zeros(3, int))
    assert _lowest_ceiling(rooms, np.array([0, 1])) == pytest.approx(2.69)
    assert _lowest_ceiling(rooms, np.array([0, 1, 2])) == pytest.approx(2.69)
    assert 1 < _lowest_ceiling(rooms, np.array([1])) < 2


def test_listen_hears_the_source_after_its_delay(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    bank = load_bank(houses, num_houses=1)
    feet = np.asarray(bank.navigation.start[0, 0])
    yaw = longest_free_direction(bank, feet)  # so that nothing stands between head and source
    source = np.add(feet, [np.cos(yaw), np.sin(yaw), EYE_HEIGHT])
    where = ["--source", *map(str, source)]
    assert main(["listen", "--dataset", str(houses), "--out", str(tmp_path), "--clip", "tone", *where]) == 0
    printed = capsys.readouterr().out
    metres = float(printed.split(": ")[-1].split()[0])
    assert printed.split("octave [Hz]")[1].split()[:7] == ["125", "250", "500", "1000", "2000", "4000", "8000"]
    table = {line.split()[0]: np.array(line.split()[-7:]) for line in printed.splitlines() if len(line.split()) >= 8}
    assert {"T20", "T30", "EDT", "C50", "C80", "D50", "Ts", "DRR", "G", "IACC", "LF"} <= set(table)
    sound = np.array([table[name].astype(float) for name in ("T30", "EDT", "D50", "IACC", "LF")])
    assert np.all((sound > 0) & (sound < [[3], [3], [1], [1], [1]]))
    assert np.all(table["T30"].astype(float)[3:6] > 0.1)
    with wave.open(str(tmp_path / "response.wav")) as file:
        assert (file.getnchannels(), file.getframerate()) == (2, 16000)
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2").reshape(-1, 2)
    first = np.argmax(np.abs(samples).max(1) > 0.1 * 32767)  # the direct sound; band-limited, so it swells up
    assert abs(first / 16000 * 343.2 - metres) < 0.3  # the head is 0.09 m in radius
    assert (tmp_path / "heard.wav").stat().st_size > 2 * 2 * 16000


@pytest.mark.slow
def test_listen_draws_level_and_decay_over_the_floor(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """In many shades, and of the same rooms."""
    assert main(["listen", "--dataset", str(houses), "--out", str(tmp_path), "--map"]) == 0
    printed = capsys.readouterr().out
    shapes = []
    for name in ("level", "t30"):
        assert f"{name}.png" in printed
        picture = np.asarray(Image.open(tmp_path / f"{name}.png")).astype(int)
        shapes.append(picture.shape)
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 10
    assert shapes[0] == shapes[1]


def test_the_map_has_as_many_rays_of_each_octave_as_if_one_carried_all():
    """A survey's rays carry one octave each; with as few of each as their share, far rooms heard nothing."""
    shared = replace(SURVEY_CONFIG, late=replace(SURVEY_CONFIG.traced, octave_rays=False))
    assert reduce_rays(SURVEY_CONFIG).traced.num_rays == 7 * reduce_rays(shared).traced.num_rays
    assert reduce_rays(SURVEY_CONFIG).traced.num_rays < SURVEY_CONFIG.traced.num_rays


def test_places_outside_of_the_house_are_refused(houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    where = ["--dataset", str(houses), "--out", str(tmp_path)]
    assert main(["render", *where, "--at", "1000", "1000"]) == 2
    assert "--at 1000 1000 is outside of the house. X is " in capsys.readouterr().err
    assert main(["listen", *where, "--source", "1000", "0", "1"]) == 2
    assert "--source 1000 0 is outside of the house. X is " in capsys.readouterr().err
    physics = HouseBank.from_compiled([HouseSet(houses).load()[0]]).physics
    walls = np.flatnonzero(
        (np.asarray(physics.collider_object[0]) < 0) & (np.asarray(physics.collider_size[0, :, 2]) > 1)
    )
    middle = [f"{x:.3f}" for x in np.asarray(physics.collider_pos[0])[walls[len(walls) // 2]]]
    assert main(["listen", *where, "--source", *middle]) == 2
    assert "is in a wall, or not above the floor of a room. The result would be silent." in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_bench_prints_json_lines(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["bench", "load", "--json", "--dataset", str(houses), "--houses", "2"]) == 0
    (record,) = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [*RECORD, "note"] == list(record)
    assert (record["case"], record["unit"]) == ("load/houses", "houses/s")
    assert 0 < record["value"] < 1e4
    assert record["note"].startswith("2 houses of")


def test_bench_of_rays_names_batch_and_compile_time(houses: Path, capsys: pytest.CaptureFixture):
    args = ["--json", "--dataset", str(houses), "--houses", "2", "--envs", "2", "--seconds", "1"]
    assert main(["bench", "rays/primary-depth", *args]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["num_envs"] == 2
    assert record["compile_seconds"] > 0
    assert record["value"] > 1e4
    assert record["peer"].startswith("Embree")
    assert record["ratio"] == pytest.approx(record["value"] / record["peer_value"])


@pytest.mark.slow
def test_bench_of_all_sensors_bakes_the_houses_of_a_dataset(houses: Path, capsys: pytest.CaptureFixture):
    args = ["--json", "--dataset", str(houses), "--houses", "1", "--envs", "2", "--seconds", "1"]
    assert main(["bench", "env/all-sensors", *args]) == 0
    assert json.loads(capsys.readouterr().out)["value"] > 1


@pytest.mark.slow
def test_streams_of_a_dataset_of_one_house_are_measured_on_generated_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture
):
    generate_flats(tmp_path, range(1))
    args = ["--json", "--dataset", str(tmp_path), "--houses", "2", "--envs", "2", "--seconds", "1"]
    assert main(["bench", "compile/stream", *args]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["value"] > 0
    assert "generated houses" in record["note"]


def test_max_bodies_limits_what_can_move_and_says_how_much_is_left(houses: Path, tmp_path: Path, capsys):
    assert main(["inspect", "--dataset", str(houses), "--json"]) == 0
    usual = json.loads(capsys.readouterr().out)["counts"]
    assert usual["movable_but_too_many"] == 0
    assert main(["inspect", "--dataset", str(houses), "--json", "--max-bodies", "3"]) == 0
    few = json.loads(capsys.readouterr().out)["counts"]
    assert few["bodies"] <= 3
    assert few["movable_but_too_many"] == usual["bodies"] - 3
    house = next((houses / "house").iterdir()).name
    assert main(["compile", house, "--dataset", str(houses), "--mjcf", str(tmp_path), "--max-bodies", "0"]) == 0
    assert "movable objects are fixed" in capsys.readouterr().out
    assert main(["inspect", "--dataset", str(houses), "--max-bodies", "-1"]) != 0
