"""Scenes as houses: rooms, objects, the room file, and depth against Embree on the triangles of the file."""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gltf_files import CUBE, GltfFile, read_scene, scan_of_two_rooms, triangles_of, two_rooms
from PIL import Image
from png_files import encoded

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.datasets import ReadOptions, open_dataset
from home_mjx.datasets.gltf.categories import category_metadata, category_words
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownIdError
from home_mjx.geometry.polygons import polygon_area
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.categories import COARSE, FINE, NYU40


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def flat(tmp_path) -> Path:
    return two_rooms().write(tmp_path / "flat.glb")


def compiled(name):
    dataset = open_dataset(name)
    return compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)


def test_rooms_are_found_on_both_sides_of_a_doorway(flat):
    """Each is 3.95 m x 4 m between its walls, and reaches up to 0.15 m into them."""
    house = open_dataset(flat).load_house("flat")
    (level,) = house.levels
    assert len(level.rooms) == 2
    for room in level.rooms:
        low, high = room.shape.corners.min(axis=0), room.shape.corners.max(axis=0)
        left = 0 if low[0] < 2 else 4
        assert np.allclose([low, high], [[left, 0], [left + 4, 4]], atol=0.16)
        assert (room.shape.floor, room.shape.ceiling) == (pytest.approx(0), pytest.approx(2.6))
        assert polygon_area(room.shape.corners) == pytest.approx(16.6, abs=0.8)
        assert room.walls.part.max() == 3
    assert sorted(o.model_id for o in level.objects if o.model_id != "structure") == ["chair", "dining_table"]


def test_agents_walk_through_the_doorway(flat):
    house = compiled(flat)
    rooms = house.navigation.room[0][house.navigation.region[0] == 0]
    assert set(np.unique(rooms)) == {0, 1}
    assert house.report["hinged_leaves"] == house.report["problems"] - 1 == 0


def test_no_triangle_is_lost_or_doubled(flat, tmp_path):
    """The area of the compiled house is that of the file, also of floors that are cut along rooms."""
    house = compiled(flat)
    corners = np.concatenate([world(house, row) for row in range(len(house.instances.model))])
    expected = triangles_of(read_scene(flat, tmp_path)[0])
    assert area(corners) == pytest.approx(area(expected), rel=1e-5)


def world(house, row):
    pose = house.instances.pose[row]
    return house.models[house.instances.model[row]].triangle.astype(float) @ pose[:, :3].T + pose[:, 3]


def area(triangles):
    a, b, c = triangles.transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def test_depth_is_that_of_embree_on_the_triangles_of_the_file(flat, tmp_path):
    pytest.importorskip("embreex.rtcore_scene", reason="Embree is not installed")
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    house = compiled(flat)
    rng = np.random.default_rng(0)
    origin = rng.uniform([0.2, 0.2, 0.2], [7.8, 2.4, 3.8], (20_000, 3))
    away = rng.normal(size=origin.shape)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    scene = EmbreeScene()
    TriangleMesh(scene, triangles_of(read_scene(flat, tmp_path)[0]).astype(np.float32))
    expected = scene.run(origin.astype(np.float32), away.astype(np.float32), query="DISTANCE")
    bank = HouseBank.from_compiled([house])
    physics = bank.physics
    agent = jnp.array([[50.0, 0.0, 0.0]]), jnp.array([[1.0, 0.0, 0.0, 0.0]])
    view = make_scene(bank, jnp.int32(0), physics.body_pos[0], physics.body_quat[0], *agent)
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    rays = [jnp.asarray(x, jnp.float32) for x in (origin @ turn.T + house.offset, away @ turn.T)]
    found = np.asarray(jax.jit(cast)(view, *rays).t)
    assert (abs(found - expected) < 1e-3).mean() >= 0.9999


