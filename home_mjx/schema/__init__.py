"""Records shared by all packages: the dataset's house, the compiled house, and their vocabularies.

Host only: no module here imports JAX.
"""

from home_mjx.schema.agent import Body
from home_mjx.schema.categories import COARSE, FINE, NYU40, ROOM_TYPES
from home_mjx.schema.compiled import BANDS, CompiledHouse, PortalKind, Ray
from home_mjx.schema.house import Box, Ground, House, Level, Light, Material, Mesh, Metadata, ModelInfo, Object, Room
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.timing import Timing

__all__ = [
    "BANDS",
    "COARSE",
    "FINE",
    "NYU40",
    "ROOM_TYPES",
    "Body",
    "Box",
    "CompiledHouse",
    "Ground",
    "House",
    "Level",
    "Light",
    "Material",
    "Mesh",
    "Metadata",
    "ModelInfo",
    "Object",
    "PortalKind",
    "Ray",
    "Room",
    "Semantic",
    "Timing",
]
