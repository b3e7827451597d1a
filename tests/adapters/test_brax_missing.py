"""The adapter says what to install where Brax is not."""

import importlib
import sys

import pytest

from home_mjx.errors import ConfigError


def test_without_brax_the_adapter_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delitem(sys.modules, "home_mjx.adapters.brax", raising=False)
    for name in [name for name in sys.modules if name.split(".")[0] == "brax"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "brax", None)
    with pytest.raises(ConfigError, match=r"pip install '\.\[train\]'"):
        importlib.import_module("home_mjx.adapters.brax")
