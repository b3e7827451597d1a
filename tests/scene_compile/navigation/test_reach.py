"""Storeys that stairs do not connect to the ground floor are reported."""

from dataclasses import replace

import numpy as np
import pytest
from storeys import Stairs, Storey, metadata_of, stacked

from home_mjx.cli import main
from home_mjx.datasets import outline_house, stack_levels, write_house, write_library
from home_mjx.datasets.outlines import RoomOutline
from home_mjx.scene_compile.pipeline.compile import compile_house, find_storeys_without_access

HALL = [RoomOutline("Living_Room", [(0, 0), (9, 0), (9, 8), (0, 8)])]
CASES = {  # stairs, and the unreachable storeys with the stairs that begin or end there
    "above one another": ([Stairs((2.0, 3)), Stairs((2.0, 3), level=1)], {}),
    "beside one another": ([Stairs((2.0, 2)), Stairs((2.0, 6), level=1)], {}),
    "offset": ([Stairs((2.0, 3)), Stairs((2.3, 3), level=1)], {2: ("1_1",)}),
    "opposed": ([Stairs((2.5, 3)), Stairs((7.2, 3), heading=np.pi, level=1)], {1: ("0_1", "1_1"), 2: ("1_1",)}),
    "no stairs": ([], {1: (), 2: ()}),
}


@pytest.mark.parametrize("case", CASES)
def test_storeys_that_agents_cannot_reach_are_named_with_their_stairs(case):
    stairs, expected = CASES[case]
    house = stacked([Storey(HALL)] * 3, stairs, house_id="reach")
    compiled = compile_house(house, metadata_of(house))
    found = find_storeys_without_access(house, metadata_of(house))
    assert {one.storey: names for one, names in found.items()} == expected
    assert all(50 < one.area < 72 and one.level == one.storey for one in found)
    assert compiled.report["unreachable_storeys"] == len(expected)
    starts = np.bincount(np.round(compiled.navigation.start[:, 2] / 2.8).astype(int), minlength=3)
    assert set(np.flatnonzero(starts > 0.02 * starts.sum()).tolist()) == {0, 1, 2} - set(expected)


def test_the_validator_on_the_command_line_reports_unreachable_storeys(tmp_path, capsys):
    house = outline_house("tower", HALL)
    levels = stack_levels([house.levels[0], outline_house("tower", HALL).levels[0]], rise=2.8)
    write_library(tmp_path, [], {})
    write_house(tmp_path, replace(house, levels=levels))
    assert main(["inspect", "tower", "--dataset", str(tmp_path), "--validate"]) == 0
    line, total = capsys.readouterr().out.splitlines()
    assert line.startswith("warning: ")
    assert line.split("house.json: ")[1].startswith(
        "levels[1]: no stairs connect it to the ground floor: agents cannot"
    )
    assert line.endswith("[unreachable-storey]")
    assert total == "tower: 0 errors, 1 warnings"
