"""Kinematic agents against closed forms, and against boxes sampled point by point."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import rollouts
from handmade import Furniture, shoebox
from numpy.testing import assert_allclose, assert_array_equal
from rollouts import SCENES
from tiny_houses import Box, Door, TinyHouse, make_bank

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig, PhysicsSetup, Template
from home_mjx.physics.kinematic.footprints import MAX_PENETRATION, Footprints
from home_mjx.physics.mjx.contact_slots import OrientedBoxes
from home_mjx.schema import AgentBody

CONFIG = PhysicsSetup(impl="kinematic")
RADIUS, HALF = CONFIG.body.radius, CONFIG.body.half_length


@pytest.fixture(scope="module")
def world():
    bank, template = rollouts.build("kinematic")
    house = jnp.arange(rollouts.BATCH, dtype=jnp.int32)
    begun = rollouts.start(bank, template, house)
    return begun, *rollouts.make_run(template)(bank, house, begun, rollouts.actions())


def scene(rollout, name):
    return rollouts.Rollout(*(values[:, rollouts.NAMES.index(name)] for values in rollout))


def test_an_agent_in_the_open_moves_exactly_as_told(world):
    """The yaw turns first, then half of each step's way is walked twice; speeds are those of the whole step."""
    free = scene(world[2], "free")
    yaw = CONFIG.body.turn_rate * 0.1 / 2 * np.arange(1, 41)
    assert_allclose(free.agent_yaw[:, 0], yaw[1::2], rtol=1e-5)
    way = 0.05 * np.stack([np.cos(yaw), np.sin(yaw)], axis=-1).cumsum(axis=0)
    assert_allclose(free.agent_pos[:, 0, :2], way[1::2], atol=1e-5)
    assert not free.contact.any()
    assert_allclose(free.agent_velocity[:, 0, 2], CONFIG.body.turn_rate, rtol=1e-4)


def test_a_wall_takes_what_points_into_it_and_nothing_else(world):
    slide = scene(world[2], "slide")
    assert_allclose(slide.agent_pos[:, 0, 1], 0.07 * np.arange(1, 21), rtol=1e-5)
    assert_allclose(slide.agent_pos[-1, 0, 0], 1.5 - RADIUS, atol=1e-5)
    assert slide.contact[-1, 0]
    assert_allclose(slide.agent_velocity[-1, 0], [0, CONFIG.body.strafe_speed, 0], atol=1e-4)


def test_things_stay_where_they_are_and_stop_agents(world):
    begun, _, rollout = world
    assert_array_equal(rollout.body_pos, np.broadcast_to(rollout.body_pos[0], rollout.body_pos.shape))
    assert_array_equal(rollout.body_pos[0].reshape(rollouts.BATCH, -1, 3)[:, 0], begun.qpos[:, 4:7])
    for name in ("light", "wardrobe", "sofa"):
        box = SCENES[name].movable[0]
        assert_allclose(scene(rollout, name).agent_pos[-1, 0, 0], box.pos[0] - box.size[0] - RADIUS, atol=1e-5)


def test_two_agents_do_not_walk_into_each_other():
    bank = make_bank([TinyHouse()], num_bodies=0)
    template = Template(PhysicsConfig(impl="kinematic", num_agents=2), bank.spec)
    pos = jnp.array([[-1.0, 0.03, 0.0], [1.0, 0.0, 0.0]])
    state = physics.reset(template, bank, jnp.int32(0), pos, jnp.array([0.0, jnp.pi]))
    step = jax.jit(lambda state: physics.step(template, bank, jnp.int32(0), state, jnp.ones((2, 3)).at[:, 1:].set(0)))
    met = False
    for _ in range(30):
        state = step(state)
        met |= bool(physics.agent_contact(template, state).all())
        places = physics.agent_pose(template, state)[0]
        assert float(jnp.linalg.norm(places[0, :2] - places[1, :2])) > 2 * RADIUS - MAX_PENETRATION
    assert met  # and slid around each other
    assert float(places[0, 0]) > 1 > -1 > float(places[1, 0])


