"""Agents climb stairs, which are ramps to them, stand on them, and walk on upper floors."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, Template

SLOPE, RISE = np.deg2rad(32), 1.5
RUN = RISE / np.tan(SLOPE)
TOP = np.array([1 + RUN / 2, 0, RISE / 2])  # middle of the ramp, which begins at x = 1
NORMAL = np.array([-np.sin(SLOPE), 0, np.cos(SLOPE)])
HOUSE = TinyHouse(
    static=[
        Box(tuple(TOP - 0.1 * NORMAL), (0.6, RISE / np.sin(SLOPE) / 2, 0.1), yaw=-np.pi / 2, roll=SLOPE),
        Box((1 + RUN + 1.5, 0, RISE - 0.1), (1.5, 1.5, 0.1)),
    ],
    movable=[Box((1 + RUN + 2, 0.8, RISE + 0.201), (0.2, 0.2, 0.2), mass=3)],
    ramp_collider=0,
    ramp=(TOP[0], 0, 1, 0, RUN / 2, 0.6, RISE / 2, np.tan(SLOPE)),
)


@pytest.fixture(scope="module", params=["fused", "c", "kinematic"])
def walk(request):
    bank = make_bank([HOUSE])
    template = Template(PhysicsConfig(impl=request.param), bank.spec)
    step = jax.jit(lambda state, action: physics.step(template, bank, jnp.int32(0), state, action[None]))

    def run(start, *action, steps):
        state = physics.reset(template, bank, jnp.int32(0), jnp.array([start], jnp.float32), jnp.zeros(1))
        poses = []
        for _ in range(steps):
            state = step(state, jnp.array(action))
            poses.append(np.asarray(state.qpos))
        return np.array(poses)

    return run


def test_an_agent_walks_up_and_on(walk):
    poses = walk((0.0, 0.0, 0.0), 1.0, 0.0, 0.0, steps=55)
    assert poses[-1, 0] > 1 + RUN + 0.5
    assert_allclose(poses[-1, 2], RISE + 0.8, atol=0.01)
    on_ramp = (poses[:, 0] > 1.3) & (poses[:, 0] < 0.8 + RUN)
    surface = (poses[on_ramp, 0] - 1) * np.tan(SLOPE) + 0.8
    assert_allclose(poses[on_ramp, 2], surface, atol=0.06)  # the ball of the foot touches above its lowest point
    assert (np.diff(poses[on_ramp, 0]) > 0.06).all()  # it does not stick


def test_an_agent_stands_on_the_stairs(walk):
    start = TOP + np.array([0, 0, 0.02])
    poses = walk(start, 0.0, 0.0, 0.0, steps=40)
    assert_allclose(poses[-1, :2], poses[10, :2], atol=0.01)
    assert abs(poses[-1, 0] - start[0]) < 0.1


def test_an_agent_walks_down_again(walk):
    poses = walk((1 + RUN + 1.0, 0.0, RISE), -1.0, 0.0, 0.0, steps=60)
    assert poses[-1, 0] < 0.5
    assert_allclose(poses[-1, 2], 0.8, atol=0.01)
    assert_allclose(poses[-1, 6], RISE + 0.2, atol=0.01)  # what stands upstairs stays there


@pytest.mark.parametrize("height", [0.5, 2.0])
def test_a_kinematic_body_released_over_stairs_rests_on_them(height):
    """It neither falls through to the floor below, nor floats at the height of the highest step."""
    x = 1 + RUN / 4
    thing = Box((x, 0.2, height + RISE / 4), (0.1, 0.1, 0.1), mass=1)
    bank = make_bank([replace(HOUSE, movable=[thing])])
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    state = physics.reset(template, bank, jnp.int32(0), jnp.zeros((1, 3)), jnp.zeros(1))
    state = state.replace(qvel=state.qvel.at[template.layout.body_qvel].set(-1e-3))
    state = physics.step(template, bank, jnp.int32(0), state, jnp.zeros((1, 3)))
    assert_allclose(state.qpos[template.layout.body_qpos].reshape(-1, 7)[0, 2], RISE / 4 + 0.1, atol=1e-4)
