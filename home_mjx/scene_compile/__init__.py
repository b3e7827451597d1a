"""Compiler from houses to arrays: `compile_house`, semantics, MJCF.

Host code only; no module here imports JAX.
"""

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
    "ColliderOptions",
    "CompileOptions",
    "HouseSemantics",
    "LightOptions",
    "MovableOptions",
    "NavigationOptions",
    "ObjectSemantics",
    "PartSemantics",
    "Relation",
    "RoomSemantics",
    "SemanticOptions",
    "Viewpoint",
    "compile_house",
    "describe_object",
    "export_mjcf",
    "house_semantics",
    "names_of",
    "number_of",
    "to_mjcf",
    "vocabularies",
]