def depth(pos, box: Box, step=0.01):
    """How deep a capsule is in a box [m]: points on its axis against the box in its own frame."""
    w, x, y, z = box.quat
    rot = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    points = pos + np.array([[0, 0, h] for h in np.arange(-HALF, HALF + step, step)])
    local = np.abs((points - np.array(box.pos)) @ rot) - np.array(box.size)
    return RADIUS - np.linalg.norm(np.maximum(local, 0), axis=1).min()


@functools.cache
def stepper(spec):
    template = Template(CONFIG, spec)
    return template, jax.jit(jax.vmap(functools.partial(physics.step, template), (None, 0, 0, 0)))


@pytest.mark.parametrize("seed", range(4))
def test_nobody_is_ever_inside_anything(seed):
    """A cluttered house of boxes at all angles, some tilted, some overhead; held random actions for a minute."""
    rng = np.random.default_rng(seed)
    boxes = [
        Box(
            (*rng.uniform(-2, 2, 2), rng.uniform(0.2, 2.2)),
            tuple(rng.uniform(0.05, 0.5, 3)),
            yaw=rng.uniform(0, 6),
            roll=rng.choice([0.0, 0.4]),
        )
        for _ in range(12)
    ]
    fence = [Box((x, 0, 1), (0.05, 3, 1)) for x in (-3, 3)] + [Box((0, y, 1), (3, 0.05, 1)) for y in (-3, 3)]
    bank = make_bank([TinyHouse(static=[*boxes, *fence])])
    template, step = stepper(bank.spec)
    spots = np.array(list(itertools.product(np.arange(-2.6, 2.7, 0.4), repeat=2)))
    free = [p for p in spots if max(depth(np.array([*p, 0.8]), b) for b in boxes) < -0.2][:8]
    assert len(free) >= 4
    feet = jnp.array([[*p, 0.0] for p in free])[:, None]
    house = jnp.zeros(len(free), jnp.int32)
    state = jax.vmap(lambda h, p: physics.reset(template, bank, h, p, jnp.zeros(1)))(house, feet)
    way = np.zeros(len(free))
    for tick in range(600):
        if tick % 10 == 0:
            action = jnp.asarray(rng.choice([-1.0, 0.3, 1.0], (len(free), 1, 3)), jnp.float32)
        before, state = np.asarray(state.qpos[:, :2]), step(bank, house, state, action)
        way += np.linalg.norm(np.asarray(state.qpos[:, :2]) - before, axis=1)
        if tick % 5 == 0:
            for pos in np.asarray(state.qpos[:, :3]):
                assert max(depth(pos, box) for box in (*boxes, *fence)) < 2 * MAX_PENETRATION
                assert np.abs(pos[:2]).max() < 3
    assert (way > 3).all()


def test_footprints_of_upright_boxes_are_exact_whichever_axis_is_up():
    """Corners of the footprint are those of the box, for all 24 ways to stand on a face, turned."""
    turned = np.array([np.cos(0.35), 0, 0, np.sin(0.35)])
    half, down = np.array([0.5, 0.2, 0.9]), 2**-0.5
    quarters = [(1, 0, 0, 0), (down, down, 0, 0), (down, 0, down, 0), (down, 0, 0, down), (0.5, 0.5, 0.5, 0.5)]
    for quat in map(np.array, quarters):
        w, x, y, z = _product(turned, quat)
        boxes = OrientedBoxes(
            jnp.zeros((1, 3)), jnp.array([[w, x, y, z]], jnp.float32), jnp.asarray(half[None], jnp.float32)
        )
        print_ = jax.tree.map(lambda value: float(value[0]), Footprints.from_boxes(boxes))
        axes = np.array([[float(c[0]) for c in axis] for axis in boxes.axes])
        corners = np.array(list(itertools.product([-1, 1], repeat=3))) * half @ axes
        heading = np.array([[print_.cos, print_.sin], [-print_.sin, print_.cos]])
        extent = np.abs(corners[:, :2] @ heading.T)
        assert_allclose(extent, np.broadcast_to([print_.half_u, print_.half_v], extent.shape), atol=1e-6)
        assert_allclose([print_.bottom, print_.top], [corners[:, 2].min(), corners[:, 2].max()], atol=1e-6)


