"""Compile houses to arrays: `compile_house`, the cache of compiled houses, semantics and MJCF export.

Host code only; no module here imports JAX.
"""

from typing import TYPE_CHECKING

from home_mjx import moved
from home_mjx.datasets.splits import SPLITS, select_ids, split_of
from home_mjx.scene_compile.cache.house_cache import HouseCache, load_compiled
from home_mjx.scene_compile.cache.house_set import HouseSet
from home_mjx.scene_compile.cache.job import compile_dataset
from home_mjx.scene_compile.cache.report import Outcome, Summary
from home_mjx.scene_compile.cache.selection import HouseFilter
from home_mjx.scene_compile.collision.colliders import ColliderOptions
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.lighting.lights import LightOptions
from home_mjx.scene_compile.mjcf.export import export_mjcf, to_mjcf
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.scene_compile.semantics import (
    HOME,
    HouseSemantics,
    ObjectSemantics,
    PartSemantics,
    Relation,
    RoomSemantics,
    SemanticOptions,
    Viewpoint,
    describe_object,
    house_semantics,
    names_of,
    number_of,
    vocabularies,
)

__all__ = [
    "HOME",
    "SPLITS",
    "ColliderOptions",
    "CompileOptions",
    "HouseCache",
    "HouseFilter",
    "HouseSemantics",
    "HouseSet",
    "LightOptions",
    "MovableOptions",
    "NavigationOptions",
    "ObjectSemantics",
    "Outcome",
    "PartSemantics",
    "Relation",
    "RoomSemantics",
    "SemanticOptions",
    "Summary",
    "Viewpoint",
    "compile_dataset",
    "compile_house",
    "describe_object",
    "export_mjcf",
    "house_semantics",
    "load_compiled",
    "names_of",
    "number_of",
    "select_ids",
    "split_of",
    "to_mjcf",
    "vocabularies",
]

if not TYPE_CHECKING:  # type checkers report missing names by themselves
    __getattr__ = moved.attributes_of(__name__)
