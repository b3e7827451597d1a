"""Discrete actions: how far moves go, where they end, what stop ends, and who takes them."""

import functools

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from checked import checked
from handmade import Furniture, shoebox
from numpy.testing import assert_allclose, assert_array_equal
from whole_episodes import begun, played

import home_mjx
from home_mjx import AutoReset, HouseBank
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.adapters.gymnax import GymnaxEnv
from home_mjx.errors import ConfigError, OutOfRangeError
from home_mjx.physics import PhysicsConfig
from home_mjx.schema import AgentBody
from home_mjx.tasks import DiscreteActions, Status, add_expert, make_config, sample_episodes
from home_mjx.tasks.env.actions import decode_actions
from home_mjx.viewer.episodes.keyboard import key_actions

MOVES = ("stop", "move_forward", "turn_left", "turn_right", "look_up", "look_down")
NAMES = (*MOVES, "pick", "drop", "throw", "open", "close")
NUM = 32
IMPLS = ("kinematic", "fused", pytest.param("jax", marks=pytest.mark.slow))
WALL = 3.0  # [m], of the empty room along x


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox()])


class Room:
    """Agents that stand where they are put, in an empty room or another bank."""

    def __init__(self, bank: HouseBank, actions: str | DiscreteActions = "discrete", **options):
        self.env = home_mjx.make("PointNav-v0", bank, actions=actions, sensors=("state",), **options)
        self.half = self.env.config.body.height / 2
        self.reset = jax.jit(self.env.core.reset)
        self.program = jax.jit(self.env.core.step)
        self.step = checked(self.program)
        self.many = checked(jax.jit(jax.vmap(self.env.core.step, (None, 0, 0))))

    def at(self, x: float, y: float, yaw: float, seed: int = 0):
        state = self.reset(self.env.params, jax.random.key(seed))
        pose = jnp.array([x, y, self.half, yaw], jnp.float32)
        return state.replace(physics=state.physics.replace(qpos=state.physics.qpos.at[:4].set(pose)))

    def do(self, state, *names: str):
        for name in names:
            state = self.step(self.env.params, state, jnp.int32(NAMES.index(name)))
        return state


def pose(state) -> np.ndarray:
    """x, y [m], yaw and pitch [rad] of the first agent, in double precision."""
    qpos = np.asarray(state.physics.qpos, float)
    return np.concatenate([qpos[..., [0, 1, 3]], np.asarray(state.world.pitch, float)[..., :1]], axis=-1)


@pytest.fixture(scope="module")
def rooms(bank):
    """The room of an implementation, made once."""
    return functools.cache(lambda impl: Room(bank, impl=impl))


@pytest.fixture(scope="module", params=IMPLS)
def room(request, rooms):
    return rooms(request.param)


def expected(before: np.ndarray, name: str, forward: float, turn: float, tilt: float) -> np.ndarray:
    """The pose after a move in free space."""
    x, y, yaw, pitch = before.T
    step = forward * (name == "move_forward")
    left = turn * ((name == "turn_left") - (name == "turn_right"))
    up = tilt * ((name == "look_up") - (name == "look_down"))
    return np.stack([x + step * np.cos(yaw), y + step * np.sin(yaw), yaw + left, pitch + up], axis=-1)


def check_moves(room: Room, forward: float, turn: float, tilt: float) -> None:
    """Random chains of moves, each compared with the pose before it."""
    rng = np.random.default_rng(0)
    atol = 5e-6 if room.env.config.physics.impl == "jax" else 2e-6  # MJX adds up 30 steps in single precision
    starts = [room.at(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-3, 3)) for _ in range(NUM)]
    states = jax.tree.map(lambda *x: jnp.stack(x), *starts)
    for chosen in rng.integers(1, 6, (4, NUM)):
        before, states = pose(states), room.many(room.env.params, states, jnp.asarray(chosen, jnp.int32))
        wanted = np.stack([expected(before[i], NAMES[k], forward, turn, tilt) for i, k in enumerate(chosen)])
        wanted[:, 3] = np.where(abs(wanted[:, 3]) > 1.0, before[:, 3], wanted[:, 3])
        assert_allclose(pose(states), wanted, atol=atol)


