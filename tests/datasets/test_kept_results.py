"""Results of models on disk: read instead of computed, and computed again if the file is damaged."""

import logging

import numpy as np
import pytest

import home_mjx.datasets.kept_results as kept
from home_mjx.datasets.kept_results import ResultStore, keep_results, kept_result
from home_mjx.geometry.boxes import BoxSet, make_boxes
from home_mjx.geometry.cells import unique_cells


def fitted(calls: list[int]) -> BoxSet:
    def compute() -> BoxSet:
        calls.append(1)
        return make_boxes([0.0, 0.0, 0.5], 0.5)

    return kept_result(BoxSet, b"a chair", compute)


def test_a_result_is_computed_once_and_without_a_store_each_time(tmp_path):
    calls: list[int] = []
    fitted(calls)
    fitted(calls)
    assert len(calls) == 2
    with keep_results(ResultStore(tmp_path, lambda key: None)):
        first, second = fitted(calls), fitted(calls)
    assert len(calls) == 3
    for name in ("center", "half", "yaw"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


@pytest.mark.parametrize("damage", [b"", b"PK", None])
def test_a_damaged_result_is_computed_and_written_again(tmp_path, damage, caplog):
    calls: list[int] = []
    with keep_results(ResultStore(tmp_path, lambda key: None)):
        fitted(calls)
        (path,) = tmp_path.rglob("*.zip")
        intact = path.read_bytes()
        path.write_bytes(intact[:-100] + bytes(100) if damage is None else damage)
        with caplog.at_level(logging.WARNING):
            assert len(fitted(calls)) == 1
        assert path.read_bytes() == intact
    assert len(calls) == 2
    assert str(path) in caplog.text


def test_a_store_without_space_only_costs_time(tmp_path, monkeypatch):
    def refuse(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kept, "write_entry", refuse)
    with keep_results(ResultStore(tmp_path, lambda key: None)):
        assert len(fitted([])) == 1
    assert not list(tmp_path.rglob("*"))


@pytest.mark.parametrize("scale", [5, 1 << 40])
def test_cells_are_those_of_numpy(rng, scale):
    cells = rng.integers(-scale, scale, (300, 3))[rng.integers(0, 300, 900)]
    _, first, inverse = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    found = unique_cells(cells)
    np.testing.assert_array_equal(found[0], first)
    np.testing.assert_array_equal(found[1], inverse.reshape(-1))
