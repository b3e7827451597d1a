"""MJCF scenes as houses: counts of the shared sample, depth against MuJoCo's rays, round trip of an exported home."""

import json
from collections import Counter
from pathlib import Path

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.datasets import ReadOptions, open_dataset
from home_mjx.datasets.mjcf.categories import body_category
from home_mjx.datasets.mjcf.model import compile_scene
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownIdError
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.mjcf.export import export_mjcf
from home_mjx.scene_compile.objects.fixed_parts import describe_fixed, fixed_joints
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.categories import FINE
from home_mjx.schema.house import House
from home_mjx.schema.semantic import Semantic

SAMPLE = Path(__file__).parents[4] / "shared" / "data" / "mjcf_sample"
needs_sample = pytest.mark.skipif(not SAMPLE.is_dir(), reason="the shared MJCF sample is not here")
WALLS = "".join(
    f'<geom name="wall_{i}" type="box" size="{size}" pos="{pos}"/>'
    for i, (size, pos) in enumerate(
        (("2.1 .05 1.3", "2 -.05 1.3"), ("2.1 .05 1.3", "2 3.05 1.3"), (".05 1.6 1.3", "-.05 1.5 1.3"))
    )
)
FLOOR = '<geom name="floor" type="box" size="2.1 1.6 .05" pos="2 1.5 -.05"/>'


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def write(folder: Path, body: str, assets: str = "", name: str = "room.xml", head: str = "") -> Path:
    path = folder / name
    text = f"<mujoco>{head}<asset>{assets}</asset><worldbody>{FLOOR}{WALLS}{body}</worldbody></mujoco>"
    path.write_text(text)
    return path


def read(path: Path, **options: bool) -> House:
    dataset = open_dataset(path)
    return dataset.load_house(dataset.house_ids[0], ReadOptions(**options))


def things(house: House) -> list:
    return [o for level in house.levels for o in level.objects if o.model_id != "structure"]


def depth(house, origin, away) -> np.ndarray:
    """Cast rays of the world before compilation in a compiled house."""
    bank = HouseBank.from_compiled([house])
    agent = jnp.array([[90.0, 0.0, 0.0]]), jnp.array([[1.0, 0.0, 0.0, 0.0]])
    view = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *agent)
    rays = [jnp.asarray(x, jnp.float32) for x in (origin + house.offset, away)]
    return np.asarray(jax.jit(cast)(view, *rays).t)


def mujoco_depth(scene, origin, away) -> np.ndarray:
    """Cast rays with MuJoCo against the visible geoms of the file."""
    model, data = scene.model, scene.data
    backing = np.array(["backing" in model.body(int(b)).name for b in model.geom_bodyid])
    model.geom_group[:] = np.where(scene.shown & ~backing, 0, 5)
    model.geom_rgba[:, 3], model.geom_matid[:] = 1, -1  # MuJoCo's rays pass transparent geoms
    found, geom, groups = np.full(len(origin), -1.0), np.zeros(1, np.int32), np.array([1, 0, 0, 0, 0, 0], np.uint8)
    for i, (point, way) in enumerate(zip(origin, away, strict=True)):
        found[i] = mujoco.mj_ray(model, data, point, way, groups, 1, -1, geom)
    return found


