"""Exported houses: MuJoCo compiles them, they show what the arrays hold and move as the batched physics."""

import dataclasses
import io

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from handmade import Furniture, shoebox
from numpy.testing import assert_allclose, assert_array_equal
from PIL import Image
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.geometry.meshes import transform
from home_mjx.scene_compile.mjcf.assets import MIN_TRIANGLE_AREA, obj_bytes
from home_mjx.scene_compile.mjcf.export import export_mjcf, split_linear, to_mjcf
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import ARCHITECTURE
from home_mjx.schema.lighting import LightTable
from home_mjx.schema.timing import Timing

FURNITURE = (
    Furniture((1.0, 0.0), (0.3, 0.3, 0.3), mass=5.0),
    Furniture((-1.0, 1.0), (0.5, 0.8, 0.7), yaw=0.5),
    Furniture((0.0, -1.5), (0.6, 0.4, 1.2), yaw=-0.4, mass=60.0),
)


@pytest.fixture(scope="module")
def house():
    return shoebox(furniture=FURNITURE)


def _compile(house, **options):
    return mujoco.MjModel.from_xml_string(*to_mjcf(house, **options))


def _start(model):
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return data


def _visuals(model, body):
    first = model.body_geomadr[body]
    geoms = np.arange(first, first + model.body_geomnum[body])
    return geoms[model.geom_type[geoms] == mujoco.mjtGeom.mjGEOM_MESH]


def _triangles(model, data, geom):
    """Corners in the world of the triangles that a mesh geom shows."""
    mesh = model.geom_dataid[geom]
    vertex = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
    face = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
    return (vertex[face] @ data.geom_xmat[geom].reshape(3, 3).T) + data.geom_xpos[geom]


def _shown(model, data, name):
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    return np.concatenate([_triangles(model, data, g) for g in _visuals(model, body)])


def _area_vectors(triangles):
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2


def _assert_shows(model, data, house, instance):
    """The geoms of an instance are its triangles: corners, area and orientation of the faces."""
    owner = house.instances.object_id
    name = "architecture" if instance == ARCHITECTURE else f"object{owner[instance]}"
    if instance and owner[instance] == owner[instance - 1]:
        name += f"_leaf{instance}"
    library = house.models[house.instances.model[instance]]
    want = transform(house.instances.pose[instance], library.triangle.astype(float))
    if np.linalg.det(house.instances.pose[instance][:, :3]) < 0:
        want = want[:, ::-1]
    area = np.linalg.norm(_area_vectors(want), axis=1)
    want = want[area > 1e-9]
    got = _shown(model, data, name)
    scale = np.ptp(want.reshape(-1, 3), axis=0).max()
    distance, nearest = cKDTree(got.mean(axis=1)).query(want.mean(axis=1))
    assert distance.max() < 1e-4 * max(scale, 1)
    assert cKDTree(want.mean(axis=1)).query(got.mean(axis=1))[0].max() < 1e-3 * max(scale, 1)
    total = np.abs(_area_vectors(want)).sum(axis=0)
    assert_allclose(np.abs(_area_vectors(got)).sum(axis=0), total, rtol=1e-3, atol=1e-4)
    agree = np.sum(_area_vectors(got)[nearest] * _area_vectors(want), axis=1) > 0
    assert agree.mean() > 0.98  # coincident back-to-back faces may be matched crosswise
    return len(got)


def test_house_shows_its_triangles_and_moves_its_bodies(house):
    model = _compile(house)
    data = _start(model)
    for instance in range(len(house.instances.model)):
        assert _assert_shows(model, data, house, instance) == len(
            house.models[house.instances.model[instance]].triangle
        )
    joints = [model.joint(i).name for i in range(model.njnt)]
    assert joints == ["object0", "object2"]
    assert_allclose(model.body("object0").mass, 5.0)
    x, y, z = 0.6, 0.4, 1.2
    assert_allclose(model.body("object2").inertia, 60 / 12 * np.array([y**2 + z**2, x**2 + z**2, x**2 + y**2]))
    assert_allclose(model.body_mass.sum(), 65.0)  # what is only seen weighs nothing


