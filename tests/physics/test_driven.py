"""Doors, hands and what was touched: the fused step and C MuJoCo against C MuJoCo by hand and against MJX."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_physics_model import host_spec
from test_physics_parity import _control
from tiny_houses import NUM_DOORS, Box, Door, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.base.state import FLOOR, NOTHING, STATIC

SCENES = [
    TinyHouse(doors=[Door((0.4, 0.5), yaw=-np.pi / 2, low=0.0, high=1.4)]),
    TinyHouse(
        movable=[Box((0.6, 0.1, 0.1), (0.1, 0.1, 0.1), mass=4)],
        doors=[Door((1.0, -0.6), yaw=np.pi / 2, low=-1.6, high=0.3), Door((-1, 0), mass=30)],
    ),
    TinyHouse(
        static=[Box((1.2, 0, 0.35), (0.3, 0.6, 0.35))],
        movable=[
            Box((1.1, 0.1, 0.8), (0.1, 0.08, 0.1), mass=2, yaw=0.5),
            Box((1.35, -0.4, 0.75), (0.05, 0.05, 0.05), mass=1),
        ],
        doors=[Door((-1.0, 0.4), yaw=0.2, high=1.2)],
    ),
    TinyHouse(doors=[Door((0.5, 0.0), high=0.9, mass=20, slides=True), Door((-1, 0.3), high=0.5)]),
    TinyHouse(
        movable=[Box((0.6, 0.1, 0.1), (0.1, 0.1, 0.1), mass=4)],
        doors=[Door((0.9, 0.1), yaw=-0.2, high=0.4, slides=True)],
    ),
    TinyHouse(doors=[Door((-1.0, 1.4), yaw=0.2, low=-0.4, high=0.7, mass=30, slides=True)]),
]
DRIVEN, SLIDING = 2, 5
WALK, STAND, AROUND = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-0.5, 0.2, 0.6)
GRIP = (0.45, -0.1, 0.3, 1.0, 0.0, 0.0, 0.0)


def build(impl):
    bank = make_bank(SCENES)
    return bank, Template(PhysicsConfig(impl=impl), bank.spec)


def start(bank, template, house):
    state = physics.reset(template, bank, house, jnp.zeros((1, 3)), jnp.zeros(1))
    driven = jnp.where(house == DRIVEN, jnp.array([1.0, NOT_DRIVEN, NOT_DRIVEN]), NOT_DRIVEN)
    driven = jnp.where(house == SLIDING, jnp.array([NOT_DRIVEN, NOT_DRIVEN, 0.6]), driven)
    held = jnp.where(house == DRIVEN, 0, -1)[None].astype(jnp.int32)
    return state.replace(door_goal=driven, held=held, grip=jnp.array([GRIP]))


def rollout(impl, length):
    """States after each control step (t, house)."""
    bank, template = build(impl)
    house = jnp.arange(len(SCENES), dtype=jnp.int32)
    action = jnp.array([[WALK], [WALK], [AROUND], [WALK], [WALK], [STAND]])

    @jax.jit
    def run(bank):
        def step(state, _):
            state = jax.vmap(lambda h, s, a: physics.step(template, bank, h, s, a))(house, state, action)
            return state, state

        begun = jax.vmap(lambda h: start(bank, template, h))(house)
        return jax.lax.scan(step, begun, None, length=length)[1]

    return template, run(bank)


@pytest.fixture(scope="module", params=["fused", "c"])
def driven(request):
    return rollout(request.param, 20)


@pytest.fixture(scope="module")
def truth():
    return rollout("jax", 6)[1]


@pytest.mark.parametrize("number", [0, 1, 3, 4])
def test_doors_move_as_in_c(driven, number):
    """An agent walks into a leaf that turns or slides, and pushes a box into another."""
    template, states = driven
    house, layout, config = SCENES[number], template.layout, template.config
    spec = host_spec(template, house)
    spec.option.iterations, spec.option.ls_iterations = 100, 50
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[2] = config.body.height / 2
    used = house.door_rows
    for t in range(20):
        for _ in range(config.timing.substeps):
            data.ctrl[:] = _control(config, model.dof_M0[3], WALK, data)
            mujoco.mj_step(model, data)
        qpos = np.asarray(states.qpos[t, number])
        assert_allclose(qpos[layout.agent_qpos], data.qpos[layout.agent_qpos], atol=3e-3)
        assert_allclose(qpos[layout.door_qpos][used], data.qpos[layout.door_qpos][used], atol=3e-3)
        if house.movable:
            assert_allclose(qpos[layout.body_qpos][:3], data.qpos[layout.body_qpos][:3], atol=3e-3)
    assert np.abs(qpos[layout.door_qpos][used[0]]) > 0.3


def test_the_reference_drives_doors_and_hands_alike(driven, truth):
    """MJX against the others, six control steps of all scenes: also what touched what, and how hard."""
    template, states = driven
    layout = template.layout
    got = jax.tree.map(lambda x: np.asarray(x[:6]), states)
    assert_allclose(got.qpos, truth.qpos, atol=3e-3)
    assert_allclose(got.qvel[..., layout.door_qvel], truth.qvel[..., layout.door_qvel], atol=0.05)
    assert_allclose(got.contact_impulse, truth.contact_impulse, atol=0.05 * float(truth.contact_impulse.max()))
    strong = np.asarray(truth.contact_impulse) > 0.5
    assert strong.any()
    assert (got.contact_partner[strong] == np.asarray(truth.contact_partner)[strong]).mean() > 0.95


def test_a_hand_carries_a_thing_to_its_grip(driven):
    """It comes off the table and stays where the hand holds it while the agent walks and turns."""
    template, states = driven
    agent, body = (np.asarray(states.qpos)[:, 2, at] for at in (template.layout.agent_qpos, template.layout.body_qpos))
    yaw = agent[-1, 3]
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    assert_allclose(body[-1, :3], agent[-1, :3] + turn @ GRIP[:3], atol=0.02)
    turned = 2 * np.arctan2(body[-1, 6], body[-1, 3])
    assert_allclose(np.sin(turned - yaw), 0, atol=0.05)


def test_a_door_turns_to_its_goal(driven):
    template, states = driven
    angle = np.asarray(states.qpos)[:, 2, template.layout.door_qpos][:, 0]
    assert (np.diff(angle) > -1e-4).all()
    assert_allclose(angle[-1], 1.0, atol=0.01)


def test_a_door_slides_to_its_goal(driven):
    template, states = driven
    way = np.asarray(states.qpos)[:, SLIDING, template.layout.door_qpos][:, -1]
    assert (np.diff(way) > -1e-4).all()
    assert_allclose(way[-1], 0.6, atol=0.02)


def test_what_was_touched_is_told(driven):
    """The agent stands on the floor and pushes a leaf; the leaf is pushed by the agent."""
    template, states = driven
    door = template.layout.num_agents + template.layout.num_bodies
    others, impulse = np.asarray(states.contact_partner), np.asarray(states.contact_impulse)
    weight = template.config.body.mass * 9.81 * template.config.timing.ctrl_dt
    assert_allclose(impulse[5:, 2, 0], weight, rtol=0.02)
    assert (others[5:, 2, 0] == FLOOR).all()
    pushed = others[:, 0, door] == 0
    assert pushed.any()
    assert (impulse[:, 0, door][pushed] > 0).all()
    assert others[-1, 2, 1] == NOTHING  # in the hand
    assert (others[5:, 2, 2] == STATIC).all()  # on the table, which is static box 0
    assert_allclose(impulse[10:, 2, 2], 9.81 * template.config.timing.ctrl_dt, rtol=0.02)
    assert (others[:, 0, door + 1 : door + NUM_DOORS] == NOTHING).all()
