"""Scripts beside the package use nothing of it that has moved away; most of them are run by hand and seldom."""

import ast
import importlib
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parent.parent
SCRIPTS = [path for folder in ("benchmarks", "scripts", "examples") for path in sorted((ROOT / folder).glob("*.py"))]
FRAMEWORKS = {
    "cleanrl_ppo": "torch",
    "recurrent_ppo": "torch",
    "stable_baselines3_ppo": "stable_baselines3",
}  # what adapters that a script imports need in their turn


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_script_uses_what_is_there(path: Path):
    if path.stem in FRAMEWORKS:
        pytest.importorskip(FRAMEWORKS[path.stem])
    tree = ast.parse(path.read_text())
    known = dict(_imported(tree))
    used = (node for node in ast.walk(tree) if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name))
    for node in used:
        module = known.get(node.value.id)
        if isinstance(module, ModuleType) and node.value.id not in _assigned(tree):
            assert hasattr(module, node.attr), f"line {node.lineno}: {module.__name__} has no {node.attr}"


def _imported(tree: ast.Module) -> Iterator[tuple[str, object]]:
    """What a script imports from the package, by the name that it has there."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "home_mjx":
            module = importlib.import_module(node.module)
            for name in node.names:
                yield name.asname or name.name, _member(module, name.name)


def _member(module: ModuleType, name: str) -> object:
    """A module's attribute or submodule; fails where there is neither."""
    return getattr(module, name) if hasattr(module, name) else importlib.import_module(f"{module.__name__}.{name}")


def _assigned(tree: ast.Module) -> set[str]:
    """Names that stand for something else as well."""
    arguments = {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
    return arguments | {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


PIP = """#!/usr/bin/env bash
case "$*" in
    *" -e "*)
        echo "Collecting jaxlib==0.10.2 (from -c requirements/constraints.txt (line 3))"
        echo "  Downloading jaxlib-0.10.2-cp311-cp311-manylinux_2_27_x86_64.whl (80.1 MB)"
        echo "  Downloading mirror/simple/scipy-1.17.0-cp311-cp311-manylinux_2_27_x86_64.whl (35.3 MB)"
        echo "Downloading six-1.17.0-py2.py3-none-any.whl (11 kB)"
        echo "Downloading tqdm-4.67.1-py3-none-any.whl (1.5 MB)"
        echo "Installing collected packages: six, tqdm, jaxlib"
        exit $PIP_STATUS
        ;;
esac
"""


@pytest.mark.parametrize("status", [0, 1])
def test_the_installation_says_what_it_does(tmp_path: Path, status: int):
    """A stand-in for the environment's Python prints lines of pip."""
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    python.write_text(PIP)
    python.chmod(0o755)
    done = subprocess.run(
        [ROOT / "scripts" / "setup_venv.sh", tmp_path, ".[train]"],
        env={**os.environ, "PIP_STATUS": str(status)},
        capture_output=True,
        text=True,
        timeout=60,
    )
    lines = done.stdout.splitlines()
    assert done.returncode == status
    assert lines[0].startswith(f"Installing .[train] with its dependencies into {tmp_path}, 69 packages: about 0.4 GB")
    assert lines[3:6] == [
        "  downloading jaxlib-0.10.2-cp311-cp311-manylinux_2_27_x86_64.whl (80.1 MB)",
        "  downloading scipy-1.17.0-cp311-cp311-manylinux_2_27_x86_64.whl (35.3 MB)",
        "  unpacking 3 packages",
    ]
    assert lines[6:] == ["Installed"] * (status == 0)
