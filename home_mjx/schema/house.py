"""Dataset content as frozen dataclasses of NumPy arrays, in the file's own frame (Y up, metres).

Nothing here needs JAX or MuJoCo. The compiler turns these into the world frame (Z up).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from home_mjx.errors import ConfigError
from home_mjx.schema.house_html import format_house
from home_mjx.schema.lighting import SurfaceMaps


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
    maps: SurfaceMaps | None = None  # of physically based materials

    @property
    def texture_name(self) -> str:
        """Name of its texture without extension, even if the image is missing; "" without a texture."""
        if self.texture is not None:
            return self.texture.stem
        return "" if self.missing_file.endswith(".mtl") else self.missing_file


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh with material slots."""

    path: Path  # its file, for messages
    vertices: Float[np.ndarray, "v 3"]  # [m], Y up
    faces: Int[np.ndarray, "f 3"]  # indices into vertices, counter-clockwise outwards
    uv: Float[np.ndarray, "f 3 2"]  # per corner; 0 where the file has none
    slot: Int[np.ndarray, " f"]  # index into materials
    group: Int[np.ndarray, " f"]  # index into groups; -1 where the file has none
    materials: tuple[Material, ...]
    groups: tuple[str, ...] = ()  # names of the groups, such as the `o` lines of an OBJ; nothing is derived from them
    normal: Float[np.ndarray, "f 3 3"] | None = None  # unit, per corner; None if the file lacks normals or all are flat
    part: Int[np.ndarray, " f"] | None = None  # of a mesh of walls: wall of each face; None: all faces are one wall

    def faces_by_part(self) -> list[Int[np.ndarray, " _"]]:
        """Return the face indices of each part with faces, in ascending order; all faces as one if `part` is None.

        Faces of part -1 are a part as well, the first.
        """
        part = np.zeros(len(self.faces), int) if self.part is None else self.part
        return [np.flatnonzero(part == number) for number in np.unique(part)]


JointKind = Literal["hinge", "slide"]
JOINT_KINDS: tuple[str, ...] = get_args(JointKind)
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Joint:
    """A movable part of a model's mesh, in the model's own Y-up frame; joint value 0 is the pose of the mesh.

    Example:
        >>> door = Joint("home_x_1", "door_1", "hinge", (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), 0.0, 1.5, ((0, 1), (4, 4)))
        >>> door.faces.tolist()
        [0, 1, 4]
    """

    model_id: str
    part: str  # such as `drawer_2`: kind of part, and a number unique in its model
    kind: JointKind
    axis: Vector  # unit vector; right-handed rotation of a hinge, direction of a slide
    point: Vector  # [m], a point on the axis of a hinge or on the front of a slide
    low: float  # hinge [rad], slide [m]; minimum, at most 0
    high: float
    face_ranges: tuple[tuple[int, int], ...]  # first and last face of each run; joints of a mesh share no face
    closed: float = 0.0  # value of the closed pose

    @property
    def open(self) -> float:
        """Joint value [rad] or [m] of the end of the range that is farther from `closed`; `high` if both are as far."""
        return self.high if self.high - self.closed >= self.closed - self.low else self.low

    @cached_property
    def faces(self) -> Int[np.ndarray, " n"]:
        """Indices of its faces in the mesh."""
        return np.concatenate([np.arange(first, last + 1) for first, last in self.face_ranges])

    def matrix(self, value: float) -> Float[np.ndarray, "4 4"]:
        """Return the rigid motion (column vectors, model's frame) of the part from joint value 0 to `value`.

        Args:
            value: Angle [rad] or displacement [m].

        Raises:
            ConfigError: The value is outside the joint's range.
        """
        if not self.low <= value <= self.high:
            hint = f"Its range is {self.low:g} to {self.high:g}."
            raise ConfigError(f"{self.model_id} {self.part} has no joint value {value!r:.40}", hint=hint)
        motion = np.eye(4)
        if self.kind == "slide":
            motion[:3, 3] = value * np.asarray(self.axis)
        else:
            motion[:3, :3] = _turn(np.asarray(self.axis), value)
            motion[:3, 3] = np.asarray(self.point) - motion[:3, :3] @ np.asarray(self.point)
        return motion

    def move(self, mesh: Mesh, value: float) -> Mesh:
        """Return a copy of a mesh with this part moved; call it once per part to move several parts.

        Vertices that other faces share with this part move with it.

        Args:
            mesh: The joint's mesh with its faces in their original order; this part is at joint value 0.
            value: Angle [rad] or displacement [m].

        Raises:
            ConfigError: The value is out of range, or the mesh lacks faces of the part.
        """
        if self.face_ranges[-1][1] >= len(mesh.faces):
            raise ConfigError(f"{self.model_id} {self.part} has faces that the mesh lacks", hint="Is it another model?")
        motion, vertices = self.matrix(value), mesh.vertices.copy()
        own = np.unique(mesh.faces[self.faces])
        vertices[own] = vertices[own] @ motion[:3, :3].T + motion[:3, 3]
        return replace(mesh, vertices=vertices, normal=_turned(mesh, self.faces, motion[:3, :3]))