def rays(low, high, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    away = rng.normal(size=(count, 3))
    return rng.uniform(low, high, (count, 3)), away / np.linalg.norm(away, axis=1, keepdims=True)


@needs_sample
def test_a_kitchen_of_robocasa_has_the_counts_of_its_readme_and_the_depth_of_mujoco():
    path = SAMPLE / "robocasa_kitchen" / "kitchen.xml"
    scene = compile_scene(path)
    assert (scene.model.nbody - 1, scene.model.ngeom) == (327, 1608)
    house = read(path)
    (level,) = house.levels
    (room,) = level.rooms
    assert room.types == ("Kitchen",)
    assert (room.shape.floor, room.shape.ceiling) == (pytest.approx(0), pytest.approx(3, abs=1e-3))
    assert np.allclose([room.shape.corners.min(axis=0), room.shape.corners.max(axis=0)], [[0, 0], [6.4, 5]], atol=0.15)
    assert room.walls.part.max() == 2  # three walls: the kitchen is open to one side
    found = Counter(o.model_id for o in things(house))
    assert sum(found.values()) == 110 - 8  # roots without walls, floors and their backings
    assert found["unknown"] == 0
    assert (found["window"], found["stool"], found["sink"], found["refrigerator"]) == (1, 3, 1, 1)
    joints = Counter(j.kind for o in things(house) for j in o.joints)
    assert joints["slide"] == 31
    assert joints["hinge"] == 36  # one of the 37 is on a part that another one moves
    assert "1 joints are on parts that other joints move: fixed" in [problem.message for problem in house.problems]
    parts = Counter(j.part.partition("_")[0] for o in things(house) for j in o.joints)
    assert parts == {"drawer": 31, "door": 29, "knob": 5, "spout": 1, "handle": 1}
    compiled = compile_house(house, open_dataset(path).metadata)
    assert describe_fixed(compiled, fixed_joints(house, {}, open_dataset(path).metadata, compiled)) == [
        "fixed: kitchen_cabinet with 28 doors, 31 drawers",
        "fixed: microwave with 1 door",
        "fixed: range_oven with 5 knobs",
        "fixed: sink with 1 handle, 1 spout",
    ]
    origin, away = rays([0.1, -4.9, 0.1], [6.3, -0.1, 2.9], 10_000)
    expected = mujoco_depth(scene, origin, away)
    got = depth(compiled, origin, away)
    hit = expected >= 0
    good = np.where(hit, abs(got - expected) < 1e-3, ~(got < 20))
    assert good.mean() >= 0.9999


@needs_sample
def test_a_kitchen_without_a_floor_gets_one_or_is_refused():
    path = SAMPLE / "furniture_sim" / "kitchen" / "kitchen1.xml"
    house = read(path)
    assert [f.kind for f in house.fallbacks] == ["room mesh"]
    assert [room.types for room in house.levels[0].rooms] == [("Kitchen",)]
    joints = [(j.kind, round(j.low, 3), round(j.high, 3)) for o in things(house) for j in o.joints]
    assert {("slide", 0, 0.44), ("hinge", -1.57, 0), ("hinge", 0, 1.57), ("hinge", -2.094, 0)} <= set(joints)
    assert Counter(kind for kind, *_ in joints) == {"hinge": 8, "slide": 6}
    (kettle,) = [o for o in things(house) if o.model_id == "kettle"]
    assert kettle.extra["free"]
    assert sum(o.extra["mass"] for o in things(house)) == pytest.approx(28.23, abs=0.5)  # a collider is left
    with pytest.raises(DatasetError, match="no floor"):
        read(path, strict=True)


@needs_sample
def test_parts_and_attached_models_are_read_or_refused_by_the_missing_file():
    (block,) = things(read(SAMPLE / "molmospaces" / "custom_assets" / "scene.xml"))
    assert block.extra["mass"] == pytest.approx(0.125)
    for name, texture in (("cabinet_hinge", "wood1.png"), ("drawer", "ceramic.png")):
        with pytest.raises(MissingFileError, match=texture):
            read(SAMPLE / "robocasa" / "fixtures" / "cabinets" / f"{name}.xml")
    with pytest.raises(DatasetError, match="shows nothing"):
        read(SAMPLE / "molmospaces" / "base_scene.xml")


@pytest.mark.slow
def test_an_exported_home_is_read_with_the_same_poses_categories_and_doors(tmp_path):
    dataset = open_dataset("procedural:1?seed=3&preset=flat")
    (house_id,) = dataset.house_ids
    before = compile_house(dataset.load_house(house_id), dataset.metadata)
    export_mjcf(before, tmp_path)
    again = open_dataset(tmp_path)
    after = compile_house(again.load_house(house_id), again.metadata)
    assert np.array_equal(before.rooms.type, after.rooms.type)
    assert np.allclose(before.rooms.floor, after.rooms.floor)
    old, new = object_boxes(before), object_boxes(after, after.offset)
    assert {fine for fine, _ in old} <= {fine for fine, _ in new}
    for fine, box in old:  # each object is at its place, and of its category
        assert min(abs(box - other).max() for kind, other in new if kind == fine) < 1e-3, FINE[fine]
    assert np.allclose(before.doors.pivot + 0, after.doors.pivot - after.offset[:2], atol=1e-3)
    assert np.allclose(before.doors.closed, after.doors.closed, atol=1e-6)


def object_boxes(house, offset=0.0) -> list[tuple[int, np.ndarray]]:
    """Return the category of each object and its box, with all its instances, such as the leaves of a door."""
    points: dict[int, list[np.ndarray]] = {}
    rows = zip(house.instances.model, house.instances.pose, house.instances.object_id.tolist(), strict=True)
    for model, pose, owner in rows:
        corners = house.models[model].triangle.astype(float) @ pose[:, :3].T + pose[:, 3] - offset
        points.setdefault(owner, []).append(corners.reshape(-1, 3))
    kinds = dict(zip(house.instances.object_id.tolist(), house.instances.semantic.tolist(), strict=True))
    joined = {owner: np.concatenate(parts) for owner, parts in points.items() if owner >= 0}
    fine = {owner: int(house.semantics[kinds[owner], Semantic.FINE]) for owner in joined}
    return [(fine[owner], np.array([p.min(axis=0), p.max(axis=0)])) for owner, p in joined.items()]


def test_a_door_between_rooms_turns_on_its_hinge_and_primitives_have_their_size(tmp_path):
    """All six shapes stand in a room; frame and leaf are bodies of one door, whose spring rests where it is shut."""
    shapes = ("sphere size='.2'", "capsule size='.1 .3'", "cylinder size='.1 .3'", "ellipsoid size='.1 .2 .3'")
    body = "".join(
        f"<body name='vase{i}' pos='{i + 0.5} 1 .8'><geom type='{s.split()[0]}' {s.split(' ', 1)[1]}/></body>"
        for i, s in enumerate(shapes)
    )
    body += """<body name="door_1" pos="1 2 1"><geom type="box" size=".05 .05 1"/>
    <body pos=".1 0 0"><joint type="hinge" axis="0 0 1" range="-10 90" springref="90"/>
    <geom type="box" size=".4 .02 1" pos=".4 0 0"/></body></body>"""
    house = read(write(tmp_path, body))
    sizes = {o.extra["name"]: np.ptp(house.models[o.model_key].vertices, axis=0) for o in things(house)}
    for i, expected in enumerate(([0.4, 0.4, 0.4], [0.2, 0.8, 0.2], [0.2, 0.6, 0.2], [0.2, 0.6, 0.4])):
        assert sizes[f"vase{i}"] == pytest.approx(expected, abs=1e-3)  # y up
    (joint,) = [j for o in things(house) for j in o.joints]
    assert (joint.kind, joint.axis) == ("hinge", pytest.approx((0, 1, 0)))
    assert (joint.low, joint.high, joint.closed) == pytest.approx(np.deg2rad([-10, 90, 90]), abs=1e-6)
    assert joint.point == pytest.approx((0.1, 0, 0))
    assert joint.faces.tolist() == list(range(12, 24))


def test_joints_of_furniture_are_records_of_kind_axis_range_and_faces_and_listed_as_fixed(tmp_path):
    """A room door moves; a drawer that slides towards the house's +z, a lid and an unnamed flap do not."""
    box = '<geom type="box" size=".3 .3 .01" pos="0 0 {}"/>'
    body = f"""<body name="dresser" pos="3 1 .4"><geom type="box" size=".3 .3 .3"/>
    <body name="front"><joint type="slide" axis="0 -1 0" range="0 .3"/><geom type="box" size=".2 .02 .1"/></body>
    <body><joint name="lid_joint" axis="1 0 0" pos="0 .3 .3" range="-80 0"/>{box.format(0.31)}
    <body><joint axis="0 0 1" range="0 10"/>{box.format(0.33)}</body></body>
    <body><joint axis="1 0 0" range="-20 0"/>{box.format(-0.31)}</body></body>
    <body name="door_1" pos="1 2 1"><geom type="box" size=".05 .05 1"/>
    <body pos=".1 0 0"><joint axis="0 0 1" range="0 90"/><geom type="box" size=".4 .02 1" pos=".4 0 0"/></body>
    </body>"""
    path = write(tmp_path, body)
    house = read(path)
    (dresser,) = [o for o in things(house) if o.model_id == "dresser"]
    drawer, lid, _ = dresser.joints
    assert [joint.part.partition("_")[0] for joint in dresser.joints] == ["drawer", "lid", "flap"]
    assert (drawer.kind, drawer.axis, drawer.low, drawer.high) == ("slide", pytest.approx((0, 0, 1)), 0, 0.3)
    assert [joint.faces.tolist() for joint in (drawer, lid)] == [list(range(12, 24)), list(range(24, 48))]
    opened = lid.move(house.models[dresser.model_key], lid.low)
    edge = opened.vertices[np.unique(opened.faces[24:36])]
    height = 0.3 + 0.6 * np.sin(-lid.low) + 0.02 * np.cos(lid.low)
    assert edge[:, 1].max() == pytest.approx(height, abs=1e-3)
    compiled = compile_house(house, open_dataset(path).metadata)
    assert len(compiled.doors.instance) == 1
    assert describe_fixed(compiled, fixed_joints(house, {}, open_dataset(path).metadata, compiled)) == [
        "fixed: dresser with 1 drawer, 1 flap, 1 lid"
    ]
    assert "1 joints are on parts" in " ".join(problem.message for problem in house.problems)


def test_visible_geoms_are_told_from_colliders_by_contacts_not_by_groups(tmp_path):
    pair = '<geom type="box" size=".1 .1 .1" group="{}" contype="0" conaffinity="0"/><geom size=".9" group="{}"/>'
    body = "".join(
        f'<body name="stool_{i}" pos="{i + 1} 1 1">{pair.format(*groups)}</body>'
        for i, groups in enumerate(((1, 0), (0, 3), (2, 3)))
    )
    body += '<body name="table" pos="2 2 .5"><geom size=".1"/><geom size=".5" group="4"/></body>'
    body += '<body name="desk" pos="2 2 .5"><geom size=".1"/><geom size=".5" rgba="1 1 1 0"/></body>'
    sizes = [np.ptp(o, axis=0).max() for o in mesh_points(read(write(tmp_path, body)))]
    assert sizes == pytest.approx([0.2] * 5, abs=1e-3)


def mesh_points(house: House) -> list[np.ndarray]:
    return [house.models[o.model_key].vertices for o in things(house)]


def test_textures_of_meshes_are_upright_and_lights_shine_at_their_places(tmp_path):
    """A square whose image is red in its upper half: v = 1 is the top row of the image."""
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[:2, :, 0], pixels[2:, :, 2] = 255, 255
    Image.fromarray(pixels).save(tmp_path / "flag.png")
    corners = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    (tmp_path / "flag.obj").write_text(f"{corners}f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
    assets = '<mesh name="flag" file="flag.obj" inertia="shell"/><texture name="t" type="2d" file="flag.png"/>'
    assets += '<material name="wood" texture="t"/>'
    body = '<body name="picture" pos="1 1 1"><geom type="mesh" mesh="flag" material="wood" contype="0" '
    body += 'conaffinity="0"/></body>'
    body += '<light type="point" pos="1 1 2" diffuse="1 .5 0"/><light type="point" pos="3 1 2" diffuse=".5 .5 .5"/>'
    house = read(write(tmp_path, body, assets))
    (picture,) = things(house)
    mesh = house.models[picture.model_key]
    height = mesh.vertices[mesh.faces][..., 1]
    assert np.allclose(mesh.uv[..., 1], height - height.min(), atol=1e-6)
    texture = mesh.materials[0].texture
    assert texture.name.startswith("wood_")
    assert np.array_equal(np.asarray(Image.open(texture)), pixels)
    found = [(o.transform, light) for o in house.levels[0].objects for light in o.lights]
    places = sorted((t[:3, :3] @ light.position + t[:3, 3]).round(6).tolist() for t, light in found)
    assert places == [[1, 2, -1], [3, 2, -1]]
    powers = sorted(light.power for _, light in found)
    assert powers[0] == pytest.approx(powers[1])  # equal means
    assert sum(powers) == pytest.approx(3 * 4 * 3, rel=0.15)  # 3 W/m^2 on 4 m x 3 m


def test_bodies_that_only_group_others_are_no_objects_and_equal_things_share_a_model(tmp_path):
    stool = '<body name="stool_{0}" pos="{0} 1 .2"><geom type="box" size=".1 .1 .2"/></body>'
    house = read(write(tmp_path, f'<body name="all">{"".join(stool.format(i) for i in (1, 2, 3))}</body>'))
    assert [o.model_id for o in things(house)] == ["stool"] * 3
    assert len({o.model_key for o in things(house)}) == 1


@pytest.mark.parametrize(
    ("name", "fine"),
    [
        ("island_panel_cab_left_island_group_base_main", "kitchen_cabinet"),
        ("paper_towel_main_group_main", "toilet_paper"),
        ("window_group_main_group_root", "window"),
        ("wall_3_2", "wall"),
        ("chairs2", "chair"),
        ("panda_link0", ""),
    ],
)
def test_names_of_bodies_are_categories(name, fine):
    assert body_category(name) == fine


def test_metadata_of_molmospaces_name_categories(tmp_path):
    path = write(tmp_path, '<body name="x_0_1" pos="1 1 .5"><geom size=".1"/></body>', name="train_0_ceiling.xml")
    objects = {"x_0_1": {"category": "AlarmClock", "asset_id": "Alarm_Clock_1", "room_id": 1}}
    (tmp_path / "train_0_metadata.json").write_text(json.dumps({"objects": objects}))
    (clock,) = things(read(path))
    assert (clock.model_id, clock.extra["category"]) == ("clock", "AlarmClock")


def test_names_options_and_digests(tmp_path):
    path = write(tmp_path, "")
    dataset = open_dataset(path)
    assert dataset == open_dataset(f"mjcf:{path}")
    assert dataset.house_ids == open_dataset(tmp_path).house_ids == ("room",)
    before = dataset.inputs().house("room")
    (tmp_path / "room.rooms.json").write_text('{"rooms": []}')
    assert open_dataset(path).inputs().house("room") != before
    assert open_dataset(f"mjcf:{path}?rooms=one").inputs().house("room") != dataset.inputs().house("room")
    with pytest.raises(UnknownIdError):
        dataset.load_house("other")
    for query in ("rooms=two", "up=y"):
        with pytest.raises(ConfigError):
            open_dataset(f"mjcf:{path}?{query}")
    with pytest.raises(MissingFileError):
        open_dataset("mjcf:nowhere.xml")


def test_height_fields_are_as_deep_as_mujoco_has_them(tmp_path):
    """A lawn of 20 heights, turned, beside a room: rays from above and from the side meet its top, rims and base."""
    heights = " ".join(map(str, np.random.default_rng(1).random(20).round(3)))
    assets = f'<hfield name="hills" nrow="4" ncol="5" size="2 1 .5 .3" elevation="{heights}"/>'
    path = write(tmp_path, '<geom type="hfield" hfield="hills" pos="2 -3 .4" euler="3 0 20"/>', assets)
    scene = compile_scene(path)
    house = compile_house(read(path), open_dataset(path).metadata)
    assert "not shown" not in " ".join(problem.message for problem in read(path).problems)
    rng = np.random.default_rng(2)
    away = np.array([2, -3, 0.4]) + rng.normal(size=(400, 3)) * [0.6, 0.3, 0.2]
    origin = away + 3 * (ways := rng.normal(size=(400, 3))) / np.linalg.norm(ways, axis=1, keepdims=True)
    away = (away - origin) / np.linalg.norm(away - origin, axis=1, keepdims=True)
    expected, got = mujoco_depth(scene, origin, away), depth(house, origin, away)
    assert (expected > 0).mean() > 0.9
    assert np.mean(abs(np.where(expected < 0, 0, got - expected)) < 1e-3) > 0.99
