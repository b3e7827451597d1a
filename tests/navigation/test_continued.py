"""Distances wherever an agent can stand: on the floor, close to walls, and where things were that could be moved."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.boxes import BoxSet, footprint_distance
from home_mjx.houses import load_bank
from home_mjx.houses.house_set import HouseSet
from home_mjx.navigation import geodesic_distance, is_near_home_region
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.tasks.env.env import Env

NUM_HOUSES, NUM_STEPS, NUM_ENVS = 4, 500, 32
MOVED = 0.05  # [m], between the points of a pair


@pytest.fixture(scope="module")
def houses(tmp_path_factory) -> list[CompiledHouse]:
    from generated import generate_flats

    root = tmp_path_factory.mktemp("generated")
    return list(HouseSet.coerce(root, ids=generate_flats(root, range(NUM_HOUSES))).load(False))


@pytest.fixture(scope="module")
def bank(houses) -> HouseBank:
    return HouseBank.from_compiled(houses)


@pytest.fixture(scope="module")
def distances():
    return jax.jit(lambda bank, house, points: jax.vmap(lambda p: geodesic_distance(bank, house, None, p))(points))


def static_clearance(house: CompiledHouse, points: np.ndarray) -> np.ndarray:
    """Distance in the plan from points to the nearest box that never moves and that agents meet [m]."""
    n, c = house.navigation, house.colliders
    yaw = 2 * np.arctan2(c.quat[:, 3], c.quat[:, 0])
    boxes = BoxSet(c.pos, c.size, yaw)
    met = (boxes.top > n.floor[0] + 0.03) & (boxes.bottom < n.floor[0] + n.agent_height)
    return footprint_distance(boxes[met], points[None, :, :2]).min(axis=0)


def in_grid(house: CompiledHouse, grid: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The entry of a grid of the ground floor at each point."""
    n = house.navigation
    column, row = np.floor((points[:, :2] - n.origin) / n.cell).astype(int).T
    return grid[0][np.clip(row, 0, grid.shape[1] - 1), np.clip(column, 0, grid.shape[2] - 1)]


def pairs(house: CompiledHouse, rng: np.random.Generator, count: int = 20_000) -> tuple[np.ndarray, np.ndarray]:
    """Points of rooms where an agent's axis may be once all that can be moved is away, two by two."""
    n = house.navigation
    size = np.array(n.region.shape[:0:-1]) * n.cell
    start = np.c_[rng.uniform(0, size, (count, 2)) + n.origin, np.full(count, n.floor[0])]
    angle = rng.uniform(0, 2 * np.pi, count)
    end = start + MOVED * np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    kept = (in_grid(house, n.room, start) >= 0) & (in_grid(house, n.room, end) >= 0)
    kept &= (static_clearance(house, start) > n.agent_radius) & (static_clearance(house, end) > n.agent_radius)
    return start[kept], end[kept]


def test_distances_have_no_steps_wherever_an_agent_can_stand(bank, houses, distances, rng):
    """Within two cells of what was walked on the floor and along walls; on places of things nearly always."""
    for h, house in enumerate(houses):
        cell, free = house.navigation.cell, house.navigation.home_mask
        start, end = pairs(house, rng)
        a, b = (np.asarray(distances(bank, jnp.int32(h), p.astype(np.float32))) for p in (start, end))
        assert np.isfinite(a).all()
        assert np.isfinite(b).all()
        jump = (abs(a - b) - MOVED).max(axis=1)
        walked = in_grid(house, free, start) & in_grid(house, free, end)
        assert 0.4 < walked.mean() < 0.9
        assert jump[walked].max() < 2 * cell
        stand = house.bodies
        things = BoxSet(stand.pos, stand.size, 2 * np.arctan2(stand.quat[:, 3], stand.quat[:, 0]))
        away = footprint_distance(things, start[None, :, :2]).min(axis=0)
        along_walls = ~walked & (away > 0.5)
        assert along_walls.sum() > 100
        assert jump[along_walls].max() < 2 * cell
        assert np.quantile(jump, 0.95) < 2 * cell


def test_a_diagonal_gap_of_the_home_region_is_no_cliff(bank, houses, distances):
    """From centre to centre of two cells that touch at a corner, where both others lack only the margin."""
    gaps = 0
    for h, house in enumerate(houses):
        n = house.navigation
        corners = np.zeros_like(n.home_mask)
        corners[tuple(n.extrapolated.coords[: n.extrapolated.num_free].T)] = True
        home, corners = n.home_mask[0], corners[0]
        starts, ends = [], []
        for y, x in np.argwhere(np.pad(home[:-1, 1:-1], ((0, 1), (1, 1)))):
            for dx in (-1, 1):
                if home[y + 1, x + dx] and corners[y + 1, x] and corners[y, x + dx]:
                    starts.append((x, y))
                    ends.append((x + dx, y + 1))
        gaps += len(starts)
        if starts:
            begin, end = ((np.array(cells) + 0.5) * n.cell + n.origin for cells in (starts, ends))
            plan = np.linspace(begin, end, 15)
            points = np.concatenate([plan, np.full((*plan.shape[:2], 1), n.floor[0])], axis=2).astype(np.float32)
            found = np.stack([np.asarray(distances(bank, jnp.int32(h), p)) for p in points])
            assert abs(np.diff(found, axis=0)).max() < np.hypot(n.cell, n.cell) / 14 + MOVED
    assert gaps > 0