def test_colliders_are_those_of_the_house(house):
    model = _compile(house)
    boxes = [i for i in range(model.ngeom) if model.geom(i).name.startswith("static")]
    assert_allclose(model.geom_pos[boxes], house.colliders.pos, atol=1e-7)
    assert_allclose(model.geom_quat[boxes], house.colliders.quat, atol=1e-7)
    assert_allclose(model.geom_size[boxes], house.colliders.size, atol=1e-7)
    solid = (model.geom_contype | model.geom_conaffinity) > 0
    assert set(np.flatnonzero(solid)) == {
        *boxes,
        model.geom("floor").id,
        model.geom("object0").id,
        model.geom("object2").id,
    }


def test_ceilings_can_be_hidden(house):
    model = _compile(house)
    data = _start(model)
    geoms = _visuals(model, model.body("architecture").id)
    high = [np.mean(_triangles(model, data, g)[..., 2]) > 2.9 for g in geoms]
    assert_array_equal(model.geom_group[geoms] == 4, high)
    assert any(high)


def test_lamps_hang_where_the_renderer_has_them(house):
    pose = house.instances.pose[1]
    lamp = dataclasses.replace(
        LightTable.empty(),
        pos=np.array([[0.1, 0.2, 0.3], [0, 0, 0], [0, 0, 1.0]]),
        axis_u=np.zeros((3, 3)),
        axis_v=np.zeros((3, 3)),
        direction=np.array([[0, 0, -1.0], [1.0, 0, 0], [0, 0, -1.0]]),
        intensity=np.array([[4, 2, 0], [2, 2, 2], [9, 9, 9.0]]),
        exponent=np.array([0.0, 3.0, 1.0]),
        cutoff=np.array([-2.0, 0.5, 0.0]),
        area=np.zeros(3),
        daylight=np.array([False, False, True]),
        instance=np.array([1, 0, 0], np.int32),
        room=np.zeros(3, np.int32),
    )
    model = _compile(dataclasses.replace(house, lights=lamp))
    assert [model.light(i).name for i in range(model.nlight)] == ["", "lamp0", "lamp1"]
    assert_allclose(model.light("lamp0").pos, transform(pose, lamp.pos[0]), atol=1e-6)
    assert_allclose(model.light("lamp0").diffuse, [0.7, 0.35, 0], rtol=1e-5)
    assert_allclose(model.light("lamp1").dir, [1, 0, 0], atol=1e-6)
    assert model.light("lamp1").cutoff == pytest.approx(60)


def test_top_camera_sees_the_whole_house(house):
    model = _compile(house)
    data = _start(model)
    camera = model.camera("top").id
    corners = np.stack(np.meshgrid(*house.box.T), -1).reshape(-1, 3)
    local = (corners - data.cam_xpos[camera]) @ data.cam_xmat[camera].reshape(3, 3)
    assert (local[:, 2] < 0).all()
    assert (np.abs(local[:, :2]) <= -local[:, 2:] * np.tan(np.deg2rad(model.cam_fovy[camera] / 2))).all()


def test_house_stands_still(house):
    model = _compile(house, agent=AgentBody())
    data = _start(model)
    start = data.qpos.copy()
    for _ in range(600):
        mujoco.mj_step(model, data)
    assert_allclose(data.qpos, start, atol=2e-3)
    assert np.abs(data.qvel).max() < 1e-4
    assert not [w for w in data.warning if w.number]