def _product(a, b):
    w, x, y, z = a
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ b


@pytest.fixture(scope="module")
def end():
    """Where five steps with one action end, as a number, and its gradient: of an action, a house and a start."""
    bank, template = rollouts.build("kinematic")

    def run(action, house, feet):
        def step(state, _):
            return physics.step(template, bank, house, state, action[None]), None

        begun = physics.reset(template, bank, house, feet, jnp.zeros(1))
        state, _ = jax.lax.scan(step, begun, None, length=5)
        return state.qpos[0] + 2 * state.qpos[1] + 3 * state.qpos[3]

    return jax.jit(jax.value_and_grad(run))


@pytest.mark.parametrize("name", ["slide", "free", "wardrobe"])
def test_gradients_are_those_of_finite_differences(end, name):
    """In the open, along a wall, and against a body, half a second after the start."""
    house, feet = jnp.int32(rollouts.NAMES.index(name)), jnp.array([[1.35 * (name == "slide"), 0.0, 0.0]])
    action = jnp.array([0.6, 0.3, 0.1])
    ends = [[end(action.at[i].add(way), house, feet)[0] for way in (1e-2, -1e-2)] for i in range(3)]
    numbers = [(ahead - behind) / 2e-2 for ahead, behind in ends]
    assert_allclose(end(action, house, feet)[1], numbers, atol=2e-3)


def test_an_environment_takes_it():
    bank = HouseBank.from_compiled([shoebox(furniture=[Furniture((0.0, 0.0), size=(0.5, 0.5, 0.5), mass=5.0)])])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state", "goal"), impl="kinematic")
    state = jax.jit(env.reset)(jax.random.key(0))
    after = jax.jit(env.step)(state, jnp.array([1.0, 0.0, 0.0, 0.0]))
    assert_array_equal(after.physics.qpos[4:], state.physics.qpos[4:])
    moved = np.linalg.norm(after.physics.qpos[:2] - state.physics.qpos[:2])
    assert_allclose(moved, 0.1, atol=1e-5)


def test_agents_push_sliding_doors_by_their_ends_only():
    """An agent that walks into the end pushes the leaf before it, to the end of its rail; into the face, nothing."""
    doors = [Door((0.5, 0.0), yaw=0.0, high=0.6, slides=True)], [Door((0.5, -0.4), yaw=np.pi / 2, slides=True)]
    bank = make_bank([TinyHouse(doors=d) for d in doors], num_bodies=0)
    template = Template(CONFIG, bank.spec)
    for house, end in enumerate((0.6, 0.0)):
        state = physics.reset(template, bank, jnp.int32(house), jnp.zeros((1, 3)), jnp.zeros(1))
        step = jax.jit(lambda s, h=house: physics.step(template, bank, jnp.int32(h), s, jnp.array([[1.0, 0.0, 0.0]])))
        for _ in range(15):
            state = step(state)
            way, x = float(state.qpos[template.layout.door_qpos][-1]), float(state.qpos[0])
            if house == 0:
                assert_allclose(way, np.clip(x + RADIUS - 0.5, 0, end), atol=1e-5)
        assert_allclose(way, end, atol=1e-6)
        face = 0.5 if house == 0 else 0.48
        assert_allclose(x, face + end - RADIUS, atol=1e-4)


def test_agents_too_fast_for_their_size_are_refused():
    """They once took as many parts of a step as that needs, and compiling never ended."""
    bank = make_bank([TinyHouse()])
    template, house = (
        Template(PhysicsSetup(impl="kinematic", body=AgentBody(forward_speed=1e6)), bank.spec),
        jnp.int32(0),
    )
    state = physics.reset(template, bank, house, jnp.zeros((1, 3)), jnp.zeros(1))
    with pytest.raises(ConfigError, match="may move by 100 times its radius in a control step") as error:
        physics.step(template, bank, house, state, jnp.zeros((1, 3)))
    assert error.value.hint