def _turn(axis: Float[np.ndarray, " 3"], angle: float) -> Float[np.ndarray, "3 3"]:
    """Return the right-handed rotation by `angle` [rad] about a unit vector, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def _turned(mesh: Mesh, faces: Int[np.ndarray, " n"], turn: Float[np.ndarray, "3 3"]) -> np.ndarray | None:
    """Return the mesh's corner normals with those of `faces` rotated; None if it has none."""
    if mesh.normal is None:
        return None
    normal = mesh.normal.copy()
    normal[faces] = normal[faces] @ turn.T
    return normal


Joints = Mapping[str, tuple[Joint, ...]]  # by model id
LightKind = Literal["point", "spot", "line"]


@dataclass(frozen=True)
class Light:
    """One light of a lamp model, in the model's own Y-up frame."""

    kind: LightKind
    power: float  # [W]
    color: tuple[float, float, float]  # sRGB, 0..1
    position: tuple[float, float, float]  # [m]
    direction: tuple[float, float, float] | None = None
    cutoff: float | None = None  # [rad]
    end: tuple[float, float, float] | None = None  # [m], second end of a `line`
    dropoff: float = 0.0  # exponent of the cosine to `direction`; intensity falls with the squared distance


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
    """An instance of a model."""

    model_id: str  # id of its category and size, see `Metadata.info`
    model_key: str  # key of its mesh in `House.models`; states of a model, such as open and closed, have own meshes
    transform: Float[np.ndarray, "4 4"]  # scene from model, row-major
    materials: tuple[Material, ...] = ()  # overrides by slot position
    lights: tuple[Light, ...] = ()  # lights that it carries, in its model's frame
    joints: tuple[Joint, ...] = ()  # movable parts of its mesh; the compiler uses those of doors

    @property
    def is_mirrored(self) -> bool:
        """True if the transform has a negative determinant, which reverses the winding of faces."""
        return bool(np.linalg.det(self.transform[:3, :3]) < 0)


@dataclass(frozen=True)
class BoxNode(Node):
    """A solid axis-aligned box in its local frame, centred at its origin."""

    dimensions: Float[np.ndarray, " 3"]  # [m], full edge lengths
    transform: Float[np.ndarray, "4 4"]
    materials: tuple[Material, ...] = ()


@dataclass(frozen=True)
class StatedOutline:
    """Outline and heights of a room whose meshes do not tell them, such as those of a scan."""

    corners: Float[np.ndarray, "n 2"]  # [m], (x, z) in scene coordinates, of either winding
    floor: float  # [m], height of the floor's upper side
    ceiling: float  # [m], height of the ceiling's underside


@dataclass(frozen=True)
class RoomNode(Node):
    """A room; its meshes are already in scene coordinates."""

    model_id: str
    types: tuple[str, ...]  # such as ("Bedroom",); empty if unknown
    members: tuple[int, ...]  # indices of nodes in the level
    floor: Mesh | None
    ceiling: Mesh | None
    walls: Mesh | None
    shape: StatedOutline | None = None  # stated outline and heights; None: those of the meshes


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

    kind: str  # one of FALLBACK_KINDS
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
    path: Path  # its file, for messages
    levels: tuple[Level, ...]
    models: Mapping[str, Mesh]  # by `ObjectNode.model_key`
    problems: tuple[Problem, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)  # as of a node
    fallbacks: tuple[Fallback, ...] = ()  # fallbacks for missing parts of the dataset

    def _repr_html_(self) -> str:
        """Return counts, rooms with their objects, and the plan of each level, for notebooks."""
        rows = {"version": self.version, "models": len(self.models), "problems": len(self.problems)}
        rooms = {
            f"level {number}, room {n}": f"{', '.join(room.types) or 'unknown'}: {len(room.members)} objects"
            for number, level in enumerate(self.levels)
            for n, room in enumerate(level.rooms)
        }
        meshes = [[room.floor for room in level.rooms if room.floor is not None] for level in self.levels]
        plans = [[m.vertices[m.faces][..., [0, 2]] * np.array([1.0, -1.0]) for m in floors] for floors in meshes]
        return format_house(self.id, rows | rooms, plans)


@dataclass(frozen=True)
class ModelInfo:
    """Category and size of a model, in SUNCG's vocabulary."""

    model_id: str
    fine: str = "unknown"
    coarse: str = "unknown"
    nyu40: str = "void"
    dims: tuple[float, float, float] | None = None  # [m], x y z in the model's own Y-up frame
    front: tuple[float, float, float] = (0.0, 0.0, 1.0)
    low: tuple[float, float, float] | None = None  # [m], minimum corner of its box with edges `dims`


@dataclass(frozen=True)
class Metadata:
    """Categories and sizes of the models of a dataset."""

    models: Mapping[str, ModelInfo]  # by `ObjectNode.model_id`

    def info(self, model_id: str) -> ModelInfo:
        """Return the row of a model; if it has none, one with the defaults of `ModelInfo` (category `unknown`)."""
        return self.models.get(model_id) or ModelInfo(model_id)
