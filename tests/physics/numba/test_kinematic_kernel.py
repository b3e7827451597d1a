"""The kernel of kinematic steps against the same step in JAX, in homes of one to three storeys and in flats."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from storey_homes import homes_bank
from tiny_houses import Box, Door, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, PhysicsSetup, Template
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.kinematic.kinematic_step import step_in_jax
from home_mjx.physics.kinematic.native import KERNEL
from home_mjx.schema import AgentBody

ENVS, STEPS = 48, 60


@pytest.fixture(scope="module", params=[pytest.param("storeys, 1", marks=pytest.mark.slow), "storeys, 3", "flats, 2"])
def world(request, generated_bank):
    """Bank and template of homes on stairs, or of flats with movable bodies and doors; agents of different sizes."""
    kind, num = request.param.split(", ")
    bodies = (AgentBody(), AgentBody(radius=0.15, height=0.9, eye_height=0.8), AgentBody(forward_speed=4.0))
    bank = homes_bank() if kind == "storeys" else generated_bank
    return bank, Template(PhysicsSetup(impl="kinematic", num_agents=int(num), bodies=bodies[: int(num)]), bank.spec)


def begun(bank, template, rng):
    agents = template.layout.num_agents
    house = np.arange(ENVS) % bank.num_houses
    starts = np.asarray(bank.navigation.start)
    pick = rng.integers(0, starts.shape[1], (ENVS, agents))
    pos = starts[house[:, None], pick] + np.array([0, 0, 0.01])
    yaw = rng.uniform(-np.pi, np.pi, (ENVS, agents))
    reset = jax.jit(jax.vmap(lambda *given: physics.reset(template, bank, *given)))
    house = jnp.asarray(house, jnp.int32)
    return house, reset(house, jnp.asarray(pos, jnp.float32), jnp.asarray(yaw, jnp.float32))


def disturbed(state, layout, rng):
    """The state with other held bodies, goals of doors and released bodies."""
    agents, bodies, doors = layout.num_agents, layout.num_bodies, layout.num_doors
    held = rng.integers(-bodies, bodies, (ENVS, agents)).clip(-1) if bodies else np.full((ENVS, agents), -1)
    grip = np.concatenate([rng.uniform(-0.6, 0.6, (ENVS, agents, 3)), rng.normal(size=(ENVS, agents, 4))], axis=-1)
    grip[..., 3:] /= np.linalg.norm(grip[..., 3:], axis=-1, keepdims=True)
    goal = np.where(rng.random((ENVS, doors)) < 0.5, rng.uniform(-2, 2, (ENVS, doors)), NOT_DRIVEN)
    qvel = np.array(state.qvel)
    released = np.repeat(rng.random((ENVS, bodies)) < 0.1, 6, axis=1)
    qvel[:, layout.body_qvel] = released * rng.normal(size=released.shape)
    return state.replace(
        held=jnp.asarray(held, jnp.int32),
        grip=jnp.asarray(grip, jnp.float32),
        door_goal=jnp.asarray(goal, jnp.float32),
        qvel=jnp.asarray(qvel, jnp.float32),
    )


def test_it_agrees_with_the_step_in_jax(world, rng):
    """But for decisions at a bound, such as whether an agent stays in a gap; those are few."""
    assert KERNEL.find_problem("cpu") is None
    bank, template = world
    house, state = begun(bank, template, rng)
    steps = [
        jax.jit(jax.vmap(lambda house, state, action, step=step: step(template, bank.physics, house, state, action)[0]))
        for step in (step_in_jax, physics.dynamics.step_kinematic)
    ]
    other, unequal, touched, dropped = 0, 0, 0, 0
    for number in range(STEPS):
        if number % 6 == 0:
            state = disturbed(state, template.layout, rng)
            action = rng.uniform(-1.3, 1.3, (ENVS, template.layout.num_agents, 3))
            action[..., 0] = np.abs(action[..., 0])
        expected, got = (step(house, state, jnp.asarray(action, jnp.float32)) for step in steps)
        off = np.abs(np.asarray(got.qpos) - np.asarray(expected.qpos)).max(axis=1)
        other += (off > 1e-4).sum()
        near = off <= 1e-4
        assert_allclose(np.asarray(got.qvel)[near], np.asarray(expected.qvel)[near], atol=2e-3)
        unequal += (np.asarray(got.num_contacts) != np.asarray(expected.num_contacts)).sum()
        touched += (np.asarray(expected.num_contacts) > 0).sum()
        before, after = (np.asarray(x.qpos)[:, template.layout.body_qpos].reshape(ENVS, -1, 7) for x in (state, got))
        dropped += (before[..., 2] > after[..., 2] + 0.01).sum()
        for name in ("held", "grip", "door_goal", "qacc", "contact_impulse"):
            assert_array_equal(getattr(got, name), getattr(expected, name))
        state = expected
    assert touched > 100
    assert dropped > 10 or not template.layout.num_bodies
    assert other <= 3
    assert unequal <= 12


def test_one_environment_and_nested_batches_are_the_same(world, rng):
    bank, template = world
    house, state = begun(bank, template, rng)
    action = jnp.asarray(rng.uniform(-1, 1, (ENVS, template.layout.num_agents, 3)), jnp.float32)
    step = lambda *given: physics.step(template, bank, *given).qpos  # noqa: E731
    flat = jax.jit(jax.vmap(step))(house, state, action)
    folded = jax.tree.map(lambda x: x.reshape(6, 8, *x.shape[1:]), (house, state, action))
    assert_array_equal(np.asarray(jax.jit(jax.vmap(jax.vmap(step)))(*folded)).reshape(flat.shape), flat)
    assert_array_equal(jax.jit(step)(house[5], jax.tree.map(lambda x: x[5], state), action[5]), flat[5])


def test_gradients_are_those_of_the_step_in_jax():
    """Of the door that the agent opens, and of its own place along a wall."""
    bank = make_bank(
        [TinyHouse(movable=[Box((2, 2, 0.1), (0.1, 0.1, 0.1))], doors=[Door(pivot=(0.9, 0.2))])], num_bodies=1
    )
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    house, action = jnp.int32(0), jnp.array([[0.9, 0.3, 0.2]])
    state = physics.reset(template, bank, house, jnp.zeros((1, 3)), jnp.zeros(1))

    def slope(step):
        return jax.jit(jax.jacobian(lambda given: step(given)[0].qpos))(action)

    got = slope(lambda given: physics.dynamics.step_kinematic(template, bank.physics, house, state, given))
    expected = slope(lambda given: step_in_jax(template, bank.physics, house, state, given))
    assert_array_equal(got, expected)
    assert np.abs(got).max() > 0.05


def test_a_bank_without_bodies():
    bank = make_bank([TinyHouse()], num_bodies=0)
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    assert template.layout.num_bodies == 0
    state = physics.reset(template, bank, jnp.int32(0), jnp.zeros((1, 3)), jnp.zeros(1))
    action = jnp.array([[1.0, 0.0, 0.0]])
    expected = jax.jit(lambda: step_in_jax(template, bank.physics, jnp.int32(0), state, action)[0])()
    got = physics.step(template, bank, jnp.int32(0), state, action)
    assert_allclose(got.qpos, expected.qpos, atol=1e-6)
