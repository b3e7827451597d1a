"""Distances to what descriptors mean, against those that houses are compiled with."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import homes_bank

from home_mjx.houses import load_bank
from home_mjx.navigation.grid import room_at_feet
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE
from home_mjx.tasks.rules.cell_graph import (
    BRUSH_COST_FACTOR,
    MAX_TURN_DISTANCE,
    MIN_LEAF_CLEARANCE,
    CellGraph,
)


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


def test_fields_to_the_banks_goals_are_the_banks(bank):
    """Also up stairs, close to walls and where things stand."""
    navigation = bank.navigation
    for house in range(bank.num_houses):
        graph = CellGraph(bank, house, brush_cost_factor=1.0)
        ends = [graph.nearest_cell(np.asarray(goal)) for goal in navigation.goal[house]]
        ends = [(cells, np.zeros(1)) for cells, _ in ends]
        found = graph.compute_fields(ends)
        first = int(navigation.first_cell[house])
        expected = np.asarray(navigation.field[first : first + len(found)])
        assert ((found == FIELD_UNREACHABLE) == (expected == FIELD_UNREACHABLE)).all()
        apart = np.abs(found.astype(float) - expected) * FIELD_UNIT
        assert apart[found != FIELD_UNREACHABLE].max() < 0.01


def test_the_cells_around_a_box_are_the_nearest_that_are_at_no_leaf(bank):
    graph = CellGraph(bank, 0)
    low = graph.place[np.flatnonzero(graph.at_leaf)[0]] - [0.5, 0.5, 0]
    cells, away = graph.nearest_cells(low, low + 1, 40)
    plan = graph.place[:, :2]
    gap = np.hypot(*np.maximum(np.maximum(low[:2] - plan, plan - low[:2] - 1), 0).T)
    np.testing.assert_allclose(gap[cells], away)
    assert len(set(cells.tolist())) == 40
    others = np.setdiff1d(np.flatnonzero(~graph.at_leaf), cells)
    assert not graph.at_leaf[cells].any()
    assert graph.at_leaf[gap <= away.max()].any()
    assert away.max() <= gap[others].min()
    assert not len(graph.nearest_cells(low + 50, low + 51, 40)[0])


def test_cells_at_leaves_are_those_near_points_of_open_leaves(bank):
    leaves = jax.tree.map(lambda x: x[0], DoorLeaves.from_physics(bank.physics))
    pos, quat = (np.asarray(x) for x in leaves.pose_at(bank.physics.door_fully_open[0]))
    graph = CellGraph(bank, 0)
    least = np.full(len(graph.place), np.inf)
    u, v = np.meshgrid(np.linspace(-1, 1, 81), np.linspace(-1, 1, 5))
    for middle, (w, _, _, z), half in zip(pos, quat, np.asarray(leaves.size), strict=True):
        if half[0] <= 0:
            continue
        yaw = 2 * np.arctan2(z, w)
        x, y = half[0] * u.ravel(), half[1] * v.ravel()
        points = middle[:2] + np.stack([np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y], axis=1)
        away = np.linalg.norm(graph.place[:, None, :2] - points, axis=-1).min(axis=1)
        rise = graph.place[:, 2] - middle[2]
        as_high = (rise < half[2]) & (rise + bank.spec.agent_height > -half[2])
        least = np.minimum(least, np.where(as_high, away, np.inf))
    reach = bank.spec.agent_radius + MIN_LEAF_CLEARANCE
    assert graph.at_leaf.any()
    assert graph.at_leaf[least < reach - 0.02].all()
    assert not (graph.at_leaf & ~graph.cut_off)[least > reach + 0.02].any()


def test_a_way_past_a_leaf_is_no_shorter(bank):
    graph, plain = CellGraph(bank, 0), CellGraph(bank, 0, brush_cost_factor=1.0)
    ends = [graph.nearest_cell(np.asarray(bank.navigation.goal[0, 0]))]
    far, near = graph.compute_distances(ends)[:, 0], plain.compute_distances(ends)[:, 0]
    assert (far >= near - 1e-9).all()
    assert (far[graph.at_leaf] > near[graph.at_leaf] + 0.1).any()
    assert (far <= BRUSH_COST_FACTOR * near + 1e-9)[~graph.cut_off].all()


def reached(begin: int, joined: dict[int, list[int]], free: np.ndarray) -> set[int]:
    """Cells that are joined to one by free ones, by a walk over them."""
    seen, left = {begin}, [begin]
    while left:
        for cell in joined[left.pop()]:
            if free[cell] and cell not in seen:
                seen.add(cell)
                left.append(cell)
    return seen


@pytest.mark.parametrize("share", [0.55, 0.8])
def test_what_leads_out_is_near_the_largest_part_of_what_is_wide(bank, share):
    """Against a walk and distances by brute force, with cells that are wide at random, of part of a house."""
    graph = CellGraph(bank, 1)
    wide = np.random.default_rng(0).random(len(graph.place)) < share
    joined = {cell: [] for cell in range(len(wide))}
    for a, b in zip(*graph._edges[:2], strict=True):
        joined[a].append(b)
        joined[b].append(a)
    left, parts = set(np.flatnonzero(wide).tolist()), []
    while left:
        parts.append(reached(next(iter(left)), joined, wide))
        left -= parts[-1]
    largest = np.array(sorted(max(parts, key=len)))
    cells = np.arange(0, len(wide), 7)
    away = np.linalg.norm(graph.place[cells, None] - graph.place[largest], axis=-1).min(axis=1)
    expected = away <= MAX_TURN_DISTANCE
    np.testing.assert_array_equal(graph.has_turning_room(cells, wide), expected)
    assert len(parts) > 1
    assert not graph.has_turning_room(cells, np.zeros(len(wide), bool)).any()
    assert graph.has_turning_room(cells, np.ones(len(wide), bool))[~graph.cut_off[cells]].all()


def test_feet_in_the_end_cells_of_a_room_are_in_it():
    """Cells of two levels meet at the head of stairs; agents that ended in those of the other one turned to and fro."""
    bank = homes_bank(("straight", "corner"))
    for house in range(bank.num_houses):
        graph = CellGraph(bank, house)
        for room in np.unique(graph.room[graph.room >= 0]):
            cells, _ = graph.cells_in_rooms(np.arange(bank.navigation.room_labels.shape[1]) == room)
            feet = jnp.asarray(graph.place[cells], jnp.float32)
            found = jax.jit(jax.vmap(lambda at, h=house: room_at_feet(bank, jnp.int32(h), at)))(feet)
            np.testing.assert_array_equal(found, room)
