"""Notebooks of the documentation: every one runs, and is stored with its outputs."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
NAMES = {"first_steps", "own_task", "sensors", "sound", "training_curve"}


def runner() -> ModuleType:
    """Load `scripts/run_notebooks.py`."""
    spec = importlib.util.spec_from_file_location("run_notebooks", ROOT / "scripts" / "run_notebooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def code_cells(notebook: dict) -> list[dict]:
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def kinds(cell: dict) -> list[list[str]]:
    return [sorted(output.get("data", [output.get("name")])) for output in cell["outputs"]]


def test_each_notebook_is_small_and_has_its_outputs_and_a_link():
    assert {path.stem for path in NOTEBOOKS} == NAMES
    page = (ROOT / "docs" / "notebooks" / "index.md").read_text()
    for path in NOTEBOOKS:
        text = path.read_text()
        assert len(text.encode()) <= runner().MAX_BYTES
        assert f"({path.name})" in page
        cells = code_cells(json.loads(text))
        assert [cell["execution_count"] is not None for cell in cells] == [True] * len(cells)
        assert sum(len(cell["outputs"]) for cell in cells) >= 2


def test_a_cell_shows_its_last_value_and_what_it_prints():
    names: dict = {}
    done = runner().run_cell({"cell_type": "code", "source": ["x = 2\n", "print(x)\n", "x + 1"]}, names)
    assert done["outputs"][0]["text"] == ["2\n"]
    assert done["outputs"][1]["data"] == {"text/plain": ["3"]}
    with pytest.raises(ZeroDivisionError):
        runner().run_cell({"cell_type": "code", "source": ["1 / 0"]}, names)


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_what_is_stored(path: Path):
    stored = json.loads(path.read_text())
    done = runner().run_notebook(stored)
    assert [kinds(cell) for cell in code_cells(done)] == [kinds(cell) for cell in code_cells(stored)]
