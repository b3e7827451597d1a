"""The house of the story is one that the reader, the validator and the compiler take like any other."""

import numpy as np
import pytest

from examples.story.furniture import LOWER, UPPER
from examples.story.house import write_story_house
from examples.story.stairs import RISE
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.scene_compile.pipeline.compile import compile_house


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory):
    root = tmp_path_factory.mktemp("story")
    write_story_house(root)
    return open_dataset(root)


@pytest.fixture(scope="module")
def house(dataset):
    return compile_house(dataset.load_house("story"), dataset.metadata)


def test_the_validator_finds_nothing(dataset):
    assert validate_house(dataset, "story") == ()


def test_all_objects_are_there_and_none_is_stuck(house):
    assert house.report["objects"] == len(LOWER) + len(UPPER)
    assert house.blocked_objects.tolist() == []


def test_stairs_join_both_storeys(house):
    floors = house.navigation.floor
    np.testing.assert_allclose(floors, [0.05, 0.05 + RISE], atol=1e-6)
    (ramp,) = house.ramps.pos
    assert floors[0] < ramp[2] < floors[1]
    home = house.navigation.region == 0
    assert home.any(axis=(1, 2)).tolist() == [True, True]  # an agent gets upstairs


def test_one_door_opens_and_the_other_is_shut_for_good(house):
    assert len(house.doors.mass) == 1
    assert abs(house.doors.fully_open[0] - house.doors.closed[0]) == pytest.approx(np.pi / 2, abs=0.01)
    (door, *_) = house.navigation.portals.leaf.tolist()
    assert 0 in door


def test_nobody_steps_off_the_loft(house):
    """No cell of the upper grid is free where the hall is open, apart from the stairs."""
    navigation, ramps = house.navigation, house.ramps
    centres = np.argwhere(navigation.region[1] >= 0)[:, ::-1] * 0.1 + 0.05 + navigation.origin
    edge = ramps.pos[0, 0] + ramps.size[0, 0] * np.cos(ramps.slope[0])  # where the stairs end, the loft begins
    over_the_hall = centres[centres[:, 0] < edge - 0.3]
    assert (abs(over_the_hall[:, 1] - ramps.pos[0, 1]) < ramps.size[0, 1]).all()
