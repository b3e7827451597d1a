"""A short walk of many agents in homes with stairs of every kind; `stairs.py` is the long one."""

import numpy as np
import pytest
import stairs
from storey_homes import HOMES, homes_bank


@pytest.mark.parametrize("impl", ["kinematic", "fused"])
def test_nobody_leaves_floors_and_stairs(impl):
    names = tuple(name for name in HOMES if name != "one storey")
    record, faults = stairs.soak(homes_bank(names), impl, 72, 200, np.random.default_rng(0))
    assert faults == []
    assert record["climbed"] >= 5
