"""Semantics of a house: categories, colours, materials, sizes, supports, relations and descriptions."""

from home_mjx.scene_compile.semantics.appearance import SemanticOptions
from home_mjx.scene_compile.semantics.describe import describe_object
from home_mjx.scene_compile.semantics.engine import house_semantics
from home_mjx.scene_compile.semantics.relations import ObserverPose, Relation
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics, PartSemantics, RoomSemantics
from home_mjx.schema.vocabulary import decode_row, encode_name, vocabularies

__all__ = [
    "HouseSemantics",
    "ObjectSemantics",
    "ObserverPose",
    "PartSemantics",
    "Relation",
    "RoomSemantics",
    "SemanticOptions",
    "decode_row",
    "describe_object",
    "encode_name",
    "house_semantics",
    "vocabularies",
]
