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
    HouseSemantics,
    ObjectSemantics,
    ObserverPose,
    PartSemantics,
    Relation,
    RoomSemantics,
    SemanticOptions,
    decode_row,
    describe_object,
    encode_name,
    house_semantics,
    vocabularies,
)

__all__ = [
    "ColliderOptions",
    "CompileOptions",
    "HouseSemantics",
    "LightOptions",
    "MovableOptions",
    "NavigationOptions",
    "ObjectSemantics",
    "ObserverPose",
    "PartSemantics",
    "Relation",
    "RoomSemantics",
    "SemanticOptions",
    "compile_house",
    "decode_row",
    "describe_object",
    "encode_name",
    "export_mjcf",
    "house_semantics",
    "to_mjcf",
    "vocabularies",
]
