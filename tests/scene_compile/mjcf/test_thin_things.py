"""Things without thickness: houses with them can be exported, stepped and entered by robots."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from thin_things import THIN, mesh_of, room_with, write_room

from home_mjx.geometry.boxes import MIN_HALF_EXTENT
from home_mjx.geometry.meshes import min_thickness
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig, Template, agent_pose, reset, robot_in_house, step
from home_mjx.scene_compile import CompileOptions, compile_house, to_mjcf
from home_mjx.scene_compile.collision.movables import MIN_BODY_HALF, MovableOptions

BALL = '<mujoco><worldbody><body pos="0 1 .1"><freejoint/><geom size=".1"/></body></worldbody></mujoco>'
FREE = CompileOptions(movables=MovableOptions(min_edge=0, min_lowered_height=0))


def check(house):
    """It loads in C MuJoCo and can be stepped; returns the half extents of bodies."""
    model = mujoco.MjModel.from_xml_string(*to_mjcf(house))
    data = mujoco.MjData(model)
    for _ in range(3):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert house.bodies.size.min(initial=1) >= MIN_BODY_HALF
    assert house.colliders.size.min(initial=1) >= MIN_HALF_EXTENT
    assert house.doors.size.min(initial=1) >= MIN_BODY_HALF
    return house.bodies.size


@pytest.mark.parametrize("name", THIN)
@pytest.mark.parametrize("category", ["trash_can", "window", "door", "stairs", "picture_frame"])
def test_things_without_thickness_are_exported(name, category):
    for yaw in (0.0, 0.3, np.pi / 2) if category == "trash_can" else (0.3,):
        for options in (CompileOptions(), FREE):
            house, metadata = room_with(mesh_of(*THIN[name]), category, yaw=yaw)
            assert len(check(compile_house(house, metadata, options))) == 0  # it stays fixed


@pytest.mark.parametrize("yaw", np.linspace(0.0, 1.5, 6).tolist())
def test_an_upright_sheet_stays_fixed_however_it_is_turned(yaw):
    house, metadata = room_with(mesh_of(*THIN["sheet"]), yaw=yaw)
    assert len(check(compile_house(house, metadata))) == 0


@pytest.mark.parametrize("height", [0.05, 0.03, 0.01, 0.0051, 0.005])
def test_a_thing_that_is_sunk_into_the_floor(height):
    """3 cm high: at 0.02 m its top is level with the floor, and its body would have no height, or less than none."""
    corners = [[x, y, z] for x in (-0.2, 0.2) for y in (0, 0.03) for z in (-0.2, 0.2)]
    faces = [[0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7], [0, 4, 1], [1, 4, 5], [2, 3, 6], [3, 7, 6]]
    house, metadata = room_with(mesh_of(corners, faces), "toy", height=height)
    for options in (CompileOptions(), FREE):
        assert len(check(compile_house(house, metadata, options))) == (height > 0.025)


def test_robots_and_c_mujoco_in_a_house_with_a_sheet(tmp_path):
    house, metadata = room_with(mesh_of(*THIN["sheet"]), yaw=0.5)
    compiled = compile_house(house, metadata)
    robot_in_house(compiled, BALL, visuals=False).compile()
    bank = load_bank(str(write_room(tmp_path, house, metadata)))
    template = Template(PhysicsConfig(impl="c"), bank.spec)
    state = reset(template, bank, jnp.int32(0), bank.navigation.start[0, :1], jnp.zeros(1))
    state = jax.jit(step, static_argnums=0)(template, bank, jnp.int32(0), state, jnp.zeros((1, 3)))
    assert np.isfinite(agent_pose(template, state)[0]).all()


@pytest.mark.parametrize(("name", "thickness"), [(name, 1e-3 if name == "card" else 0.0) for name in THIN])
def test_thickness_does_not_depend_on_the_pose(name, thickness, rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    assert min_thickness(np.array(THIN[name][0]) @ turn) == pytest.approx(thickness, abs=1e-12)
