"""Compiled houses are kept by the code of their readers: it includes the shared modules that a reader imports."""

import ast
from pathlib import Path

import pytest

import home_mjx.datasets
from home_mjx.datasets.front.dataset import FrontDataset
from home_mjx.datasets.gltf.dataset import GltfDataset
from home_mjx.datasets.gltf.scene_dataset import SceneDataset
from home_mjx.datasets.habitat.dataset import HabitatDataset
from home_mjx.datasets.mjcf.dataset import MjcfDataset
from home_mjx.datasets.usd.dataset import UsdDataset

FOLDER = Path(home_mjx.datasets.__file__).parent
SHARED = ("front", "gltf", "habitat", "mjcf", "outlines", "shapes", "storeys", "taxonomy", "usd")  # others are stable


@pytest.mark.parametrize("kind", [FrontDataset, GltfDataset, HabitatDataset, MjcfDataset, UsdDataset])
def test_the_code_of_a_reader_has_the_shared_modules_that_it_imports(kind: type[SceneDataset]):
    folders = FOLDER / kind.__module__.split(".")[2], FOLDER / "gltf"
    needed = {path for folder in folders for file in folder.rglob("*.py") for path in imported(file)}
    needed |= {FOLDER / "taxonomy.csv"} if FOLDER / "taxonomy.py" in needed else set()
    missing = {path for path in needed if not any(path.is_relative_to(code) for code in kind.code)}
    assert not missing


def imported(file: Path) -> set[Path]:
    """Files of the shared modules that a module imports."""
    nodes = [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ImportFrom)]
    names = [node.module.split(".")[2:] for node in nodes if (node.module or "").startswith("home_mjx.datasets.")]
    return {FOLDER.joinpath(*name).with_suffix(".py") for name in names if name[0] in SHARED}
