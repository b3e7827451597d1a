"""The top-down map: its cells, goals, ways and fog of war by hand."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.ndimage
from handmade import Furniture, two_rooms

from home_mjx import HouseBank, physics
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.tasks import HouseholdEnv, make_config
from home_mjx.tasks.metrics import CellOccupancy, top_down_map, update_map_memory
from home_mjx.tasks.suite import HouseTasks, ObjectNav, RoomNav
from home_mjx.viewer.pictures import draw_map
from home_mjx.viewer.pictures.floor_map import GOAL_COLOUR, PATH_COLOUR, UNSEEN_BRIGHTNESS

SIZE = (4.0, 5.0, 3.0)
CUPBOARD = Furniture((-2.0, 1.0), (0.8, 0.6, 2.4))  # hides what is behind it
STOOL = Furniture((-2.0, -1.0), (0.6, 0.6, 0.5))  # does not
FILLED = Furniture((2.0, 0.0), (3.0, 4.0, 2.4))  # so that the home region is in the other room
OPTIONS = {"num_agents": 2, "impl": "kinematic", "sensors": ("state",), "max_depth": 30.0}
EAST, NORTH = 0.0, np.pi / 2


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([two_rooms(SIZE, furniture=(CUPBOARD, STOOL, FILLED))])
    return HouseholdEnv(make_config(**OPTIONS)).bind(bank)


@pytest.fixture(scope="module")
def begun(env):
    return jax.jit(functools.partial(env.core.reset, observe=False))(env.params, jax.random.key(0))


@pytest.fixture(scope="module")
def remember(env):
    return jax.jit(lambda state, memory: update_map_memory(env.core.snapshot(env.params, state), memory))


@pytest.fixture(scope="module")
def draw(env):
    return jax.jit(lambda state, memory: top_down_map(env.core.snapshot(env.params, state), state.task, memory))


def at(env, begun, places, yaws=(EAST, EAST), step=1):
    """The state with both agents at places on the floor."""
    bank, template = env.bank, env.core.template(env.bank)
    pos = jnp.asarray([[*place, begun.physics.qpos[2]] for place in places], jnp.float32)
    house, angle = begun.world.house, physics.door_angle(template, begun.physics)
    moved = physics.reset(template, bank, house, pos.at[:, 2].set(0.0), jnp.asarray(yaws, jnp.float32), angle, None)
    return begun.replace(physics=moved, world=begun.world.replace(step=jnp.int32(step)))


def middles(env):
    """x and y of every cell [m]."""
    rows, columns = env.bank.navigation.room.shape[2:]
    origin, cell = np.asarray(env.bank.navigation.origin[0]), env.bank.spec.cell
    return np.meshgrid(origin[0] + (np.arange(columns) + 0.5) * cell, origin[1] + (np.arange(rows) + 0.5) * cell)


def cell(env, place):
    return tuple(np.floor((np.asarray(place) - np.asarray(env.bank.navigation.origin[0])) / env.bank.spec.cell)[::-1])


FIRST, SECOND = (-3.03, -2.02), (-1.04, 2.03)


def test_ground_is_that_of_the_bank_and_of_the_boxes(env, begun, remember, draw):
    state = at(env, begun, (FIRST, SECOND))
    ground = np.asarray(draw(state, remember(state, None)).occupancy)
    number, first = np.asarray(env.bank.navigation.cell[0, 0]), int(env.bank.navigation.first_cell[0])
    free = (number >= 0) & (number - first < int(env.bank.navigation.num_cells[0]))
    np.testing.assert_array_equal(ground == CellOccupancy.FREE, free)
    x, y = middles(env)
    room = (x > -4.05) & (x < -0.05) & (np.abs(y) < 2.5)
    for item in (CUPBOARD, STOOL):
        under = (np.abs(x - item.position[0]) < item.size[0] / 2) & (np.abs(y - item.position[1]) < item.size[1] / 2)
        assert (ground[room & under] == CellOccupancy.BLOCKED).all()
    assert (ground[(x < -4.3) | (np.abs(y) > 2.8)] == CellOccupancy.OUTSIDE).all()
    open_floor = (x > -3.7) & (x < -2.7) & (np.abs(y) < 2.1)
    assert (ground[open_floor] == CellOccupancy.FREE).all()
    assert not (free & ~((np.abs(x) < 4.05) & (np.abs(x) > 0.05) & (np.abs(y) < 2.5))).any()


def test_who_is_where_and_looks_whither(env, begun, remember, draw):
    state = at(env, begun, (FIRST, SECOND), (0.5, -2.0))
    memory = remember(state, None)
    there = at(env, begun, ((-3.03, 0.02), SECOND), (NORTH, 3.0), step=2)
    found = draw(there, remember(there, memory))
    assert [tuple(place) for place in np.asarray(found.agents).tolist()] == [
        cell(env, (-3.03, 0.02)),
        cell(env, SECOND),
    ]
    np.testing.assert_allclose(found.yaw, [NORTH, 3.0], atol=1e-5)
    assert tuple(np.asarray(found.start)) == cell(env, FIRST)
    assert int(found.level) == 0
    second = top_down_map(env.core.snapshot(env.params, there), there.task, memory, agent=1)
    assert tuple(np.asarray(second.start)) == cell(env, SECOND)
    with pytest.raises(ConfigError, match="map of 2"):
        top_down_map(env.core.snapshot(env.params, there), there.task, memory, agent=2)


def test_the_way_has_no_gaps_and_a_new_episode_begins_anew(env, begun, remember, draw):
    corners = [(-3.22, -2.02), (-3.22, 2.03), (-1.03, 2.03)]
    path = [np.linspace(a, b, 30) for a, b in itertools.pairwise(corners)]
    state, memory = at(env, begun, (corners[0], SECOND)), None
    for number, place in enumerate(np.concatenate(path)):
        state = at(env, begun, (place, SECOND), step=number + 1)
        memory = remember(state, memory)
    visited = np.asarray(draw(state, memory).visited)
    fine = np.concatenate([np.linspace(a, b, 2000) for a, b in itertools.pairwise(corners)])
    expected = np.zeros_like(visited)
    expected[tuple(np.array([cell(env, place) for place in fine], int).T)] = True
    np.testing.assert_array_equal(visited, expected)
    again = at(env, begun, (FIRST, SECOND), step=0)
    fresh = remember(again, memory)
    np.testing.assert_array_equal(fresh.visited, remember(again, None).visited)
    np.testing.assert_array_equal(fresh.seen, remember(again, None).seen)
    assert np.asarray(fresh.visited[0]).sum() == 1


@pytest.mark.parametrize(("place", "yaw"), [((-2.0, -2.2), NORTH), ((-3.6, 1.0), EAST), ((-0.6, -2.0), 2.4)])
def test_what_is_seen_is_what_straight_lines_reach(env, begun, remember, draw, place, yaw):
    state = at(env, begun, (place, (-3.9, 2.3)), (yaw, EAST))
    seen = np.asarray(draw(state, remember(state, None)).seen)
    x, y = middles(env)
    turn = np.angle(np.exp(1j * (np.arctan2(y - place[1], x - place[0]) - yaw)))
    parts = np.linspace(0, 1, 400)[:, None, None]
    lines = place[0] + parts * (x - place[0]), place[1] + parts * (y - place[1])
    hidden = [np.abs(line - c) < s / 2 for line, c, s in zip(lines, CUPBOARD.position, CUPBOARD.size, strict=False)]
    beyond = (lines[0] > -0.05) | (lines[0] < -4.05) | (np.abs(lines[1]) > 2.5)
    expected = (np.abs(turn) < np.pi / 4) & ~np.any((hidden[0] & hidden[1]) | beyond, axis=0)
    own = cell(env, place)
    expected[int(own[0]), int(own[1])] = True
    edge = scipy.ndimage.binary_dilation(expected, iterations=2) & ~scipy.ndimage.binary_erosion(expected, iterations=2)
    other = np.hypot(x + 3.9, y - 2.3) < 0.4  # the second agent stands there, and hides what is behind it
    assert not ((seen != expected) & ~edge & ~other).any()  # rays are 1.4 degrees apart, and cells are not points
    assert (seen == expected).mean() > 0.985
    assert expected.sum() > 100
    assert not seen[x > 0.2].any()  # through the wall


def test_the_fog_lifts_and_does_not_fall(env, begun, remember, draw):
    memory, shares = None, []
    for step, yaw in enumerate((0.0, NORTH, 2 * NORTH, 3 * NORTH), 1):
        state = at(env, begun, ((-3.0, -0.5), SECOND), (yaw, EAST), step)
        memory = remember(state, memory)
        found = draw(state, memory)
        shares.append(float(np.asarray(found.seen)[np.asarray(found.occupancy) == CellOccupancy.FREE].mean()))
    assert (np.diff(shares) > 0).all()


def test_pointnavs_goal_is_its_cell(env, begun, remember, draw):
    state = at(env, begun, (FIRST, SECOND))
    goal = np.asarray(draw(state, remember(state, None)).goal)
    place = np.asarray(env.bank.navigation.goal[0, int(state.task.goal)])
    assert np.argwhere(goal).tolist() == [[int(i) for i in cell(env, place[:2])]]


def test_a_picture_shows_it(env, begun, remember, draw):
    state = at(env, begun, (FIRST, SECOND))
    found = draw(state, remember(state, None))
    image = draw_map(found, 400)
    assert 300 <= max(image.shape[:2]) <= 400
    colours = {tuple(colour) for colour in image.reshape(-1, 3).tolist()}
    assert tuple(int(240 * UNSEEN_BRIGHTNESS) for _ in range(3)) in colours
    assert (240, 240, 240) in colours
    clear = found.replace(seen=jnp.ones_like(found.seen), visited=jnp.ones_like(found.visited))
    assert (draw_map(clear) == np.array(PATH_COLOUR)).all(axis=-1).mean() > 0.5
    goal = found.replace(goal=jnp.ones_like(found.goal), visited=found.visited & False, seen=clear.seen)
    assert (np.abs(draw_map(goal).astype(int)[..., 2] - np.mean(GOAL_COLOUR[2])) < 120).all()


def test_goals_of_rows_are_their_rooms_and_things():
    bank = load_bank("procedural:1?preset=flat")
    env = HouseholdEnv(make_config(impl="kinematic", sensors=("state",)), HouseTasks(num_tasks=6)).bind(bank)
    rows = len(env.params.tasks)

    def maps(key, row):
        state = env.core.reset(env.params, key, None, row, observe=False)
        snapshot = env.core.snapshot(env.params, state)
        return top_down_map(snapshot, state.task, update_map_memory(snapshot)), state.task.targets

    keys = jax.random.split(jax.random.key(0), rows)
    found, means = jax.tree.map(np.asarray, jax.jit(jax.vmap(maps))(keys, jnp.arange(rows)))
    room, geometry = np.asarray(bank.navigation.room[0]), jax.tree.map(np.asarray, bank.geometry)
    x, y = middles(env)
    half = bank.spec.cell / 2
    task = np.asarray(env.params.tasks.rows.columns["task"])
    assert set(task.tolist()) == {0, 1}
    for row in range(rows):
        expected = np.zeros(x.shape, bool)
        if task[row] == 0:
            numbers = np.flatnonzero(means.room[row, 0])
            expected = np.isin(room[found.level[row]], numbers)
        for instance in np.flatnonzero(means.instance[row, 0]):
            box, pose = geometry.model_box[geometry.instance_model[0, instance]], geometry.instance_pose[0, instance]
            corners = np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1).reshape(-1, 3) @ pose[:, :3].T + pose[:, 3]
            low, high = corners.min(axis=0), corners.max(axis=0)
            over = (x + half > low[0]) & (x - half < high[0]) & (y + half > low[1]) & (y - half < high[1])
            expected |= over
        assert found.goal[row].any()
        differ = found.goal[row] != expected
        assert differ.sum() <= 0.05 * expected.sum() + 2  # cells that a bound just touches
    assert {type(task).__name__ for task in env.task.tasks} == {ObjectNav.__name__, RoomNav.__name__}
