"""Storeys that stairs do not connect to the ground floor are reported."""

from dataclasses import replace

import numpy as np
import pytest
from storeys import Stairs, Storey, metadata_of, stacked

from home_mjx.cli import main
from home_mjx.datasets import (
    SuncgDataset,
    open_dataset,
    outline_house,
    stack_levels,
    validate_house,
    write_house,
    write_library,
)
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
    for points in (compiled.navigation.start, compiled.navigation.goal):  # half of the goals were at a head of stairs
        assert set(np.round(points[:, 2] / 2.8).astype(int).tolist()) == {0, 1, 2} - set(expected)


def written(root, *levels):
    write_library(root, [], {})
    write_house(root, replace(outline_house("tower", HALL), levels=stack_levels(levels, rise=2.8)))
    return open_dataset(root)


def test_the_validator_reports_unreachable_storeys(tmp_path):
    """The command line alone reported them."""
    found = validate_house(written(tmp_path, *(outline_house("tower", HALL).levels[0] for _ in range(2))), "tower")
    assert [(f.rule, f.element, f.severity) for f in found] == [("unreachable-storey", "levels[1]", "warning")]


def test_the_validator_reads_a_house_once(tmp_path, monkeypatch):
    dataset = written(tmp_path, *(outline_house("tower", HALL).levels[0] for _ in range(2)))
    monkeypatch.setattr(SuncgDataset, "load_house", lambda *args: pytest.fail("read again"))
    assert main(["inspect", "tower", "--dataset", str(dataset.root), "--validate"]) == 0


def test_closets_of_the_ground_floor_are_no_unreachable_storey(tmp_path):
    """Twelve rooms without doors, none of which has a tenth of the floor."""
    rooms = [RoomOutline("Storage", [(x, 0), (x + 2, 0), (x + 2, 2), (x, 2)]) for x in range(0, 36, 3)]
    dataset = written(tmp_path, outline_house("tower", rooms).levels[0])
    assert compile_house(dataset.load_house("tower"), dataset.metadata).report["unreachable_storeys"] == 0
    assert validate_house(dataset, "tower") == ()


def test_the_validator_on_the_command_line_reports_unreachable_storeys(tmp_path, capsys):
    written(tmp_path, *(outline_house("tower", HALL).levels[0] for _ in range(2)))
    assert main(["inspect", "tower", "--dataset", str(tmp_path), "--validate"]) == 0
    line, total = capsys.readouterr().out.splitlines()
    assert line.startswith("warning: ")
    assert line.split("house.json: ")[1].startswith(
        "levels[1]: no stairs connect it to the ground floor: agents cannot"
    )
    assert line.endswith("[unreachable-storey]")
    assert total == "tower: 0 errors, 1 warnings"
