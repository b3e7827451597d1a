"""Distances beside the home region: closed forms, the defining equation, and points on generated houses' grids."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from home_mjx.geometry.extrapolation import extrapolate_fields, nearest_cell_numbers

CELL = 0.1


def continued(home, *around, room=None, standable=None):
    """Of a flat level whose home cells' distances to a first goal are their columns, and to a second one 7."""
    home, *around = (np.array(grid, bool)[None] for grid in (home, *around))
    room = np.zeros(home.shape, int) if room is None else np.array(room)[None]
    standable = home if standable is None else np.array(standable, bool)[None]
    columns = np.argwhere(home)[:, 2].astype(float)
    field = np.stack([columns, np.full_like(columns, 7)], axis=1)
    found = extrapolate_fields(home, around, standable, room, np.zeros(home.shape), field, CELL)
    return tuple(np.concatenate(part) for part in zip(*found, strict=True))


def test_a_corridor_between_two_ends_rises_evenly():
    place, field = continued([[1, 0, 0, 0, 0, 0, 1]], [[1] * 7])
    assert_array_equal(place, [[0, 0, k] for k in range(1, 6)])
    to_an_end = CELL * np.array([1, 2, 3, 2, 1])
    assert_allclose(field[:, 0], np.arange(1, 6) + to_an_end)
    assert_allclose(field[:, 1], 7 + to_an_end)


def test_a_dead_end_is_the_way_out():
    _, field = continued([[1, 0, 0, 0]], [[1] * 4])
    assert_allclose(field[:, 0], CELL * np.array([1, 2, 3]))


def test_what_is_free_already_does_not_depend_on_what_may_be():
    home, now, later = [[1, 0, 0, 0, 0, 0, 1]], [[1, 1, 0, 0, 0, 1, 1]], [[1] * 7]
    place, field = continued(home, now, later)
    assert_array_equal(place[:, 2], [1, 5, 2, 3, 4])
    assert_allclose(field[:, 0], CELL * np.array([1, 1, 2, 3, 2]) + [0, 6, 1.5, 3, 4.5])


def test_what_cannot_be_entered_or_come_to_has_no_distance():
    place, _ = continued([[1, 0, 0, 0, 0]], [[1, 1, 0, 1, 1]])
    assert_array_equal(place, [[0, 0, 1]])
    assert len(continued([[1, 0, 1]], [[1, 0, 1]])[0]) == 0


def test_no_way_leads_through_a_wall_thinner_than_a_cell_but_through_where_agents_stand():
    room = [[0, 0, 1, 1]]
    _, field = continued([[1, 0, 0, 1]], [[1] * 4], room=room)
    assert_allclose(field[:, 0], [0 + CELL, 3 + CELL])
    joined = continued([[1, 0, 0, 1]], [[1] * 4], room=room, standable=[[1] * 4])[1]
    assert_allclose(joined[:, 0], [1 + CELL, 2 + CELL])


def test_each_distance_is_the_mean_of_its_neighbours(rng):
    """The harmonic function's definition, summed by hand, with the way to the border taken off."""
    shape = 9, 11
    enterable = rng.random(shape) < 0.8
    home = enterable & (rng.random(shape) < 0.15)
    place, field = continued(home, enterable)
    value = np.full(shape, np.nan)
    value[home] = np.argwhere(home)[:, 1]
    rows, columns = place[:, 1:].T
    way = field[:, 1] - 7  # all distances to the second goal are 7 at the border
    value[rows, columns] = field[:, 0] - way
    assert len(place) > 30
    for y, x in place[:, 1:].tolist():
        total = weight = 0.0
        for dy, dx in [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]:
            if not (0 <= y + dy < shape[0] and 0 <= x + dx < shape[1]):
                continue
            if enterable[y + dy, x + dx] and enterable[y, x + dx] and enterable[y + dy, x]:
                total, weight = total + value[y + dy, x + dx] / np.hypot(dy, dx), weight + 1 / np.hypot(dy, dx)
        assert value[y, x] == pytest.approx(total / weight, abs=1e-9)


def test_the_nearest_cell_is_one_of_the_same_room():
    number = np.array([[[0, -1, -1, -1, -1, 1, -1]]])
    room = np.array([[[0, 0, 0, 0, -1, 1, -1]]])
    assert nearest_cell_numbers(number, room).tolist() == [[[0, 0, 0, 0, 1, 1, 1]]]
    assert nearest_cell_numbers(number, np.zeros_like(room)).tolist() == [[[0, 0, 0, 1, 1, 1, 1]]]


def test_a_level_without_cells_takes_those_of_the_next():
    number = np.full((3, 1, 4), -1)
    number[0, 0] = [5, -1, -1, 6]
    assert nearest_cell_numbers(number, np.full((3, 1, 4), -1)).tolist() == [[[5, 5, 6, 6]]] * 3
