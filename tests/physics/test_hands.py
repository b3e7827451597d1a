"""Hands: what they take, carry, put down, drop and throw, and which doors they turn."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation
from tiny_houses import Box, Door, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.geometry.boxes import make_boxes, penetration_depth
from home_mjx.physics import PhysicsConfig, PhysicsSetup, Template
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.hand_control import (
    MAX_HOLD_DISTANCE,
    MAX_PLACE_STEPS,
    MAX_THROW_SPEED,
    HandCommands,
    apply_hand_commands,
    update_hands,
)
from home_mjx.schema import AgentBody
from home_mjx.schema.timing import Timing

CUP, STOOL, SOFA, BOOK = range(4)
TABLE = Box((1.0, 0.0, 0.35), (0.3, 0.6, 0.35))
HOUSE = TinyHouse(
    static=[TABLE, *(Box((3 * s, 0, 1.25), (0.05, 3, 1.25)) for s in (-1, 1)), Box((0, 3, 1.25), (3, 0.05, 1.25))],
    movable=[
        Box((0.8, 0.1, 0.75), (0.04, 0.04, 0.05), mass=0.3),
        Box((-0.6, 0.5, 0.2), (0.2, 0.2, 0.2), mass=5),
        Box((-1.0, -1.5, 0.4), (0.4, 0.8, 0.4), mass=45),
        Box((0.9, -0.3, 0.72), (0.1, 0.07, 0.02), yaw=0.4, mass=1),
    ],
    doors=[Door((0.3, 1.2), yaw=0.0, high=1.5)],
)
STILL = np.zeros((2, 3), np.float32)


class Scene:
    """Two agents before a table, one of them weaker."""

    def __init__(self, impl: str = "fused"):
        self.bank = make_bank([HOUSE])
        config = PhysicsConfig(
            impl=impl,
            num_agents=2,
            bodies=(AgentBody(), AgentBody(radius=0.15, height=1.2, eye_height=1.1, max_lift_mass=2)),
        )
        self.template, house = Template(config, self.bank.spec), jnp.int32(0)
        pos = jnp.array([[0.2, 0.0, 0.0], [0.2, 0.7, 0.0]])
        self.start = physics.reset(self.template, self.bank, house, pos, jnp.zeros(2))

        def step(state, action, commands):
            state = apply_hand_commands(self.template, self.bank, house, state, commands)
            state = physics.step(self.template, self.bank, house, state, action)
            return update_hands(self.template, self.bank, house, state)

        self.step = jax.jit(step)

    def run(self, state, steps: int, action=STILL, **command):
        """Some steps, told once."""
        for i in range(steps):
            state = self.step(state, jnp.asarray(action), told(**command) if i == 0 else told())
        return state

    def body(self, state, k: int) -> np.ndarray:
        return np.asarray(state.qpos[self.template.layout.body_qpos]).reshape(-1, 7)[k]


def told(agent: int = 0, **command) -> HandCommands:
    none = HandCommands.idle(2)
    return none.replace(**{name: getattr(none, name).at[agent].set(value) for name, value in command.items()})


@pytest.fixture(scope="module", params=["fused", "c", "kinematic"])
def scene(request):
    return Scene(request.param)


@pytest.fixture(scope="module")
def fused():
    return Scene()


def test_nothing_settles_where_no_hand_was_told_anything(fused):
    """So an environment without hands does not ask: not even a bit changes, while agents push things and doors."""
    pushes = np.array([[-1.0, 0.5, -1.0], [0.3, 1.0, 0.0]], np.float32)
    state, moved = fused.start, False
    for _ in range(20):
        state = physics.step(fused.template, fused.bank, jnp.int32(0), state, jnp.asarray(pushes))
        jax.tree.map(
            np.testing.assert_array_equal, update_hands(fused.template, fused.bank, jnp.int32(0), state), state
        )
        moved |= bool(abs(state.qvel[fused.template.layout.door_qvel]).max() > 0.1)
    assert moved


def test_a_cup_is_taken_carried_and_put_down(scene):
    state = scene.run(scene.start, 12, pick=CUP)
    assert state.held.tolist() == [CUP, -1]
    hand = scene.body(state, CUP)
    assert hand[2] > 0.9
    walked = scene.run(state, 12, np.array([[-0.6, 0, 0], [0, 0, 0]], np.float32))
    assert_allclose(scene.body(walked, CUP)[:3] - hand[:3], np.asarray(walked.qpos[:3] - state.qpos[:3]), atol=0.02)
    back = scene.run(walked, 12, np.array([[0.6, 0, 0], [0, 0, 0]], np.float32))
    spot = np.array([0.9, -0.05, 0.7])
    put = scene.run(back, MAX_PLACE_STEPS, place=spot)
    assert put.held.tolist() == [-1, -1]
    still = scene.run(put, 10)
    assert_allclose(scene.body(still, CUP)[:3], [0.9, -0.05, 0.75], atol=0.01)


@pytest.mark.parametrize(
    ("agent", "body", "why"),
    [(0, SOFA, "too heavy"), (1, STOOL, "too heavy for this agent"), (1, BOOK, "out of reach"), (0, 9, "no such body")],
)
def test_what_cannot_be_taken_stays(scene, agent, body, why):
    state = scene.run(scene.start, 2, agent=agent, pick=body)
    assert (state.held == -1).all(), why


def test_a_thing_has_one_holder(scene):
    state = scene.run(scene.start, 3, pick=CUP)
    state = scene.run(state, 3, agent=1, pick=CUP)
    assert state.held.tolist() == [CUP, -1]
    state = scene.run(state, 2, pick=BOOK)
    assert state.held.tolist() == [CUP, -1]  # the hand is full


def test_what_is_dropped_falls(scene):
    """On what is below: the table, or the floor beside it."""
    held = scene.run(scene.start, 12, pick=CUP)
    beside = scene.run(held, 15, np.array([[-0.8, 0, 0], [0, 0, 0]], np.float32))
    over = scene.run(held, 4, np.array([[1, 0, 0], [0, 0, 0]], np.float32))
    for state, height in ((beside, 0.05), (over, 0.75)):
        state = scene.run(state, 12, drop=True)
        assert state.held.tolist() == [-1, -1]
        assert_allclose(scene.body(state, CUP)[2], height, atol=0.01)


def test_a_drop_moves_no_other_body(scene):
    """An empty hand does not release body 0, which was the index used in place of -1."""
    args = scene.template, scene.bank, jnp.int32(0)
    state = scene.run(scene.start, 12, pick=BOOK)
    state = scene.run(state, 12, np.array([[-0.6, 0, 0], [0, 0, 0]], np.float32))
    assert state.held.tolist() == [BOOK, -1]
    state = physics.step(*args, apply_hand_commands(*args, state, told(drop=True)), jnp.asarray(STILL))
    np.testing.assert_array_equal(update_hands(*args, state).qvel, state.qvel)


def test_what_is_thrown_flies(fused):
    held = fused.run(fused.start, 12, pick=CUP)
    thrown = fused.run(held, 1, throw=np.array([0.6, 0.0, 0.8]))
    start = fused.template.layout.body_qvel.start + 6 * CUP
    speed = MAX_THROW_SPEED * np.array([0.6, 0.0, 0.8]) - [0, 0, 9.81 * 0.1]
    assert_allclose(thrown.qvel[start : start + 3], speed, atol=0.05)
    assert fused.body(fused.run(thrown, 20), CUP)[0] < 3  # the wall stops it


@pytest.mark.parametrize("length", [1e-30, 1e9])
def test_a_throw_has_a_direction_and_no_length(scene, length):
    held = scene.run(scene.start, 12, pick=CUP)
    aim = np.array([0.6, 0.0, 0.8])
    as_unit, thrown = (scene.run(held, 2, throw=aim * factor) for factor in (1, length))
    assert thrown.held.tolist() == [-1, -1]
    assert_allclose(thrown.qpos, as_unit.qpos, atol=1e-4)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_throw_to_nowhere_is_left_undone(scene, wrong):
    held = scene.run(scene.start, 12, pick=CUP)
    kept = scene.run(held, 1, throw=np.array([0.6, wrong, 0.8]))
    assert kept.held.tolist() == [CUP, -1]
    assert bool(jnp.isfinite(kept.qvel).all())


@pytest.mark.parametrize("height", [-100.0, 2.7, 50.0, np.nan])
def test_nothing_is_put_down_far_above_or_below(scene, height):
    """The hand once took things through the roof, as its reach was that in the plan."""
    held = scene.run(scene.start, 12, pick=CUP)
    kept = scene.run(held, 3, place=np.array([0.9, 0.0, height]))
    assert not bool(jnp.isfinite(kept.place_target).any())
    assert_allclose(scene.body(kept, CUP), scene.body(held, CUP), atol=2e-3)


def test_doors_of_other_storeys_are_out_of_reach(scene):
    middle = HOUSE.doors[0].height + scene.template.config.agents[1].height / 2  # of an agent on top of the leaf
    for rise, turns in ((0.9, True), (1.1, False)):
        z = middle + rise
        above = scene.start.replace(qpos=scene.start.qpos.at[4:7].set(jnp.array([0.7, 1.2, z])))
        assert (scene.run(above, 1, agent=1, door=0, open=True).door_goal[0] != NOT_DRIVEN) == turns


@pytest.mark.parametrize("impl", ["fused", "c"])
def test_an_edge_that_a_hand_presses_against_an_edge_is_not_2_cm_deep(impl):
    """MuJoCo finds one contact of two parallel edges, at one end and the other by turns: so hands must be weak.

    A long box stands before the frame of a door, and the hand is behind that and rises.
    """
    frame, turned = Box((0, 0, 1.06), (0.064, 0.07, 1.06)), np.radians([80, 80, 88])
    boxes = [
        Box((0.094 + x, y, 1.1), (0.475, 0.11, 0.317), yaw=yaw, mass=4, friction=0.35, restitution=0.35)
        for x, y, yaw in zip((0.191, 0.191, 0.127), (0.2, 0.25, 0.2), turned, strict=True)
    ]
    bank = make_bank([TinyHouse(static=[frame], movable=[box]) for box in boxes])
    template = Template(PhysicsSetup(impl=impl, timing=Timing(ctrl_dt=0.01)), bank.spec)
    house, agent = jnp.arange(len(boxes)), jnp.array([[-0.4, -1.5, 0.0]])
    state = jax.vmap(lambda h: physics.reset(template, bank, h, agent, jnp.zeros(1)))(house)
    state = state.replace(held=jnp.zeros_like(state.held))
    step = jax.jit(jax.vmap(lambda h, s: physics.step(template, bank, h, s, jnp.zeros((1, 3)))))
    grip = np.stack([[*(np.array(box.pos) - [0.4, 0, 0] - np.asarray(state.qpos[0, :3])), *box.quat] for box in boxes])
    deepest = 0.0
    for _ in range(120):
        grip[:, 2] += 0.003
        state = step(house, state.replace(grip=jnp.array(grip[:, None], jnp.float32)))
        deepest = max(deepest, *(depth_in(np.asarray(pose), boxes[0].size, frame) for pose in state.qpos[:, 4:11]))
    assert 0.01 < deepest < 0.02


def depth_in(pose: np.ndarray, half: tuple[float, ...], other: Box) -> float:
    """How deep a box that stands upright is in another one [m]."""
    yaw, *tilt = Rotation.from_quat(pose[3:], scalar_first=True).as_euler("zyx")
    assert_allclose(tilt, 0, atol=0.05)
    both = make_boxes(np.stack([pose[:3], other.pos]), np.stack([half, other.size]), np.array([yaw, other.yaw]))
    return penetration_depth(both[:1], both[1:])[0, 0]


def test_a_thing_that_is_stuck_is_torn_away(fused):
    """It hangs behind a wall for ever, so the hand lets go of it; the agent is held back, but not for ever."""
    state = fused.run(fused.start, 12, pick=CUP)
    layout = fused.template.layout
    q = layout.body_qpos.start + 7 * CUP
    beyond = state.replace(qpos=state.qpos.at[q : q + 3].set(jnp.array([0.6, 3.5, 1.0])))
    assert float(jnp.linalg.norm(beyond.qpos[q : q + 3] - state.qpos[q : q + 3])) > MAX_HOLD_DISTANCE
    assert fused.run(beyond, MAX_PLACE_STEPS + 3).held.tolist() == [-1, -1]


def test_a_hand_turns_a_door_to_its_ends(scene):
    opened = scene.run(scene.start, 25, agent=1, door=0, open=True)
    angle = scene.template.layout.door_qpos.start
    assert_allclose(opened.qpos[angle], HOUSE.doors[0].high, atol=0.05)
    assert opened.door_goal[0] == NOT_DRIVEN
    shut = scene.run(opened, 25, agent=1, door=0, open=False)
    assert_allclose(shut.qpos[angle], 0.0, atol=0.05)
    far = scene.start.replace(qpos=scene.start.qpos.at[4:6].set(jnp.array([-2.5, -2.5])))
    assert scene.run(far, 3, agent=1, door=0, open=True).door_goal[0] == NOT_DRIVEN  # out of reach


class Hands(RuleBasedStateMachine):
    """Any sequence of commands leaves a possible world."""

    scene: Scene

    @initialize()
    def begin(self):
        self.state = self.scene.start

    @rule(
        walk=st.tuples(*[st.sampled_from([-1.0, 0.0, 1.0])] * 6),
        agent=st.integers(0, 1),
        steps=st.integers(1, 12),
        command=st.one_of(
            st.builds(lambda k: {"pick": k}, st.integers(-1, 4)),
            st.just({"drop": True}),
            st.builds(
                lambda x, y: {"throw": np.array([x, y, np.sqrt(1 - x * x - y * y)])}, *[st.floats(-0.7, 0.7)] * 2
            ),
            st.builds(lambda x, y, z: {"place": np.array([x, y, z])}, *[st.floats(-2, 2)] * 2, st.floats(0, 1)),
            st.builds(lambda d, o: {"door": d, "open": o}, st.integers(-1, 2), st.booleans()),
        ),
    )
    def act(self, walk, agent, steps, command):
        self.state = self.scene.run(self.state, steps, np.array(walk, np.float32).reshape(2, 3), agent=agent, **command)

    @invariant()
    def possible(self):
        state, config, layout = self.state, self.scene.template.config, self.scene.template.layout
        assert bool(jnp.isfinite(state.qpos).all())
        held = [k for k in state.held.tolist() if k >= 0]
        assert len(set(held)) == len(held)
        for k, body in zip(state.held.tolist(), config.agents, strict=True):
            assert k < 0 or HOUSE.movable[k].mass <= body.max_lift_mass
        (door,) = np.asarray(state.qpos[layout.door_qpos])[: len(HOUSE.doors)]
        assert -0.1 < door < HOUSE.doors[0].high + 0.1
        for k in range(4):
            assert self.scene.body(state, k)[2] > -0.02  # nothing is under the floor
            assert abs(self.scene.body(state, k)[0]) < 3.05
        assert float(state.qpos[0]) < 2.95 - config.agents[0].radius + 0.03


def test_any_sequence_of_commands_leaves_a_possible_world(fused):
    Hands.scene = fused
    machine = Hands.TestCase
    machine.settings = settings(max_examples=15, stateful_step_count=12, deadline=None, derandomize=True)
    machine("runTest").runTest()
