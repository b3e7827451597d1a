"""Examples in docstrings and guides run."""

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import home_mjx

ROOT = Path(__file__).resolve().parent.parent
MODULES = sorted(module.name for module in pkgutil.walk_packages(home_mjx.__path__, "home_mjx."))


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name: str):
    if "brax" in name:
        pytest.importorskip("brax")
    failed, _ = doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


def test_docstring_examples_exist():
    finder = doctest.DocTestFinder()
    assert sum(len(found.examples) for found in finder.find(importlib.import_module("home_mjx.errors"))) >= 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "block"), [("README.md", 0), ("docs/quickstart.md", 0), ("docs/adapters.md", 0)], ids=lambda v: str(v)
)
def test_python_blocks_of_the_guides_run(page: str, block: int, monkeypatch: pytest.MonkeyPatch):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    smaller = blocks[block].replace("64", "4").replace("range(100)", "range(2)")
    exec(compile(smaller, page, "exec"), {})
