"""Doors of exported houses: hinges as the compiled house says, and what they touch."""

import mujoco
import numpy as np
import pytest
from generated import generate_flats
from numpy.testing import assert_allclose

from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import CompiledHouse


@pytest.fixture(scope="module")
def house(tmp_path_factory) -> CompiledHouse:
    root = tmp_path_factory.mktemp("generated")
    return HouseSet(root, ids=generate_flats(root, [2])).load()[0]


@pytest.fixture(scope="module")
def model(house):
    return mujoco.MjModel.from_xml_string(*to_mjcf(house, agent=AgentBody()))


def _names(house) -> list[str]:
    return [f"object{house.instances.object_id[i]}_leaf{i}" for i in house.doors.instance]


def test_hinges_have_the_range_axis_and_damping_of_the_house(house, model):
    doors = house.doors
    for row, name in enumerate(_names(house)):
        joint = model.joint(name)
        assert joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE
        assert model.jnt_limited[joint.id]
        assert_allclose(joint.range, [doors.low[row], doors.high[row]], atol=1e-7)
        assert_allclose(joint.axis, [0, 0, 1])
        dof = joint.dofadr[0]
        assert (model.dof_armature[dof], model.dof_frictionloss[dof]) == (0.0, 0.0)
        assert_allclose(model.dof_damping[dof], 1.5 * model.dof_M0[dof], rtol=1e-6)
        assert_allclose(model.body(name).mass, doors.mass[row])


def test_the_inertia_about_a_hinge_is_that_of_a_plate_beside_it(house, model):
    """m ((a^2 + b^2) / 12 + d^2): Steiner's theorem."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    dofs = [model.joint(name).dofadr[0] for name in _names(house)]
    assert_allclose(full[dofs, dofs], _inertia(house), rtol=1e-6)


def _inertia(house) -> np.ndarray:
    doors = house.doors
    away = np.linalg.norm(doors.pos[:, :2] - doors.pivot, axis=1)
    return doors.mass * (((2 * doors.size[:, :2]) ** 2).sum(axis=1) / 12 + away**2)


def test_leaves_turn_about_their_pivots(house, model):
    data = mujoco.MjData(model)
    angle = 0.7
    for name in _names(house):
        data.joint(name).qpos[:] = angle
    mujoco.mj_kinematics(model, data)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for row, name in enumerate(_names(house)):
        pos, pivot = house.doors.pos[row], house.doors.pivot[row]
        assert_allclose(data.geom(name).xpos[:2], pivot + turn @ (pos[:2] - pivot), atol=1e-6)
        assert_allclose(data.geom(name).xpos[2], pos[2], atol=1e-6)


def test_leaves_meet_agents_and_movable_objects_only(house, model):
    bodies = [f"object{house.instances.object_id[i]}" for i in house.bodies.instance]
    leaves = _names(house)
    meets = {model.geom(i).name for i in range(model.ngeom) if _collide(model, model.geom(leaves[0]).id, i)}
    assert meets == {"agent0", *bodies}
    assert len(bodies) > 3


def _collide(model, a: int, b: int) -> bool:
    return bool(model.geom_contype[a] & model.geom_conaffinity[b] or model.geom_contype[b] & model.geom_conaffinity[a])


def test_a_leaf_that_is_thrown_stops_at_its_limit(house, model):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for name in _names(house):
        data.joint(name).qvel[:] = 6.0
    least, most = np.inf, -np.inf
    for _ in range(400):
        mujoco.mj_step(model, data)
        angles = np.array([data.joint(name).qpos[0] for name in _names(house)])
        least, most = np.minimum(least, angles), np.maximum(most, angles)
    assert (most <= house.doors.high + np.deg2rad(3)).all()
    assert (least >= house.doors.low - np.deg2rad(3)).all()
    assert (most > house.doors.high - np.deg2rad(3)).any()


def test_a_leaf_slows_down_as_its_damping_says(house, model):
    """From 90 degrees open towards closed, for 0.5 s: exp(-1.5 t) of its speed is left, as in the physics' own step."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    towards = np.sign(house.doors.closed)
    for name, way in zip(_names(house), towards, strict=True):
        data.joint(name).qvel[:] = way
    for _ in range(100):
        mujoco.mj_step(model, data)
    speed = towards * [data.joint(name).qvel[0] for name in _names(house)]
    expected = np.exp(-1.5 * data.time)
    assert (abs(speed - expected) < 2e-3).sum() >= 4  # one may meet something
    assert_allclose(data.time, 0.5)


def test_shut_leaves_are_static_and_closed(house, model):
    instances = np.flatnonzero(np.diff(house.instances.object_id) == 0) + 1  # after their frames
    (shut,) = set(instances.tolist()) - set(house.doors.instance.tolist())
    name = f"object{house.instances.object_id[shut]}_leaf{shut}"
    assert model.body(name).jntnum[0] == 0
    assert (house.colliders.object_id == house.instances.object_id[shut]).sum() >= 4  # frame and leaf
