"""Environments of one batch are in different houses and do not know of one another."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import rollouts
from numpy.testing import assert_allclose, assert_array_equal
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import Template
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.physics.mjx.template_mjcf import PARKED_HEIGHT


def _take(tree, index):
    return jax.tree.map(lambda x: x[index], tree)


def test_permuted_batch_gives_the_same_bits(world):
    order = np.array([3, 7, 0, 5, 1, 8, 6, 2, 4])
    assert sorted(order) == list(range(rollouts.BATCH))
    actions = rollouts.actions()[:, order]
    _, permuted = world.run(world.bank, world.house[order], _take(world.start, order), actions)
    for got, want in zip(permuted, world.rollout, strict=True):
        assert_array_equal(got, want[:, order])


def test_changed_neighbours_change_no_bit(world):
    house = world.house.at[1::2].set(rollouts.NAMES.index("crowded"))
    actions = rollouts.actions().at[:, 1::2].set(-0.5)
    start = rollouts.start(world.bank, world.template, house)
    _, changed = world.run(world.bank, house, start, actions)
    for got, want in zip(changed, world.rollout, strict=True):
        assert_array_equal(got[:, ::2], want[:, ::2])


@pytest.mark.parametrize("world", [pytest.param("jax", marks=pytest.mark.slow), "fused", "c"], indirect=True)
def test_alone_as_in_the_batch(world):
    """Within 1e-4 over 100 physics steps, bodies resting and pushed."""
    index = rollouts.NAMES.index("sofa")
    one = slice(index, index + 1)
    alone = rollouts.make_run(world.template)
    _, got = alone(world.bank, world.house[one], _take(world.start, one), rollouts.actions()[:, one])
    for name in ("agent_pos", "agent_yaw", "body_pos"):
        assert_allclose(getattr(got, name), getattr(world.rollout, name)[:, one], atol=1e-4, err_msg=name)


def test_unused_bodies_never_move(world):
    """They are put back exactly after each physics step, so what holds after 200 steps holds after any number."""
    data, rollout = world.end, world.rollout
    used = np.asarray(world.bank.physics.body_valid)
    first = rollout.body_pos[0][~used]
    assert (first[:, 2] == PARKED_HEIGHT).all()
    for _ in range(2):
        assert_array_equal(rollout.body_pos[-1][~used], first)
        assert_array_equal(rollout.body_quat[-1][~used], np.tile([1.0, 0, 0, 0], (len(first), 1)))
        qvel = np.asarray(data.qvel)[:, world.template.layout.body_qvel].reshape(*used.shape, 6)
        assert not qvel[~used].any()
        data, rollout = world.run(world.bank, world.house, data, rollouts.actions())


def test_bodies_jammed_into_each_other_stay_finite_and_inside():
    """A house that no compiler should make: bodies deep inside walls and one another."""
    rng = np.random.default_rng(1)
    shell = [Box((x, 0, 1.2), (0.2, 2.2, 1.2)) for x in (-2, 2)] + [Box((0, y, 1.2), (2.2, 0.2, 1.2)) for y in (-2, 2)]

    def jammed():
        middles = rng.uniform(-0.7, 0.7, (4, 2))
        return TinyHouse(
            static=[*shell, Box((0.3, 0.2, 0.3), (0.3, 0.3, 0.3))],
            movable=[Box((*xy, 0.3), tuple(rng.uniform(0.05, 0.4, 3)), mass=rng.uniform(1, 80)) for xy in middles],
        )

    bank = make_bank([jammed() for _ in range(rollouts.BATCH)])
    template = Template(PhysicsConfig(), bank.spec)
    house = jnp.arange(rollouts.BATCH, dtype=jnp.int32)
    run, data = rollouts.make_run(template), rollouts.start(bank, template, house)
    for _ in range(3):
        data, rollout = run(bank, house, data, rollouts.actions())
        assert np.isfinite(rollout.body_pos).all()
        assert np.isfinite(rollout.agent_pos).all()
        assert (np.abs(rollout.body_pos[..., :2]) < 2.5).all()
        assert (np.abs(rollout.agent_pos[..., :2]) < 2.5).all()
    speed = np.abs(np.asarray(data.qvel)[:, template.layout.body_qvel])
    assert speed.max() <= template.config.max_body_spin * (1 + 1e-5)


class Pair:
    """Two agents that face each other in a house without any box."""

    def __init__(self):
        bank = make_bank([TinyHouse(floor=-0.5)], num_bodies=0)
        self.template = Template(PhysicsConfig(num_agents=2), bank.spec)
        pos = jnp.array([[-1.0, 0.0, -0.5], [1.0, 0.0, -0.5]])
        house = jnp.int32(0)
        self.start = physics.reset(self.template, bank, house, pos, jnp.array([0.0, jnp.pi]))
        self.step = jax.jit(lambda data, action: physics.step(self.template, bank, house, data, action))

    def walk(self, action, steps):
        data, contact = self.start, []
        for _ in range(steps):
            data = self.step(data, jnp.array(action))
            contact.append(np.asarray(physics.agent_contact(self.template, data)))
        return data, np.array(contact)


@pytest.fixture(scope="module")
def pair():
    return Pair()


def test_agents_stop_each_other_in_a_house_without_bodies(pair):
    data, contact = pair.walk([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 20)
    pos, yaw = physics.agent_pose(pair.template, data)
    assert_allclose(pos, [[-0.1, 0, 0.3], [0.1, 0, 0.3]], atol=5e-3)
    assert_allclose(yaw, [0, np.pi], atol=1e-3)
    assert not contact[3].any()
    assert contact[-1].all()
    assert physics.body_pose(pair.template, data)[0].shape == (0, 3)


def test_velocity_is_in_the_agents_own_frame(pair):
    data, _ = pair.walk([[0.0, 1.0, 0.0], [-3.0, 0.0, 0.5]], 8)  # actions are clipped to [-1, 1]
    config = pair.template.config
    velocity = physics.agent_velocity(pair.template, data)
    assert_allclose(velocity[0], [0, config.body.strafe_speed, 0], atol=5e-3)
    # The velocity of a turning agent trails its frame by about one response time.
    trail = config.body.turn_rate / 2 * config.response_time
    assert_allclose(velocity[1], [-np.cos(trail), np.sin(trail), config.body.turn_rate / 2], atol=0.02)
    assert data.qpos[1] > 0.3  # left of an agent that looks along +x is +y
