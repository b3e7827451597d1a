"""An adapter says what to install where its library is not."""

import importlib
import sys

import pytest

from home_mjx.errors import ConfigError


@pytest.mark.parametrize(
    ("adapter", "package", "hint"),
    [
        ("brax", "brax", r"pip install '\.\[train\]'"),
        ("jaxmarl", "jaxmarl", r"pip install '\.\[multiagent\]'"),
        ("pettingzoo", "pettingzoo", r"pip install '\.\[multiagent\]'"),
        ("playground", "mujoco_playground", r"pip install '\.\[playground\]'"),
        ("pytorch", "torch", "pip install torch"),
        ("stable_baselines3", "stable_baselines3", r"pip install '\.\[sb3\]'"),
    ],
)
def test_without_its_package_an_adapter_says_what_to_install(adapter, package, hint, monkeypatch: pytest.MonkeyPatch):
    if adapter == "playground":
        pytest.importorskip("brax", reason="its own absence would be told")
    monkeypatch.delitem(sys.modules, f"home_mjx.adapters.{adapter}", raising=False)
    for name in [name for name in sys.modules if name.split(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ConfigError, match=hint):
        importlib.import_module(f"home_mjx.adapters.{adapter}")
