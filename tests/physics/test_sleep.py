"""What has come to rest sleeps: it does not move by a bit, and wakes when something comes near."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tiny_houses import Box, Door, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.base.state import FLOOR, STATIC
from home_mjx.physics.hand_control import HandCommands, apply_hand_commands

TABLE, CUP, CHEST, LAMP = range(4)
HOUSE = TinyHouse(
    static=[Box((0, 2.0, 0.25), (0.3, 0.3, 0.25))],
    movable=[
        Box((1.0, 0, 0.3), (0.3, 0.3, 0.3), mass=12),
        Box((1.0, 0, 0.651), (0.05, 0.05, 0.05), mass=0.5),
        Box((-2.0, 0, 0.21), (0.2, 0.2, 0.2), mass=20, yaw=0.3),
        Box((0, 2.0, 0.602), (0.1, 0.1, 0.1), mass=1),
    ],
    doors=[Door((-0.5, -2.0))],
)


class Scene:
    def __init__(self):
        self.bank = make_bank([HOUSE])
        self.template = Template(PhysicsConfig(), self.bank.spec)
        self.layout, self.house = self.template.layout, jnp.int32(0)
        self.step = jax.jit(lambda state, action: physics.step(self.template, self.bank, self.house, state, action))
        start = physics.reset(self.template, self.bank, self.house, jnp.zeros((1, 3)), jnp.zeros(1))
        self.rested = self.run(start, 15)

    def run(self, state, steps, *action):
        for _ in range(steps):
            state = self.step(state, jnp.array([action or (0.0, 0.0, 0.0)], jnp.float32))
        return state

    def asleep(self, state) -> list[bool]:
        rates = np.asarray(state.qvel)[self.layout.body_qvel], np.asarray(state.qacc)[self.layout.body_qvel]
        return [not any(x.reshape(-1, 6)[k].any() for x in rates) for k in range(4)]


@pytest.fixture(scope="module")
def scene():
    return Scene()


def test_what_rests_does_not_creep(scene):
    """All sleep after 1.5 s; ten seconds later, an agent walking by, not one bit of a pose has changed."""
    assert scene.asleep(scene.rested) == [True] * 4
    later = scene.run(scene.rested, 50, -0.2, 0.5, 0.5)
    later = scene.run(later, 50, 0.1, 0.0, 1.0)
    assert scene.asleep(later) == [True] * 4
    assert_array_equal(later.qpos[scene.layout.body_qpos], scene.rested.qpos[scene.layout.body_qpos])


def test_what_sleeps_still_tells_what_it_stands_on(scene):
    assert scene.rested.contact_partner[1 + np.array([TABLE, CUP, CHEST, LAMP])].tolist() == [
        FLOOR,
        1 + TABLE,
        FLOOR,
        STATIC,
    ]
    assert (scene.rested.contact_impulse[1:5] > 0).all()


def test_a_push_wakes_what_it_reaches(scene):
    """The agent pushes the table with the cup on it; what stands elsewhere sleeps on."""
    pushed = scene.run(scene.rested, 20, 1.0, 0.0, 0.0)
    bodies = np.asarray(pushed.qpos[scene.layout.body_qpos]).reshape(-1, 7)
    before = np.asarray(scene.rested.qpos[scene.layout.body_qpos]).reshape(-1, 7)
    assert bodies[TABLE, 0] - before[TABLE, 0] > 0.2
    assert bodies[CUP, 0] - before[CUP, 0] > 0.1  # it rides along, or slides off
    assert_array_equal(bodies[[CHEST, LAMP]], before[[CHEST, LAMP]])
    assert scene.asleep(pushed)[2:] == [True, True]


def test_sleepers_move_like_those_that_never_slept(scene):
    """The same push, of a table that slept and of one that was kept awake."""
    config = PhysicsConfig(sleep=False)
    template = Template(config, scene.bank.spec)
    step = jax.jit(lambda state: physics.step(template, scene.bank, scene.house, state, jnp.array([[1.0, 0.0, 0.0]])))
    awake, slept = scene.rested, scene.rested
    for _ in range(15):
        awake, slept = step(awake), scene.run(slept, 1, 1.0, 0.0, 0.0)
    assert_allclose(slept.qpos[: 4 + 7], awake.qpos[: 4 + 7], atol=3e-3)


def test_what_stood_on_a_thing_falls_when_it_is_taken(scene):
    """A hand takes a cube from under another."""
    house = TinyHouse(
        movable=[Box((0.6, 0, 0.1), (0.1, 0.1, 0.1), mass=2), Box((0.6, 0, 0.25), (0.05, 0.05, 0.05), mass=1)]
    )
    bank = make_bank([house])
    template = Template(PhysicsConfig(), bank.spec)
    state = physics.reset(template, bank, scene.house, jnp.zeros((1, 3)), jnp.zeros(1))
    step = jax.jit(lambda state: physics.step(template, bank, scene.house, state, jnp.zeros((1, 3))))
    for _ in range(15):
        state = step(state)
    take = HandCommands.idle(1).replace(pick=jnp.zeros(1, jnp.int32))
    state = apply_hand_commands(template, bank, scene.house, state, take)
    for _ in range(40):
        state = step(state)
    upper = np.asarray(state.qpos[template.layout.body_qpos]).reshape(-1, 7)[1]
    lower = np.asarray(state.qpos[template.layout.body_qpos]).reshape(-1, 7)[0]
    assert lower[2] > 0.8
    on_top, on_floor = abs(upper[2] - lower[2] - 0.15) < 0.03, abs(upper[2] - 0.05) < 0.01
    assert on_top or on_floor


def test_what_is_woken_was_pushed_by_its_weight_all_the_while(scene):
    """Also in the control step in the midst of which an agent came near."""
    state, least, woken = scene.rested, 12 * 9.81 * 0.1, []
    while float(state.qpos[0]) < 0.55:
        state = scene.step(state, jnp.array([[1.0, 0.0, 0.0]]))
        if state.contact_partner[1 + TABLE] == FLOOR:
            assert state.contact_impulse[1 + TABLE] > 0.99 * least
            woken.append(not scene.asleep(state)[TABLE])
    assert len(woken) > 3
    assert any(woken)
