"""From the name of a dataset to a bank: sets of houses, the cache of compiled houses, streams and bakes.

`load_bank` is the way in. Engines know compiled houses and banks only; this package alone knows folders on disk.
"""

import importlib
from typing import Any

from home_mjx.houses.house_cache import HouseCache, load_compiled
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.job import compile_dataset
from home_mjx.houses.report import CompileOutcome, CompileSummary
from home_mjx.houses.selection import HouseFilter

_WITH_JAX = {  # imported on first use, so that processes that compile houses load no JAX
    "DEFAULT_DATASET": "home_mjx.houses.load",
    "Bake": "home_mjx.houses.bakes",
    "HouseStream": "home_mjx.houses.stream",
    "add_bakes": "home_mjx.houses.bakes",
    "load_bank": "home_mjx.houses.load",
    "register_bake": "home_mjx.houses.bakes",
}

__all__ = [
    "DEFAULT_DATASET",
    "Bake",
    "CompileOutcome",
    "CompileSummary",
    "HouseCache",
    "HouseFilter",
    "HouseSet",
    "HouseStream",
    "add_bakes",
    "compile_dataset",
    "load_bank",
    "load_compiled",
    "register_bake",
]


def __getattr__(name: str) -> Any:
    if name not in _WITH_JAX:
        raise AttributeError(f"module 'home_mjx.houses' has no attribute {name!r}")
    return getattr(importlib.import_module(_WITH_JAX[name]), name)