def test_a_move_goes_exactly_as_far_as_it_says(room):
    """0.25 m, 10 degrees and 15 degrees: Habitat's."""
    check_moves(room, 0.25, np.radians(10), np.radians(15))


@pytest.mark.parametrize("control", ["velocity", "force"])
def test_moves_have_the_size_that_was_chosen(bank, control):
    body = AgentBody(forward_speed=0.5, turn_rate=1.0, mass=30)
    room = Room(bank, DiscreteActions(0.1, 30, 20), body=body, ctrl_dt=0.6, control=control)
    check_moves(room, 0.1, np.radians(30), np.radians(20))


def test_a_wall_ends_a_move(room):
    """From 17 cm before a wall the agent walks as far as that; from there it walks away as if nothing had been."""
    radius, deepest = 0.1, 0.001 if room.env.config.physics.impl == "kinematic" else 0.02
    before = room.at(WALL - radius - 0.17, 0.3, 0.0)
    there = room.do(before, "move_forward")
    assert -deepest < WALL - radius - pose(there)[0] < 0.005
    assert_allclose(pose(there)[1:3], [0.3, 0.0], atol=1e-4)
    assert bool(there.obs["state"][9])
    turned = room.do(there, *["turn_left"] * 18)
    away = room.do(turned, "move_forward")
    assert_allclose(pose(away)[:2] - pose(turned)[:2], [-0.25, 0.0], atol=deepest)
    assert_allclose(pose(away)[2], np.pi, atol=1e-4)


def test_along_a_wall_the_agent_slides(room):
    yaw = np.radians(30)
    before = room.at(WALL - 0.1 - 0.05, 0.0, yaw)
    after = room.do(before, "move_forward")
    x, y, turned, _ = pose(after) - pose(before)
    assert 0.045 < x < 0.08
    assert 0.08 < y < 0.25 * np.sin(yaw) + 0.01
    assert_allclose(turned, 0, atol=1e-5)


def test_looks_stay_on_their_grid(rooms):
    """A look that would end beyond `max_pitch` (57.3 degrees) is not done."""
    room = rooms("kinematic")
    state, seen = room.at(0, 0, 0), []
    for name in ["look_up"] * 5 + ["look_down"] * 8:
        state = room.do(state, name)
        seen.append(round(float(np.degrees(state.world.pitch[0])), 3))
    assert seen == [15, 30, 45, 45, 45, 30, 15, 0, -15, -30, -45, -45, -45]


@pytest.mark.parametrize("number", [-1, 6, 1000])
def test_a_number_that_is_no_action_does_nothing(rooms, number):
    room = rooms("kinematic")
    before = room.at(0, 0, 1.0)
    after = room.program(room.env.params, before, jnp.int32(number))
    assert_array_equal(pose(after), pose(before))
    assert not after.world.stopped.any()
    assert int(after.world.step) == 1
    assert Status(int(after.status)) == Status.ACTION


def at_goal(room: Room, state, away: float):
    """The state with the agent `away` [m] beside its goal."""
    goal = room.env.bank.navigation.goal[state.world.house, state.task.goal]
    toward = -jnp.sign(goal[0]) * away  # into the room
    pos = goal.at[0].add(toward).at[2].add(room.half)
    return state.replace(physics=state.physics.replace(qpos=state.physics.qpos.at[:3].set(pos)))


