"""Records shared by all packages: the dataset's house, the compiled house, and their vocabularies.

Host only: no module here imports JAX.
"""

from home_mjx.schema.agent import AgentBody
from home_mjx.schema.categories import COARSE, FINE, NYU40, ROOM_TYPES
from home_mjx.schema.compiled import BANDS, CompiledHouse, PortalKind, RayKind
from home_mjx.schema.house import (
    BoxNode,
    GroundNode,
    House,
    Joint,
    Level,
    Light,
    Material,
    Mesh,
    Metadata,
    ModelInfo,
    ObjectNode,
    RoomNode,
)
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.timing import Timing

__all__ = [
    "BANDS",
    "COARSE",
    "FINE",
    "NYU40",
    "ROOM_TYPES",
    "AgentBody",
    "BoxNode",
    "CompiledHouse",
    "GroundNode",
    "House",
    "Joint",
    "Level",
    "Light",
    "Material",
    "Mesh",
    "Metadata",
    "ModelInfo",
    "ObjectNode",
    "PortalKind",
    "RayKind",
    "RoomNode",
    "Semantic",
    "Timing",
]
