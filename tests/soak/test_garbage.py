"""Garbage in all arrays of rays and physics, in a process of its own; see `garbage.py`, which goes on for longer."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("garbage.py")


@pytest.mark.parametrize("part", ["rays", pytest.param("physics", marks=pytest.mark.slow)])
def test_garbage_in_every_field_kills_nothing(part, tmp_path):
    """With rays that trust their trees the first call ends by a signal, with physics that trusts hands the fourth."""
    command = [sys.executable, SCRIPT, "--parts", part, "--scenes", "960", "--seed", "7", "--stuck", "100"]
    environment = os.environ | {"JAX_PLATFORMS": "cpu"}
    done = subprocess.run(
        [*command, "--out", tmp_path], capture_output=True, text=True, timeout=300, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr[-3000:]
    record = json.loads(done.stdout)
    assert (record["scenes"], record["failed"]) == (960, 0)
    assert record["numbers"] > 10_000
    assert not list(tmp_path.iterdir())