def test_stop_declares_arrival(bank):
    """As in Habitat: only `stopped` within 0.2 m of the goal is success, and `stopped` anywhere ends the episode."""
    room = Room(bank, impl="kinematic", stop=True, success_distance=0.2)
    start = room.at(0, 0, 0)
    there, beside = at_goal(room, start, 0.05), at_goal(room, start, 0.5)
    silent = room.do(there, "turn_left")
    assert not silent.terminated
    assert float(silent.metrics["success"]) == 0
    for state, success in ((silent, 1), (beside, 0)):
        done = room.do(state, "stop")
        assert bool(done.terminated)
        assert not done.truncated
        assert float(done.metrics["success"]) == success
        progress = float(state.task.distance[0] - done.task.distance[0])
        assert_allclose(done.reward, progress - 0.01 + 2.5 * success, atol=1e-5)


def test_stop_gives_up_where_arrival_needs_no_word(rooms):
    room = rooms("kinematic")
    start = room.at(0, 0, 0)
    done = room.do(at_goal(room, start, 0.5), "stop")
    assert bool(done.terminated)
    assert float(done.metrics["success"]) == 0
    there = room.do(at_goal(room, start, 0.05), "turn_left")
    assert bool(there.terminated)
    assert float(there.metrics["success"]) == 1


def test_an_agent_that_has_stopped_waits_for_the_others(bank):
    env = home_mjx.make("PointNav-v0", bank, actions="discrete", num_agents=2, impl="kinematic", sensors=("state",))
    step, state = jax.jit(env.core.step), jax.jit(env.core.reset)(env.params, jax.random.key(1))
    assert env.action_spec.shape == (2,)
    stopped = step(env.params, state, jnp.array([0, 1]))
    assert not stopped.terminated
    assert stopped.world.stopped.tolist() == [True, False]
    after = step(env.params, stopped, jnp.array([1, 2]))
    assert_array_equal(after.obs["state"][0, :6], stopped.obs["state"][0, :6])
    assert not np.allclose(after.obs["state"][1, :6], stopped.obs["state"][1, :6])
    assert bool(step(env.params, after, jnp.array([1, 0])).terminated)


def test_the_next_episode_begins_unstopped(bank):
    env = home_mjx.make("PointNav-v0", bank, actions="discrete", impl="kinematic", sensors=("state",))
    batch = AutoReset(env.core).bind(env.params)
    states = jax.jit(batch.reset)(jax.random.split(jax.random.key(0), 3))
    after = jax.jit(batch.step)(states, jnp.array([0, 1, 2]))
    assert after.terminated.tolist() == [True, False, False]
    assert not after.world.stopped.any()
    assert after.world.step.tolist() == [0, 1, 1]


def test_hands_have_actions_of_their_own(bank):
    config = make_config(actions="discrete", hands=True, num_agents=2)
    told = {"pick": (1, 0, 0), "drop": (-1, 0, 0), "throw": (0, 1, 0), "open": (0, 0, 1), "close": (0, 0, -1)}
    nobody = jnp.zeros(2, bool)
    for number, name in enumerate(NAMES):
        moves = decode_actions(config, jnp.array([number, 3]), nobody)
        assert_array_equal(moves.hands, [told.get(name, (0, 0, 0)), (0, 0, 0)])
        assert moves.stopped.tolist() == [name == "stop", False]


@pytest.mark.parametrize("impl", ["kinematic", "fused"])
def test_a_thing_is_carried_as_far_as_a_move(impl):
    """The crate in the middle of the view is taken, carried 0.25 m, and dropped to the floor."""
    crate = Furniture((0.6, 0.0), size=(0.3, 0.3, 1.7), mass=5.0)
    room = Room(HouseBank.from_compiled([shoebox(furniture=[crate])]), hands=True, impl=impl)
    assert room.env.action_spec.text.split(", ") == list(NAMES)
    assert room.env.action_size == len(NAMES)
    held = room.do(room.at(0, 0, 0), "pick", "turn_left", "turn_right")
    assert held.physics.held.tolist() == [0]
    moved = room.do(held, *["turn_left"] * 9, "move_forward")
    assert moved.physics.held.tolist() == [0]
    assert_allclose(pose(moved)[1] - pose(held)[1], 0.25, atol=1e-5)
    dropped = room.do(moved, "drop", "turn_left")
    assert dropped.physics.held.tolist() == [-1]
    rows = room.env.core.template(room.env.bank).layout.body_qpos
    assert_allclose(dropped.physics.qpos[rows][2], 1.7 / 2, atol=0.01)


