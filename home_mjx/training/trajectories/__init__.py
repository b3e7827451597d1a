"""Datasets of recorded episodes in Minari's format, written at GPU simulation speed.

Needs the extra `data`. `record` writes and `Trajectories` reads them; Minari and Apache Arrow readers can read them
too.
"""

import importlib
from typing import TYPE_CHECKING, Any

from home_mjx.errors import ConfigError, install_hint

if TYPE_CHECKING:
    from home_mjx.training.trajectories.reader import Trajectories, Trajectory
    from home_mjx.training.trajectories.recording import record
    from home_mjx.training.trajectories.writer import TrajectoryWriter

__all__ = ["Trajectories", "Trajectory", "TrajectoryWriter", "record"]

_MODULES = {
    "Trajectories": "reader",
    "Trajectory": "reader",
    "TrajectoryWriter": "writer",
    "record": "recording",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'home_mjx.training.trajectories' has no attribute {name!r}")
    try:
        return getattr(importlib.import_module(f"home_mjx.training.trajectories.{_MODULES[name]}"), name)
    except ModuleNotFoundError as error:
        raise ConfigError(f"datasets need the package `{error.name}`", hint=install_hint("data")) from error
