"""Data sets of episodes that were played: written at the speed of a GPU, in Minari's format.

Needs the extra `data`. `record` writes, `Trajectories` reads; so do Minari, and anything that reads Apache Arrow.
"""

import importlib
from typing import TYPE_CHECKING, Any

from home_mjx.errors import ConfigError, install_hint

if TYPE_CHECKING:
    from home_mjx.training.trajectories.reader import Trajectories, Trajectory
    from home_mjx.training.trajectories.recording import record

__all__ = ["Trajectories", "Trajectory", "record"]

_MODULES = {"Trajectories": "reader", "Trajectory": "reader", "record": "recording"}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'home_mjx.training.trajectories' has no attribute {name!r}")
    try:
        return getattr(importlib.import_module(f"home_mjx.training.trajectories.{_MODULES[name]}"), name)
    except ModuleNotFoundError as error:
        raise ConfigError(f"data sets need the package `{error.name}`", hint=install_hint("data")) from error
