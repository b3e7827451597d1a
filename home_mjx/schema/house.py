"""Dataset content as frozen dataclasses of NumPy arrays, in the file's own frame (Y up, metres).

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
    missing_file: str = ""  # name of a missing texture, or of a missing material library if it ends with `.mtl`

    @property
    def texture_name(self) -> str:
        """Name of its texture, even if the image is missing; "" without a texture."""
        return (
            self.texture.stem
            if self.texture is not None
            else ""
            if self.missing_file.endswith(".mtl")
            else self.missing_file
        )


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
    normal: Float[np.ndarray, "f 3 3"] | None = None  # unit, per corner; None if the file lacks normals or all are flat


@dataclass(frozen=True)
class Node:
    """The common fields of a level's nodes."""

    id: str  # "<level>_<index>" as in the file
    index: int  # position in the level's node list
    path: str  # element path for messages: levels[0].nodes[17]
    bbox: Float[np.ndarray, "2 3"] | None  # [m], min and max as in the file
    extra: Mapping[str, Any] = field(default_factory=dict, kw_only=True)  # unknown fields, preserved unchanged


@dataclass(frozen=True)
class ObjectNode(Node):
    """An instance of a library model."""

    model_id: str
    state: int | None  # None or 0: base model (an open door); 1: the `_0` variant (closed)
    transform: Float[np.ndarray, "4 4"]  # scene from model, row-major
    materials: tuple[Material, ...] = ()  # overrides by slot position

    @property
    def model_key(self) -> str:
        """Stem of the OBJ of this instance's state."""
        return self.model_id if not self.state else f"{self.model_id}_{self.state - 1}"

    @property
    def other_state_key(self) -> str:
        """Stem of the OBJ of the other state: the closed variant of an open object, else the open base model."""
        return self.model_id if self.state else f"{self.model_id}_0"

    @property
    def is_mirrored(self) -> bool:
        """True if the transform mirrors the model."""
        return bool(np.linalg.det(self.transform[:3, :3]) < 0)


@dataclass(frozen=True)
class BoxNode(Node):
    """A solid axis-aligned box in its local frame, centred at its origin."""

    dimensions: Float[np.ndarray, " 3"]  # [m], full edge lengths
    transform: Float[np.ndarray, "4 4"]
    materials: tuple[Material, ...] = ()


@dataclass(frozen=True)
class RoomNode(Node):
    """A room; its meshes are already in scene coordinates."""

    model_id: str
    types: tuple[str, ...]  # such as ("Bedroom",); empty if unknown
    members: tuple[int, ...]  # indices of nodes in the level
    floor: Mesh | None
    ceiling: Mesh | None
    walls: Mesh | None


@dataclass(frozen=True)
class GroundNode(Node):
    """A slab of outdoor ground, in scene coordinates."""

    model_id: str
    mesh: Mesh | None


@dataclass(frozen=True)
class UnknownNode(Node):
    """A node of unknown type, which is not visible but preserved for writing."""

    data: Mapping[str, Any]


@dataclass(frozen=True)
class Level:
    """One storey."""

    id: str
    index: int
    rooms: tuple[RoomNode, ...]
    objects: tuple[ObjectNode, ...]
    boxes: tuple[BoxNode, ...]
    grounds: tuple[GroundNode, ...]
    unknown: tuple[UnknownNode, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)  # as of a node
    hidden: tuple[UnknownNode, ...] = ()  # disabled or empty nodes, preserved for writing


@dataclass(frozen=True)
class Problem:
    """A tolerated irregularity of the input, which is always reported."""

    element: str
    message: str
    rule: str = ""  # name of the violated validator rule


@dataclass(frozen=True)
class Fallback:
    """A missing part of the dataset and the fallback used instead."""

    kind: str  # one of STAND_INS
    name: str  # name of the texture, material library, model, room mesh or metadata row
    element: str  # first user: an element path or a file
    replacement: str  # description of the fallback
    reason: str = ""  # cause, if the file is not simply missing

    def __str__(self) -> str:
        reason = f": {self.reason}" if self.reason else ""
        return f"{self.kind} {self.name} of {self.element}{reason}: {self.replacement}"


FALLBACK_KINDS = ("texture", "material library", "model", "room mesh", "metadata row")


@dataclass(frozen=True)
class House:
    """A house with all library models that it uses."""

    id: str
    version: str
    path: Path  # house.json
    levels: tuple[Level, ...]
    models: Mapping[str, Mesh]  # by Object.model_key
    other_state_models: Mapping[str, Mesh] = field(
        default_factory=dict
    )  # by Object.other_key, for objects with another state
    problems: tuple[Problem, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)  # as of a node
    fallbacks: tuple[Fallback, ...] = ()  # fallbacks for missing parts of the dataset


def base_model(model_id: str, known: Callable[[str], bool]) -> str:
    """Return the base model of a variant (`122` of `122_0`, `s__12` of `s__12_2`), or the model itself.

    Ids themselves contain underscores and digits, so the set of existing models decides, not the form of the id.

    Args:
        model_id: The id of a model or of a variant.
        known: Returns whether a model id exists.

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
    """A row of ModelCategoryMapping.csv joined with its row of models.csv."""

    model_id: str
    fine: str = "unknown"
    coarse: str = "unknown"
    nyu40: str = "void"
    dims: tuple[float, float, float] | None = None  # [m], x y z in the model's own Y-up frame
    front: tuple[float, float, float] = (0.0, 0.0, 1.0)
    low: tuple[float, float, float] | None = None  # [m], minimum corner of its box with edges `dims`


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
    dropoff: float = 0.0  # exponent of the cosine to `direction`; intensity falls with the squared distance


@dataclass(frozen=True)
class Metadata:
    """The metadata tables of a dataset."""

    models: Mapping[str, ModelInfo]
    lights: Mapping[str, tuple[Light, ...]] = field(default_factory=dict)

    def info(self, model_id: str) -> ModelInfo:
        """Return the row of a model; variants (`_0`, `_2`) fall back to their base, other ids to `unknown`."""
        return self.models.get(base_model(model_id, self.models.__contains__)) or ModelInfo(model_id)
