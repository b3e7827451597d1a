"""Placing bodies and agents."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import compose, invert, quat_matrix, rigid_transform, transform_bounds
from home_mjx.raycast_render.scene.scene import make_scene

FURNITURE = (
    Furniture((1.0, 1.0), (0.4, 0.6, 0.8), yaw=0.3, mass=5.0),
    Furniture((-1.0, 1.0)),
    Furniture((-1.0, -1.0), (1.0, 0.5, 0.2), yaw=-1.0, mass=9.0),
)
QUAT = [[np.cos(0.4), 0, 0, np.sin(0.4)], [0.5, 0.5, 0.5, 0.5]]


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=FURNITURE)])


def place(bank, pos, quat):
    agents = jnp.array([[0.0, 0.5, 0.8], [1.0, -1.0, 0.9]]), jnp.array(QUAT)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        moving = jax.jit(lambda *args: make_scene(*args).moving)(bank, jnp.int32(0), pos, quat, *agents)
    return jax.tree.map(np.asarray, moving)


def test_bodies_at_their_starts_lie_where_the_house_has_them(bank):
    moving = place(bank, bank.physics.body_pos[0], bank.physics.body_quat[0])
    number = bank.physics.body_instance[0, :2]
    np.testing.assert_array_equal(moving.instance[:2], number)
    np.testing.assert_allclose(moving.pose[:2], bank.geometry.instance_pose[0, number], atol=1e-6)
    for name in ("model", "object", "material", "semantic"):
        field = {"object": "object_id"}.get(name, name)
        np.testing.assert_array_equal(getattr(moving, field)[:2], getattr(bank.geometry, f"instance_{name}")[0, number])


def test_a_moved_body_turns_about_its_middle(bank, rng):
    pos, quat = np.array(bank.physics.body_pos[0]), np.array(bank.physics.body_quat[0])
    pos[1], quat[1] = [0.3, -0.2, 1.5], [0.5, -0.5, 0.5, 0.5]
    moving = place(bank, jnp.asarray(pos), jnp.asarray(quat))
    middle = np.asarray(bank.geometry.model_box)[moving.model[1]].mean(axis=0)
    np.testing.assert_allclose(moving.pose[1, :, :3] @ middle + moving.pose[1, :, 3], pos[1], atol=1e-6)
    # Half extents 0.5 0.25 0.1, turned by 120 degrees: the axes change places.
    size = moving.box[1, 1] - moving.box[1, 0]
    np.testing.assert_allclose(np.sort(size), [0.2, 0.5, 1.0], atol=1e-3)


def test_agents_follow_the_house_s_instances(bank):
    moving = place(bank, bank.physics.body_pos[0], bank.physics.body_quat[0])
    count = bank.spec.num_instances
    np.testing.assert_array_equal(moving.instance[-2:], [count, count + 1])
    np.testing.assert_array_equal(moving.object_id[-2:], [count, count + 1])
    np.testing.assert_array_equal(moving.model[-2:], bank.geometry.agent_model)
    # The capsule stands upright around its middle, the visor ahead.
    np.testing.assert_allclose(moving.box[-2].mean(axis=0)[2], 0.8, atol=1e-5)
    np.testing.assert_allclose(moving.pose[-2, :, :3] @ [1, 0, 0], [np.cos(0.8), np.sin(0.8), 0], atol=1e-6)


def test_unused_slots_are_inert_whatever_their_pose(bank):
    pos, quat = np.array(bank.physics.body_pos[0]), np.array(bank.physics.body_quat[0])
    pos[2:], quat[2:] = np.nan, np.nan
    moving = place(bank, jnp.asarray(pos), jnp.asarray(quat))
    unused = slice(2, -2)
    assert len(moving.instance[unused]) > 0
    assert (moving.instance[unused] == -1).all()
    assert (moving.box[unused, 0] > moving.box[unused, 1]).all()
    assert np.isfinite(moving.pose).all()
    assert np.isfinite(moving.inverse).all()


def test_maps(rng):
    quat = rng.normal(size=4)
    quat = jnp.asarray(quat / np.linalg.norm(quat), jnp.float32)
    pose = jnp.asarray(rng.normal(size=(3, 4)), jnp.float32)
    body = rigid_transform(jnp.array([1.0, 2, 3]), quat)
    identity = np.eye(3, 4)
    np.testing.assert_allclose(quat_matrix(quat) @ quat_matrix(quat).T, np.eye(3), atol=1e-6)
    assert np.linalg.det(np.asarray(quat_matrix(quat))) > 0
    np.testing.assert_allclose(compose(pose, invert(pose)), identity, atol=1e-4)
    np.testing.assert_allclose(compose(invert(pose), pose), identity, atol=1e-4)
    point = rng.normal(size=3).astype(np.float32)
    there = np.asarray(pose[:, :3]) @ point + np.asarray(pose[:, 3])
    np.testing.assert_allclose(
        compose(body, pose)[:, :3] @ point + compose(body, pose)[:, 3], body[:, :3] @ there + body[:, 3], atol=1e-4
    )
    box = np.sort(rng.normal(size=(2, 3)), axis=0).astype(np.float32)
    corners = np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3) @ np.asarray(pose[:, :3]).T + np.asarray(pose[:, 3])
    np.testing.assert_allclose(
        transform_bounds(pose, jnp.asarray(box)), [corners.min(axis=0), corners.max(axis=0)], atol=1e-5
    )


def test_a_quaternion_that_is_not_of_unit_length_makes_no_larger_body(bank):
    pos, quat = bank.physics.body_pos[0], np.array(bank.physics.body_quat[0])
    quat[1] *= 2
    moving = place(bank, pos, jnp.asarray(quat))
    assert np.isnan(moving.pose[1]).all()
    assert np.isfinite(np.delete(moving.pose, 1, axis=0)).all()
