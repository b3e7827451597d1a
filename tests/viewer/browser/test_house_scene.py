"""The browser's scene against the bank's own triangles and poses."""

import io

import jax
import numpy as np
import pytest
import trimesh
from generated import flat_id, generate_flats
from handmade import Furniture, shoebox
from scipy.spatial.transform import Rotation

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.scene.scene import make_open_scene, make_scene
from home_mjx.schema.categories import FINE
from home_mjx.schema.semantic import Semantic
from home_mjx.viewer.browser.scene.house_scene import CEILING, MOVING, STATIC, HouseScene, InstanceGroup
from home_mjx.viewer.browser.scene.models import ModelLibrary, texture_pixels
from home_mjx.viewer.browser.scene.poses import is_plain_scale, split_poses


def drawn(group: InstanceGroup) -> np.ndarray:
    """Triangles of a group as a browser draws them (n, 3, 3) [m]."""
    found = []
    for glb in group.glbs:
        corners = trimesh.load(io.BytesIO(glb), file_type="glb").to_mesh().triangles
        for pos, quat, scale in zip(group.pos, group.quat, group.scale, strict=True):
            found.append((corners * scale) @ Rotation.from_quat(quat, scalar_first=True).as_matrix().T + pos)
    return np.concatenate(found)


def world_triangles(bank: HouseBank, moving: object) -> np.ndarray:
    """Triangles of the first house by walking its trees one node at a time (n, 3, 3) [m]."""
    geometry, found = bank.geometry, []
    model, pose = np.asarray(geometry.instance_model[0]), np.array(geometry.instance_pose[0])
    placed = {i: (model[i], pose[i]) for i in np.flatnonzero(model >= 0)}
    for row in np.flatnonzero(np.asarray(moving.instance) >= 0):
        placed[int(moving.instance[row])] = int(moving.model[row]), np.asarray(moving.pose[row])
    child, triangle = np.asarray(geometry.node_child), np.asarray(geometry.triangle)
    for number, matrix in placed.values():
        stack = [int(geometry.model_root[number])]
        while stack:
            for code in child[stack.pop()].tolist():
                if code >= 0:
                    stack.append(code)
                else:
                    first, count = ~code >> 4, ~code & 15
                    found += [corners @ matrix[:, :3].T + matrix[:, 3] for corners in triangle[first : first + count]]
    return np.array(found)


def rows(triangles: np.ndarray) -> np.ndarray:
    """Areas and centres in one order, whatever the order of triangles and corners."""
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    table = np.column_stack([triangles.mean(axis=1), cross / 2]).round(3) + 0.0
    return table[np.lexsort(table.T)]


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    chair = Furniture((1.0, 0.5), (0.5, 0.4, 0.9), mass=5.0)
    table = Furniture((-1.0, 0.0), (1.0, 0.6, 0.7), yaw=0.4)
    return HouseBank.from_compiled([shoebox(furniture=(chair, table))])


def test_split_poses_rebuild_every_affine_map(rng: np.random.Generator):
    pose = np.concatenate([rng.normal(size=(200, 3, 3)), rng.normal(size=(200, 3, 1))], axis=2)
    split = split_poses(pose)
    rotation = Rotation.from_quat(split.quat, scalar_first=True).as_matrix()
    np.testing.assert_allclose(rotation @ split.stretch, pose[:, :, :3], atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(rotation), 1)
    assert (np.sign(np.linalg.det(split.stretch)) == np.sign(np.linalg.det(pose[:, :, :3]))).all()


def test_mirrors_and_shears_are_no_plain_scale():
    assert is_plain_scale(np.diag([0.2, 1.0, 3.0]))
    shear = np.eye(3) + 0.1 * (np.ones((3, 3)) - np.eye(3))
    assert not any(is_plain_scale(x) for x in (np.diag([-1.0, 1, 1]), shear))


