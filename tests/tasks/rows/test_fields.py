"""Distances to what descriptors mean, against those that houses are compiled with."""

import numpy as np
import pytest

from home_mjx.registry import as_bank
from home_mjx.schema.compiled import FIELD_FAR, FIELD_UNIT
from home_mjx.tasks.rows.fields import CellGraph


@pytest.fixture(scope="module")
def bank():
    return as_bank(None, 4)


def test_fields_to_the_banks_goals_are_the_banks(bank):
    """Also up stairs, close to walls and where things stand."""
    navigation = bank.navigation
    for house in range(bank.num_houses):
        graph = CellGraph(bank, house)
        ends = [graph.at(np.asarray(goal)) for goal in navigation.goal[house]]
        ends = [(cells, np.zeros(1)) for cells, _ in ends]
        found = graph.fields(ends)
        first = int(navigation.first_cell[house])
        expected = np.asarray(navigation.field[first : first + len(found)])
        assert ((found == FIELD_FAR) == (expected == FIELD_FAR)).all()
        apart = np.abs(found.astype(float) - expected) * FIELD_UNIT
        assert apart[found != FIELD_FAR].max() < 0.01


def test_a_box_is_reached_from_cells_beside_it(bank):
    graph = CellGraph(bank, 0)
    low = graph.place[0] - [0.5, 0.5, 0]
    cells, away = graph.beside(low, low + [1, 1, 1])
    assert away.min() == 0
    plan = graph.place[cells, :2]
    gap = np.maximum(np.maximum(low[:2] - plan, plan - low[:2] - 1), 0)
    np.testing.assert_allclose(np.hypot(*gap.T), away)
    assert not len(graph.beside(low + [0, 0, 50], low + [1, 1, 51])[0])