SEAM = TinyHouse(  # an upper floor of two parts, 8 mm apart at x = 0
    static=[Box((side * 1.004, 0, 0.95), (1.0, 1.0, 0.05)) for side in (-1, 1)],
    movable=[Box((0, 0.5, 1.1), (0.1, 0.1, 0.1), mass=1)],
)


@pytest.fixture(scope="module")
def seam():
    bank = make_bank([SEAM])
    return bank, Template(PhysicsConfig(impl="kinematic"), bank.spec)


def test_nobody_falls_through_a_seam_of_a_floor(seam):
    """Every substep of a walk along x, and of one exactly along the seam, stays on the upper floor."""
    bank, template = seam
    step = jax.jit(lambda state, action: physics.step(template, bank, jnp.int32(0), state, action[None]))
    for start, yaw, action in (((-0.5, -0.5), 0.0, [1.0, 0, 0]), ((0.0, -0.8), np.pi / 2, [0.5, 0, 0])):
        pos = jnp.array([[*start, 1.0 + RADIUS + HALF]], jnp.float32)
        state = physics.reset(template, bank, jnp.int32(0), pos, jnp.full(1, yaw, jnp.float32))
        for _ in range(8):
            state = step(state, jnp.array(action, jnp.float32))
            assert_allclose(physics.agent_pose(template, state)[0][0, 2], 1.0 + RADIUS + HALF, atol=1e-4)


def test_a_released_body_rests_on_a_seam_of_a_floor(seam):
    bank, template = seam
    pos = jnp.array([[-0.5, -0.5, 1.0 + RADIUS + HALF]], jnp.float32)
    state = physics.reset(template, bank, jnp.int32(0), pos, jnp.zeros(1))
    state = state.replace(qvel=state.qvel.at[template.layout.body_qvel].set(-1e-3))
    state = physics.step(template, bank, jnp.int32(0), state, jnp.zeros((1, 3)))
    assert_allclose(state.qpos[template.layout.body_qpos].reshape(-1, 7)[0, 2], 1.1, atol=1e-4)


def test_a_released_body_does_not_rest_on_a_held_one():
    """A held body follows its hand, so it supports nothing: the body above it drops to the floor."""
    bank = make_bank([TinyHouse(movable=[Box((0, 0.5, z), (0.1, 0.1, 0.1), mass=1) for z in (0.5, 0.8)])])
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    pos = jnp.array([[-0.5, -0.5, 0.0]], jnp.float32)
    state = physics.reset(template, bank, jnp.int32(0), pos, jnp.zeros(1))
    rows = template.layout.body_qvel.start + 6 + jnp.arange(6)
    state = state.replace(qvel=state.qvel.at[rows].set(-1e-3), held=jnp.zeros(1, jnp.int32))
    state = physics.step(template, bank, jnp.int32(0), state, jnp.zeros((1, 3)))
    assert_allclose(state.qpos[template.layout.body_qpos].reshape(-1, 7)[1, 2], 0.1, atol=1e-4)


@pytest.mark.parametrize("impl", ["kinematic", "fused"])
def test_physics_of_a_house_that_is_none_is_that_of_the_nearest_one(impl):
    """As of rays: JAX counts negative indices from the end."""
    crate = Box((0.8, 0, 0.2), (0.2, 0.2, 0.2), mass=2)
    bank = make_bank(
        [TinyHouse(movable=[crate]), TinyHouse(static=[crate], movable=[Box((0, 2, 0.3), (0.3,) * 3, mass=9)])]
    )
    template = Template(PhysicsConfig(impl=impl), bank.spec)

    @jax.jit
    def moved(house):
        pos = jnp.array([[0.0, 0.0, RADIUS + HALF]], jnp.float32)
        state = physics.reset(template, bank, house, pos, jnp.zeros(1))
        state = physics.step(template, bank, house, state, jnp.array([[1.0, 0, 0]]))
        return state.qpos, physics.is_out_of_bounds(template, bank, house, state)

    for asked, given in ((-1, 0), (9, 1)):
        jax.tree.map(assert_array_equal, moved(jnp.int32(asked)), moved(jnp.int32(given)))
