"""Examples in docstrings and guides run; what the guides name is there."""

import doctest
import importlib
import pkgutil
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
