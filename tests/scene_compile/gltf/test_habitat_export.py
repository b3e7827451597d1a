"""Houses as Habitat datasets, read back by the package's own reader."""

import json
from pathlib import Path

import numpy as np
import pytest
from habitat_files import write, write_dataset

from home_mjx.cli import main
from home_mjx.datasets import ReadOptions, open_dataset
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.gltf.habitat_export import export_habitat
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.semantic import Semantic

DOOR = """<robot name="door"><link name="frame"/>
<joint name="hinge" type="revolute"><origin xyz="4 0 1.52"/><parent link="frame"/><child link="leaf"/>
<axis xyz="0 1 0"/><limit lower="-1.5" upper="0" effort="1" velocity="1"/></joint>
<link name="leaf"><visual><origin xyz="0 1.03 0.43"/><geometry><box size="0.04 2.04 0.86"/></geometry></visual></link>
</robot>"""


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def compiled(path: Path) -> CompiledHouse:
    dataset = open_dataset(path)
    return compile_house(dataset.load_house(dataset.house_ids[0], ReadOptions(strict=None)), dataset.metadata)


@pytest.fixture
def source(tmp_path) -> Path:
    """Two rooms with a door that is open by 0.5 rad, a chair, a mirrored chair, and a cupboard."""
    doors = [{"template_name": "room_door", "initial_joint_pose": [-0.5]}]
    cupboard = [{"template_name": "cupboard", "translation": [6, 0, 0.3]}]
    chairs = [{"template_name": "chair_1", "translation": [2, 0.45, 1]}]
    chairs += [{"template_name": "chair_1", "translation": [6, 0.45, 3], "non_uniform_scale": [-1, 1, 1.5]}]
    config = write_dataset(tmp_path / "in", articulated_object_instances=doors + cupboard, object_instances=chairs)
    write(tmp_path / "in" / "urdf" / "room_door" / "room_door.urdf", DOOR)
    return config


def boxes(house: CompiledHouse, offset: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return the category and the box of each instance of a known category, sorted, in the frame of its file."""
    found = []
    for instance, key in enumerate(house.instances.model):
        fine = int(house.semantics[house.instances.semantic[instance], Semantic.FINE])
        if fine >= 0 and FINE[fine] != "unknown":  # pieces of the stage are cut anew
            pose = house.instances.pose[instance]
            points = house.models[key].triangle.astype(float).reshape(-1, 3) @ pose[:, :3].T + pose[:, 3] - offset
            found.append((FINE[fine], np.array([points.min(axis=0), points.max(axis=0)])))
    return sorted(found, key=lambda one: (one[0], one[1].round(2).tolist()))


def test_rooms_objects_and_doors_are_read_back_within_a_millimetre(source, tmp_path):
    before = compiled(source)
    after = compiled(export_habitat(before, tmp_path / "out").parent)
    assert np.array_equal(before.rooms.type, after.rooms.type)
    assert before.rooms.ceiling == pytest.approx(after.rooms.ceiling, abs=1e-3)
    old, new = boxes(before, np.zeros(3)), boxes(after, after.offset)
    assert [fine for fine, _ in old] == [fine for fine, _ in new]
    assert "door" in {fine for fine, _ in old}
    assert max(abs(a - b).max() for (_, a), (_, b) in zip(old, new, strict=True)) < 1e-3
    shift = after.offset[:2]
    assert len(before.doors.instance) == len(after.doors.instance) == 1
    assert before.doors.pivot == pytest.approx(after.doors.pivot - shift, abs=1e-3)
    for name in ("low", "high", "closed", "fully_open"):
        assert getattr(before.doors, name) == pytest.approx(getattr(after.doors, name), abs=1e-6), name
    assert before.doors.closed == pytest.approx([0.5], abs=1e-6)
    area = [sum(np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1).sum() for t in world(house))
            for house in (before, after)]  # fmt: skip
    assert area[0] == pytest.approx(area[1], rel=1e-4)


def world(house: CompiledHouse) -> list[np.ndarray]:
    rows = zip(house.instances.model, house.instances.pose, strict=True)
    return [house.models[m].triangle.astype(float) @ pose[:, :3].T + pose[:, 3] for m, pose in rows]


def test_houses_share_a_folder_and_the_command_names_the_configuration(source, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["export", "flat_0", str(out), "--format", "habitat", "--dataset", str(source)]) == 0
    assert capsys.readouterr().out.strip() == str(out / "home_mjx.scene_dataset_config.json")
    scene = json.loads((out / "scenes" / "flat_0.scene_instance.json").read_text())
    assert {one["motion_type"] for one in scene["object_instances"]} <= {"STATIC", "DYNAMIC"}
    write(out / "scenes" / "other.scene_instance.json", scene)
    assert open_dataset(out).house_ids == ("flat_0", "other")
    with pytest.raises(ConfigError, match="this is a file"):
        export_habitat(compiled(source), source)


@pytest.mark.slow
def test_a_generated_home_is_read_back_within_a_millimetre(tmp_path):
    dataset = open_dataset("procedural:1?seed=3&preset=flat")
    (house_id,) = dataset.house_ids
    before = compile_house(dataset.load_house(house_id), dataset.metadata)
    after = compiled(export_habitat(before, tmp_path).parent)
    assert np.array_equal(before.rooms.type, after.rooms.type)
    old, new = boxes(before, np.zeros(3)), boxes(after, after.offset)
    for fine, box in old:
        assert min(abs(box - other).max() for kind, other in new if kind == fine) < 1e-3, fine
    assert before.doors.pivot == pytest.approx(after.doors.pivot - after.offset[:2], abs=1e-3)
