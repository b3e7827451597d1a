"""Every example runs as a script; the list of them is complete."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NEEDS = {
    "cleanrl_ppo": "torch",
    "recurrent_ppo": "torch",
    "stable_baselines3_ppo": "stable_baselines3",
    "brax_ppo": "brax",
    "ppo_from_pixels": "flax",
    "curriculum": "flax",
    "own_text_encoder": "flax",
}


def test_the_list_names_every_example():
    listed = re.findall(r"^\| `(\w+\.py)` \|", (ROOT / "examples" / "README.md").read_text(), re.MULTILINE)
    assert sorted(listed) == [path.name for path in EXAMPLES]
    assert all(ast.get_docstring(ast.parse(path.read_text())) for path in EXAMPLES)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, tmp_path: Path):
    if path.stem in NEEDS:
        pytest.importorskip(NEEDS[path.stem], reason=f"needs {NEEDS[path.stem]}")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path), "XLA_FLAGS": ""}
    command = [sys.executable, "-W", "default", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
