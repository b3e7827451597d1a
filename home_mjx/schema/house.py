"""The content of a dataset as frozen dataclasses of NumPy arrays, in the file's own frame (Y up, metres).

Nothing here needs JAX or MuJoCo. The compiler turns these into the world frame (Z up).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True)
class Material:
    """One material slot: an MTL `newmtl`, or an override from house.json (then None keeps the MTL's value)."""

    name: str
    diffuse: tuple[float, float, float] | None = None  # sRGB, 0..1
    texture: Path | None = None  # existing image file
    opacity: float | None = None  # 1 = opaque
    specular: tuple[float, float, float] | None = None  # linear light, `Ks`
    shininess: float | None = None  # `Ns`, Blinn-Phong exponent
    lacking: str = ""  # name of a texture, or with `.mtl` of a material library, that the dataset lacks

    @property
    def texture_name(self) -> str:
        """Name of its texture, whether the dataset has it or not; "" if there is none."""
        return self.texture.stem if self.texture is not None else "" if self.lacking.endswith(".mtl") else self.lacking


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh as read from one OBJ and its MTL."""

    path: Path
    vertices: Float[np.ndarray, "v 3"]  # [m], Y up
    faces: Int[np.ndarray, "f 3"]  # indices into vertices, counter-clockwise outwards
    uv: Float[np.ndarray, "f 3 2"]  # per corner; 0 where the file has none
    slot: Int[np.ndarray, " f"]  # index into materials, in MTL order
    group: Int[np.ndarray, " f"]  # index into groups; -1 where the file has none
    materials: tuple[Material, ...]
    groups: tuple[str, ...] = ()  # names of the `o` lines, such as WallInside#0_1_3
    normal: Float[np.ndarray, "f 3 3"] | None = None  # unit, per corner; None if the file has none or flat ones only


@dataclass(frozen=True)
class Node:
    """The fields that all nodes of a level have."""

    id: str  # "<level>_<index>" as in the file
    index: int  # position in the level's node list
    path: str  # element path for messages: levels[0].nodes[17]
    bbox: Float[np.ndarray, "2 3"] | None  # [m], min and max as in the file
    extra: Mapping[str, Any] = field(default_factory=dict, kw_only=True)  # unknown fields, unchanged


@dataclass(frozen=True)
class Object(Node):
    """An instance of a library model."""

    model_id: str
    state: int | None  # None or 0: base model (an open door); 1: the `_0` variant (closed)
    transform: Float[np.ndarray, "4 4"]  # scene from model, row-major
    materials: tuple[Material, ...] = ()  # overrides by slot position

    @property
    def model_key(self) -> str:
        """Stem of the OBJ that this instance shows."""
        return self.model_id if not self.state else f"{self.model_id}_{self.state - 1}"

    @property
    def other_key(self) -> str:
        """Stem of the OBJ of the other state: closed for what is shown open, else open."""
        return self.model_id if self.state else f"{self.model_id}_0"

    @property
    def mirrored(self) -> bool:
        """Whether the transform mirrors the model."""
        return bool(np.linalg.det(self.transform[:3, :3]) < 0)


@dataclass(frozen=True)
class Box(Node):
    """A solid axis-aligned box in its local frame, centred at its origin."""

    dimensions: Float[np.ndarray, " 3"]  # [m], full edge lengths
    transform: Float[np.ndarray, "4 4"]
    materials: tuple[Material, ...] = ()


@dataclass(frozen=True)
class Room(Node):
    """A room; its meshes are already in scene coordinates."""

    model_id: str
    types: tuple[str, ...]  # such as ("Bedroom",); empty if unknown
    members: tuple[int, ...]  # indices of nodes in the level
    floor: Mesh | None
    ceiling: Mesh | None
    walls: Mesh | None


@dataclass(frozen=True)
class Ground(Node):
    """A slab of outdoor ground, in scene coordinates."""

    model_id: str
    mesh: Mesh | None


@dataclass(frozen=True)
class Unknown(Node):
    """A node of an unknown type: not shown, but kept as in the file and written again."""

    data: Mapping[str, Any]


@dataclass(frozen=True)
class Level:
    """One storey."""

    id: str
    index: int
    rooms: tuple[Room, ...]
    objects: tuple[Object, ...]
    boxes: tuple[Box, ...]
    grounds: tuple[Ground, ...]
    unknown: tuple[Unknown, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)  # as of a node
    hidden: tuple[Unknown, ...] = ()  # switched off or empty: only to be written again


@dataclass(frozen=True)
class Problem:
    """An oddity in the input that was tolerated: kept and reported, never dropped silently."""

    element: str
    message: str
    rule: str = ""  # name of the validator's rule that it breaks


@dataclass(frozen=True)
class StandIn:
    """Something that the dataset lacks, and what was taken in its place."""

    kind: str  # one of STAND_INS
    name: str  # of the texture, material library, model, mesh of a room, or row
    element: str  # who needs it first: an element path or a file
    taken: str  # what stands in
    reason: str = ""  # why, if not because the file is missing

    def __str__(self) -> str:
        reason = f": {self.reason}" if self.reason else ""
        return f"{self.kind} {self.name} of {self.element}{reason}: {self.taken}"


STAND_INS = ("texture", "material library", "model", "room mesh", "metadata row")


@dataclass(frozen=True)
class House:
    """One house and every library model that it uses."""

    id: str
    version: str
    path: Path  # house.json
    levels: tuple[Level, ...]
    models: Mapping[str, Mesh]  # by Object.model_key
    others: Mapping[str, Mesh] = field(default_factory=dict)  # by Object.other_key, for objects with another state
    problems: tuple[Problem, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)  # as of a node
    stand_ins: tuple[StandIn, ...] = ()  # for what the dataset lacks


def base_model(model_id: str, known: Callable[[str], bool]) -> str:
    """The base model of a variant (`122` of `122_0`, `s__12` of `s__12_2`), or the model itself.

    Ids contain underscores and digits themselves, so the existing models decide, not the form of the id.

    Args:
        model_id: The id of a model or of a variant.
        known: Says whether a model of an id exists.

    Example:
        >>> models = {"122", "s__12", "s__1296", "table_1"}
        >>> [base_model(key, models.__contains__) for key in ("122_0", "s__12_2", "s__1296", "table_1", "table_1_0")]
        ['122', 's__12', 's__1296', 'table_1', 'table_1']
    """
    base, _, variant = model_id.rpartition("_")
    is_variant = len(variant) == 1 and variant in "0123456789" and not known(model_id) and known(base)
    return base if is_variant else model_id


@dataclass(frozen=True)
class ModelInfo:
    """A row of ModelCategoryMapping.csv joined with one of models.csv."""

    model_id: str
    fine: str = "unknown"
    coarse: str = "unknown"
    nyu40: str = "void"
    dims: tuple[float, float, float] | None = None  # [m], x y z in the model's own Y-up frame
    front: tuple[float, float, float] = (0.0, 0.0, 1.0)
    low: tuple[float, float, float] | None = None  # [m], least corner of its box, of which `dims` are the edges


@dataclass(frozen=True)
class Light:
    """One light of a lamp model, in the model's own Y-up frame."""

    kind: str  # PointLight, SpotLight, LineLight
    power: float  # [W]
    color: tuple[float, float, float]  # sRGB, 0..1
    position: tuple[float, float, float]  # [m]
    direction: tuple[float, float, float] | None = None
    cutoff: float | None = None  # [rad]
    end: tuple[float, float, float] | None = None  # [m], second end of a LineLight
    dropoff: float = 0.0  # exponent of the cosine from `direction`; light falls with the square of the distance


@dataclass(frozen=True)
class Metadata:
    """The metadata tables of a dataset."""

    models: Mapping[str, ModelInfo]
    lights: Mapping[str, tuple[Light, ...]] = field(default_factory=dict)

    def info(self, model_id: str) -> ModelInfo:
        """The row of a model; variants (`_0`, `_2`) fall back to their base, the rest to `unknown`."""
        return self.models.get(base_model(model_id, self.models.__contains__)) or ModelInfo(model_id)