def test_the_scene_has_the_bank_s_triangles_where_the_renderer_has_them(bank: HouseBank):
    quat = np.array([[np.cos(0.3), 0, 0, np.sin(0.3)]], np.float32)
    count = bank.spec.num_bodies
    pos = np.tile([[0.3, -0.2, 0.6]], (count, 1)).astype(np.float32)
    agent = np.array([[0.0, 1.0, 0.8]], np.float32)
    scene = make_scene(bank, 0, pos, np.tile(quat, (count, 1)), agent, quat)
    house = HouseScene(bank, 0, scene.moving)
    found = np.concatenate([drawn(group) for group in house.groups])
    np.testing.assert_allclose(rows(found), rows(world_triangles(bank, scene.moving)), atol=2e-3)


def test_moved_groups_are_where_the_renderer_has_them(bank: HouseBank):
    before = make_open_scene(bank, 0).moving
    group = next(g for g in HouseScene(bank, 0, before).groups if g.layer == MOVING)
    quat = np.array([[0.6, 0.8, 0, 0]], np.float32)
    count = bank.spec.num_bodies
    nobody = np.zeros((0, 3), np.float32), np.zeros((0, 4), np.float32)
    moved = make_scene(bank, 0, np.full((count, 3), 0.7, np.float32), np.tile(quat, (count, 1)), *nobody).moving
    split = split_poses(np.asarray(moved.pose))
    box = drawn(group.with_poses(split.pos, split.quat)).reshape(-1, 3)
    entry = int(group.entries[0])
    np.testing.assert_allclose([box.min(axis=0), box.max(axis=0)], np.asarray(moved.box[entry]), atol=1e-3)


def test_ceilings_are_a_layer_of_their_own(bank: HouseBank):
    groups = HouseScene(bank, 0, make_open_scene(bank, 0).moving).groups
    ceiling = np.concatenate([drawn(g) for g in groups if g.layer == CEILING])
    rest = np.concatenate([drawn(g) for g in groups if g.layer == STATIC and g.objects[0] < 0])
    assert ceiling[..., 2].min() >= 3.0 - 1e-6  # the room is 3 m high
    assert rest[..., 2].min() < 0.0
    assert FINE[int(bank.semantics[groups[0].semantic[0], Semantic.FINE])] != "ceiling"


def test_mirrored_models_face_outwards(bank: HouseBank):
    library = ModelLibrary(bank)
    model = int(bank.geometry.instance_model[0, 1])
    glb = library.to_glb(library.triangles(model), int(bank.geometry.instance_material[0, 1]), -np.eye(3))
    mesh = trimesh.load(io.BytesIO(glb), file_type="glb").to_mesh()
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    assert mesh.volume == pytest.approx(np.prod(mesh.extents), rel=1e-4)


def test_textures_are_sent_at_viewing_size():
    chain = np.concatenate([np.full(256 * 256, 7), np.arange(128 * 128), np.full(64 * 64, 9)])
    textures = np.zeros((2, (4 * 256 * 256 - 1) // 3), np.uint32)
    textures[1, : len(chain)] = chain
    pixels = texture_pixels(textures, 1, 128)
    assert pixels.shape == (128, 128, 4)
    np.testing.assert_array_equal(np.ascontiguousarray(pixels).view("<u4")[..., 0].reshape(-1), np.arange(128 * 128))


@pytest.mark.slow
def test_a_flat_is_whole_and_small(tmp_path):
    generate_flats(tmp_path, [3])
    bank = home_mjx.load_bank(str(tmp_path), ids=[flat_id(3)])
    moving = jax.tree.map(np.asarray, make_open_scene(bank, 0).moving)
    house = HouseScene(bank, 0, moving)
    found = np.concatenate([drawn(group) for group in house.groups])
    np.testing.assert_allclose(rows(found), rows(world_triangles(bank, moving)), atol=5e-3)
    count = sum(len(group.entries) for group in house.groups if group.objects[0] >= 0)
    assert count == (np.asarray(bank.geometry.instance_model[0]) >= 0).sum() - 1
    assert sum(len(glb) for group in house.groups for glb in group.glbs) < 20e6