def test_agent_pushes_as_in_the_batched_physics(house):
    """3 s of walking into the light box and on to the wall, beside the template that the batch steps."""
    shape = AgentBody()
    model = _compile(house, agent=shape, timestep=Timing().sim_dt)
    data = _start(model)
    agent, box = model.joint("agent0_x").qposadr[0], model.joint("object0").qposadr[0]
    data.qpos[agent : agent + 4] = 0, 0, shape.height / 2, 0
    speed = model.jnt_dofadr[model.joint("agent0_x").id]

    bank = HouseBank.from_compiled([house])
    config = physics.PhysicsSetup()
    template = physics.Template(config, bank.spec)
    action, index = jnp.array([[1.0, 0.0, 0.0]]), jnp.int32(0)
    batched = physics.reset(template, bank, index, jnp.zeros((1, 3)), jnp.zeros(1))
    step = jax.jit(lambda data: physics.step(template, bank, index, data, action))
    gap = 0.0
    for _ in range(30):
        for _ in range(config.timing.substeps):
            force = config.body.mass * (config.body.forward_speed - data.qvel[speed]) / config.response_time
            data.ctrl[:2] = min(force, config.body.max_push_force), 0.0
            mujoco.mj_step(model, data)
        batched = step(batched)
        positions = physics.agent_pose(template, batched)[0][0], physics.body_pose(template, batched)[0][0]
        gap = max(gap, np.abs(positions[0][:2] - data.qpos[agent : agent + 2]).max())
        gap = max(gap, np.abs(positions[1] - data.qpos[box : box + 3]).max())
    assert gap < 0.015  # a pushed box hops by about a centimetre in both, not in step
    assert data.qpos[box] > 3.0 - 0.15 - 0.02  # it went all the way
    assert physics.agent_contact(template, batched).all()


@pytest.mark.parametrize("seed", range(4))
def test_rotation_and_stretch_give_the_map_back(seed):
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    for linear in (turn, turn * 2, turn * [1, 2, 3], turn * [-1, 2, 0.5], -turn, rng.normal(size=(3, 3))):
        rotation, stretch = split_linear(linear)
        assert_allclose(rotation @ stretch, linear, atol=1e-12)
        assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-6)
        assert np.linalg.det(rotation) > 0


@pytest.mark.parametrize("linear", [np.diag([1.0, -1.0, 1.0]), np.array([[1, 0.4, 0], [0, 1, 0], [0.2, 0, 2.0]])])
def test_mirrored_and_sheared_objects_keep_their_shape(house, linear):
    pose = house.instances.pose.copy()
    pose[2, :, :3] = pose[2, :, :3] @ linear
    changed = dataclasses.replace(house, instances=dataclasses.replace(house.instances, pose=pose))
    model = _compile(changed)
    _assert_shows(model, _start(model), changed, 2)


def test_one_mesh_serves_all_instances_of_a_model():
    same = [Furniture((x, 0.0), (0.4, 0.4, 0.4), yaw=x) for x in (-1.0, 0.0, 1.0)]
    house = shoebox(furniture=same)
    assert _compile(house).nmesh == _compile(shoebox(furniture=same[:1])).nmesh


def test_triangles_without_area_and_tiny_meshes():
    corner = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]])
    text = obj_bytes(corner, np.zeros((1, 3, 2))).decode()
    assert text.count("v ") == 4  # as many as MuJoCo wants
    asset = '<mesh name="m" file="m.obj" inertia="shell"/>'
    geom = '<geom type="mesh" mesh="m" contype="0" conaffinity="0"/>'
    xml = f"<mujoco><asset>{asset}</asset><worldbody>{geom}</worldbody></mujoco>"
    assert mujoco.MjModel.from_xml_string(xml, {"m.obj": text.encode()}).mesh_facenum[0] == 1
    house = shoebox(furniture=FURNITURE[1:2])
    flat = house.models[house.instances.model[1]]
    flat = dataclasses.replace(flat, triangle=flat.triangle * np.float32(np.sqrt(MIN_TRIANGLE_AREA) / 10))
    empty = dataclasses.replace(house, models={**house.models, flat.key: flat})
    model = _compile(empty)
    assert model.body("object0").geomnum[0] == 0


