"""Kinematic agents that stop at contact: closed forms at a wall and a corner, ways that are straight, both kernels."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_kinematic import depth
from tiny_houses import Box, TinyHouse, make_bank

import home_mjx
from home_mjx import physics
from home_mjx.adapters import habitat
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig, PhysicsSetup, Template
from home_mjx.physics.kinematic.footprints import MAX_PENETRATION
from home_mjx.physics.kinematic.kinematic_step import step_in_jax

CONFIG = PhysicsSetup(impl="kinematic", allow_sliding=False)
RADIUS = CONFIG.body.radius


def run(static, yaw, actions, start=(0.0, 0.0)):
    """Return the plan positions and contacts of an agent after each action."""
    bank = make_bank([TinyHouse(static=static)])
    template = Template(CONFIG, bank.spec)
    state = physics.reset(template, bank, jnp.int32(0), jnp.array([[*start, 0.0]]), jnp.array([yaw]))
    step = jax.jit(lambda state, action: physics.step(template, bank, jnp.int32(0), state, action))
    places, touched = [], []
    for action in actions:
        state = step(state, jnp.asarray([action], jnp.float32))
        places.append(np.asarray(state.qpos[:2]))
        touched.append(bool(physics.agent_contact(template, state)[0]))
    return np.array(places), touched


def test_an_agent_stops_where_its_straight_way_meets_a_wall_and_walks_off_or_along_it():
    wall = Box((1.0, 0.0, 1.0), (0.1, 5.0, 1.0))
    ahead, back, along = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    places, touched = run([wall], np.pi / 4, [ahead] * 30 + [back] * 3)
    assert_allclose(places[:, 0], places[:, 1], atol=1e-5)  # on the line of its heading
    assert_allclose(places[29], 0.9 - RADIUS, atol=1e-4)
    assert touched[29]
    assert not touched[32]
    assert places[32, 0] < 0.8 - 0.1
    places, _ = run([wall], 0.0, [ahead] * 30 + [along] * 10)
    assert_allclose(places[29], [0.9 - RADIUS, 0.0], atol=1e-4)
    assert_allclose(places[39] - places[29], [0.0, 10 * CONFIG.body.strafe_speed * 0.1], atol=1e-4)


def test_an_agent_stops_at_the_corner_that_its_disc_meets_first():
    """The box's corner is 0.06 m beside the way: the disc touches it sqrt(0.1^2 - 0.06^2) = 0.08 m before."""
    places, touched = run([Box((1.0, 0.56, 1.0), (0.2, 0.5, 1.0))], 0.0, [(1.0, 0.0, 0.0)] * 30)
    assert_allclose(places[-1], [0.8 - 0.08, 0.0], atol=1e-4)
    assert touched[-1]


def test_ways_are_straight_nobody_is_inside_anything_and_both_kernels_agree():
    rng = np.random.default_rng(0)
    boxes = [
        Box((*rng.uniform(-2, 2, 2), 1.0), tuple(rng.uniform(0.05, 0.5, 3)), yaw=rng.uniform(0, 6)) for _ in range(12)
    ]
    bank = make_bank([TinyHouse(static=boxes)])
    template, house = Template(CONFIG, bank.spec), jnp.int32(0)
    spots = np.array(list(itertools.product(np.arange(-2.6, 2.7, 0.4), repeat=2)))
    free = [p for p in spots if max(depth(np.array([*p, 0.8]), box) for box in boxes) < -0.1][:40]
    state = jax.vmap(lambda p: physics.reset(template, bank, house, p, jnp.zeros(1)))(
        jnp.array([[*p, 0.0] for p in free])[:, None]
    )
    step = jax.jit(jax.vmap(functools.partial(physics.step, template), (None, None, 0, 0)))
    plain = jax.jit(jax.vmap(lambda s, a: step_in_jax(template, bank.physics, house, s, a)[0]))
    stopped = 0
    for tick in range(100):
        if tick % 10 == 0:
            action = jnp.asarray(rng.choice([-1.0, 0.0, 1.0], (len(free), 1, 3)) * [1, 0, 0.2], jnp.float32)
        other, before, state = plain(state, action), np.asarray(state.qpos), step(bank, house, state, action)
        after = np.asarray(state.qpos)
        assert_allclose(after, np.asarray(other.qpos), atol=2e-5)
        assert np.array_equal(np.asarray(state.num_contacts) > 0, np.asarray(other.num_contacts) > 0)
        way, yaw = after[:, :2] - before[:, :2], (after[:, 3] + before[:, 3]) / 2
        across = abs(way[:, 1] * np.cos(yaw) - way[:, 0] * np.sin(yaw))
        turn = abs(after[:, 3] - before[:, 3])
        assert (across <= 0.1 * turn + 1e-3).all()
        stopped += int((np.asarray(state.num_contacts)[:, 0] > 0).sum())
        if tick % 10 == 0:
            assert max(depth(p, box) for p in after[:, :3] for box in boxes) < 2 * MAX_PENETRATION
    assert stopped > 100


def test_only_kinematic_agents_can_stop_and_habitats_option_says_so():
    with pytest.raises(ConfigError, match="kinematic"):
        PhysicsConfig(allow_sliding=False)
    name = "benchmark/nav/pointnav/pointnav_gibson.yaml"
    config = habitat.get_config(name, ["habitat.simulator.habitat_sim_v0.allow_sliding=False"])
    assert not config.allow_sliding
    assert habitat.get_config(name).allow_sliding
    with pytest.raises(ConfigError):
        home_mjx.make("PointNav-v0", num_houses=1, allow_sliding=False)
