"""A generated house whose doors slide into their walls, every second one: from its meshes to agents that open them."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from door_states import other_state
from generated import generate_flats
from numpy.testing import assert_allclose, assert_array_equal

from home_mjx import HouseBank, physics
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.read.door_joints import find_joints
from home_mjx.datasets.suncg.read.hinges import find_hinges
from home_mjx.geometry.meshes import triangles_z_up
from home_mjx.navigation import door_angles, passable_portals
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.hand_control import HandCommands, apply_hand_commands, update_hands
from home_mjx.raycast_render import cast, make_scene
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.agent import AgentBody

WAY = 0.7  # [m]
HOUSE = jnp.int32(0)


def slid(closed, shown):
    """A door's mesh with its leaf not turned, but shifted by `WAY` along the wall."""
    (hinge,) = find_hinges(triangles_z_up(shown), triangles_z_up(closed))
    vertices = closed.vertices.copy()
    vertices[np.unique(closed.faces[hinge.leaf])] += [WAY, 0, 0]
    return replace(closed, vertices=vertices)


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    root = tmp_path_factory.mktemp("generated")
    (name,) = generate_flats(root, [1])
    dataset = open_dataset(root)
    found = dataset.load_house(name)
    models, objects = dict(found.models), []
    doors = [o for o in found.levels[0].objects if o.joints]
    for door in doors[::2]:
        closed, is_closed = other_state(dataset, door), door.model_key != door.model_id
        key = f"sliding_{is_closed}"
        models[key] = slid(closed, models[door.model_key])
        joints = find_joints(key, models[key], closed, is_closed)
        objects.append(replace(door, model_id="sliding", model_key=key, joints=joints))
    changed = {o.index: o for o in objects}
    level = replace(found.levels[0], objects=tuple(changed.get(o.index, o) for o in found.levels[0].objects))
    known = dataset.metadata.models | {"sliding": dataset.metadata.info(doors[0].model_id)}
    metadata = replace(dataset.metadata, models=known)
    return compile_house(replace(found, models=models, levels=(level,)), metadata)


@pytest.fixture(scope="module")
def bank(house):
    return HouseBank.from_compiled([house])


def test_leaves_slide_as_far_as_they_were_shifted(house):
    doors = house.doors
    assert 0 < doors.is_sliding.sum() < len(doors.mass)
    assert_allclose(abs(doors.fully_open - doors.closed)[doors.is_sliding], WAY, atol=0.011)
    assert_array_equal(doors.fully_open[doors.is_sliding], 0)  # as shown
    assert_allclose(np.linalg.norm(doors.slide[doors.is_sliding], axis=1), 1)
    thin = doors.size[:, :2].argmin(axis=1)
    yaw = 2 * np.arctan2(doors.quat[:, 3], doors.quat[:, 0]) + np.pi / 2 * thin
    across = np.c_[np.cos(yaw), np.sin(yaw)]
    assert_allclose((doors.slide * across).sum(axis=1)[doors.is_sliding], 0, atol=1e-3)


def test_a_bank_has_sliding_leaves_last_and_portals_name_their_rows(house, bank):
    doors, slides = house.doors, int(house.doors.is_sliding.sum())
    assert bank.spec.num_slides >= slides
    valid = np.asarray(bank.physics.door_valid[0])
    first = bank.spec.num_doors - bank.spec.num_slides
    assert valid[first:].sum() == slides
    assert valid.sum() == len(doors.mass)
    assert (np.asarray(bank.physics.door_slide[0, first:]) != 0).any(axis=1).all()  # padding, too
    assert (np.asarray(bank.physics.door_slide[0, :first]) == 0).all()
    leaf, packed = (
        house.navigation.portals.leaf,
        np.asarray(bank.navigation.portal_leaf[0])[: len(house.navigation.portals.leaf)],
    )
    assert_array_equal(packed >= 0, leaf >= 0)
    instance = np.asarray(bank.physics.door_instance[0])
    assert_array_equal(instance[packed[leaf >= 0]], doors.instance[leaf[leaf >= 0]])


@pytest.mark.parametrize("state", ["open", "closed"])
def test_rays_and_ways_go_through_where_a_leaf_was(house, bank, state):
    """A ray across each doorway that slides, at the middle of the closed leaf."""
    angle = door_angles(bank, HOUSE, state, jax.random.key(0))
    scene = make_scene(bank, HOUSE, bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody(), door_angle=angle)
    doors = house.doors
    for row in np.flatnonzero(doors.is_sliding):
        middle = doors.pos[row] + doors.closed[row] * np.array([*doors.slide[row], 0])
        across = np.array([-doors.slide[row, 1], doors.slide[row, 0], 0])
        origin = jnp.array(middle - 0.3 * across, jnp.float32)[None]
        hit = cast(scene, origin, jnp.array(across, jnp.float32)[None])
        met = int(hit.instance[0]) == int(doors.instance[row]) and float(hit.t[0]) < 0.35
        assert met == (state == "closed")
    passed = np.asarray(passable_portals(bank, HOUSE, angle))[: len(house.navigation.portals.leaf)]
    portals = house.navigation.portals
    inner = (portals.leaf[:, 0] >= 0) & (portals.width > 0)
    assert inner.any()
    assert (passed[inner] == (state == "open")).all()


def nobody():
    return jnp.zeros((0, 3)), jnp.zeros((0, 4))


def test_exported_leaves_slide_to_where_they_are_closed(house):
    model = mujoco.MjModel.from_xml_string(*to_mjcf(house, agent=AgentBody()))
    data, doors = mujoco.MjData(model), house.doors
    for row in np.flatnonzero(doors.is_sliding):
        name = f"object{house.instances.object_id[doors.instance[row]]}_leaf{doors.instance[row]}"
        joint = model.joint(name)
        assert joint.type[0] == mujoco.mjtJoint.mjJNT_SLIDE
        assert_allclose(joint.range, [doors.low[row], doors.high[row]], atol=1e-7)
        data.joint(name).qpos[:] = doors.closed[row]
        mujoco.mj_kinematics(model, data)
        expected = doors.pos[row] + doors.closed[row] * np.array([*doors.slide[row], 0])
        assert_allclose(data.geom(name).xpos, expected, atol=1e-6)


def test_a_hand_slides_a_door_open_and_shut(house, bank):
    """Without dynamics, which other tests have; what is told here is which leaf moves, and how far."""
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    row = bank.spec.num_doors - bank.spec.num_slides
    beside = bank.physics.door_pos[0, row] + jnp.array([0.0, 0.0, -1.0])
    shut = door_angles(bank, HOUSE, "closed", jax.random.key(0))
    state = physics.reset(template, bank, HOUSE, beside[None], jnp.zeros(1), shut)

    @jax.jit
    def step(state, commands):
        state = physics.step(
            template, bank, HOUSE, apply_hand_commands(template, bank, HOUSE, state, commands), jnp.zeros((1, 3))
        )
        return update_hands(template, bank, HOUSE, state)

    for opens, end in ((True, bank.physics.door_fully_open), (False, bank.physics.door_closed)):
        command = HandCommands.idle(1).replace(door=jnp.array([row], jnp.int32), open=jnp.array([opens]))
        for t in range(12):
            state = step(state, command if t == 0 else HandCommands.idle(1))
        way = physics.door_angle(template, state)
        assert_allclose(way[row], end[0, row], atol=0.03)
        assert_array_equal(np.delete(np.asarray(way), row), np.delete(np.asarray(shut), row))