def test_a_step_is_as_long_as_moves_need():
    assert make_config(actions="discrete").timing.ctrl_dt == 0.3
    assert make_config(actions="discrete", sample_rate=8000).audio.frame == 2400
    assert make_config(actions="discrete", ctrl_dt=0.5).physics_setup.timing.ctrl_dt == 0.5
    assert make_config(actions="discrete", forward_speed=2.5, turn_rate=2.0).timing.ctrl_dt == 0.1
    assert make_config(actions=DiscreteActions(0.05, 5)).timing.ctrl_dt == 0.1
    assert make_config().timing.ctrl_dt == 0.1
    for options in ({"ctrl_dt": 0.2}, {"forward_speed": 0.5}, {"turn_rate": 0.5}):
        with pytest.raises(ConfigError, match=r"a move takes 0\.\d+ s"):
            make_config(actions="discrete", **options)
    slow = PhysicsConfig(num_agents=2, bodies=(AgentBody(), AgentBody(forward_speed=0.5)))
    with pytest.raises(ConfigError, match=r"takes 0\.5 s at full speed, but a step is 0\.3 s"):
        make_config(actions="discrete", physics=slow)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"actions": "discret"}, "Did you mean `discrete`"),
        ({"stop": True}, 'actions="discrete"'),
        ({"actions": "discrete", "stop": 1}, "stop"),
        ({"turn_angle": 30}, "DiscreteActions"),
    ],
)
def test_options_that_make_no_sense_are_refused(bank, options, words):
    with pytest.raises(ConfigError, match=words):
        home_mjx.make("PointNav-v0", bank, **options)
    with pytest.raises(ConfigError, match="forward_step_size"):
        DiscreteActions(forward_step_size=-1)


@pytest.mark.parametrize(("action", "words"), [(np.float32(1), "integer"), (np.zeros(1, np.int32), "shape")])
def test_actions_that_are_no_number_are_refused(bank, action, words):
    env = home_mjx.make("PointNav-v0", bank, actions="discrete", impl="kinematic", sensors=("state",))
    state = jax.eval_shape(env.reset, jax.ShapeDtypeStruct((2,), jnp.uint32))
    if words == "shape":
        jax.eval_shape(env.step, state, action)  # one agent may have its axis
        action = np.zeros(2, np.int32)
    with pytest.raises(ConfigError, match=words):
        jax.eval_shape(lambda s: env.step(s, action), state)


FOUR = DiscreteActions(tilt_angle=None)


def test_without_looks_there_are_the_four_moves_of_habitat(bank):
    """Names, numbers, spaces and keys; a step of each does as its name says, and the pitch stays."""
    room = Room(bank, FOUR, impl="kinematic")
    assert room.env.core.action_names == MOVES[:4]
    assert (room.env.action_spec.low, room.env.action_spec.high, room.env.core.action_size) == (0, 3, 4)
    assert sorted(key_actions(room.env.config)) == [" ", "a", "d", "w"]
    for number, name in enumerate(MOVES[1:4], 1):
        before = room.at(0.2, -0.3, 0.5)
        after = room.step(room.env.params, before, jnp.int32(number))
        wanted = expected(pose(before)[None], name, 0.25, np.radians(10), 0.0)[0]
        assert_allclose(pose(after), wanted, atol=2e-6)
    assert Status.names(room.program(room.env.params, before, jnp.int32(4)).status) == ["ACTION"]
    assert make_config(actions={"tilt_angle": None}).actions == FOUR
    said = make_config(actions=FOUR, speech=("say:yes",))
    assert said.action_names == (*MOVES[:4], "say:yes")
    with pytest.raises(ConfigError, match="hands aim by looking up and down"):
        make_config(actions=FOUR, hands=True)
    with pytest.raises(ConfigError, match=r"actions.turn_angle"):
        DiscreteActions(turn_angle=-1.0)


