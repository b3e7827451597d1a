"""Batch simulator of households for massively parallel RL.

Names are imported on first use, so that `import home_mjx` is fast and does not start a JAX backend.
"""

import importlib
from typing import Any

from home_mjx import registry as _registry  # noqa: F401, registers the ids with Gymnasium

__version__ = "0.1.0"

_PUBLIC = {
    "AutoReset": "home_mjx.tasks",
    "Env": "home_mjx.tasks",
    "EnvConfig": "home_mjx.tasks",
    "EnvParams": "home_mjx.tasks",
    "EnvSpec": "home_mjx.registry",
    "HouseBank": "home_mjx.bank",
    "HouseFilter": "home_mjx.houses",
    "HouseSet": "home_mjx.houses",
    "HouseStream": "home_mjx.houses",
    "HouseholdEnv": "home_mjx.tasks",
    "Observer": "home_mjx.tasks.env.observers",
    "Sensor": "home_mjx.tasks",
    "State": "home_mjx.tasks",
    "Task": "home_mjx.tasks",
    "compile_dataset": "home_mjx.houses",
    "compiler_options": "home_mjx.core.compile_cache",
    "list_envs": "home_mjx.registry",
    "load_bank": "home_mjx.houses",
    "make": "home_mjx.env_factory",
    "register": "home_mjx.registry",
    "register_observer": "home_mjx.tasks.env.observers",
    "register_sensor": "home_mjx.tasks",
    "use_compile_cache": "home_mjx.core.compile_cache",
}

__all__ = ["__version__", *_PUBLIC]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'home_mjx' has no attribute {name!r}")
    return getattr(importlib.import_module(_PUBLIC[name]), name)


def __dir__() -> list[str]:
    """Return the public names, sorted."""
    return sorted(__all__)
