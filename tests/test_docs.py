"""Examples in docstrings and guides run; what the guides name is there."""

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import home_mjx

ROOT = Path(__file__).resolve().parent.parent
PARTS = {path.name for path in (ROOT / "home_mjx").iterdir() if path.is_dir()}
OPTIONAL = {
    "home_mjx.adapters.brax": "brax",
    "home_mjx.adapters.jaxmarl": "jaxmarl",
    "home_mjx.adapters.pettingzoo": "pettingzoo",
    "home_mjx.adapters.playground": "mujoco_playground",
    "home_mjx.adapters.pytorch": "torch",
    "home_mjx.adapters.stable_baselines3": "stable_baselines3",
}
MODULES = sorted(module.name for module in pkgutil.walk_packages(home_mjx.__path__, "home_mjx."))


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name: str):
    if name in OPTIONAL:
        pytest.importorskip(OPTIONAL[name])
    if name.startswith("home_mjx.training.") and not name.endswith(".shim"):
        pytest.importorskip("flax")
    if name.startswith("home_mjx.training.trajectories."):
        pytest.importorskip("pyarrow")
    failed, _ = doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


def test_docstring_examples_exist():
    finder = doctest.DocTestFinder()
    assert sum(len(found.examples) for found in finder.find(importlib.import_module("home_mjx.errors"))) >= 2


def test_the_code_map_names_files_that_exist():
    text = (ROOT / "docs" / "architecture.md").read_text().split("## Code map")[1].split("\n## ")[0]
    rows = re.findall(r"^\| .+ \| (`[^|]+`) \|$", text, re.MULTILINE)
    assert 20 <= len(rows) <= 30
    places = [place for row in rows for place in re.findall(r"`([^`]+)`", row)]
    roots = (ROOT / "home_mjx", ROOT)
    assert [place for place in places if not any((root / place).exists() for root in roots)] == []


def test_the_architecture_page_shows_every_part():
    """Those of its diagram and of the sentence below it are the parts that the tests of the structure know."""
    text = (ROOT / "docs" / "architecture.md").read_text().split("## Code map")[0]
    words = set(re.findall(r"\w+", text))
    parts = {path.name for path in (ROOT / "home_mjx").iterdir() if (path / "__init__.py").exists()}
    assert parts - words == set()


def test_files_that_the_guides_name_exist():
    """Paths in backticks that lie in the repository or in the package."""
    folders = ("docs", "tests", "scripts", "benchmarks", "home_mjx", "requirements")
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    named = {
        (page, path)
        for page in pages
        for path in re.findall(r"`((?:[\w.]+/)+(?:[\w.]+\.(?:py|cu|md|txt))?)`", page.read_text())
    }
    here = [(page, path) for page, path in named if path.split("/")[0] in folders or path.split("/")[0] in PARTS]
    assert len(here) >= 20
    roots = (ROOT, ROOT / "home_mjx")
    assert [f"{page.name}: {path}" for page, path in here if not any((root / path).exists() for root in roots)] == []


def test_every_decision_says_why_and_what_was_measured():
    pages = sorted((ROOT / "docs" / "decisions").glob("0*.md"))
    assert len(pages) >= 10
    listed = (ROOT / "docs" / "decisions" / "index.md").read_text()
    for page in pages:
        text = page.read_text()
        assert re.findall(r"^## (.+)$", text, re.MULTILINE) == ["Context", "Decision", "Consequences", "Measured"]
        title = re.match(r"# (.+)\n", text)
        assert title is not None
        assert f"[{title[1]}]({page.name})" in listed
