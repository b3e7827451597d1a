"""The reader against the real SUNCG house: reference counts, trimesh, and the boxes that the file itself states."""

import time
import warnings

import numpy as np
import pytest
import trimesh

from home_mjx.datasets.registry import open_dataset
from home_mjx.schema.categories import texture_family
from home_mjx.schema.material_kinds import HOME_TEXTURE_KINDS

pytestmark = pytest.mark.real
TRIANGLES = {  # per OBJ, counted in the original files
    "67": 1126, "77": 3872, "81": 3292, "83": 2752, "87": 2236, "109": 592, "122": 1588, "122_0": 1582, "126": 736,
    "135": 4306, "144": 220, "150": 2708, "174": 1610, "203": 7932, "209": 1432, "210": 2128, "261": 16124,
    "274": 1828, "317": 1344, "352": 4534, "365": 300, "441": 4148, "456": 540, "478": 3628, "499": 1056, "502": 1416,
    "561": 1696, "625": 1036, "656": 456, "s__1296": 932,
}  # fmt: skip


@pytest.fixture(scope="module")
def dataset(suncg_root):
    return open_dataset(suncg_root)


@pytest.fixture(scope="module")
def house(dataset):
    return dataset.load_house(dataset.house_ids[0])


def architecture(house):
    return [part for level in house.levels for room in level.rooms for part in (room.floor, room.ceiling, room.walls)]


def objects(house):
    return [item for level in house.levels for item in level.objects]


def test_counts_equal_the_reference(house):
    parts = [part for part in architecture(house) if part is not None]
    assert (len(house.levels), len(house.levels[0].rooms), len(objects(house)), len(parts)) == (1, 4, 43, 12)
    assert sum(len(part.faces) for part in parts) == 1_768
    assert sum(len(house.models[item.model_key].faces) for item in objects(house)) == 100_308
    assert len(house.models) == 28
    assert house.problems == ()


def test_rooms_equal_the_reference(house):
    rooms = house.levels[0].rooms
    assert [room.types for room in rooms] == [("Storage",), (), ("Bedroom",), ("Room",)]
    assert [len(room.members) for room in rooms] == [8, 18, 11, 3]
    assert [item.index for item in objects(house) if item.is_mirrored] == [17]
    names = [name for room in rooms for part in (room.floor, room.walls) for name in part.groups]
    assert {"Floor#0_3", "WallInside#0_1_5", "WallOutside#0_3_1"} <= set(names)


def test_every_model_has_its_reference_triangles(dataset):
    counts = {key: len(dataset.load_model(key).faces) for key in TRIANGLES}
    assert counts == TRIANGLES
    assert sum(counts.values()) == 77_150


def test_house_loads_cold_within_two_seconds(suncg_root):
    start = time.process_time()
    fresh = open_dataset(suncg_root)
    fresh.load_house(fresh.house_ids[0])
    assert time.process_time() - start < 2.0


def soup(triangles):
    """Triangles in a canonical order: each starts at its least vertex, which keeps the winding."""
    keys = np.round(triangles, 7)
    first = np.array([np.lexsort(tri.T[::-1])[0] for tri in keys])
    turned = np.stack([keys[np.arange(len(keys)), (first + k) % 3] for k in range(3)], axis=1).reshape(-1, 9)
    return turned[np.lexsort(turned.T[::-1])]


def test_geometry_equals_trimesh(dataset, house):
    meshes = [dataset.load_model(key) for key in TRIANGLES] + architecture(house)
    for mesh in meshes:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # trimesh takes the median of an empty slice
            oracle = trimesh.load_mesh(mesh.path, process=False, skip_materials=True, split_object=False)
        np.testing.assert_array_equal(soup(mesh.vertices[mesh.faces]), soup(oracle.triangles), err_msg=str(mesh.path))
        area = trimesh.triangles.area(mesh.vertices[mesh.faces]).sum()
        assert area == pytest.approx(oracle.area, rel=1e-12)


def test_transformed_models_fill_the_boxes_of_the_file(dataset, house):
    """SUNCG computed them from the base model, whatever the state."""
    for item in objects(house):
        vertices = dataset.load_model(item.model_id).vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
        box = np.stack([vertices.min(0), vertices.max(0)])
        np.testing.assert_allclose(box, item.bbox, rtol=0, atol=1e-3, err_msg=item.path)


def test_rooms_lie_in_the_boxes_of_the_file(house):
    for room in house.levels[0].rooms:
        vertices = np.concatenate([part.vertices for part in (room.floor, room.ceiling, room.walls)])
        assert (vertices.min(0) > room.bbox[0] - 1e-3).all()
        assert (vertices.max(0) < room.bbox[1] + 1e-3).all()


def test_bounds_of_models_equal_the_table(dataset, house):
    for key, mesh in house.models.items():
        dims = dataset.metadata.info(key).dims
        np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), dims, rtol=0, atol=1e-3, err_msg=key)


def test_every_texture_is_there_and_has_a_known_family(dataset, house):
    meshes = [*house.models.values(), *architecture(house), dataset.load_model("s__1296")]
    owners = [mesh.materials for mesh in meshes] + [item.materials for item in objects(house)]
    paths = {material.texture for materials in owners for material in materials if material.texture}
    assert paths == set((dataset.root / "texture").iterdir())
    assert len(paths) == 27
    families = {texture_family(path.stem) for path in paths}
    assert {"wood", "textile", "wallp", "laminate", "bricks", "stone", "linen"} <= families & set(HOME_TEXTURE_KINDS)


def test_overrides_of_this_house_repeat_the_models_own_textures(house):
    """So the positional rule can be checked without an oracle: name by name, override and MTL agree."""
    overrides = [
        (override.texture, slot.texture, item.path)
        for item in objects(house)
        for override, slot in zip(item.materials, house.models[item.model_key].materials, strict=False)
        if override.texture
    ]
    assert len(overrides) == 50
    assert [path for ours, theirs, path in overrides if ours != theirs] == []


def test_slots_are_the_runs_of_usemtl(dataset):
    """The sum of triangles by material name, counted line by line."""
    for key in ("122", "135", "352"):
        mesh = dataset.load_model(key)
        counts, name = dict.fromkeys((m.name for m in mesh.materials), 0), ""
        for line in mesh.path.read_text().splitlines():
            if line.startswith("usemtl"):
                name = line.split()[1]
            elif line.startswith("f "):
                counts[name] += len(line.split()) - 3
        assert np.bincount(mesh.slot, minlength=len(mesh.materials)).tolist() == list(counts.values())


def test_models_are_parsed_once(dataset):
    first, second = (dataset.load_house(dataset.house_ids[0]) for _ in range(2))
    assert all(first.models[key] is second.models[key] for key in first.models)
    assert first.levels[0].rooms[0].walls is not second.levels[0].rooms[0].walls
