"""Houses of 3D-FRONT: two rooms written by the format's description, since its terms forbid to share any."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import BOXES, CUBE

from home_mjx.datasets import ReadOptions, open_dataset
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.polygons import polygon_area
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.house import House

CHAIR = "v -.25 0 -.2\nv .25 0 -.2\nv .25 .9 .2\nv -.25 0 .2\nvt 0 0\no solid_001\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\n"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def mesh(uid: str, kind: str, triangles: np.ndarray) -> dict[str, Any]:
    """Return a mesh of flat lists."""
    flat = np.reshape(triangles, (-1, 3))
    faces = list(range(len(flat)))
    return {"uid": uid, "type": kind, "xyz": flat.ravel().tolist(), "faces": faces, "uv": [], "material": "m"}


def rectangle(x0: float, x1: float, height: float) -> np.ndarray:
    a, b, c, d = ([x, height, z] for x, z in ((x0, 0), (x0, 4), (x1, 4), (x1, 0)))
    return np.array([[a, b, c], [a, c, d]])


def flat(**changes: Any) -> dict[str, Any]:
    """Return two rooms of 4 x 4 m with walls between them, a chair that is valid, one that is not, and a huge one."""
    walls = [name for name in BOXES if name not in ("slab", "top", "Dining_Table.001", "chair")]
    solids = {name: np.array(BOXES[name][0]) + CUBE * np.subtract(BOXES[name][1], BOXES[name][0]) for name in walls}
    meshes = [mesh(name, "WallInner", triangles) for name, triangles in solids.items()]
    meshes += [mesh("floor1", "Floor", rectangle(0, 4, 0)), mesh("floor2", "Floor", rectangle(4, 8, 0)[:, ::-1])]
    meshes += [mesh("top", "Ceiling", rectangle(0, 8, 2.6)[:, ::-1]), mesh("door", "Door", rectangle(3.9, 4.1, 1))]
    chair = {"valid": True, "jid": "abc", "category": "Dining Chair", "size": [0.5, 0.9, 0.4]}
    furniture = [{"uid": "c1", **chair}, {"uid": "c2", **chair, "valid": False}, {"uid": "c3", **chair}]
    turned = {"pos": [1, 0, 2], "rot": [0, 0.5**0.5, 0, 0.5**0.5], "scale": [2, 1, 1]}
    first = [{"ref": name, "pos": [0, 0, 0]} for name in (*walls, "floor1", "top", "door")]
    first += [{"ref": "c1", **turned}, {"ref": "c2", **turned}, {"ref": "c3", **turned, "scale": [0, 1, 1]}]
    second = [{"ref": "floor2"}, {"ref": "c3", "scale": [99, 1, 1]}]
    rooms = [
        {"type": "MasterBedroom", "instanceid": "a", "children": first},
        {"type": "KidsRoom", "instanceid": "b", "children": second},
        {"type": "Balcony", "instanceid": "c", "children": []},
    ]
    material = [{"uid": "m", "color": [255, 0, 51, 255], "texture": "https://host/a.jpg"}]
    return {
        "uid": "x",
        "furniture": furniture,
        "mesh": meshes,
        "material": material,
        "scene": {"room": rooms},
    } | changes


def read(folder: Path, content: Any, **options: bool) -> House:
    folder.mkdir(exist_ok=True)
    (folder / "flat.json").write_text(json.dumps(content))
    return open_dataset(f"front:{folder}").load_house("flat", ReadOptions(**options))


def chairs(house: House) -> list:
    return [o for o in house.levels[0].objects if o.model_id == "chair"]


def test_rooms_come_from_floors_and_furniture_is_scaled_turned_and_moved(tmp_path):
    house = read(tmp_path / "3D-FRONT", flat())
    rooms = house.levels[0].rooms
    assert [room.types for room in rooms] == [("Bedroom",), ("Child_Room",)]
    assert [polygon_area(room.shape.corners) for room in rooms] == pytest.approx([16, 16])
    assert [room.shape.ceiling for room in rooms] == pytest.approx([2.6, 2.6])
    assert rooms[0].walls.materials[0].diffuse == pytest.approx((1, 0, 0.2))
    (chair,) = chairs(house)
    points = house.models[chair.model_key].vertices @ chair.transform[:3, :3].T + chair.transform[:3, 3]
    low, high = points.min(axis=0), points.max(axis=0)
    assert [low, high] == [pytest.approx([0.8, 0, 1.5], abs=1e-6), pytest.approx([1.2, 0.9, 2.5], abs=1e-6)]
    assert [fallback.name for fallback in house.fallbacks] == ["abc", "abc"]  # the second is larger than the house
    notes = " ".join(problem.message for problem in house.problems)
    for part in (
        "not positive",
        "larger than the house",
        "1 pieces are not marked",
        "no floor",
        "`Door` are left out",
        "1 instances name no",
    ):
        assert part in notes


def test_agents_walk_from_room_to_room(tmp_path):
    house = read(tmp_path / "3D-FRONT", flat())
    compiled = compile_house(house, open_dataset(f"front:{tmp_path / '3D-FRONT'}").metadata)
    assert set(np.unique(compiled.navigation.room[0][compiled.navigation.region[0] == 0])) == {0, 1}


def test_models_of_3d_future_are_read_beside_the_houses_or_refused(tmp_path):
    with pytest.raises(MissingFileError, match=r"model `abc` is missing.*children\[10\]"):
        read(tmp_path / "3D-FRONT", flat(), strict=True)
    folder = tmp_path / "3D-FUTURE-model" / "abc"
    folder.mkdir(parents=True)
    (folder / "raw_model.obj").write_text(CHAIR)
    house = read(tmp_path / "3D-FRONT", flat())
    (chair,) = chairs(house)
    assert (len(house.models[chair.model_key].faces), house.fallbacks) == (2, ())
    dataset = open_dataset(tmp_path / "3D-FRONT")  # recognized by its content
    before = dataset.inputs().house("flat")
    (folder / "raw_model.obj").write_text(CHAIR + "# changed\n")
    assert dataset.inputs().house("flat") != before


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mesh": [{"uid": "a", "xyz": [0, 1], "faces": []}]}, r"expected a list of 3 numbers.*mesh\[0\].xyz"),
        ({"mesh": [{"uid": "a", "xyz": [0, 1, float("nan")], "faces": []}]}, "finite"),
        ({"mesh": [{"uid": "a", "xyz": [0, 1, 2], "faces": [0, 0, 1]}]}, "indices of the 1 corners"),
        ({"scene": {"room": [{"children": [{"ref": "a", "rot": [0] * 4}]}]}}, "quaternion has no length"),
        ({"furniture": [{"uid": "a", "valid": True, "jid": "../../etc"}]}, "not a plain name"),
        ({"scene": {"room": []}}, "no room with a floor"),
        ({"scene": []}, "expected an object"),
    ],
)
def test_broken_houses_are_refused_at_their_elements(tmp_path, change, message):
    with pytest.raises(DatasetError, match=message):
        read(tmp_path, flat(**change))
