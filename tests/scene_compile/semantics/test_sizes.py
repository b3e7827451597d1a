"""Sizes within a category."""

import math

import numpy as np
import pytest

from home_mjx.datasets.suncg.read.metadata import read_metadata
from home_mjx.scene_compile.semantics.sizes import MIN_PEERS, size_table
from home_mjx.schema.house import Metadata, ModelInfo
from home_mjx.schema.semantic import SIZES


def metadata(edges: list[float], fine: str = "chair", coarse: str = "chair") -> Metadata:
    return Metadata({str(i): ModelInfo(str(i), fine, coarse, dims=(e, e, e)) for i, e in enumerate(edges)})


def test_sizes_are_by_standard_deviations_of_the_log_volume():
    edges = np.exp([-1.0, -1.0, 0.0, 0.0, 1.0, 1.0])
    table, info = size_table(metadata(edges.tolist())), ModelInfo("x", "chair", "chair")
    spread = 3 * np.std([-1.0, -1.0, 0.0, 0.0, 1.0, 1.0])
    for deviation, size in (
        (-2.1, "tiny"),
        (-1.1, "small"),
        (-0.9, "normal"),
        (0.9, "normal"),
        (1.1, "large"),
        (2.1, "huge"),
    ):
        assert table.log_volume_size(math.exp(deviation * spread), info) == size


def test_the_coarse_category_stands_in_for_a_fine_one_of_few_models():
    few = metadata([1.0] * (MIN_PEERS - 1), fine="stool").models
    many = {f"m{key}": value for key, value in metadata([0.1] * MIN_PEERS, fine="armchair").models.items()}
    table = size_table(Metadata({**few, **many}))
    assert table.log_volume_size(1e-3, ModelInfo("x", "armchair", "chair")) == "normal"
    assert table.log_volume_size(8.0, ModelInfo("x", "armchair", "chair")) == "huge"
    assert table.log_volume_size(0.03, ModelInfo("x", "stool", "chair")) == "normal"


def test_without_peers_nothing_is_said():
    table = size_table(metadata([1.0] * (MIN_PEERS - 1)))
    assert table.log_volume_size(1.0, ModelInfo("x", "chair", "chair")) == ""
    assert table.log_volume_size(1.0, ModelInfo("x")) == ""
    unknown = size_table(metadata([1.0] * 9, "unknown", "unknown"))
    assert unknown.log_volume_size(1.0, ModelInfo("x")) == ""


def test_like_models_are_not_told_apart_by_a_few_percent():
    table = size_table(metadata([1.0] * 9))
    assert table.log_volume_size(1.08, ModelInfo("x", "chair", "chair")) == "normal"


@pytest.mark.real
def test_every_model_of_the_full_tables_has_a_size(suncg_root):
    """And the five sizes are as frequent as deviations of a bell curve, within a factor of two."""
    folder = suncg_root.parent / "suncg_metadata_v1"
    if not folder.is_dir():
        pytest.skip("the full SUNCG v1 metadata is not beside the sample")
    full = read_metadata(folder)
    table = size_table(full)
    sized = [info for info in full.models.values() if info.dims is not None]
    found = [table.log_volume_size(math.prod(info.dims), info) for info in sized if math.prod(info.dims) > 0]
    known = [size for size in found if size]
    assert len(sized) == 2_592
    assert len(known) > 0.97 * len(sized)
    frequent = np.array([known.count(size) for size in SIZES]) / len(known)
    np.testing.assert_array_less(frequent, 2 * np.array([0.0228, 0.1359, 0.6827, 0.1359, 0.0228]))
    np.testing.assert_array_less(0.5 * np.array([0.0228, 0.1359, 0.6827, 0.1359, 0.0228]), frequent)
