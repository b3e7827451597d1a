"""Friction and mass of bodies times factors: as in a house whose bodies are so, and as closed forms say."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.errors import ConfigError
from home_mjx.physics import BodyScale, PhysicsSetup, Template
from home_mjx.schema import Timing

GRAVITY, FRICTION, MASS, SPEED = 9.81, 0.4, 3.0, 2.0
FACTORS = np.array([[1.0, 1.0], [0.5, 1.0], [2.0, 1.0], [0.5, 2.0], [1.0, 8.0]])  # of friction and of mass
STEPS = 40  # of 0.1 s


def boxes(friction=1.0, mass=1.0):
    """One that slides into nothing, one that meets another."""
    place = ((0, 0, 0.0995), (0, 2, 0.0995), (0.8, 2, 0.0995))
    masses = MASS, MASS, 1.0
    return [
        Box(at, (0.2, 0.2, 0.1), mass=mass * own, friction=friction * FRICTION)
        for at, own in zip(place, masses, strict=True)
    ]


def slide(houses, scales, impl="fused", speed=SPEED, agent=(50.0, 50.0, 0.0), forward=0.0):
    """Poses of all environments' bodies after two were given a speed; environment e is in house e."""
    bank, num = make_bank(houses), max(len(houses), len(scales))
    template = Template(PhysicsSetup(timing=Timing(ctrl_dt=0.1, sim_dt=0.01), impl=impl), bank.spec)
    house = jnp.arange(num, dtype=jnp.int32) % len(houses)
    factors = jnp.broadcast_to(jnp.asarray(scales, jnp.float32), (num, 2))
    rows, given = template.layout.body_qvel, jnp.zeros((4, 6)).at[:2, 0].set(speed).reshape(-1)

    @jax.jit
    @jax.vmap
    def run(house, factor):
        scale = BodyScale(friction=factor[0], mass=factor[1])
        at, yaw = jnp.array([agent]), jnp.zeros(1)
        state = physics.reset(template, bank, house, at, yaw, scale=scale)
        state = state.replace(qvel=state.qvel.at[rows].set(given))
        action = jnp.array([[forward, 0.0, 0.0]])
        step = lambda s, _: (physics.step(template, bank, house, s, action), None)  # noqa: E731
        state = jax.lax.scan(step, state, None, length=STEPS)[0]
        return physics.body_pose(template, state)[0], state.qpos, state.scale.mass

    pos, qpos, mass = run(house, factors)
    assert_array_equal(mass, factors[:, 1])
    return np.asarray(pos), np.asarray(qpos)


@pytest.mark.cpu
def test_c_mujoco_refuses_scaled_bodies():
    with pytest.raises(ConfigError, match="does not scale bodies"):
        slide([TinyHouse(movable=boxes())], FACTORS[:1], impl="c")


@pytest.fixture(scope="module")
def scaled():
    return slide([TinyHouse(movable=boxes())], FACTORS)


def test_a_box_slides_as_far_as_its_scaled_friction_lets_it(scaled):
    """v^2 / (2 mu g), whatever its mass."""
    assert_allclose(scaled[0][:, 0, 0], SPEED**2 / (2 * FACTORS[:, 0] * FRICTION * GRAVITY), rtol=0.1)


def test_scaled_bodies_are_those_of_a_house_that_has_them_so(scaled):
    """To the last bit where factors are powers of two, as inertia and friction then are."""
    own = slide([TinyHouse(movable=boxes(*factors)) for factors in FACTORS], [[1.0, 1.0]])
    assert_array_equal(scaled[1], own[1])
    assert_allclose(scaled[0][4], scaled[0][0], atol=1e-4)  # if all are heavier, nothing changes among them


def test_a_heavier_box_is_pushed_less_far():
    """Its friction, 0.4 m g, is 12 N and 1177 N; an agent pushes with 300 N."""
    factors = [[1.0, 1.0], [1.0, 100.0]]
    house = [TinyHouse(movable=boxes())]
    light, heavy = slide(house, factors, speed=0.0, agent=(-0.6, 0.0, 0.0), forward=1.0)[0][:, 0, 0]
    assert light > 1.0
    assert abs(heavy) < 0.02


@pytest.mark.slow
def test_mjx_scales_as_the_fused_step(scaled):
    """Within what both differ by at a factor of 1."""
    pos = slide([TinyHouse(movable=boxes())], FACTORS, impl="jax")[0]
    assert_allclose(pos[:, 0], scaled[0][:, 0], atol=0.05)
