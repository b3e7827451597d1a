"""Semantics of a house: categories, colours, materials, sizes, supports, relations and descriptions."""

from home_mjx.scene_compile.semantics.describe import describe_object
from home_mjx.scene_compile.semantics.engine import house_semantics
from home_mjx.scene_compile.semantics.looks.options import HOME, SemanticOptions
from home_mjx.scene_compile.semantics.relations import Relation, Viewpoint
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics, PartSemantics, RoomSemantics
from home_mjx.scene_compile.semantics.vocabulary import names_of, number_of, vocabularies

__all__ = [
    "HOME",
    "HouseSemantics",
    "ObjectSemantics",
    "PartSemantics",
    "Relation",
    "RoomSemantics",
    "SemanticOptions",
    "Viewpoint",
    "describe_object",
    "house_semantics",
    "names_of",
    "number_of",
    "vocabularies",
]
