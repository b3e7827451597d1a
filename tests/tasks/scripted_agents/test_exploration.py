"""Exploration: tiles against loops over cells, coverage and its reward, and who covers how much."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, HouseholdEnv, expert_action
from home_mjx.tasks.scripted_agents.exploration import divide_in_tiles
from home_mjx.tasks.suite import Exploration

CONFIG = EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(impl="kinematic"))
NUM, HORIZON = 8, 500
FORWARD, LEFT = 1, 2


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:2?preset=flat")


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(CONFIG, Exploration()).bind(bank)


@pytest.fixture(scope="module")
def walk(env):
    """States of a batch at the reset, and after each of 12 steps ahead and to the left."""
    begin = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0, 0)))
    advance = jax.jit(jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0)))
    states = [begin(env.params, jax.random.split(jax.random.key(0), NUM), jnp.arange(NUM) % 2)]
    for step in range(12):
        states.append(advance(env.params, states[-1], jnp.full(NUM, FORWARD if step % 4 else LEFT)))
    return states


def home_cells(bank, house: int) -> np.ndarray:
    """Level, row and column of the cells where agents can walk."""
    cell = np.asarray(bank.navigation.cell[house])
    first, count = int(bank.navigation.first_cell[house]), int(bank.navigation.num_cells[house])
    return np.argwhere((cell >= first) & (cell < first + count))


def test_tiles_hold_the_free_cells_and_the_room_of_their_middle(bank):
    for house in range(2):
        tiles = jax.tree.map(np.asarray, jax.jit(divide_in_tiles)(bank, jnp.int32(house)))
        cells, rooms = home_cells(bank, house), np.asarray(bank.navigation.room[house])
        expected = np.zeros_like(tiles.free)
        np.add.at(expected, (cells[:, 0], cells[:, 1] // 5, cells[:, 2] // 5), 1)
        np.testing.assert_array_equal(tiles.free, expected)
        assert tiles.middle.shape == rooms.shape
        for level, row, column in np.argwhere(expected):
            own = cells[(cells[:, 0] == level) & (cells[:, 1] // 5 == row) & (cells[:, 2] // 5 == column)]
            away = np.linalg.norm(own[:, 1:] + 0.5 - [5 * row + 2.5, 5 * column + 2.5], axis=1)
            nearest = own[away < away.min() + 1e-6]
            chosen = nearest[[bool(tiles.middle[tuple(c)]) for c in nearest]]
            assert len(chosen) == 1
            assert tiles.room[level, row, column] == rooms[tuple(chosen[0])]
        assert tiles.middle.sum() == (expected > 0).sum()
        assert (tiles.room[expected == 0] == -1).all()


def test_what_is_near_in_the_same_room_is_covered(env, bank, walk):
    """Against a loop over agents' places: covered is what was near at any of them."""
    covered = [np.zeros(np.shape(walk[0].task.covered[0]), bool) for _ in range(NUM)]
    for state in walk:
        place = agent_places(env, state)
        for e in range(NUM):
            house = int(state.world.house[e])
            covered[e] |= near_tiles(bank, house, np.asarray(state.task.room[e]), place[e])
            np.testing.assert_array_equal(state.task.covered[e], covered[e])


def agent_places(env, states) -> np.ndarray:
    return np.asarray(positions(env.core, env.params, states))[:, 0]


@functools.partial(jax.jit, static_argnums=0)
def positions(core, params, states):
    return jax.vmap(lambda s: core.snapshot(params, s).pose.pos)(states)


def near_tiles(bank, house: int, room: np.ndarray, pos: np.ndarray) -> np.ndarray:
    local = pos[:2] - np.asarray(bank.navigation.origin[house])
    own = np.asarray(bank.navigation.room[house])[0][tuple((local[::-1] / 0.1).astype(int))]
    found = np.zeros(room.shape, bool)
    for level, row, column in np.argwhere(room == own):
        middle = np.array([column + 0.5, row + 0.5]) * 0.5
        found[level, row, column] = level == 0 and np.hypot(*(middle - local)) <= 2
    return found


def test_reward_is_the_area_that_is_new(env, walk):
    task, gains = env.task, []
    look = jax.jit(jax.vmap(lambda state: env.core.snapshot(env.params, state)))
    for before, after in itertools.pairwise(walk):
        free = np.asarray(after.task.free)
        new = (free * (np.asarray(after.task.covered) & ~np.asarray(before.task.covered))).sum(axis=(1, 2, 3)) * 0.01
        gains.append(new)
        touches = np.asarray(look(after).in_contact)[:, 0]
        collided = np.asarray(after.task.collisions - before.task.collisions)[:, 0]
        np.testing.assert_array_equal(collided, touches * (np.asarray(look(after).action)[:, 0, FORWARD] > 0))
        costs = task.step_cost + task.contact_cost * touches
        np.testing.assert_allclose(after.reward, task.area_reward * new - costs, atol=1e-5)
        share = (free * np.asarray(after.task.covered)).sum(axis=(1, 2, 3)) / free.sum(axis=(1, 2, 3))
        np.testing.assert_allclose(after.metrics["coverage"], share, atol=1e-6)
    assert np.sum(gains) > 1
    assert not np.asarray(walk[-1].terminated).any()


@pytest.mark.parametrize(("option", "value"), [("cover_radius", 0.2), ("success_coverage", 1.5), ("area_reward", -1.0)])
def test_options_that_cannot_be_are_refused(option, value):
    with pytest.raises(ConfigError, match=option):
        Exploration(**{option: value})


def test_the_id_makes_the_task(bank):
    env = home_mjx.make("Exploration-v0", bank, sensors=("state",), cover_radius=1.5)
    assert env.task == Exploration(cover_radius=1.5)
    assert env.config.discrete is not None
    assert env.config.episode_length == 4000


def test_the_expert_stops_once_nothing_is_left(env, walk):
    def expert(state, covered):
        return expert_action(env.core.snapshot(env.params, state), state.task.replace(covered=covered))[0]

    stop, act = env.core.action_names.index("stop"), jax.jit(jax.vmap(expert))
    covered = walk[-1].task.covered
    assert (act(walk[-1], covered) != stop).all()
    np.testing.assert_array_equal(act(walk[-1], jnp.ones_like(covered)), stop)


@pytest.mark.slow
def test_the_expert_covers_the_house_and_chance_does_not(env):
    """Within 500 steps, an eighth of what the id gives: these houses are small."""
    states = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0, 0)))(
        env.params, jax.random.split(jax.random.key(0), NUM), jnp.arange(NUM) % 2
    )

    def run(act):
        def step(states, key):
            actions = jax.vmap(act)(states, jax.random.split(key, NUM))
            advance = jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0))
            return advance(env.params, states, actions), None

        keys = jax.random.split(jax.random.key(1), HORIZON)
        return jax.jit(lambda s: jax.lax.scan(step, s, keys)[0])(states)

    expert = run(lambda s, _: expert_action(env.core.snapshot(env.params, s), s.task)[0])
    assert np.asarray(expert.metrics["success"]).mean() >= 0.99
    random = run(lambda _, key: jax.random.randint(key, (), 1, 6))  # without `stop`, which would end it sooner
    assert np.asarray(random.metrics["success"]).mean() < 0.1
    assert np.asarray(random.metrics["coverage"]).mean() < 0.5
