"""The real house, against what HoME measured in it and against its own meshes."""
import numpy as np
import pytest

from home_mjx.scene_compile.compile import compile_house
from home_mjx.scene_compile.suncg import open_dataset

pytestmark = pytest.mark.real


@pytest.fixture(scope="module")
def dataset(suncg_root):
    return open_dataset(suncg_root)


@pytest.fixture(scope="module")
def house(dataset):
    return dataset.load_house(dataset.house_ids[0])


@pytest.fixture(scope="module")
def compiled(house, dataset):
    return compile_house(house, dataset.metadata)


def test_counts(compiled):
    report = compiled.report
    counts = [report[n] for n in ("levels", "rooms", "objects", "architecture_parts", "triangles")]
    assert counts == [1, 4, 43, 12, 102_076]
