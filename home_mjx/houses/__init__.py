"""From the name of a dataset to a bank: sets of houses, the cache of compiled houses, streams and bakes.

`load_bank` is the entry point. Engines use compiled houses and banks only; this package alone reads folders on disk.
Names are imported on first use: processes that compile houses load no JAX, and tasks load no compiler.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from home_mjx.houses.bakes import Bake, add_bakes, register_bake
    from home_mjx.houses.house_cache import HouseCache, load_compiled
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.houses.job import compile_dataset
    from home_mjx.houses.load import DEFAULT_DATASET, load_bank
    from home_mjx.houses.report import CompileOutcome, CompileSummary
    from home_mjx.houses.selection import HouseFilter
    from home_mjx.houses.stream import HouseStream

_MODULES = {
    "DEFAULT_DATASET": "load",
    "Bake": "bakes",
    "CompileOutcome": "report",
    "CompileSummary": "report",
    "HouseCache": "house_cache",
    "HouseFilter": "selection",
    "HouseSet": "house_set",
    "HouseStream": "stream",
    "add_bakes": "bakes",
    "compile_dataset": "job",
    "load_bank": "load",
    "load_compiled": "house_cache",
    "register_bake": "bakes",
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
    if name not in _MODULES:
        raise AttributeError(f"module 'home_mjx.houses' has no attribute {name!r}")
    return getattr(importlib.import_module(f"home_mjx.houses.{_MODULES[name]}"), name)