def test_a_thing_in_the_way_is_no_cliff():
    """A long table cuts a room in two but for a gap: where it stood the way around comes and goes step by step."""
    table = Furniture((-0.5, 0.0), size=(4.6, 0.4, 0.8), mass=30.0, category="table")
    house = shoebox(furniture=[table])
    bank = HouseBank.from_compiled([house])
    y = np.linspace(-0.6, 0.6, 121)
    points = np.stack([np.full_like(y, -2.0), y, np.zeros_like(y)], axis=1).astype(np.float32)
    found = np.asarray(jax.jit(jax.vmap(lambda p: geodesic_distance(bank, jnp.int32(0), None, p)))(points))
    far = np.ptp(found, axis=0).argmax()
    assert np.ptp(found[:, far]) > 2.5  # around the table
    assert abs(np.diff(found[:, far])).max() < 0.25 * np.ptp(found[:, far])


def test_where_no_cell_is_the_way_to_the_nearest_one_counts(bank, houses, distances):
    """Outdoors, in other rooms that nobody comes to, and beyond the grid."""
    rooms = HouseBank.from_compiled([two_rooms()])
    n = two_rooms().navigation
    home = np.argwhere(n.home_mask)[:, :0:-1] * n.cell + n.origin + n.cell / 2
    for point in ([-9.0, 0.3, 0.0], [0.05, 12.0, 0.0], [3.9, 0.1, 0.0]):
        found = np.asarray(distances(rooms, jnp.int32(0), jnp.array([point])))[0, : len(n.goal)]
        way = np.linalg.norm(home - point[:2], axis=1)
        assert np.isfinite(found).all()
        # No less than straight to the region, and no more than to its nearest cell and on from there, by two cells.
        on = np.stack([n.distance(g)[n.home_mask] for g in range(len(n.goal))], axis=1)
        assert (found >= way.min() - 3 * n.cell).all()
        assert (found <= way.min() + on[way.argmin()] + 10 * n.cell).all()


def test_beside_the_home_region_is_not_in_it(bank, houses):
    house = houses[0]
    n = house.navigation
    cells = np.indices(n.home_mask.shape)[1:].reshape(2, -1)[::-1].T
    points = np.c_[(cells + 0.5) * n.cell + n.origin, np.full(len(cells), n.floor[0])].astype(np.float32)
    near = jax.jit(jax.vmap(lambda p: is_near_home_region(bank, jnp.int32(0), p)))
    found = np.asarray(near(points)).reshape(n.home_mask.shape)
    padded = np.pad(n.home_mask[0], 1)
    around = [
        padded[1 + a : 1 + a + padded.shape[0] - 2, 1 + b : 1 + b + padded.shape[1] - 2]
        for a in (-1, 0, 1)
        for b in (-1, 0, 1)
    ]
    np.testing.assert_array_equal(found[0], np.any(around, axis=0))


def walk(env: Env, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distances, rewards and places of agents that walk at random, each for a while in one direction."""
    count = env.bank.num_houses * (NUM_ENVS // NUM_HOUSES)
    houses = jnp.arange(count, dtype=jnp.int32) % env.bank.num_houses
    keys = jax.random.key_data(jax.random.split(jax.random.key(3), count))
    state = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0, 0)))(env.params, keys, houses)
    aims = jax.random.uniform(jax.random.key(4), (steps // 10, count, 4), jnp.float32, -1.0, 1.0)
    aims = jnp.clip(2 * aims, -1.0, 1.0)

    @jax.jit
    def run(params, state):
        def step(state, action):
            after = jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0))(params, state, action)
            return after, (after.task.distance[:, 0], after.reward, after.physics.qpos[:, :2])

        return jax.lax.scan(step, state, jnp.repeat(aims, 10, axis=0))[1]

    first = (
        np.asarray(state.task.distance)[None, :, 0],
        np.zeros((1, count)),
        np.asarray(state.physics.qpos)[None, :, :2],
    )
    return tuple(np.concatenate([a, b]) for a, b in zip(first, run(env.params, state), strict=True))


def check_walk(bank: HouseBank) -> None:
    """No distance is unknown, and rewards are nothing but what it changes by and the task's costs.

    It changes by no more than what was walked and two cells, but for squeezing through gaps that are too narrow for the
    home region: there the way around comes or goes within the gap's length.
    """
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", num_agents=1)
    distance, reward, place = walk(env, NUM_STEPS)
    assert np.isfinite(distance).all()
    step = np.diff(distance, axis=0)
    walked = np.linalg.norm(np.diff(place, axis=0), axis=-1)
    assert walked.sum(axis=0).min() > 3
    beyond = abs(step) - walked
    jumps = {(env, *np.round(2 * place[step, env])) for step, env in np.argwhere(beyond > 2 * bank.spec.cell)}
    assert len(jumps) / beyond.size < 0.001  # a gap counts once per agent, however often it goes to and fro
    assert beyond.max() < 1.0
    task = env.core.task
    bonus = reward[1:] > task.success_reward / 2
    cost = -step - (reward[1:] - task.success_reward * bonus)
    assert cost.min() > task.step_cost - 1e-5
    assert cost.max() < task.step_cost + task.contact_cost + 1e-5


def test_agents_that_walk_at_random_always_know_how_far_it_is(bank):
    check_walk(bank)


@pytest.mark.real
def test_agents_in_the_real_house_always_know_how_far_it_is(suncg_root):
    check_walk(load_bank(suncg_root))
