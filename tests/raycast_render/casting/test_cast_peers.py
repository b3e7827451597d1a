"""`cast` against ray casters by others: MuJoCo's `mj_ray` and Intel's Embree."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
import trimesh
from handmade import Furniture, two_rooms
from soup import BACKENDS, Placed, Soup, f32, in_jit, random_pose

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene

N = 4000


def mujoco_model(mesh, box_size, poses):
    """Two geoms: a mesh and a box; a mesh keeps its own frame only where it is placed by a body of its own."""
    spec = mujoco.MjSpec()
    spec.add_mesh(name="m", uservert=mesh.vertices.flatten(), userface=mesh.faces.flatten())
    for pose, settings in zip(poses, ({"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": "m"}, None), strict=True):
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, pose[:, :3].flatten())
        body = spec.worldbody.add_body(pos=pose[:, 3], quat=quat)
        body.add_geom(**(settings or {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": box_size}))
    return spec.compile()


@pytest.mark.parametrize("backend", BACKENDS)
def test_mujoco_sees_the_same(backend):
    rng = np.random.default_rng(5)
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.vertices *= [0.5, 1.0, 0.7]
    size = np.array([0.4, 1.0, 0.6])
    poses = [random_pose(rng), random_pose(rng)]
    model = mujoco_model(mesh, size, poses)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    box = trimesh.creation.box(extents=2 * size)
    soup = Soup(
        [mesh.triangles.astype(np.float32), box.triangles.astype(np.float32)],
        [Placed(0, poses[0], 0), Placed(1, poses[1], 1, moves=True)],
    )
    origin = rng.uniform(-4, 4, size=(N, 3)).astype(np.float32)
    inside = rng.uniform(size=N) < 0.2
    origin[inside] = (poses[1][:, 3] + rng.uniform(-0.2, 0.2, size=(N, 3)))[inside]
    aim = np.where(rng.uniform(size=(N, 1)) < 0.5, poses[0][:, 3], poses[1][:, 3]) + rng.normal(size=(N, 3)) * 0.6
    direction = aim - origin
    direction = (direction / np.linalg.norm(direction, axis=1, keepdims=True)).astype(np.float32)
    hit = in_jit(cast, soup.scene(), f32(origin), f32(direction), backend=backend)

    geom = np.zeros((1, 1), np.int32)
    expected, who = np.empty(N), np.empty(N, int)
    for i in range(N):
        args = (origin[i].astype(float)[:, None], direction[i].astype(float)[:, None])
        expected[i] = mujoco.mj_ray(model, data, *args, None, 1, -1, geom)
        who[i] = geom[0, 0]
    # Rays that pass a silhouette within rounding may go either way.
    same = hit.instance == who
    assert same.mean() > 0.999
    met = same & (who >= 0)
    assert 0.5 < met.mean() < 0.95
    np.testing.assert_allclose(hit.t[met], expected[met], atol=1e-4)
    assert np.isinf(hit.t[same & (who < 0)]).all()


def place(bank, shift):
    """Bodies moved by `shift`, one agent in room 1."""
    physics = bank.physics
    agent = jnp.array([[1.0, 0.5, 0.8]]), jnp.array([[0.8, 0.0, 0.0, 0.6]])
    return make_scene(bank, jnp.int32(0), physics.body_pos[0] + shift, physics.body_quat[0], *agent)


def world_triangles(scene):
    """Triangles of everything in a scene where it stands, and the instance and triangle index of each."""
    geometry, moving = (jax.tree.map(np.asarray, x) for x in (scene.geometry, scene.moving))
    models, poses, numbers = (
        geometry.instance_model[0],
        geometry.instance_pose[0],
        np.arange(geometry.instance_model.size),
    )
    static = (models >= 0) & (geometry.instance_body[0] < 0)
    used = moving.instance >= 0
    models = np.concatenate([models[static], moving.model[used]])
    poses = np.concatenate([poses[static], moving.pose[used]]).astype(float)
    numbers = np.concatenate([numbers[static], moving.instance[used]])
    parts = []
    for model, pose, number in zip(models, poses, numbers, strict=True):
        rows = triangles_of(geometry, geometry.model_root[model])
        world = geometry.triangle[rows].astype(float) @ pose[:, :3].T + pose[:, 3]
        parts.append((world, np.full(len(rows), number), rows))
    return [np.concatenate(x) for x in zip(*parts, strict=True)]


def triangles_of(geometry, node):
    """Triangle indices below a node."""
    rows = []
    for code in geometry.node_child[node].tolist():
        rows += triangles_of(geometry, code) if code >= 0 else range(~code >> 4, (~code >> 4) + (~code & 15))
    return rows


def assert_equals_embree(scene, low, high, backend, count):
    embree = pytest.importorskip("embreex.rtcore_scene", reason="Embree is not installed")
    from embreex.mesh_construction import TriangleMesh

    rng = np.random.default_rng(1)
    origin = rng.uniform(low, high, size=(count, 3)).astype(np.float32)
    direction = rng.normal(size=(count, 3))
    direction = (direction / np.linalg.norm(direction, axis=1, keepdims=True)).astype(np.float32)
    hit = in_jit(cast, scene, f32(origin), f32(direction), mask=7, backend=backend)
    triangles, instance, row = world_triangles(scene)
    peer = embree.EmbreeScene()
    TriangleMesh(peer, triangles.astype(np.float32))
    found = peer.run(origin, direction, output=1)
    met = found["geomID"] >= 0
    t = np.where(met, found["tfar"], np.inf)
    # Where surfaces coincide either may be told, and a ray along an edge may go either way.
    near = np.isclose(hit.t, t, rtol=1e-4, atol=1e-4)
    assert near.mean() > 0.9995
    same = met & (row[found["primID"]] == hit.triangle)
    assert (same | ~met).mean() > 0.95
    np.testing.assert_array_equal(hit.instance[same], instance[found["primID"]][same])
    return met.mean(), np.unique(hit.instance)


@pytest.mark.parametrize("backend", BACKENDS)
def test_embree_sees_the_same_in_a_house_by_hand(backend):
    furniture = [Furniture((-2.0, 1.0), mass=5.0), Furniture((2.0, -1.0), (0.4, 0.8, 1.0), yaw=0.5)]
    bank = HouseBank.from_compiled([two_rooms(furniture=furniture)])
    met, who = assert_equals_embree(
        place(bank, jnp.array([0.3, 0.2, 0.1])), [-4, -2.4, 0], [4, 2.4, 2.9], backend, 4000
    )
    assert met > 0.97
    assert who.tolist()[-4:] == [0, 1, 2, bank.spec.num_instances]


@pytest.mark.real
def test_embree_sees_the_same_in_the_real_house(suncg_root):
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.scene_compile.pipeline.compile import compile_house

    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    bank = HouseBank.from_compiled([house])
    scene = place(bank, jnp.array([0.1, 0.0, 0.05]))
    met, who = assert_equals_embree(scene, house.box[0] + 0.3, house.box[1] - 0.3, "cpu", 50000)
    assert met > 0.5  # the house does not fill its box
    assert len(who) > 30