def test_experts_walk_without_looks(generated_bank):
    options = {"sensors": ("state",), "impl": "kinematic", "stop": True, "actions": FOUR}
    env = home_mjx.make("PointNav-v0", generated_bank, **options)
    env = add_expert(env.with_tasks(sample_episodes(generated_bank, 16)))
    ended = played(env, begun(env), lambda state, key: state.obs["expert"], 300)
    assert np.asarray(ended.metrics["success"]).mean() > 0.9


def test_adapters_of_one_agent_have_the_four_actions(generated_bank):
    options = {"actions": FOUR, "impl": "kinematic", "sensors": ("state", "goal")}
    env = home_mjx.make("PointNav-v0", generated_bank, **options)
    assert GymEnv(houses=generated_bank, **options).action_space == gymnasium.spaces.Discrete(4)
    assert GymnaxEnv(env).num_actions == 4


def test_adapters_of_several_agents_have_the_four_actions(generated_bank):
    pytest.importorskip("jaxmarl"), pytest.importorskip("pettingzoo")
    from home_mjx.adapters.jaxmarl import JaxMarlEnv
    from home_mjx.adapters.pettingzoo import PettingZooEnv

    options = {"actions": FOUR, "impl": "kinematic", "sensors": ("state", "goal"), "num_agents": 2}
    pair = home_mjx.make("PointNav-v0", generated_bank, **options)
    assert {space.n for space in JaxMarlEnv(pair).action_spaces.values()} == {4}
    assert PettingZooEnv("PointNav-v0", houses=generated_bank, **options).action_space("agent_0").n == 4


def test_outside_jit_an_action_that_does_not_exist_is_refused():
    config = make_config(actions="discrete")
    for wrong in (6, -1):
        with pytest.raises(OutOfRangeError, match=rf"no action {wrong}. Give a number from 0 to 5: 0 stop, 1 move_for"):
            decode_actions(config, jnp.int32(wrong), jnp.zeros(1, bool), 1)
    assert bool(jax.jit(lambda a: decode_actions(config, a, jnp.zeros(1, bool), 1).is_invalid)(jnp.int32(6)))


def test_gymnasium_has_discrete_spaces(bank):
    options = {"houses": bank, "actions": "discrete", "impl": "kinematic", "sensors": ("state",), "episode_length": 3}
    env = GymEnv(**options)
    assert env.action_space == gymnasium.spaces.Discrete(6)
    assert env.metadata["render_fps"] == 3
    env.reset(seed=0)
    for _ in range(3):
        *_, truncated, _ = env.step(env.action_space.sample(np.array([0, 1, 1, 1, 1, 1], np.int8)))
    assert truncated
    env.reset(seed=0)
    for action, words in ((6, "0 to 5"), (-1, "0 to 5"), (1.0, "integers"), ([1], "shape")):
        with pytest.raises(ConfigError, match=words):
            env.step(action)
    assert GymEnv(num_agents=2, **options).action_space == gymnasium.spaces.MultiDiscrete([6, 6])
    batch = GymVectorEnv(3, **options)
    assert batch.action_space == gymnasium.spaces.MultiDiscrete([6, 6, 6])
    batch.reset(seed=0)
    *_, terminated, _, _ = batch.step(np.array([0, 1, 0]))
    assert terminated.tolist() == [True, False, True]


def test_brax_refuses_them(bank):
    pytest.importorskip("brax", reason="needs the extra `train`")
    from home_mjx.adapters.brax import BraxEnv

    with pytest.raises(ConfigError, match="discrete"):
        BraxEnv(home_mjx.make("PointNav-v0", bank, actions="discrete", sensors=("state",)))
