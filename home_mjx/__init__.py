"""Batch simulator of households for massively parallel RL.

Names are imported on first use, so that `import home_mjx` is quick and starts no JAX backend.
"""

import importlib
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {
    "AutoReset": "home_mjx.tasks",
    "EnvConfig": "home_mjx.tasks",
    "HouseBank": "home_mjx.bank",
    "HouseFilter": "home_mjx.scene_compile",
    "HouseSet": "home_mjx.scene_compile",
    "HouseStream": "home_mjx.bank",
    "HouseholdEnv": "home_mjx.tasks",
    "State": "home_mjx.tasks",
    "compile_dataset": "home_mjx.scene_compile",
    "list_envs": "home_mjx.registry",
    "make": "home_mjx.registry",
    "register": "home_mjx.registry",
}

__all__ = ["__version__", *_PUBLIC]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'home_mjx' has no attribute {name!r}")
    return getattr(importlib.import_module(_PUBLIC[name]), name)


def _register_with_gymnasium() -> None:
    from home_mjx.adapters.gymnasium_ids import register_all

    register_all()


def __dir__() -> list[str]:
    return sorted(__all__)


_register_with_gymnasium()
