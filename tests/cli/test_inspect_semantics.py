"""`home-mjx inspect --semantics`."""

import json
from pathlib import Path

import pytest
from generated import generate_flats

from home_mjx.cli import main


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("houses")
    generate_flats(root, range(1))
    return root


def test_the_table_has_a_line_per_surface_and_object(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", "--dataset", str(houses), "--semantics", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert main(["inspect", "--dataset", str(houses), "--semantics"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(record["parts"]) + len(record["objects"]) + 1
    for line, item in zip(lines, (*record["parts"], *record["objects"]), strict=False):
        assert line.endswith(item["description"])
        assert item["room_type"] in line
    assert lines[-1] == f"0 objects outside of every room, {len(record['relations'])} relations"


def test_one_report_at_a_time(houses: Path, capsys: pytest.CaptureFixture):
    assert main(["inspect", "--dataset", str(houses), "--semantics", "--validate"]) == 2
    assert "not allowed with" in capsys.readouterr().err
