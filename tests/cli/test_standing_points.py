"""`--at` selects a storey by its third number, else the lowest one."""

import numpy as np
import pytest
from storey_homes import homes_bank

from home_mjx.cli import main
from home_mjx.cli.viewpoint import _standing_point, longest_free_direction
from home_mjx.errors import ConfigError

UP = 2.8  # [m], from floor to floor


@pytest.fixture(scope="module")
def bank():
    return homes_bank(("straight",))


@pytest.fixture(scope="module")
def at(bank):
    """X and Y of a start on the upper storey."""
    starts = np.asarray(bank.navigation.start[0])
    return starts[np.argmax(starts[:, 2]), :2].tolist()


def test_the_lowest_storey_is_the_default(bank, at):
    low, high = np.asarray(bank.navigation.floor[0])[:2].tolist()
    assert high - low == pytest.approx(UP, abs=0.01)
    for z, floor in (([], low), ([low], low), ([high - 0.1], low), ([high], high), ([high + 1.5], high)):
        np.testing.assert_allclose(_standing_point(bank, [*at, *z]), [*at, floor], atol=0.01)


def test_heights_below_all_floors_are_refused(bank, at):
    with pytest.raises(ConfigError, match=r"Z -3 is below all floors") as caught:
        _standing_point(bank, [*at, -3.0])
    assert all(f"{z:.2f}" in str(caught.value) for z in np.asarray(bank.navigation.floor[0])[:2])


def test_the_free_direction_is_that_of_the_storey(bank, at):
    feet = _standing_point(bank, [*at, 10.0])
    level = int(np.argmin(abs(np.asarray(bank.navigation.floor[0]) - feet[2])))
    yaw = longest_free_direction(bank, feet)
    ahead = feet[:2] + 0.15 * np.array([np.cos(yaw), np.sin(yaw)])
    x, y = np.floor((ahead - np.asarray(bank.navigation.origin[0])) / bank.spec.cell).astype(int)
    assert np.asarray(bank.navigation.region[0, level])[y, x] == 0


@pytest.mark.parametrize("numbers", [["1"], ["1", "2", "3", "4"]])
def test_other_counts_of_numbers_are_refused(capsys, numbers):
    assert main(["render", "procedural:1?seed=1", "--at", *numbers]) == 2
    assert f"--at takes two or three numbers, got {len(numbers)}" in capsys.readouterr().err
