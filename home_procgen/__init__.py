"""Procedural homes of one to three storeys, and flats, in SUNCG's on-disk format.

The package registers with `home_mjx` as the dataset scheme `procedural:` and as the provider of fallback models.
Names are imported on first use. It runs on the host only and never imports JAX.
"""

import importlib
from typing import Any

_PUBLIC = {
    "ProceduralDataset": "home_procgen.plugin",
    "build_home": "home_procgen.build",
    "generate_dataset": "home_procgen.generate",
}

__all__ = [*_PUBLIC]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'home_procgen' has no attribute {name!r}")
    return getattr(importlib.import_module(_PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