@pytest.mark.parametrize("name", ["KHR_texture_basisu", "EXT_texture_webp"])
def test_images_of_formats_that_are_not_decoded_are_fallbacks_or_strictly_errors(tmp_path, name):
    """One texture has such an image alone, another one a PNG for readers without the extension."""
    file = two_rooms()
    view = file.view(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(64))
    file.add("images", bufferView=view, mimeType="image/ktx2")
    file.add("images", bufferView=file.view(encoded(Image.new("RGB", (2, 2)))), mimeType="image/png")
    extension = {"extensions": {name: {"source": 0}}}
    file.add("textures", **extension)
    file.add("textures", source=1, **extension)
    for texture, color in ((0, [0.5, 0.5, 0.5, 1]), (1, [1, 1, 1, 1])):
        file.add("materials", pbrMetallicRoughness={"baseColorTexture": {"index": texture}, "baseColorFactor": color})
    meshes = {node["name"]: file.json["meshes"][node["mesh"]] for node in file.json["nodes"]}
    for number, node in enumerate(("Dining_Table.001", "chair")):
        meshes[node]["primitives"][0]["material"] = number
    file.json["extensionsRequired"] = [name]
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    house = dataset.load_house("flat")
    (fallback,) = house.fallbacks
    assert (fallback.kind, fallback.element, fallback.replacement) == (
        "texture",
        "textures[0]",
        "the material's colour",
    )
    looks = {o.model_id: house.models[o.model_key].materials[0] for level in house.levels for o in level.objects}
    assert looks["dining_table"].texture is None
    assert looks["dining_table"].diffuse == pytest.approx([0.7354] * 3, abs=1e-3)  # sRGB of 0.5
    assert looks["chair"].texture.suffix == ".png"
    with pytest.raises(DatasetError, match=rf"requires the extension `{name}`.*extensionsRequired\[0\]"):
        dataset.load_house("flat", ReadOptions(strict=True))
    del file.json["extensionsRequired"]
    with pytest.raises(DatasetError, match=r"no PNG or JPEG.*textures\[0\].*gltf-transform"):
        open_dataset(file.write(tmp_path / "flat.glb")).load_house("flat", ReadOptions(strict=True))


def test_a_room_file_states_rooms_units_and_categories(tmp_path):
    """The same flat in centimetres with z up; the file names the rooms, and the table a desk."""
    file = two_rooms()
    for node in file.json["nodes"]:
        node["matrix"] = [100, 0, 0, 0, 0, 0, 100, 0, 0, -100, 0, 0, 0, 0, 0, 1]  # (x, y, z) to (x, -z, y)
    path = file.write(tmp_path / "plan.glb")
    rooms = [
        {"type": "Kitchen", "corners": [[0, 0], [4, 0], [4, 4], [0, 4]]},
        {"type": "Office", "corners": [[4, 0], [8, 0], [8, 4], [4, 4]], "ceiling": 2.5},
    ]
    content = {"up": "z", "scale": 0.01, "rooms": rooms, "objects": {"Dining_Table.001": "desk"}}
    path.with_name("plan.rooms.json").write_text(json.dumps(content))
    (level,) = open_dataset(path).load_house("plan").levels
    assert [room.types for room in level.rooms] == [("Kitchen",), ("Office",)]
    assert [room.shape.floor for room in level.rooms] == pytest.approx([0, 0], abs=1e-6)
    assert [room.shape.ceiling for room in level.rooms] == pytest.approx([2.6, 2.5])
    assert sorted(o.model_id for o in level.objects if o.model_id != "structure") == ["chair", "desk"]
    assert polygon_area(level.rooms[0].shape.corners) == 16


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"romes": []}, "unknown field `romes`"),
        ({"up": "x"}, "expected `y` or `z`"),
        ({"rooms": [{"corners": [[0, 0], [1, 1], [1, 0], [0, 1]]}]}, "crosses itself"),
        ({"rooms": [{"type": "Cellar", "corners": [[0, 0], [1, 0], [0, 1]]}]}, "unknown room type"),
        ({"objects": {"chair": "throne"}}, "unknown category `throne`"),
        ({"scale": 0}, "metres per unit"),
        ({"rooms": [{"corners": [[90, 90], [99, 90], [90, 99]]}]}, "no triangle is in a room"),
    ],
)
def test_errors_of_a_room_file_are_located(flat, content, message):
    flat.with_name("flat.rooms.json").write_text(json.dumps(content))
    with pytest.raises(DatasetError, match=message) as caught:
        open_dataset(flat).load_house("flat")
    assert caught.value.file


def test_storeys_are_found_by_floors_with_walls_above(tmp_path):
    """Two storeys of 3 m with a roof slab: the tops of the ceiling below and of the roof are no storeys."""
    file = GltfFile()
    for base in (0.0, 3.0):
        file.box("slab", (-0.1, base - 0.1, -0.1), (6.1, base, 5.1))
        file.box("a", (-0.1, base, -0.1), (6.1, base + 2.7, 0))
        file.box("b", (-0.1, base, 5), (6.1, base + 2.7, 5.1))
        file.box("c", (-0.1, base, 0), (0, base + 2.7, 5))
        file.box("d", (6, base, 0), (6.1, base + 2.7, 5))
        file.box("top", (-0.1, base + 2.7, -0.1), (6.1, base + 2.8, 5.1))
    levels = open_dataset(file.write(tmp_path / "tower.glb")).load_house("tower").levels
    assert [[round(r.shape.floor, 3) for r in level.rooms] for level in levels] == [[0], [3]]
    assert [[round(r.shape.ceiling, 3) for r in level.rooms] for level in levels] == [[2.7], [5.7]]


