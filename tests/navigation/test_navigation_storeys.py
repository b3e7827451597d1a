"""Cells, rooms and distances in homes of 1, 2 and 3 storeys, by the height of the feet."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import HOMES, homes_bank

from home_mjx.geometry.geodesic import grid_edges
from home_mjx.navigation import cell_at_feet, cell_below, geodesic_distance, room_at_feet, room_below
from home_mjx.navigation.grid import cell_position, is_passable_cell, stored_distance

STEP, TOLERANCE = 0.25, 0.05  # [m], of a walk, and between the change of the distance and what was walked
NUM_PAIRS = 150  # of a start and a goal, in each home
EYES = 1.5  # [m] above the feet
NAMES = tuple(HOMES)


@pytest.fixture(scope="module")
def bank():
    return homes_bank()


def grid_graph(bank, house: int):
    """First row of a home, and the rows of each cell's neighbours, those of its copy on another grid included."""
    navigation = jax.tree.map(np.asarray, bank.navigation)
    first, count = int(navigation.first_cell[house]), int(navigation.num_cells[house])
    coords, height = navigation.cell_coords[first : first + count].astype(int), navigation.height[first : first + count]
    free, tall, number = (np.zeros(navigation.cell.shape[1:], kind) for kind in (bool, float, int))
    free[tuple(coords.T)], tall[tuple(coords.T)], number[tuple(coords.T)] = True, height, np.arange(count)
    rows = number[free]
    passable = np.asarray(is_passable_cell(bank, jnp.int32(house), bank.navigation.cell[house]))
    tall[~free & passable] = navigation.height[navigation.cell[house][~free & passable]]
    sources, targets, _ = grid_edges(free, tall, bank.spec.cell, passable)
    around: list[list[int]] = [[] for _ in range(count)]
    for a, b in zip(rows[sources].tolist(), rows[targets].tolist(), strict=True):
        around[a].append(b)
        around[b].append(a)
    shared = np.argwhere(free[1:] & free[:-1] & (abs(tall[1:] - tall[:-1]) < 1e-3))
    for level, y, x in shared.tolist():
        pair = int(number[level, y, x]), int(number[level + 1, y, x])
        around[pair[0]] = around[pair[1]] = around[pair[0]] + around[pair[1]]
    return first, around


def walk_down(far: np.ndarray, position: np.ndarray, around, row: int) -> list[int]:
    """Rows of the shortest path from a cell to the goal."""
    path = [row]
    while far[path[-1]] > 0:
        beside = np.array(around[path[-1]])
        way = far[beside] + np.linalg.norm(position[beside] - position[path[-1]], axis=1)
        path.append(int(beside[np.argmin(way + 1e-3 * far[beside])]))  # of equal ones the nearest to the goal
    return path


def resample(points: np.ndarray, step: float) -> np.ndarray:
    """Points every `step` [m] along a line of points."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.arange(0, length[-1], step)
    return np.stack([np.interp(at, length, points[:, k]) for k in range(3)], axis=1)


@pytest.mark.parametrize("name", NAMES)
def test_distance_falls_by_what_is_walked_along_shortest_paths(bank, name, rng):
    house = NAMES.index(name)
    first, around = grid_graph(bank, house)
    position = np.asarray(
        jax.jit(jax.vmap(lambda c: cell_position(bank, jnp.int32(house), c)))(first + jnp.arange(len(around)))
    )
    fields = np.asarray(stored_distance(bank.navigation.field, first + jnp.arange(len(around)), None))
    far = jax.jit(jax.vmap(lambda p, g: geodesic_distance(bank, jnp.int32(house), g, p)))
    worst, levels = 0.0, set()
    for _ in range(NUM_PAIRS):
        goal, row = int(rng.integers(fields.shape[1])), int(rng.integers(len(around)))
        path = position[walk_down(fields[:, goal], position, around, row)]
        levels.add((round(float(path[0, 2])), round(float(path[-1, 2]))))
        feet = resample(path, STEP)
        padded = np.concatenate([feet, np.repeat(feet[-1:], 256 - len(feet), axis=0)])
        distance = np.asarray(far(jnp.asarray(padded, jnp.float32), jnp.full(256, goal, jnp.int32)))[: len(feet)]
        worst = max(worst, float(np.abs(np.diff(distance) + STEP).max(initial=0)))
    assert len(levels) >= 3 * (len(HOMES[name][0]) > 1)
    assert worst < TOLERANCE


@pytest.mark.parametrize("name", NAMES)
def test_a_cell_is_found_again_from_its_feet_and_from_above_it(bank, name):
    """Where two grids share a cell either will do."""
    house = jnp.int32(NAMES.index(name))
    navigation = bank.navigation
    rows = navigation.first_cell[house] + jnp.arange(int(navigation.num_cells[house]))
    feet = jax.jit(jax.vmap(lambda c: cell_position(bank, house, c)))(rows)
    coords = np.asarray(navigation.cell_coords[rows]).astype(int)
    at, below = (
        np.asarray(jax.jit(jax.vmap(lambda p, find=find: find(bank, house, p)))(feet + jnp.array([0, 0, rise])))
        for find, rise in ((cell_at_feet, 0.0), (cell_below, EYES))
    )
    for found in (at, below):
        np.testing.assert_array_equal(found[:, 1:], coords[:, 1:])
        height = np.asarray(navigation.height[navigation.cell[house, found[:, 0], found[:, 1], found[:, 2]]])
        np.testing.assert_allclose(height, feet[:, 2], atol=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_rooms_are_those_of_the_storey(bank, name, rng):
    """At any height between the floor and the ceiling."""
    number = NAMES.index(name)
    house, starts = jnp.int32(number), np.asarray(bank.navigation.start[number])
    levels = np.asarray(bank.navigation.floor[number])
    room = np.asarray(jax.jit(jax.vmap(lambda p: room_at_feet(bank, house, p)))(jnp.asarray(starts)))
    assert (room >= 0).all()
    storey = np.argmin(abs(starts[:, 2:] - levels), axis=1)
    assert len({(r, s) for r, s in zip(room.tolist(), storey.tolist(), strict=True)}) == len(set(room.tolist()))
    above = starts + np.c_[np.zeros((len(starts), 2)), rng.uniform(0.0, 2.6, len(starts))]
    again = np.asarray(jax.jit(jax.vmap(lambda p: room_below(bank, house, p)))(jnp.asarray(above, jnp.float32)))
    np.testing.assert_array_equal(again, room)