@pytest.fixture
def textured(house, tmp_path):
    """The house with a texture on its first object; top left red, else blue."""
    image = Image.new("RGB", (8, 8), (0, 0, 255))
    image.putpixel((0, 0), (255, 0, 0))
    image.save(tmp_path / "wood.jpg", quality=100, subsampling=0)
    row = house.instances.material[1]
    texture = list(house.materials.texture)
    texture[row] = str(tmp_path / "wood.jpg")
    key = house.instances.model[1]
    uv = np.random.default_rng(0).uniform(-2, 2, house.models[key].uv.shape).astype(np.float32)
    models = {**house.models, key: dataclasses.replace(house.models[key], uv=uv)}
    return dataclasses.replace(
        house, materials=dataclasses.replace(house.materials, texture=tuple(texture)), models=models
    )


def test_textures_become_png_with_their_coordinates(textured):
    xml, files = to_mjcf(textured)
    images = [content for name, content in files.items() if name.endswith(".png")]
    assert len(images) == 1
    with Image.open(io.BytesIO(images[0])) as image:
        assert image.format == "PNG"
        pixels = np.asarray(image.convert("RGB")).astype(int)
    assert pixels[0, 0, 0] > pixels[0, 0, 2]
    assert pixels[4, 4, 2] > pixels[4, 4, 0]
    model = mujoco.MjModel.from_xml_string(xml, files)
    geom = _visuals(model, model.body("object0").id)[0]
    mesh = model.geom_dataid[geom]
    coordinate = model.mesh_texcoord[model.mesh_texcoordadr[mesh] :][: model.mesh_texcoordnum[mesh]]
    want = textured.models[textured.instances.model[1]].uv.reshape(-1, 2)
    # MuJoCo keeps v downwards.
    assert cKDTree(coordinate * [1, -1] + [0, 1]).query(want)[0].max() < 1e-5
    assert model.mat_texid[model.geom_matid[geom]].max() == 0


def test_missing_texture_is_named(textured, tmp_path):
    (tmp_path / "wood.jpg").unlink()
    with pytest.raises(DatasetError) as error:
        export_mjcf(textured, tmp_path / "out")
    assert error.value.file == str(tmp_path / "wood.jpg")
    assert not (tmp_path / "out").exists()


def test_export_is_whole_and_replaces_only_exports(house, tmp_path):
    first = export_mjcf(house, tmp_path, agent=AgentBody())
    (first.parent / "stale.obj").write_text("left from before")
    path = export_mjcf(house, tmp_path)
    assert path == first
    assert [p.name for p in tmp_path.iterdir()] == ["shoebox"]
    assert not (path.parent / "stale.obj").exists()
    model = mujoco.MjModel.from_xml_path(str(path))
    assert model.nbody == _compile(house).nbody
    other = tmp_path / "other"
    (other / "shoebox").mkdir(parents=True)
    (other / "shoebox" / "thesis.tex").write_text("precious")
    with pytest.raises(ConfigError) as error:
        export_mjcf(house, other)
    assert error.value.file == str(other / "shoebox")
    assert (other / "shoebox" / "thesis.tex").read_text() == "precious"


def test_export_to_a_place_that_cannot_be_written(house, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match="cannot write"):
        export_mjcf(house, tmp_path / "file")


@pytest.mark.real
def test_real_house(suncg_root):
    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    model = _compile(house, agent=AgentBody())
    data = _start(model)
    shown = [_assert_shows(model, data, house, i) for i in range(len(house.instances.model))]
    assert sum(shown) > 0.999 * 102_150  # a few have no area
    start = data.qpos.copy()
    for _ in range(600):
        mujoco.mj_step(model, data)
    assert_allclose(data.qpos, start, atol=5e-3)
    assert np.abs(data.qvel).max() < 1e-3
