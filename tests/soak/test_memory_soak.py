"""Memory over many steps: flat, and a leak would be told. `tests/soak/memory.py` goes on for as long as is wanted."""

import json
import os
import subprocess
import sys
from pathlib import Path

import memory
import pytest

SOAK = Path(memory.__file__)


@pytest.mark.slow
def test_memory_stays_flat():
    done = subprocess.run(
        [sys.executable, str(SOAK), "--houses", "4", "--envs", "8", "--seconds", "20"],
        capture_output=True,
        text=True,
        timeout=900,
        env={**os.environ, "PYTHONPATH": str(SOAK.parents[2])},
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout)
    assert found["swaps"] > 2
    assert found["env_steps"] > 1000


def test_a_leak_is_told():
    """Of the process or of the GPU; what fills in the first quarter is none."""
    flat = [(1000 << 20, 0)] * 100
    assert memory.judged(flat)["failed"] == 0
    assert "device_mib" not in memory.judged(flat)
    assert memory.judged([(x << 20, 0) for x in [*range(25), *[1000] * 75]])["failed"] == 0
    assert memory.judged([((1000 << 20) + (i << 18), 0) for i in range(100)])["failed"] == 1
    assert memory.judged([(1000 << 20, (100 << 20) + (i << 15)) for i in range(100)])["failed"] == 1
    assert memory.judged([(1000 << 20, 100 << 20)] * 100)["device_growth"] == 0
    on_the_way = [(1000 << 20, (100 + 14 * (i % 20 < 4 + i // 8)) << 20) for i in range(100)]
    assert memory.judged(on_the_way)["device_growth"] == 0