def test_a_noisy_scan_has_the_same_rooms_walls_and_doorway(tmp_path):
    """One mesh of 45,000 triangles without names: furniture is an obstacle, walls are as thick as in the drawing."""
    house = compiled(scan_of_two_rooms(0.1, 0.004).write(tmp_path / "scan.glb"))
    assert house.report["rooms"] == 2
    rooms, region = house.navigation.room[0], house.navigation.region[0]
    assert set(np.unique(rooms[region == 0])) == {0, 1}
    walls = house.colliders.object_id < 0
    thin = 2 * house.colliders.size[walls, :2].min(axis=1)
    assert np.median(thin) == pytest.approx(0.13, abs=0.04)
    # 3.95 m x 4 m less 0.1 m to walls each, and the furniture with the agent's radius around it
    assert (region == 0).sum() * 0.01 == pytest.approx(2 * 3.7 * 3.75 - 1.8 * 1.3 - 0.8 * 0.8, abs=2)


def test_names_and_paths_open_the_same_houses(flat, tmp_path):
    by_path, by_name, by_folder = (open_dataset(x) for x in (flat, f"gltf:{flat}", tmp_path))
    assert by_path == by_name
    assert by_path.house_ids == by_folder.house_ids == ("flat",)
    assert open_dataset(f"gltf:{flat}?rooms=one").load_house("flat").levels[0].rooms[1:] == ()
    with pytest.raises(UnknownIdError):
        by_path.load_house("other")
    for query in ("up=x", "scale=much", "scale=-1", "colour=red", "rooms=two"):
        with pytest.raises(ConfigError):
            open_dataset(f"gltf:{flat}?{query}")
    with pytest.raises(MissingFileError):
        open_dataset("gltf:nowhere.glb")


def test_digests_follow_the_files_and_options(flat):
    before = open_dataset(flat).inputs().house("flat")
    assert open_dataset(flat).inputs().house("flat") == before
    assert open_dataset(f"gltf:{flat}?rooms=one").inputs().house("flat") != before
    flat.with_name("flat.rooms.json").write_text("{}")
    assert open_dataset(flat).inputs().house("flat") != before


@pytest.mark.parametrize(
    ("shape", "message"), [(None, "shows nothing"), ([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], "no floor")]
)
def test_a_scene_without_a_floor_is_refused(tmp_path, shape, message):
    file = GltfFile()
    if shape is not None:
        file.node(mesh=file.mesh(shape))
    with pytest.raises(DatasetError, match=message):
        open_dataset(file.write(tmp_path / "odd.glb")).load_house("odd")


def test_parts_of_an_object_are_one_and_copies_share_a_model(tmp_path):
    """A named node above two meshes, placed twice: one model with 24 triangles, two objects."""
    file = two_rooms()
    cube = file.mesh(CUBE * 0.2)
    legs = [file.node(root=False, name=f"part{i}", mesh=cube, translation=[i, 0, 0]) for i in (0, 1)]
    for number, x in enumerate((1.0, 5.0)):
        file.node(name=f"bookshelf_{number}", children=legs, translation=[x, 0, 3])
    house = open_dataset(file.write(tmp_path / "flat.glb")).load_house("flat")
    shelves = [o for o in house.levels[0].objects if o.model_id == "bookshelf"]
    assert len(shelves) == 2
    assert shelves[0].model_key == shelves[1].model_key
    assert len(house.models[shelves[0].model_key].faces) == 24
    assert [o.transform[:3, 3].tolist() for o in shelves] == [[1, 0, 3], [5, 0, 3]]


def test_categories_that_options_exclude_are_left_out(tmp_path):
    file = two_rooms()
    file.box("potted plant", (2, 0, 2), (2.3, 1, 2.3))
    dataset = open_dataset(file.write(tmp_path / "flat.glb"))
    for options, count in ((ReadOptions(), 1), (ReadOptions(plants=False), 0)):
        objects = dataset.load_house("flat", options).levels[0].objects
        assert sum(o.model_id == "plant" for o in objects) == count


def test_the_table_of_categories_uses_the_vocabulary():
    assert set(category_words().values()) | {"unknown", "empty"} == set(FINE)
    for info in category_metadata().models.values():
        assert info.coarse in COARSE
        assert info.nyu40 in NYU40


@pytest.mark.slow
def test_an_agent_steps_in_a_scene(flat):
    env = home_mjx.make("PointNav-v0", f"gltf:{flat}", impl="kinematic", ctrl_dt=0.3)
    state = jax.jit(env.reset)(jax.random.PRNGKey(0))
    before = state.obs["state"]
    state = jax.jit(env.step)(state, jnp.array([1.0, 0.0, 0.3, 0.0]))
    assert np.isfinite(state.reward)
    assert not np.array_equal(before, state.obs["state"])
