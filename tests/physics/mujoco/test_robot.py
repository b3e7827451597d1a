"""A robot of a user's MJCF in a house: it drives, walls and doors stop it, C MuJoCo and MJX agree."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from generated import generate_flats
from handmade import Furniture, shoebox
from mujoco import mjx
from numpy.testing import assert_allclose
from robots import WHEELED

from home_mjx.errors import ConfigError
from home_mjx.houses.house_set import HouseSet
from home_mjx.physics import MujocoModel, robot_in_house

pytestmark = pytest.mark.cpu

SUBSTEPS, DT = 5, 0.01
DRIVE = np.array([8.0, 8.0, 0.5], np.float32)  # [rad/s] of both wheels, [rad] of the arm
HOUSE = shoebox(furniture=[Furniture((-1.5, 0.5), mass=5.0), Furniture((1.0, 1.5), category="chair")])


@pytest.fixture(scope="module")
def model():
    return robot_in_house(HOUSE, WHEELED, (1.5, 0.0, 0.0), 0.1, timestep=DT, movable=False, visuals=False).compile()


@pytest.fixture(scope="module")
def driven(model):
    """States after each step of 0.05 s, of three robots: forward, turning, at rest (t, robot, s); their sensors."""
    house = MujocoModel(model, SUBSTEPS)
    ctrl = jnp.array([DRIVE, DRIVE * [-0.5, 0.5, 1], DRIVE * 0])

    @jax.jit
    def run(states):
        def step(states, _):
            states, sensors = jax.vmap(house.step)(states, ctrl)
            return states, (states, sensors)

        return jax.lax.scan(step, states, None, length=40)[1]

    states, sensors = run(jnp.tile(house.start, (3, 1)))
    return house, np.asarray(states), np.asarray(sensors)


def test_a_robot_drives_until_a_wall_stops_it(driven):
    house, states, sensors = driven
    (x, y, z), quat = sensors[:, 0].T, states[15, 0, house.qpos][..., 3:7]
    yaw = 2 * np.arctan2(quat[3], quat[0])
    assert_allclose(yaw, 0.1, atol=0.08)  # wheels that start at once slip a little
    free = slice(10, 16)
    speed = np.hypot(np.diff(x[free]), np.diff(y[free])) / (SUBSTEPS * DT)
    assert_allclose(speed, DRIVE[0] * 0.1, rtol=0.05)  # wheels of 0.1 m roll
    assert_allclose(np.arctan2(y[15] - y[10], x[15] - x[10]), yaw, atol=0.01)  # straight ahead
    assert 3 - 0.2 * np.cos(yaw) - 0.06 < x[-1] < 3 - 0.18  # it is 0.4 m long, the wall at 3 m
    assert_allclose(z, 0.1, atol=0.02)
    assert_allclose(states[-1, 2, house.qpos], states[10, 2, house.qpos], atol=2e-3)  # who rests, rests


def test_a_robot_turns_on_the_spot(driven):
    house, states, sensors = driven
    assert_allclose(sensors[-1, 1, :2], [1.5, 0], atol=0.05)
    quat = states[:, 1, house.qpos][-1, 3:7]
    turned = 2 * np.arctan2(quat[3], quat[0]) - 0.1
    assert_allclose(np.mod(turned, 2 * np.pi), 2 * 4 * 0.1 / 0.2, atol=0.1)  # 2 s; wheels 0.2 m away


def test_mjx_moves_the_robot_alike(model, driven):
    """One environment, until after the wall."""
    house, states, _ = driven
    with jax.numpy_dtype_promotion("standard"), jax.numpy_rank_promotion("allow"):
        device = mjx.put_model(model)
        data = mjx.make_data(device).replace(ctrl=jnp.asarray(DRIVE))

        @jax.jit
        def run(data):
            def step(data, _):
                data = jax.lax.fori_loop(0, SUBSTEPS, lambda _, d: mjx.step(device, d), data)
                return data, data.qpos

            return jax.lax.scan(step, data, None, length=40)[1]

        qpos = np.asarray(run(data))
    want = states[:, 0, house.qpos]
    wheels = [model.joint(f"robot/{side}").qposadr[0] for side in ("left", "right")]
    rest = np.setdiff1d(np.arange(model.nq), wheels)
    assert_allclose(qpos[:25, rest], want[:25, rest], atol=5e-3)
    assert_allclose(qpos[-1, :3], want[-1, :3], atol=0.03)


def test_a_robot_pushes_what_is_movable():
    model = robot_in_house(HOUSE, WHEELED, (-0.7, 0.5, 0.0), np.pi, timestep=DT, visuals=False).compile()
    house = MujocoModel(model, 150)
    state, _ = jax.jit(house.step)(house.start, jnp.asarray(DRIVE))
    box = house.qpos.start + model.joint("object0").qposadr[0]
    assert_allclose(house.start[box : box + 2], [-1.5, 0.5])
    assert -2.8 < float(state[box]) < -1.7
    assert_allclose(state[box + 1], 0.5, atol=0.05)


def test_doors_meet_the_robot_but_not_the_house(tmp_path):
    (house,) = HouseSet(tmp_path, ids=generate_flats(tmp_path, [0])).load()
    x, y, _ = house.doors.pos[0]
    spec = robot_in_house(house, mujoco.MjSpec.from_string(WHEELED), (x, y, 0.02), visuals=False)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    owner = [[model.body(model.geom_bodyid[g]).name for g in pair] for pair in data.contact.geom]
    leaf = [pair for pair in owner if any("_leaf" in name for name in pair)]
    assert leaf
    assert all(any(name.startswith("robot/") for name in pair) for pair in leaf)
    assert model.nmesh == 0


@pytest.mark.parametrize(
    ("robot", "message"), [("no_such.xml", "does not exist"), ("<mujoco><nothing/></mujoco>", "not valid MJCF")]
)
def test_what_is_no_robot_is_refused(robot, message):
    with pytest.raises(ConfigError, match=message):
        robot_in_house(HOUSE, robot)


def test_the_given_robot_is_not_changed():
    robot = mujoco.MjSpec.from_string(WHEELED)
    before = robot.to_xml()
    twice = [robot_in_house(HOUSE, robot, (0, y, 0)).compile() for y in (0.0, 1.0)]
    assert robot.to_xml() == before
    assert [model.nq for model in twice] == [7 + 3 + 7] * 2


def test_steps_in_c_are_mujocos_own(model, driven):
    """The first step of the first robot, by hand."""
    house, states, sensors = driven
    data = mujoco.MjData(model)
    data.ctrl[:] = DRIVE
    for _ in range(SUBSTEPS):
        mujoco.mj_step(model, data)
    assert_allclose(states[0, 0, house.qpos], data.qpos, atol=1e-6)
    assert_allclose(states[0, 0, house.qvel], data.qvel, atol=1e-5)
    # Sensors are of the positions before the last physics step.
    assert_allclose(sensors[0, 0], data.sensordata, atol=1e-6)


def test_a_gradient_and_no_substeps_are_refused(driven):
    house = driven[0]
    with pytest.raises(ConfigError, match="C MuJoCo has no gradient"):
        jax.grad(lambda ctrl: house.step(house.start, ctrl)[0].sum())(jnp.zeros(3))
    with pytest.raises(ConfigError, match="substeps"):
        MujocoModel(house.model, 0)


def test_states_and_controls_of_other_models_are_refused(driven):
    """MuJoCo once told of them from inside of XLA, as an internal error."""
    house = driven[0]
    with pytest.raises(ConfigError, match=r"`ctrl` must have the shape \(3,\), got \(4,\)"):
        house.step(house.start, jnp.zeros(4))
    with pytest.raises(ConfigError, match="`state` must have the shape"):
        house.step(house.start[1:], jnp.zeros(3))


@pytest.mark.parametrize("timestep", [0.0, -0.01, float("nan")])
def test_useless_timesteps_are_refused(timestep):
    with pytest.raises(ConfigError, match="`timestep` must be"):
        robot_in_house(HOUSE, WHEELED, timestep=timestep)
